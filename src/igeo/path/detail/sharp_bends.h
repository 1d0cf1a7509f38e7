/// Sharp edges that a geodesic crosses, as voxels show them. Internal to the paths.
#pragma once

#include <igeo/band/band.h>
#include <igeo/path/path.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// A part of a geodesic over an edge that psi between voxels rounds off, though the voxels show
/// both sheets.
struct SharpBend {
    std::size_t first = 0, last = 0;  ///< vertices on either sheet
    double gain = 0;                  ///< by which the geodesic over the edge is longer, voxels
    double kink = 0;                  ///< by which it turns there, with both sheets laid flat
};

/// The sharp bends of a geodesic. The sheets go on from both sides up to the line where they meet,
/// and psi at the voxels around this line is the distance to them.
/// @param path  with normals
/// Time O(length).
std::vector<SharpBend> sharpBends(const Band& band, const Path& path);

/// The length of the shortest curve near a path over its edges: each makes it longer, and where
/// psi between voxels has turned the path it gets straight, to second order.
double lengthOver(const Path& path, const std::vector<SharpBend>& bends);

}  // namespace igeo
