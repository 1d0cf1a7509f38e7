/// The torus that the invariance tests turn, shift, scale and split, and how results are compared.
#pragma once

#include <igeo/march/godunov.h>
#include <igeo/surface/level_set_band.h>
#include <openvdb/openvdb.h>

#include <array>
#include <functional>
#include <vector>

namespace igeo::test {

/// Radii 14 and 6 voxels, dx = 1, off every lattice line and symmetry, so that no two distances
/// tie. The layer is 4 voxels wide.
openvdb::FloatGrid::Ptr torusGrid();

/// Points on that torus, index space.
std::vector<Vec3d> torusPoints();

/// The band of a grid, which has to pass checkLevelSet. h = 0: the default width of the order.
Band bandOf(const openvdb::FloatGrid::Ptr& grid, double h, int order = 2);

/// In place of an order: the scheme jet.
constexpr int kJet = 0;

/// How far roundings may move a result, as a share of its largest distance. jet decides by
/// thresholds (which bucket, fit or fallback); a rounding that tips one changes a value by up to
/// the 0.01 voxels within which its two answers count as one.
inline double roundingTolerance(const Field& field, int order, double godunov) {
    return order == kJet ? 0.01 / field.maxDistance : godunov;
}

/// Marches from the points of S nearest to `seeds`, index space, with godunov of the given order or
/// jet.
Field march(const Band& band, const std::vector<Vec3d>& seeds, int order);
Field marchFrom(const Band& band, const std::vector<SurfacePoint>& seeds, int order);

/// The point of S nearest to p with coordinates in multiples of 2^-20 voxels, which shifts by up to
/// 2^32 voxels do not round; and the seed of a band that was shifted so.
SurfacePoint dyadicSeed(const Band& band, const Vec3d& p);
SurfacePoint shifted(SurfacePoint seed, const Band& from, const Band& to, const Ijk& by);

/// The grid whose voxel map(ijk) has the value of `grid` at ijk; same transform.
openvdb::FloatGrid::Ptr mapVoxels(const openvdb::FloatGrid& grid,
                                  const std::function<Ijk(const Ijk&)>& map);

/// Turns by 90 degrees and reflections: signed permutations of the axes, 48 in all.
struct Turn {
    std::array<int, 3> axis{0, 1, 2}, sign{1, 1, 1};

    template <typename T>
    Vec3<T> operator()(const Vec3<T>& v) const {
        Vec3<T> r;
        for (int a = 0; a < 3; ++a) r[a] = T(sign[std::size_t(a)]) * v[axis[std::size_t(a)]];
        return r;
    }
};
std::vector<Turn> allTurns();

/// The same voxels and values, in units `factor` times as large.
openvdb::FloatGrid::Ptr inUnits(const openvdb::FloatGrid& grid, double factor);

/// Largest |a(ijk) / scale - b(map(ijk))| over the nodes of `a`, as a share of the largest distance
/// of `b`; 0 means equal bits. Infinity where one has a node or a distance and the other has not.
double worstDifference(const Field& a, const Field& b, const std::function<Ijk(const Ijk&)>& map,
                       double scale = 1);

/// The same where both bands have the same nodes.
double worstDifference(const Field& a, const Field& b);

}  // namespace igeo::test
