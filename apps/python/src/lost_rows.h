/// Distances of several marches that the voxels have lost.
#pragma once

#include <igeo/igeo.h>
#include <igeo/results/lost_points.h>

#include <cstddef>
#include <string>
#include <vector>

/// A sentence on distances that are missing, though triangles join their points to a seed; it looks
/// at 1000 per row at most. Empty where there are none.
/// @param first    a row of distances per march, one after another; no limit has ended a march
/// @param seedsOf  (row) the seeds of that march
template <typename SeedsOf>
std::string lostOfRows(const igeo::Band& band, const igeo::MetricPtr& metric,
                       const std::vector<igeo::Vec3d>& points, std::size_t rows,
                       const double* first, const std::string& what, const SeedsOf& seedsOf) {
    constexpr std::size_t kMost = 1000;
    const std::size_t step = (points.size() + kMost - 1) / kMost;
    igeo::LostPoints lost(band, metric);
    for (std::size_t row = 0; row < rows; ++row) {
        std::vector<igeo::Vec3d> looked;
        std::vector<double> distance;
        for (std::size_t k = 0; k < points.size(); k += step) {
            looked.push_back(points[k]);
            distance.push_back(first[row * points.size() + k]);
        }
        lost.add(seedsOf(row), looked, distance);
    }
    return lost.warning((step > 1 ? what + " looked at" : what).c_str());
}
