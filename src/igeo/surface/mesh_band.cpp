#include <igeo/surface/mesh_band.h>

#include <fmt/core.h>
#include <igeo/band/detail/mesh_fan.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/mesh_bridges.h>
#include <igeo/surface/detail/mesh_joints.h>
#include <igeo/surface/detail/mesh_ways.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace igeo {

namespace {

using Triangle = TriangleMesh::Triangle;

/// Around edges sharper than about 50 degrees the core includes all voxels within kRim of them, as
/// in level_set_band.cpp: normals turn too fast there for a front to pass from face to face.
constexpr double kRim = 1, kSharp = 0.9;

/// How far beyond a boundary, along the plane there, a voxel still represents a point on it.
/// Without such voxels fronts would turn half a voxel before the boundary; with more, gaps close.
/// Measured: docs/trials.md, "Boundary of a mesh".
constexpr double kBeyond = 0.5;

/// Normals of faces, edges and corners, and where the mesh ends.
struct Pseudonormals {
    std::vector<Vec3d> ofFace, ofCorner;
    std::vector<std::uint8_t> atBoundary;  ///< per point
    const TriangleMesh& mesh;
    const MeshTopology& topology;

    Pseudonormals(const TriangleMesh& aMesh, const MeshTopology& aTopology)
        : ofFace(aMesh.triangles.size()),
          ofCorner(aMesh.points.size()),
          atBoundary(aMesh.points.size()),
          mesh(aMesh),
          topology(aTopology) {
        const std::vector<Vec3d>& p = mesh.points;
        for (std::size_t t = 0; t < ofFace.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            ofFace[t] = normalized(cross(p[b] - p[a], p[c] - p[a]));
            ofCorner[a] += angleBetween(p[b] - p[a], p[c] - p[a]) * ofFace[t];
            ofCorner[b] += angleBetween(p[c] - p[b], p[a] - p[b]) * ofFace[t];
            ofCorner[c] += angleBetween(p[a] - p[c], p[b] - p[c]) * ofFace[t];
            for (std::size_t k = 0; k < 3; ++k)
                if (topology.neighbor[t][k] == MeshTopology::kNone)
                    atBoundary[mesh.triangles[t][k]] = atBoundary[mesh.triangles[t][(k + 1) % 3]] =
                        1;
        }
        for (Vec3d& n : ofCorner) n = normalized(n);
    }

    bool ends(std::size_t t, int feature) const {
        if (feature < 3) return atBoundary[mesh.triangles[t][std::size_t(feature)]];
        return feature < 6 && topology.neighbor[t][std::size_t(feature - 3)] == MeshTopology::kNone;
    }

    /// Whether a point of a face is near an edge of three or more triangles: the sheets there
    /// divide the voxels between them, and the core of each has a gap.
    bool nearMany(std::size_t t, const Vec3d& y) const {
        constexpr double kNear = 2;
        for (std::size_t k = 0; k < 3; ++k) {
            if (topology.neighbor[t][k] != MeshTopology::kMany) continue;
            const Vec3d a = mesh.points[mesh.triangles[t][k]],
                        b = mesh.points[mesh.triangles[t][(k + 1) % 3]];
            if (length(nearestOnTriangle(y, a, b, a).point - y) < kNear) return true;
        }
        return false;
    }

    Vec3d at(std::size_t t, int feature) const {
        Vec3d n = ofFace[t];
        if (feature < 3) {
            n = ofCorner[mesh.triangles[t][std::size_t(feature)]];
        } else if (feature < 6) {
            const std::uint32_t u = topology.neighbor[t][std::size_t(feature - 3)];
            if (u < ofFace.size()) {
                // Across the seam of a one-sided component normals are opposite.
                const Vec3d sum = ofFace[t] + ofFace[u];
                if (dot(sum, ofFace[t]) > 0.1) n = normalized(sum);
            }
        }
        if (n == Vec3d{}) n = ofFace[t];
        return n == Vec3d{} ? Vec3d{0, 0, 1} : n;
    }
};

/// Removes voxels beyond a boundary and empty leaves, and numbers the rest.
void numberNodes(const Pseudonormals& normals, std::vector<NearLeaf>& nearLeaves, Band& band) {
    auto beyond = [&](const NearVoxel& v) {
        if (!normals.ends(v.triangle, v.feature)) return false;
        return length(tangential(v.point, normals.at(v.triangle, v.feature))) > kBeyond;
    };
    parallelFor(nearLeaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            auto& voxels = nearLeaves[l].voxels;
            voxels.erase(std::remove_if(voxels.begin(), voxels.end(), beyond), voxels.end());
        }
    });
    nearLeaves.erase(std::remove_if(nearLeaves.begin(), nearLeaves.end(),
                                    [](const NearLeaf& l) { return l.voxels.empty(); }),
                     nearLeaves.end());
    band.leaves.resize(nearLeaves.size());
    for (std::size_t l = 0; l < nearLeaves.size(); ++l) {
        band.leaves[l].origin = nearLeaves[l].origin;
        for (const NearVoxel& v : nearLeaves[l].voxels) band.leaves[l].band.insert(v.offset);
    }
    band.buildTopology();
}

/// Computes psi, foot points and normals.
/// @return nodes around sharp bends and junctions, for the core
std::vector<NodeIndex> fillNodes(const Pseudonormals& normals,
                                 const std::vector<NearLeaf>& nearLeaves, Band& band) {
    std::vector<std::vector<NodeIndex>> rims(nearLeaves.size());
    band.triangle.resize(band.size());
    parallelFor(nearLeaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            NodeIndex i = band.leaves[l].band.firstNode;
            for (const NearVoxel& v : nearLeaves[l].voxels) {
                Vec3d n = normals.at(v.triangle, v.feature);
                double psi = -dot(v.point, n);
                if (std::abs(psi) < kRim &&
                    (dot(n, normals.ofFace[v.triangle]) < kSharp ||
                     normals.nearMany(v.triangle, Vec3d(band.ijk(i)) + v.point)))
                    rims[l].push_back(i);
                if (!normals.ends(v.triangle, v.feature)) {
                    psi = std::copysign(length(v.point), psi);
                    // Off an edge: along grad psi, which is between the normals of the two faces.
                    constexpr double kOff = 1e-3;
                    if (std::abs(psi) > kOff) n = (-1 / psi) * v.point;
                }
                band.psi[i] = float(psi);
                band.foot[i] = Vec3f(v.point);
                band.normal[i] = Vec3f(n);
                band.triangle[i] = v.triangle;
                ++i;
            }
        }
    });
    std::vector<NodeIndex> rim;
    for (const auto& part : rims) rim.insert(rim.end(), part.begin(), part.end());
    return rim;
}

/// Adds the nodes next to another component, for the core: where two lie closer than a voxel, with
/// normals alike, the nodes beyond both are the nearest of one, and its core would be empty.
void addBesideOthers(const MeshBand& on, std::vector<NodeIndex>& rim) {
    if (on.adjacency.components() < 2) return;
    const Band& band = on.band;
    auto component = [&](NodeIndex i) { return on.adjacency.componentOf(on.voxel(i).triangle); };
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Vec3f n = band.normal[i];
        const float most = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
        if (std::abs(band.psi[i]) > most) continue;
        for (int face = 0; face < 6; ++face) {
            const NodeIndex j = band.neighbor(i, Band::faceStep(face));
            if (j == kNoNode || component(i) == component(j)) continue;
            rim.push_back(i);
            break;
        }
    }
}

/// At a sharp edge the nearest face is a tie: of the faces in a foot point, node i takes the one
/// that turns away from its normal least.
void chooseFaces(const MeshBand& on, Band& band) {
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto along = [&](std::uint32_t t) {
                return dot(Vec3d(band.normal[i]), on.faceNormal[t]);
            };
            double most = along(band.triangle[i]);
            if (most >= 0) continue;
            for (const std::uint32_t t : trianglesAt(on.adjacency, on.foot(NodeIndex(i))))
                if (along(t) > most) most = along(t), band.triangle[i] = t;
        }
    });
}

/// Adds lines where links and bridges do not go on with the mesh.
void addWays(const MeshBand& on, Band& band, Progress& progress) {
    const std::vector<NodeIndex> open = openOnMesh(on, progress);
    if (open.empty()) return;
    band.sever(inexactLinks(on, open));
    auto ways = std::make_shared<MeshWays>(waysOnMesh(on, open, progress));
    for (const MeshWay& way : ways->ways) band.facing[way.to] |= Band::kHasWays;
    band.ways = std::move(ways);
}

}  // namespace

Band bandFromMesh(const TriangleMesh& given, double dx, double h, Progress& progress, double gap) {
    if (!(h >= 0.866 && h <= 8))
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("a band of {:g} voxels; allowed are sqrt(3)/2 to 8", h),
                    "sqrt(3) is usual");
    requireReasonable(given, dx, h);
    progress.update("band", 0);
    TriangleMesh mesh = given;
    MeshTopology topology = meshTopology(mesh);
    orientConsistently(mesh, topology);
    for (Vec3d& p : mesh.points) p *= 1 / dx;
    const Pseudonormals normals(mesh, topology);
    std::vector<NearLeaf> nearLeaves = voxelsNear(mesh.points, mesh.triangles, h, progress);

    progress.update("band", 0.5);
    Band band;
    band.transform.dx = dx;
    band.h = h;
    // Wider faces count as planes: docs/trials.md, "Meshes and level sets".
    constexpr double kFaceWidth = 1;
    band.faceted = meshArea(mesh) > kFaceWidth * kFaceWidth * double(mesh.triangles.size());
    numberNodes(normals, nearLeaves, band);
    if (band.size() == 0)
        throw Error(
            Error::Kind::BadInput,
            "no voxel comes to lie on the mesh: it is smaller than one (" + given.file + ")",
            "take smaller voxels");
    std::vector<NodeIndex> rim = fillNodes(normals, nearLeaves, band);
    progress.throwIfCancelled();
    band.markFacing();
    const MeshAdjacency adjacency(mesh, topology);
    const std::vector<LeafBend> bends = bendsOf(adjacency, normals.ofFace, nearLeaves, progress);
    const MeshBand on{adjacency, normals.ofFace, nearLeaves, bends, band};
    chooseFaces(on, band);
    addBesideOthers(on, rim);
    band.numberCore(rim);
    severOffMesh(on, band, progress);
    band.spine = spineOfMesh(on);
    const MeshBridges bridges = bridgesOnMesh(on, progress);
    band.bridge(bridges.bridges);
    band.spine = bridges.spine;
    addWays(on, band, progress);
    band.markBesideSevered();
    band.cutOff = shareCutOff(on);
    band.stretch(stretchedOnMesh(on, progress));
    if (gap > 0) {
        const MeshJoints joints = jointsOverGaps(on, gap / dx, progress);
        band.joints = joints.pairs;
        band.bridge(joints.bridges);
    }
    static_assert(MeshTopology::kNone == SurfaceTriangles::kNone &&
                  MeshTopology::kMany == SurfaceTriangles::kMany);
    band.triangles = std::make_shared<const SurfaceTriangles>(
        std::move(mesh.points), std::move(mesh.triangles), std::move(topology.neighbor));
    progress.update("band", 1);
    return band;
}

}  // namespace igeo
