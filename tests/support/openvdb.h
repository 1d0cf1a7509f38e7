/// OpenVDB, with its grid and transform types registered before the first test runs.
#pragma once

#include <openvdb/openvdb.h>

namespace igeo::test {

inline const bool kOpenVdbInitialized = (openvdb::initialize(), true);

}  // namespace igeo::test
