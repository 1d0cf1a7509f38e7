/// The vertices of a PLY file. Internal.
#pragma once

#include <igeo/point_cloud.h>

#include <string>

namespace igeo {

/// Reads x y z and, if all three are there, nx ny nz of the element `vertex`; faces and all else
/// are skipped. Text, binary of either byte order, any number types, elements in any order.
/// By hand, as the usual libraries round to float, which is a decimetre in a survey's coordinates,
/// and take files that are cut off.
/// @param bytes  of the file
/// @throws Error  BadInput, with line or byte
PointCloud pointsFromPly(const std::string& file, const std::string& bytes);

}  // namespace igeo
