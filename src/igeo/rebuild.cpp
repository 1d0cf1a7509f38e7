#include <igeo/rebuild.h>

#include <igeo/error.h>
#include <igeo/format.h>
#include <openvdb/tools/Count.h>
#include <openvdb/tools/LevelSetRebuild.h>

namespace igeo {

LoadedGrid rebuilt(const LoadedGrid& volume, double iso) {
    constexpr float kHalfWidth = 3;
    LoadedGrid result = volume;
    result.grid = openvdb::tools::levelSetRebuild(*volume.grid, float(iso), kHalfWidth);
    if (result.grid->activeVoxelCount() == 0) {
        const auto range = openvdb::tools::minMax(volume.grid->tree());
        throw Error(Error::Kind::BadInput,
                    format("no surface has the value %.6g: the volume goes from %.6g to %.6g", iso,
                           double(range.min()), double(range.max())) +
                        " (file '" + volume.file + "', grid '" + volume.name + "')",
                    "give a value in between with --iso");
    }
    result.grid->setName(volume.grid->getName());
    result.isLevelSetClass = true;
    return result;
}

}  // namespace igeo
