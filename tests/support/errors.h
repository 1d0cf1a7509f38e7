/// How far a computed field is off an exact distance.
#pragma once

#include <igeo/distance.h>
#include <igeo/surface/level_set.h>
#include <openvdb/openvdb.h>

#include <functional>
#include <vector>

namespace igeo::test {

/// Exact distance from the seed at a world position on the surface; NaN: leave the point out.
using ExactDistance = std::function<double(const openvdb::Vec3d& pWorld)>;

/// In percent of the largest exact distance.
struct Errors {
    double mean = 0, max = 0, p99 = 0, bias = 0;
    std::size_t samples = 0, unreached = 0;
};

/// Compares d with `exact` at the foot points of band voxels with |psi| < 1 voxel.
/// @param stride takes every stride-th of them, for slow oracles
Errors errorsOnSurface(const Distance& distance, const ExactDistance& exact,
                       std::size_t stride = 1);

/// Slope of log(error) against log(dx), least squares.
double fittedRate(const std::vector<double>& dx, const std::vector<double>& error);

/// A grid as checkLevelSet takes it.
LevelSet checkedLevelSet(const openvdb::FloatGrid::Ptr& grid);

/// The point of S nearest to a world position.
SurfacePoint pointOn(const Band& band, const openvdb::Vec3d& pWorld);

/// World position of a point in index space.
openvdb::Vec3d worldOf(const Band& band, const Vec3d& pIndex);

inline Vec3d fromVdb(const openvdb::Vec3d& p) { return {p.x(), p.y(), p.z()}; }

/// World position of the first seed, which was moved onto S.
openvdb::Vec3d seedOf(const Distance& distance);

/// Direction in which nothing lies on a lattice line or plane, and further ones like it.
openvdb::Vec3d genericDirection(int k = 0);

}  // namespace igeo::test
