/// Grids that the library has no use for and tests make: instantiated once, in other_grids.cpp, as
/// openvdb_grids.h does for those of the library.
#pragma once

#include <igeo/io/detail/openvdb_grids.h>

#define IGEO_OTHER_GRIDS(instantiate)  \
    IGEO_GRID(instantiate, BoolTree)   \
    IGEO_GRID(instantiate, DoubleTree) \
    IGEO_GRID(instantiate, Int32Tree)  \
    IGEO_GRID(instantiate, MaskTree)   \
    IGEO_GRID(instantiate, Vec3DTree)

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
IGEO_OTHER_GRIDS(extern template class)
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
