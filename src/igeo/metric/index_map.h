/// The map from the index space of a band to that of another grid.
#pragma once

#include <igeo/base/types.h>
#include <openvdb/openvdb.h>

#include <array>
#include <string>

namespace igeo {

/// An affine map: origin + axis[0] x + axis[1] y + axis[2] z.
struct IndexMap {
    std::array<Vec3d, 3> axis{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d origin{};

    Vec3d operator()(const Vec3d& p) const { return origin + direction(p); }
    Vec3d direction(const Vec3d& v) const { return v.x * axis[0] + v.y * axis[1] + v.z * axis[2]; }

    IndexMap inverse() const;
};

/// The map from the index space of `from` through the world to that of a grid. Numbers that are
/// whole but for rounding are rounded: grids on the same voxels are read exactly, wherever they lie
/// in the world.
/// @param where  the grid, for messages
/// @throws Error  BadInput for a transform that is not linear, or has no inverse
IndexMap indexMap(const Similarity& from, const openvdb::math::Transform& to,
                  const std::string& where);

}  // namespace igeo
