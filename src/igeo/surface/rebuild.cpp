#include <igeo/surface/rebuild.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/types.h>
#include <igeo/io/openvdb_interrupter.h>
#include <openvdb/tools/LevelSetRebuild.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace igeo {

namespace {

std::string where(const LoadedGrid& volume) {
    return " (file '" + volume.file + "', grid '" + volume.name + "')";
}

/// Inactive values are tested too, because the extraction of triangles reads them.
void requireFinite(const LoadedGrid& volume) {
    for (auto it = volume.grid->tree().cbeginValueAll(); it; ++it) {
        if (std::isfinite(*it)) continue;
        const openvdb::Coord at = it.getCoord();
        throw Error(Error::Kind::BadInput,
                    fmt::format("the value at index {},{},{} is {:g}{}", at.x(), at.y(), at.z(),
                                double(*it), where(volume)),
                    "make the volume again from its source, without NaN and infinite values");
    }
}

/// The least and the largest active value; 0 and 0 if none is active. One of OpenVDB's functions
/// does this, and takes a compiler four seconds.
std::pair<double, double> activeRange(const openvdb::FloatTree& tree) {
    std::optional<std::pair<double, double>> range;
    for (auto it = tree.cbeginValueAll(); it; ++it) {
        if (!it.isValueOn()) continue;
        const double value = *it;
        if (!range) range.emplace(value, value);
        range->first = std::min(range->first, value);
        range->second = std::max(range->second, value);
    }
    return range.value_or(std::pair(0.0, 0.0));
}

/// The same voxels with voxel 0 at the world's origin, because OpenVDB rebuilds in single
/// precision.
openvdb::FloatGrid::ConstPtr atOrigin(const LoadedGrid& volume) {
    const openvdb::CoordBBox box = volume.grid->evalActiveVoxelBoundingBox();
    if (!box.empty())
        for (std::size_t a = 0; a < 3; ++a)
            if (box.min()[a] < -kFarthestInFloat || box.max()[a] > kFarthestInFloat)
                throw Error(
                    Error::Kind::BadInput,
                    fmt::format("voxels at index {} to {}: a volume is rebuilt in single "
                                "precision, which is good for indices up to {}{}",
                                box.min()[a], box.max()[a], kFarthestInFloat, where(volume)),
                    "give the grid indices near 0 and put where it lies into its "
                    "transform");
    openvdb::math::Transform::Ptr transform = volume.grid->transform().copy();
    if (transform->isLinear())
        transform->postTranslate(-transform->indexToWorld(openvdb::Vec3d(0.0)));
    return openvdb::gridConstPtrCast<openvdb::FloatGrid>(
        volume.grid->copyGridReplacingTransform(transform));
}

}  // namespace

LoadedGrid rebuilt(const LoadedGrid& volume, double iso, Progress& progress) {
    constexpr float kHalfWidth = 3;
    requireFinite(volume);
    LoadedGrid result = volume;
    OpenVdbInterrupter interrupter(progress);
    const openvdb::FloatGrid::Ptr psi = openvdb::tools::levelSetRebuild(
        *atOrigin(volume), float(iso), kHalfWidth, kHalfWidth, nullptr, interrupter.pointer());
    progress.throwIfCancelled();
    psi->setTransform(volume.grid->transform().copy());
    psi->setName(volume.grid->getName());
    result.grid = psi;
    if (result.grid->activeVoxelCount() == 0) {
        const auto [least, largest] = activeRange(volume.grid->tree());
        throw Error(
            Error::Kind::BadInput,
            fmt::format("no surface has the value {:.6g}: the volume goes from {:.6g} to {:.6g}{}",
                        iso, least, largest, where(volume)),
            "give a value in between as the iso of rebuilt()");
    }
    result.isLevelSetClass = true;
    return result;
}

}  // namespace igeo
