/// All distances between two lists of points.
#pragma once

#include <igeo/metric.h>
#include <igeo/progress.h>
#include <igeo/surface_point.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

struct DistanceMatrix {
    std::vector<SurfacePoint> seeds, targets;  ///< its rows and its columns
    std::vector<double> distance;  ///< row by row, voxels times weight; +inf: no way between them
    /// Between seeds: the largest |d_ij - d_ji| / (their mean), what one march and the one back
    /// differ by; else 0.
    double asymmetry = 0;

    double at(std::size_t seed, std::size_t target) const {
        return distance[seed * targets.size() + target];
    }
};

/// Distances from every seed to every target by marchJet, one march per seed that stops once its
/// targets are known.
/// @param targets empty: the seeds themselves. Then d_ij is the mean of the marches from i and from
///                j (of the one that arrived, where only one did), so that the matrix is symmetric,
///                and 0 on the diagonal
/// SurfacePoint::start plays no part.
/// @throws Error  InvalidArgument without seeds; as marchJet; Cancelled
/// Seeds run side by side, with at most one field per thread in memory. Same bits for any number
/// of threads.
DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets = {},
                         Progress& progress = Progress::none());

/// Comma-separated: a first line `seed,0,1,...` that numbers the targets, then a line per seed that
/// begins with its number. `inf` where there is no way. Reading the numbers gives the same doubles.
/// @param dx voxel size: distances are written in world units times weight
std::string matrixCsv(const DistanceMatrix& matrix, double dx);

/// NumPy's format, version 1.0: little-endian float64, C order, shape (seeds, targets), with
/// infinities.
/// @param dx as for matrixCsv
std::string matrixNpy(const DistanceMatrix& matrix, double dx);

}  // namespace igeo
