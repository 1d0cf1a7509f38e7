/// Writing VDB files: complete, and the same bytes for the same grids.
#pragma once

#include <openvdb/openvdb.h>

#include <iosfwd>
#include <string>

namespace igeo {

/// Writes grids in their order, Blosc-compressed, to a file, atomically.
///
/// The same grids give the same bytes: the file's UUID is computed from its content.
/// @throws Error  Io; an existing file then stays as it was
void writeVdb(const std::string& file, const openvdb::GridCPtrVec& grids);

/// The same to a stream; check the stream's state for failures. Memory: the bytes written.
void writeVdb(std::ostream& stream, const openvdb::GridCPtrVec& grids);

}  // namespace igeo
