/// OpenVDB, with the grids that many files use instantiated once, in openvdb_grids.cpp. Internal.
///
/// It is precompiled for the files that use OpenVDB (src/CMakeLists.txt), which compile four times
/// faster with it. No file includes it, because all of them compile without it as well.
#pragma once

#include <openvdb/openvdb.h>

// Grid and Tree have virtual functions: without this, every file that makes a grid would compile
// all of its reading, writing, pruning and printing.
#define IGEO_GRID(instantiate, TreeType)            \
    instantiate tree::Tree<TreeType::RootNodeType>; \
    instantiate Grid<TreeType>;
#define IGEO_GRIDS(instantiate)       \
    IGEO_GRID(instantiate, FloatTree) \
    IGEO_GRID(instantiate, Vec3STree)

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
IGEO_GRIDS(extern template class)
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
