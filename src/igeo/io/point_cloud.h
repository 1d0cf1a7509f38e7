/// Points on or near a surface.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo {

/// Points on or near a surface, world units.
struct PointCloud {
    std::string file;  ///< as given, for messages
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;  ///< per point, nonzero, of any length; empty: no normals
    std::vector<std::string> warnings = {};  ///< about the file, one sentence each
};

/// Throws BadInput, naming the point, unless all is finite and no normal is zero.
void requireUsable(const PointCloud& cloud);

/// Each position once, sorted. Of several points at one position the one with the lexicographically
/// least normal is kept, so that the order of the input has no effect.
PointCloud distinctPoints(const PointCloud& cloud);

}  // namespace igeo
