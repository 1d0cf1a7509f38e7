/// Clouds of points on surfaces that are known exactly; random, from a seed that is given.
#pragma once

#include <igeo/io/point_cloud.h>

#include <cstddef>
#include <functional>
#include <random>

namespace igeo::test {

struct CloudOptions {
    double noise = 0;      ///< standard deviation along the normal, in mean spacings
    bool normals = false;  ///< outward
    unsigned seed = 1;
};

/// About evenly spread (a Fibonacci spiral), each moved along the surface by up to 0.3 spacings.
PointCloud sphereCloud(std::size_t count, double radius, const Vec3d& center,
                       const CloudOptions& options = {});

/// Independent points, uniform by area, about the z axis.
PointCloud torusCloud(std::size_t count, double majorRadius, double minorRadius,
                      const Vec3d& center, const CloudOptions& options = {});

/// The lattice of (n + 1)^2 points on [0, n spacing]^2 in the plane z = 0, each inner one moved
/// within it by up to 0.3 spacings; the outermost stay in place.
PointCloud squareCloud(int n, double spacing, const CloudOptions& options = {});

/// The same points moved; normals are turned along by the rotation part (differences).
PointCloud movedCloud(PointCloud cloud, const std::function<Vec3d(const Vec3d&)>& map);

PointCloud shuffledCloud(const PointCloud& cloud, unsigned seed);

/// a, then b.
PointCloud joinedClouds(PointCloud a, const PointCloud& b);

}  // namespace igeo::test
