/// Points with distances as lines x,y,z,distance, which the bench programs pass to each other.
#pragma once

#include <igeo/base/types.h>

#include <string>
#include <vector>

namespace igeo::test {

struct PointsCsv {
    std::vector<Vec3d> points;     ///< world
    std::vector<double> distance;  ///< world units; +inf: none

    void add(const Vec3d& p, double d) { points.push_back(p), distance.push_back(d); }
};

/// @throws std::runtime_error  for a file that cannot be written or read, or a line that is none
void writePoints(const std::string& file, const PointsCsv& csv);
PointsCsv readPoints(const std::string& file);

/// Every how many of `count` are taken for at most `samples`; 0 samples: all.
inline std::size_t strideFor(std::size_t count, double samples) {
    const std::size_t most = std::size_t(samples);
    return most == 0 || count <= most ? 1 : (count + most - 1) / most;
}

}  // namespace igeo::test
