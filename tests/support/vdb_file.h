// Writes VDB files whose bytes depend on their contents only.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace igeo::test {

/// Writes the grids under a temporary name and renames it. OpenVDB gives every file a random
/// identifier; it is replaced by one computed from the rest of the file, so that the same
/// grids give the same bytes.
/// @throws std::runtime_error or openvdb::IoError
void writeVdb(const std::string& path, const openvdb::GridCPtrVec& grids);

}  // namespace igeo::test
