/// Point clouds in VDB files. Internal.
#pragma once

#include <igeo/io/point_cloud.h>

#include <string>

namespace igeo {

/// Reads an OpenVDB grid of points (PointDataGrid), in its own order; normals from the attribute
/// `N` of three floats, as world directions.
/// @param source  FILE, or FILE:GRID where there are several such grids
/// @throws Error  Io where the file cannot be opened, BadInput where it is no VDB file, is cut off,
///         or leaves the choice of the grid open
PointCloud readVdbPoints(const std::string& source);

}  // namespace igeo
