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
    double from = 0, to = 0;  ///< arc lengths between which the straight line below takes its place
    double length = 0;        ///< of that over both sheets laid flat, voxels
    double turnBefore = 0, turnAfter = 0;  ///< of the geodesic at either end of it, radians
};

/// The sharp bends of a geodesic. The sheets go on from both sides up to the line where they meet,
/// and psi at the voxels around this line is the distance to them.
/// @param path  with normals
/// Time O(length).
std::vector<SharpBend> sharpBends(const Band& band, const Path& path);

/// The length of the shortest curve near a path over its edges: with all sheets laid flat, the
/// straight line from end to end. Psi between voxels turns the path at edges.
double lengthOver(const Path& path, const std::vector<SharpBend>& bends);

}  // namespace igeo
