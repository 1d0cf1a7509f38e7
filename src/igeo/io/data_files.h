/// Files that belong to a mesh or a volume.
#pragma once

#include <string>
#include <vector>

namespace igeo {

/// The other files that readMesh and readVolume read with a file: the data file of a NRRD header,
/// the other file of a pair of .hdr and .img, and the buffers of a .gltf file. Empty for all
/// others, and where the file cannot be read: its reader says so. Time O(size) for .gltf, else
/// O(1).
std::vector<std::string> dataFilesOf(const std::string& file);

}  // namespace igeo
