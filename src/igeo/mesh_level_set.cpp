#include <igeo/mesh_level_set.h>

#include <igeo/error.h>
#include <igeo/mesh_voxels.h>
#include <igeo/parallel.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/ValueTransformer.h>

#include <filesystem>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// The mesh as OpenVDB asks for it: corners in index space, in double precision.
struct Adapter {
    const TriangleMesh& mesh;
    double dx;

    std::size_t polygonCount() const { return mesh.triangles.size(); }
    std::size_t pointCount() const { return mesh.points.size(); }
    std::size_t vertexCount(std::size_t) const { return 3; }
    void getIndexSpacePoint(std::size_t t, std::size_t corner, openvdb::Vec3d& p) const {
        const Vec3d& q = mesh.points[mesh.triangles[t][corner]];
        p = openvdb::Vec3d(q.x / dx, q.y / dx, q.z / dx);
    }
};

/// OpenVDB's conversion, which stops when Progress says so.
openvdb::FloatGrid::Ptr convert(const TriangleMesh& mesh, double dx, double halfWidth, int flags,
                                Progress& progress) {
    struct Interrupter {
        Progress& progress;
        void start(const char* = nullptr) {}
        void end() {}
        bool wasInterrupted(int percent = -1) {
            if (percent >= 0) progress.update("level set", std::min(percent, 100) / 100.0);
            return progress.cancelled();
        }
    } interrupter{progress};
    const auto width = float(halfWidth);
    auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        interrupter, Adapter{mesh, dx}, *openvdb::math::Transform::createLinearTransform(dx), width,
        width, flags);
    progress.throwIfCancelled();
    return grid;
}

/// OpenVDB leaves some distances beyond one voxel up to 0.2 voxels too long, where another triangle
/// is nearer than those it looked at; the signs stand. Where pieces overlap, what is hidden inside
/// is no surface of the level set, and its distances are not taken.
void makeExact(openvdb::FloatGrid& grid, const TriangleMesh& mesh, double dx, double halfWidth,
               Progress& progress) {
    constexpr double kMostOff = 0.75;
    std::vector<Vec3d> points = mesh.points;
    for (Vec3d& p : points) p *= 1 / dx;
    const std::vector<NearLeaf> near = voxelsNear(points, mesh.triangles, halfWidth, progress);
    parallelFor(near.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const Ijk& o = near[l].origin;
            auto* leaf = grid.tree().probeLeaf({o.x, o.y, o.z});
            if (!leaf) continue;
            for (const NearVoxel& v : near[l].voxels) {
                const double exact = length(v.point), old = leaf->getValue(v.offset);
                if (leaf->isValueOn(v.offset) && std::abs(std::abs(old) / dx - exact) < kMostOff)
                    leaf->setValueOnly(v.offset, float(std::copysign(exact * dx, old)));
            }
        }
    });
}

LoadedGrid loaded(const openvdb::FloatGrid::Ptr& grid, const std::string& file) {
    LoadedGrid l;
    l.grid = grid;
    l.file = file;
    l.name = std::filesystem::path(file).stem().string();
    l.isLevelSetClass = true;
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName(l.name);
    return l;
}

}  // namespace

LevelSet levelSetFromMesh(const TriangleMesh& mesh, double dx, double halfWidth,
                          Progress& progress) {
    if (!(halfWidth >= 2 && halfWidth <= 1000))
        throw Error(Kind::InvalidArgument,
                    "a half-width of " + std::to_string(halfWidth) + " voxels; 2 to 1000 will do",
                    "3 is usual");
    requireReasonable(mesh, dx, halfWidth);
    const MeshTopology topology = meshTopology(mesh);
    if (!topology.closed())
        throw Error(Kind::BadInput,
                    "the mesh has no inside: " + std::to_string(topology.boundaryEdges) +
                        " edges at a boundary, " + std::to_string(topology.nonManifoldEdges) +
                        " with three triangles or more (" + mesh.file + ")",
                    "take it as an open surface, or close its holes first");
    const auto grid = convert(mesh, dx, halfWidth, 0, progress);
    makeExact(*grid, mesh, dx, halfWidth, progress);
    return checkLevelSet(loaded(grid, mesh.file), progress);
}

LevelSet shellOfMesh(const TriangleMesh& mesh, double dx, double thickness, Progress& progress) {
    if (!(thickness >= 0.5 && thickness <= 2))
        throw Error(
            Kind::InvalidArgument,
            "a shell of " + std::to_string(thickness) + " voxels on each side; 0.5 to 2 will do",
            "1 is usual");
    constexpr double kHalfWidth = 3;
    requireReasonable(mesh, dx, kHalfWidth + thickness);
    const auto grid = convert(mesh, dx, kHalfWidth + thickness,
                              openvdb::tools::UNSIGNED_DISTANCE_FIELD, progress);
    makeExact(*grid, mesh, dx, kHalfWidth + thickness, progress);
    const auto shift = float(thickness * dx);
    openvdb::tools::foreach (grid->beginValueOn(), [&](const openvdb::FloatGrid::ValueOnIter& it) {
        it.setValue(*it - shift);
    });
    openvdb::tools::changeBackground(grid->tree(), float(kHalfWidth * dx));
    LevelSet shell = checkLevelSet(loaded(grid, mesh.file), progress);
    shell.warnings.clear();  // the middle of a plate is no fault of the mesh
    return shell;
}

}  // namespace igeo
