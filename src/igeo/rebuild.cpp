#include <igeo/rebuild.h>

#include <igeo/error.h>
#include <igeo/format.h>
#include <openvdb/tools/Count.h>
#include <openvdb/tools/LevelSetRebuild.h>

#include <cmath>

namespace igeo {

namespace {

/// Inactive values count: the way to triangles looks at them.
void requireFinite(const LoadedGrid& volume) {
    for (auto it = volume.grid->tree().cbeginValueAll(); it; ++it) {
        if (std::isfinite(*it)) continue;
        const openvdb::Coord at = it.getCoord();
        throw Error(Error::Kind::BadInput,
                    format("the value at index %.0f,%.0f,%.0f", at.x(), at.y(), at.z()) +
                        format(" is %g", double(*it)) + " (file '" + volume.file + "', grid '" +
                        volume.name + "')",
                    "make the volume again from its source, without NaN and infinite values");
    }
}

}  // namespace

LoadedGrid rebuilt(const LoadedGrid& volume, double iso) {
    constexpr float kHalfWidth = 3;
    requireFinite(volume);
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
