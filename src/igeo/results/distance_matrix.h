/// All distances between two lists of points.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

struct DistanceMatrix {
    std::vector<SurfacePoint> seeds, targets;  ///< of its rows and its columns
    std::size_t firstRow = 0;                  ///< not 0 only in a part
    std::vector<double> distance;  ///< row by row, world units times weight; +inf: no way between
    /// Between seeds: the largest |d_ij - d_ji| / (their mean), what one march and the one back
    /// differ by; NaN in a part, which does not know; else 0.
    double asymmetry = 0;

    std::size_t rows() const { return targets.empty() ? 0 : distance.size() / targets.size(); }
    double at(std::size_t seed, std::size_t target) const {
        return distance[(seed - firstRow) * targets.size() + target];
    }
};

/// Distances from every seed to every target by marchJet, one march per seed that stops once its
/// targets are known.
/// @param targets empty: the seeds themselves. Then d_ij is the mean of the marches from i and from
///                j (makeSymmetric)
/// SurfacePoint::start plays no part.
/// @throws Error  InvalidArgument without seeds; as marchJet; Cancelled
/// Seeds run side by side, with at most one field per thread in memory. Same bits for any number
/// of threads.
DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets = {},
                         Progress& progress = Progress::none());

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

/// Comma-separated: a first line `seed,0,1,...` that numbers the targets, then a line per seed that
/// begins with its number. `inf` where there is no way. Reading the numbers gives the same doubles.
std::string matrixCsv(const DistanceMatrix& matrix);

/// NumPy's format, version 1.0: little-endian float64, C order, shape (seeds, targets), with
/// infinities.
std::string matrixNpy(const DistanceMatrix& matrix);

}  // namespace igeo
