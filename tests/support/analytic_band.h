/// Bands filled from formulas: no level set, no OpenVDB, every number known.
#pragma once

#include <igeo/band/band.h>

#include <functional>
#include <vector>

namespace igeo::test {

/// A band whose nodes are these voxels, in any order; psi, foot points and normals are zero.
Band bandOfVoxels(const std::vector<Ijk>& voxels);

/// The voxels of the box [low, high] with |psi| < h, with exact psi, foot points and normals.
/// @param psi     signed distance, voxels
/// @param normal  its gradient
Band analyticBand(const std::function<double(const Vec3d&)>& psi,
                  const std::function<Vec3d(const Vec3d&)>& normal, const Ijk& low, const Ijk& high,
                  double h);

/// The plane dot(unit normal, p) = offset.
Band planeBand(const Vec3d& normal, double offset, const Ijk& low, const Ijk& high, double h);

/// The sphere of `radius` voxels about `center`.
Band sphereBand(const Vec3d& center, double radius, double h);

}  // namespace igeo::test
