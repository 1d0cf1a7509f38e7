/// OpenVDB, with its grid and transform types registered before the first test runs.
#pragma once

#include <igeo/io/vdb_read.h>
#include <openvdb/openvdb.h>

#include <memory>

namespace igeo::test {

inline const bool kOpenVdbInitialized = (openvdb::initialize(), true);

/// The grid of a test's own, to be changed before it is used.
inline openvdb::FloatGrid& editable(const LoadedGrid& loaded) {
    return *std::const_pointer_cast<openvdb::FloatGrid>(loaded.grid);
}

}  // namespace igeo::test
