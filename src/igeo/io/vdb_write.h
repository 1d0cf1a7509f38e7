/// VDB files out: the same bytes for the same grids, and never half a file.
#pragma once

#include <openvdb/openvdb.h>

#include <iosfwd>
#include <string>

namespace igeo {

/// Writes grids in their order, Blosc-compressed, to a file, atomically.
///
/// The same grids give the same bytes: the file's UUID is made from its content.
/// @throws Error  Io; an existing file is then untouched
void writeVdb(const std::string& file, const openvdb::GridCPtrVec& grids);

/// The same to a stream, whose state tells whether all was written. Memory: the bytes written.
void writeVdb(std::ostream& stream, const openvdb::GridCPtrVec& grids);

}  // namespace igeo
