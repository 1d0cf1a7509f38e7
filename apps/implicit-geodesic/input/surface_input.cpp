#include "input/surface_input.h"

#include <fmt/core.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/point_cloud_file.h>
#include <igeo/io/vdb_read.h>
#include <igeo/io/volume_file.h>
#include <igeo/surface/rebuild.h>
#include <igeo/surface/volume_mesh.h>

#include "heap.h"
#include "input/guarded_read.h"

namespace {

igeo::LoadedGrid readVolume(const SurfaceOptions& o, igeo::Progress& progress) {
    const igeo::GridSource& source = o.source;
    if (!o.rebuild) return guardedRead(source.file, [&] { return igeo::readLevelSetGrid(source); });
    igeo::LoadedGrid volume =
        guardedRead(source.file, [&] { return igeo::readScalarGrid(source); });
    const bool fog = volume.grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
    const double iso = o.iso.value_or(fog ? 0.5 : 0.0);
    const FileGuard guard(source.file, FileGuard::kNoLimit);
    igeo::LoadedGrid psi = igeo::rebuilt(volume, iso, progress);
    psi.warnings.push_back(
        fmt::format("psi was rebuilt as the distance to where the volume is {:.6g}", iso));
    return psi;
}

/// The surface of a volume of voxels, on voxels as fine as those of the volume.
igeo::TriangleMesh readVoxels(const SurfaceOptions& o, igeo::VoxelOptions& voxels,
                              igeo::Progress& progress) {
    const std::string& file = o.source.file;
    const igeo::VoxelVolume volume = guardedRead(file, [&] { return igeo::readVolume(file); });
    if (voxels.size == 0 && voxels.resolution == 0) voxels.size = volume.finestSpacing();
    const FileGuard guard(file, FileGuard::kNoLimit);
    return igeo::volumeMesh(volume, o.iso, progress);
}

/// Makes a surface from what was read, with the stages of progress.
template <typename Input, typename... Voxels>
igeo::Surface checked(Input&& input, const SurfaceOptions& o, igeo::Progress& progress,
                      const Voxels&... voxels) {
    // What reading took beside the surface, as a grid of doubles.
    giveBackFreedMemory();
    progress.finished("read");
    const FileGuard guard(o.source.text(), FileGuard::kNoLimit);
    igeo::Surface surface(std::forward<Input>(input), voxels..., progress);
    progress.finished("check");
    return surface;
}

}  // namespace

igeo::Surface readSurface(const SurfaceOptions& o, igeo::Progress& progress) {
    progress.update("read", 0);
    const std::string file = o.source.text();
    igeo::VoxelOptions voxels{o.voxelSize, o.resolution, o.scheme, o.joinGaps};
    switch (o.kind) {
        case SurfaceKind::Mesh:
            return checked(guardedRead(file, [&] { return igeo::readMesh(file); }), o, progress,
                           voxels);
        case SurfaceKind::Points:
            return checked(guardedRead(file, [&] { return igeo::readPointCloud(file); }), o,
                           progress, voxels);
        case SurfaceKind::VoxelVolume: {
            igeo::TriangleMesh mesh = readVoxels(o, voxels, progress);
            return checked(std::move(mesh), o, progress, voxels);
        }
        case SurfaceKind::None:
        case SurfaceKind::Volume:
            break;
    }
    return checked(readVolume(o, progress), o, progress);
}
