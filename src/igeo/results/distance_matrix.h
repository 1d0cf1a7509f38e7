/// All distances between two lists of points or groups of points.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// What a row or a column of a matrix is of: a point, or a group of points.
struct MatrixPlace {
    std::string name;        ///< of a group that has one
    SnappedPoint point;      ///< of a group the first of its points
    std::size_t points = 1;  ///< how many it has
    bool isGroup() const { return points > 1 || !name.empty(); }
};

struct DistanceMatrix {
    std::vector<MatrixPlace> seeds, targets;  ///< of its rows and its columns
    std::size_t firstRow = 0;                 ///< not 0 only in a part
    /// Row by row, world units times weight; +inf: no path between; NaN: the target is off the
    /// surface and was skipped.
    std::vector<double> distance;
    /// Between seeds: the largest |d_ij - d_ji| / (their mean), what one march and the one back
    /// differ by; NaN in a part, which does not know; else 0.
    double asymmetry = 0;
    bool withReasons = false;  ///< matrixCsv says why targets have no distances

    std::size_t rows() const { return targets.empty() ? 0 : distance.size() / targets.size(); }
    double at(std::size_t seed, std::size_t target) const {
        return distance[(seed - firstRow) * targets.size() + target];
    }
};

/// Distances from every seed to every target by marchJet, one march per seed that stops once its
/// targets are known. Points joined with the one before (SurfacePoint::joined) are one group, with
/// one row or column: the distance between the nearest points of two groups.
/// @param targets empty: the seeds themselves. Then d_ij is the mean of the marches from i and from
///                j (makeSymmetric)
/// SurfacePoint::start has no effect.
/// @throws Error  InvalidArgument without seeds; as marchJet; Cancelled
/// Seeds run side by side, with at most one field per thread in memory. Same bits for any number
/// of threads.
DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets = {},
                         Progress& progress = Progress::none());

/// Why a point has no distance: "0.53 from the surface"; empty: it is on it.
std::string skippedReason(const SnappedPoint& point);

/// A part of the same: the rows from `firstRow` to before `endRow`, one way, also where there are
/// no targets. The parts one after another are the whole; between seeds makeSymmetric is yet to
/// come.
DistanceMatrix distanceRows(const Band& band, const MetricPtr& metric,
                            const std::vector<SurfacePoint>& seeds,
                            const std::vector<SurfacePoint>& targets, std::size_t firstRow,
                            std::size_t endRow, Progress& progress = Progress::none());

/// Makes a whole matrix between seeds of its one-way distances: the mean of both directions, or
/// that of the one that arrived, and 0 on the diagonal; sets `asymmetry`.
void makeSymmetric(DistanceMatrix& matrix);

/// Comma-separated: a first line `target,x,y,z` and a name per seed, `distance_` and the name of
/// the group or the number of the seed; then a line per target: its number or the name of its
/// group, where it is on the surface (`nan` of a group), and its distance from each seed, `inf`
/// where there is no path. Reading the numbers gives the same doubles. With `withReasons` a last
/// column `reason` follows; a target that was skipped has that alone, and empty numbers.
std::string matrixCsv(const DistanceMatrix& matrix);

/// NumPy's format, version 1.0: little-endian float64, C order, shape (seeds, targets), with
/// infinities; NaN where a target was skipped.
std::string matrixNpy(const DistanceMatrix& matrix);

}  // namespace igeo
