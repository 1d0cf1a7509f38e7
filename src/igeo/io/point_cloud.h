/// Points on or near a surface.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo {

/// Points on or near a surface, world units.
struct PointCloud {
    std::string file;  ///< as named, for messages
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;  ///< per point, of any length but zero; empty: none are known
    std::vector<std::string> warnings = {};  ///< of the file, in sentences
};

/// Throws BadInput, naming the point, unless all is finite and no normal is zero.
void requireUsable(const PointCloud& cloud);

/// Each position once, sorted; of several points in one place the one whose normal is lowest by
/// coordinates, so that the order of the input has no effect.
PointCloud distinctPoints(const PointCloud& cloud);

}  // namespace igeo
