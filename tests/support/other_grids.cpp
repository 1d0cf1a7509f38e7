#include "other_grids.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
IGEO_OTHER_GRIDS(template class)
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
