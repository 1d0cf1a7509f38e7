#include <igeo/io/detail/vdb_sound.h>

#include <igeo/base/error.h>
#include <igeo/io/voxel_size.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace igeo {

using openvdb::GridBase;

void requireInvertible(const GridBase& grid, const std::string& where) {
    const auto& transform = grid.transform();
    const openvdb::Vec3d size = transform.voxelSize();
    if (const double least = std::min({size.x(), size.y(), size.z()});
        transform.isLinear() && least > 0 && size.product() < std::pow(kLeastVoxelSize, 3))
        requireVoxelSize(least, where);
    bool sound = true;
    try {
        if (transform.isLinear()) {
            const double volume = transform.baseMap()->getAffineMap()->getMat4().det();
            sound = std::isfinite(volume) && volume != 0;
        }
    } catch (const openvdb::Exception&) {
        sound = false;
    }
    if (!sound)
        throw Error(Error::Kind::BadInput, "the transform of " + where + " has no inverse",
                    "the file may be damaged; write it again");
}

void dropDamagedMetadata(GridBase& grid) {
    static const std::map<std::string, std::string> kTypes{
        {GridBase::META_GRID_CLASS, "string"},       {GridBase::META_GRID_NAME, "string"},
        {GridBase::META_GRID_CREATOR, "string"},     {GridBase::META_VECTOR_TYPE, "string"},
        {GridBase::META_IS_LOCAL_SPACE, "bool"},     {GridBase::META_SAVE_HALF_FLOAT, "bool"},
        {GridBase::META_FILE_BBOX_MIN, "vec3i"},     {GridBase::META_FILE_BBOX_MAX, "vec3i"},
        {GridBase::META_FILE_COMPRESSION, "string"}, {GridBase::META_FILE_MEM_BYTES, "int64"},
        {GridBase::META_FILE_VOXEL_COUNT, "int64"}};
    std::vector<std::string> damaged;
    for (auto it = grid.beginMeta(); it != grid.endMeta(); ++it) {
        const std::string type = it->second->typeName();
        const auto known = kTypes.find(it->first);
        if (!openvdb::Metadata::isRegisteredType(type) ||
            (known != kTypes.end() && known->second != type))
            damaged.push_back(it->first);
    }
    for (const std::string& name : damaged) grid.removeMeta(name);
}

}  // namespace igeo
