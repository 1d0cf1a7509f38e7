/// Ambient occlusion of a picture's pixels. Internal to the pictures.
#pragma once

#include <igeo/results/detail/raster.h>

#include <vector>

namespace igeo {

/// Per pixel from 0, occluded, to 1, open: folds and holes are darker than ridges. Computed in
/// screen space: what rises above a pixel's tangent plane within the radius, sampled at 8 pixels
/// around it, smoothed over 4 x 4 (after M. McGuire et al., Scalable ambient obscurance, 2012). 1
/// where there is no surface.
/// @param normals  of the samples, unit; on either side
/// @param radius   index units
/// In parallel; the same bits for any number of threads.
std::vector<float> openness(const Frame& frame, const std::vector<Sample>& samples,
                            const std::vector<Vec3f>& normals, double radius);

}  // namespace igeo
