/// How open to light from all around what a picture shows is. Internal to the pictures.
#pragma once

#include <igeo/results/detail/raster.h>

#include <vector>

namespace igeo {

/// Per pixel from 0, closed in, to 1, open: folds and holes are darker than ridges. Taken from the
/// picture alone: what rises above a pixel's tangent plane within the radius, by 8 of the pixels
/// around, smoothed over 4 x 4 (after M. McGuire et al., Scalable ambient obscurance,
/// 2012). 1 where nothing is seen.
/// @param normals  of the samples, unit; either side
/// @param radius   index units
/// In parallel; the same bits for any number of threads.
std::vector<float> openness(const Frame& frame, const std::vector<Sample>& samples,
                            const std::vector<Vec3f>& normals, double radius);

}  // namespace igeo
