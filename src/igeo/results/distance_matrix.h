/// All distances between two lists of points or groups of points.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// The point, or group of points, of a row or column of a matrix.
struct MatrixPlace {
    std::string name;        ///< of a named group
    SnappedPoint point;      ///< of a group its first point
    std::size_t points = 1;  ///< number of points
    bool isGroup() const { return points > 1 || !name.empty(); }
};

struct DistanceMatrix {
    std::vector<MatrixPlace> seeds, targets;  ///< of its rows and its columns
    std::size_t firstRow = 0;                 ///< nonzero only in a part
    /// Row by row, world units times weight; +infinity: no path; NaN: the target is off the surface
    /// and was skipped.
    std::vector<double> distance;
    /// Between seeds: the largest |d_ij - d_ji| / (their mean), the difference between marches in
    /// the two directions. NaN in a part, where it is unknown; else 0.
    double asymmetry = 0;
    std::size_t oneWay = 0;    ///< pairs of seeds with a path in one direction only
    bool withReasons = false;  ///< matrixCsv writes why targets have no distances

    std::size_t rows() const { return targets.empty() ? 0 : distance.size() / targets.size(); }
    double at(std::size_t seed, std::size_t target) const {
        return distance[(seed - firstRow) * targets.size() + target];
    }
};

/// Distances from every seed to every target by marchJet, one march per seed, which stops once its
/// targets are known. Points joined with the one before (SurfacePoint::joined) form a group with
/// one row or column; its distance is that between the nearest points of two groups.
/// @param targets empty: the seeds themselves. Then d_ij is the mean of the marches from i and from
///                j (makeSymmetric)
/// SurfacePoint::start has no effect.
/// @throws Error  InvalidArgument without seeds; as marchJet; Cancelled
/// The marches run side by side, with at most one field per thread in memory. Same bits for any
/// number of threads.
DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets = {},
                         Progress& progress = Progress::none());

/// Why a point has no distance: "0.53 from the surface"; empty: it is on the surface.
std::string skippedReason(const SnappedPoint& point);

/// A part of the matrix: the rows in [firstRow, endRow), in one direction, even if there are no
/// targets. The parts in order form the matrix; between seeds makeSymmetric must follow.
DistanceMatrix distanceRows(const Band& band, const MetricPtr& metric,
                            const std::vector<SurfacePoint>& seeds,
                            const std::vector<SurfacePoint>& targets, std::size_t firstRow,
                            std::size_t endRow, Progress& progress = Progress::none());

/// Completes a matrix between seeds from its one-way distances: the mean of both directions, or the
/// one that arrived, and 0 on the diagonal; sets `asymmetry` and `oneWay`.
void makeSymmetric(DistanceMatrix& matrix);

/// A sentence on `oneWay`; empty where it is 0.
std::string oneWayWarning(const DistanceMatrix& matrix);

/// Comma-separated. The first line is `target,x,y,z` and a name per seed: `distance_` and the name
/// of the group or the number of the seed. Then a line per target: its number or the name of its
/// group, its position on the surface (`nan` for a group), and its distance from each seed, `inf`
/// where there is no path. Reading the numbers gives the same doubles. With `withReasons` there is
/// a last column `reason`; for a skipped target it is the only value, and the numbers are empty.
std::string matrixCsv(const DistanceMatrix& matrix);

/// NumPy's format, version 1.0: little-endian float64, C order, shape (seeds, targets), with
/// infinities; NaN for skipped targets.
std::string matrixNpy(const DistanceMatrix& matrix);

}  // namespace igeo
