#include <igeo/io/mesh_file.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/brain_mesh_reader.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/gifti_reader.h>
#include <igeo/io/detail/ply_reader.h>
#include <igeo/io/detail/stl_reader.h>
#include <igeo/io/detail/text_mesh_reader.h>
#include <igeo/io/voxel_size.h>

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <tuple>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;

constexpr const char* kReadable =
    "meshes are read from .obj, .ply, .stl, .off, .gii, .mz3, .gltf and .glb, and from surfaces "
    "of FreeSurfer";

/// Reports the system's reasons, which assimp does not give.
void requireReadable(const std::string& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw Error(Kind::Io, "cannot read '" + file + "': it is a folder", "name a file");
    errno = 0;
    if (!std::ifstream(file, std::ios::binary).good())
        throw Error(Kind::Io, "cannot open '" + file + "': " + std::strerror(errno ? errno : EIO),
                    "check the name and the permissions");
    if (std::filesystem::is_regular_file(file, ignored) &&
        std::filesystem::file_size(file, ignored) == 0)
        throw Error(Kind::BadInput, "'" + file + "' is empty", kReadable);
}

struct Affine {
    std::array<Vec3d, 3> row{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d shift;

    Vec3d operator()(const Vec3d& p) const {
        return shift + Vec3d{dot(row[0], p), dot(row[1], p), dot(row[2], p)};
    }
    /// This one after `m`.
    Affine after(const aiMatrix4x4& m) const {
        const Vec3d x(m.a1, m.b1, m.c1), y(m.a2, m.b2, m.c2), z(m.a3, m.b3, m.c3);
        Affine both;
        for (std::size_t a = 0; a < 3; ++a)
            both.row[a] = {dot(row[a], x), dot(row[a], y), dot(row[a], z)};
        both.shift = (*this)(Vec3d(m.a4, m.b4, m.c4));
        return both;
    }
    bool mirrors() const { return dot(cross(row[0], row[1]), row[2]) < 0; }
};

void requireRoom(std::size_t points, const std::string& file) {
    constexpr std::size_t kMostPoints = std::size_t(1) << 31;
    if (points > kMostPoints)
        throw Error(Kind::BadInput, "'" + file + "' holds more than 2147483648 points",
                    "simplify the mesh: it needs no more detail than voxels");
}

/// Triangulates a polygon by cutting ears: the corner with the best triangle that contains no other
/// corner goes first. A corner in a side of the triangle counts as in it, whatever the rounding:
/// else triangles of polygons with corners in one line overlap. Assimp's own triangulation ends the
/// process on some polygons. Time O(corners^2).
class EarCutter {
public:
    EarCutter(std::vector<std::uint32_t> corners, TriangleMesh& mesh)
        : corners_(std::move(corners)), mesh_(mesh), p_(mesh.points) {
        const std::size_t n = corners_.size();
        double size = 0;
        for (std::size_t k = 0; k < n; ++k) {
            const Vec3d at = p_[corners_[k]] - p_[corners_[0]];
            normal_ += cross(at, p_[corners_[(k + 1) % n]] - p_[corners_[0]]);
            size = std::max(size, length(at));
        }
        room_ = TriangleMesh::kSame * size * length(normal_);
    }

    void cut() {
        if (corners_.size() > 3)
            for (std::size_t k = 0; k < corners_.size(); ++k) ears_.push_back(earAt(k));
        while (corners_.size() > 3) {
            std::size_t best = 0;
            for (std::size_t k = 1; k < corners_.size(); ++k)
                if (quality(ears_[k]) > quality(ears_[best])) best = k;
            remove(best);
        }
        if (corners_.size() == 3)
            mesh_.triangles.push_back({corners_[0], corners_[1], corners_[2]});
    }

private:
    /// Where a corner is to a triangle.
    struct Counts {
        std::size_t inside = 0;  ///< with those in its sides
        std::size_t close = 0;   ///< these, and what rounding may have put beside its sides
    };
    struct Ear {
        std::array<std::uint32_t, 3> corners;
        double shape;  ///< largest for an equilateral triangle, negative where it is concave
        Counts others;
    };

    Ear earAt(std::size_t k) const {
        const std::size_t n = corners_.size();
        Ear ear{{corners_[(k + n - 1) % n], corners_[k], corners_[(k + 1) % n]}, 0, {}};
        const Vec3d &a = p_[ear.corners[0]], &b = p_[ear.corners[1]], &c = p_[ear.corners[2]];
        const double sides = dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c);
        ear.shape = left(a, b, c) / std::max(sides, 1e-300);
        for (const std::uint32_t i : corners_) {
            const Counts one = countsOf(ear, i);
            ear.others.inside += one.inside, ear.others.close += one.close;
        }
        return ear;
    }

    double left(const Vec3d& from, const Vec3d& to, const Vec3d& q) const {
        return dot(cross(to - from, q - from), normal_);
    }

    /// A corner at a corner of the triangle counts as outside: a polygon around holes passes twice
    /// where it goes in to one.
    Counts countsOf(const Ear& ear, std::uint32_t i) const {
        const Vec3d &a = p_[ear.corners[0]], &b = p_[ear.corners[1]], &c = p_[ear.corners[2]],
                    &q = p_[i];
        if (q == a || q == b || q == c) return {};
        const double ab = left(a, b, q), bc = left(b, c, q), ca = left(c, a, q);
        const bool isClose = ab >= -room_ * length(b - a) && bc >= -room_ * length(c - b) &&
                             ca >= -room_ * length(a - c);
        return {ab >= 0 && bc >= 0 && ca >= 0, isClose};
    }

    /// First ears without others close to them, then flat corners, other ears, concave corners, and
    /// triangles with others inside.
    double quality(const Ear& ear) const {
        constexpr double kBehindFlat = 1e-9;
        if (ear.others.inside > 0) return std::min(ear.shape, 0.0) - 1e6 * length(normal_);
        return ear.others.close == 0 || ear.shape <= 0
                   ? ear.shape
                   : kBehindFlat * (ear.shape - length(normal_));
    }

    void remove(std::size_t k) {
        const std::uint32_t gone = corners_[k];
        mesh_.triangles.push_back(ears_[k].corners);
        corners_.erase(corners_.begin() + std::ptrdiff_t(k));
        ears_.erase(ears_.begin() + std::ptrdiff_t(k));
        for (Ear& ear : ears_) {
            const Counts one = countsOf(ear, gone);
            ear.others.inside -= one.inside, ear.others.close -= one.close;
        }
        const std::size_t n = corners_.size();
        for (const std::size_t beside : {(k + n - 1) % n, k % n}) ears_[beside] = earAt(beside);
    }

    std::vector<std::uint32_t> corners_;
    TriangleMesh& mesh_;
    const std::vector<Vec3d>& p_;
    Vec3d normal_;  ///< Newell's normal, twice the area long
    double room_;   ///< for rounding: as far from a side one unit long, times its length
    std::vector<Ear> ears_;
};

/// Cuts a polygon into the same triangles whatever its first corner and its direction, so that
/// weld() finds duplicates of a face that the file holds in both orders.
void cutAlike(std::vector<std::uint32_t> corners, TriangleMesh& mesh) {
    const auto before = [&](std::uint32_t i, std::uint32_t j) {
        const Vec3d &a = mesh.points[i], &b = mesh.points[j];
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), before),
                corners.end());
    const bool turned = before(corners.back(), corners[1]);
    if (turned) std::reverse(corners.begin() + 1, corners.end());
    const std::size_t first = mesh.triangles.size();
    EarCutter(std::move(corners), mesh).cut();
    for (std::size_t t = first; turned && t < mesh.triangles.size(); ++t)
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
}

void appendPolygon(const std::vector<std::uint32_t>& corners, TriangleMesh& mesh) {
    // This many take some seconds.
    constexpr std::size_t kMostCorners = 20000;
    if (corners.size() > kMostCorners)
        throw Error(Kind::BadInput,
                    fmt::format("a face of '{}' has {} corners, more than {}", mesh.file,
                                corners.size(), kMostCorners),
                    "cut it into triangles in the program that made it");
    if (corners.size() == 3)
        mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    else if (corners.size() > 3)
        cutAlike(corners, mesh);
}

void append(const aiMesh& from, const Affine& place, TriangleMesh& mesh) {
    const std::size_t first = mesh.points.size();
    requireRoom(first + from.mNumVertices, mesh.file);
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
        const aiVector3D& v = from.mVertices[i];
        mesh.points.push_back(place(Vec3d(v.x, v.y, v.z)));
    }
    std::vector<std::uint32_t> corners;
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
        const aiFace& face = from.mFaces[f];
        corners.clear();
        for (unsigned k = 0; k < face.mNumIndices; ++k) {
            if (face.mIndices[k] >= from.mNumVertices)
                throw Error(Kind::BadInput,
                            fmt::format("a face of '{}' names point {} of {}", mesh.file,
                                        face.mIndices[k], from.mNumVertices),
                            "the file is cut off or broken: write it again");
            corners.push_back(std::uint32_t(first + face.mIndices[k]));
        }
        if (place.mirrors()) std::reverse(corners.begin(), corners.end());
        appendPolygon(corners, mesh);
    }
}

void appendNode(const aiScene& scene, const aiNode& node, const Affine& above, TriangleMesh& mesh) {
    const Affine place = above.after(node.mTransformation);
    for (unsigned k = 0; k < node.mNumMeshes; ++k)
        append(*scene.mMeshes[node.mMeshes[k]], place, mesh);
    for (unsigned k = 0; k < node.mNumChildren; ++k)
        appendNode(scene, *node.mChildren[k], place, mesh);
}

void readScene(TriangleMesh& mesh) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(mesh.file, 0);
    if (!scene || !scene->mRootNode)
        throw Error(Kind::BadInput,
                    "cannot read '" + mesh.file + "' as a mesh: " + importer.GetErrorString(),
                    std::string(kReadable) + "; points without faces go to readPointCloud");
    appendNode(*scene, *scene->mRootNode, {}, mesh);
}

PolygonMesh readPlyMesh(const std::string& file, const std::string& bytes) {
    Ply ply = readPlyFaces(file, bytes);
    PolygonMesh mesh;
    mesh.vertices = std::move(ply.points);
    for (const std::vector<std::uint32_t>& face : ply.faces) mesh.addFace(face);
    return mesh;
}

using PolygonReader = PolygonMesh (*)(const std::string& file, const std::string& bytes);

/// The reader of a file format with vertex numbers; null for other formats.
PolygonReader polygonReaderFor(const std::string& file) {
    static constexpr std::pair<const char*, PolygonReader> kReaders[] = {{".ply", readPlyMesh},
                                                                         {".obj", readObjMesh},
                                                                         {".off", readOffMesh},
                                                                         {".gii", readGiftiMesh},
                                                                         {".mz3", readMz3Mesh}};
    const std::string ending = endingBeforeGz(file);
    for (const auto& [known, reader] : kReaders)
        if (ending == known) return reader;
    // Files of FreeSurfer have names without endings, or with endings such as .pial.
    std::array<char, 3> begin{};
    std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
    return isFreeSurferSurface({begin.data(), begin.size()}) ? readFreeSurferMesh : nullptr;
}

/// Moves polygons into the mesh, with their numbers of vertices and faces.
void takePolygons(TriangleMesh& mesh, PolygonMesh polygons) {
    const auto source = std::make_shared<const PolygonMesh>(std::move(polygons));
    requireRoom(source->vertices.size(), mesh.file);
    mesh.points = source->vertices;
    for (std::size_t f = 0; f < source->faces(); ++f) {
        const auto face = source->face(f);
        appendPolygon({face.begin(), face.end()}, mesh);
    }
    mesh.source = source;
}

/// STL has no vertex numbers: each triangle has corners of its own, which weld() joins.
void readStl(TriangleMesh& mesh) {
    mesh.points = readStlCorners(mesh.file, inflatedFileBytes(mesh.file));
    requireRoom(mesh.points.size(), mesh.file);
    for (std::uint32_t k = 0; k + 2 < mesh.points.size(); k += 3)
        mesh.triangles.push_back({k, k + 1, k + 2});
}

/// Warns if all points are in single precision, as those of STL, and its rounding moves them by
/// more than 1/400 voxel at a usual resolution.
void warnOfRounding(TriangleMesh& mesh) {
    constexpr double kMost = 1e-5, kSingle = 6e-8;
    const Box box(mesh.points);
    const double farthest = box.farthest(), off = kSingle * farthest, size = length(box.size());
    if (!(off > kMost * size)) return;
    for (const Vec3d& p : mesh.points)
        for (int a = 0; a < 3; ++a)
            if (double(float(p[a])) != p[a]) return;
    mesh.warnings.push_back(
        fmt::format("coordinates up to {:.4g} on a mesh {:.4g} across: single precision puts "
                    "points off by {:.2g}; move the mesh to the origin",
                    farthest, size, off));
}

/// Checks that every mesh must pass, weld() and splitAtJunctions().
void finish(TriangleMesh& mesh) {
    if (mesh.triangles.empty())
        throw Error(Kind::BadInput,
                    fmt::format("'{}' holds {} points and no faces", mesh.file, mesh.points.size()),
                    "give points without faces to readPointCloud");
    constexpr double kLargest = 1e30;
    auto allowed = [](double x) { return std::abs(x) <= kLargest; };
    for (const Vec3d& p : mesh.points)
        if (!allowed(p.x) || !allowed(p.y) || !allowed(p.z))
            throw Error(Kind::BadInput,
                        fmt::format("'{}' has the point {}, {}, {}: coordinates have to be finite "
                                    "and between -{:g} and {:g}",
                                    mesh.file, p.x, p.y, p.z, kLargest, kLargest),
                        "export the mesh again");
    requireExtent(Box(mesh.points).longestSide(), mesh.file);
    weld(mesh);
    if (mesh.triangles.empty())
        throw Error(Kind::BadInput,
                    "all triangles of '" + mesh.file + "' have shrunk to points or lines",
                    "give a mesh with faces");
    splitAtJunctions(mesh);
}

}  // namespace

bool isMeshFile(const std::string& file) {
    const std::string ending = endingBeforeGz(file);
    return ending == ".stl" || ending == ".gltf" || ending == ".glb" ||
           polygonReaderFor(file) != nullptr;
}

TriangleMesh readMesh(const std::string& file) {
    requireReadable(file);
    if (!isMeshFile(file))
        throw Error(Kind::BadInput, "'" + file + "' is no mesh by its name",
                    std::string(kReadable) +
                        "; level sets go to readLevelSetGrid, clouds to readPointCloud");
    TriangleMesh mesh;
    mesh.file = file;
    if (const PolygonReader reader = polygonReaderFor(file))
        takePolygons(mesh, reader(file, inflatedFileBytes(file)));
    else if (endingBeforeGz(file) == ".stl")
        readStl(mesh);
    else
        readScene(mesh);
    finish(mesh);
    warnOfRounding(mesh);
    return mesh;
}

TriangleMesh meshOf(PolygonMesh polygons, const std::string& name) {
    for (const std::uint32_t corner : polygons.corners)
        if (corner >= polygons.vertices.size())
            throw Error(Kind::BadInput,
                        fmt::format("a face of '{}' names vertex {} of {}", name, corner,
                                    polygons.vertices.size()),
                        "count vertices from 0 on");
    TriangleMesh mesh;
    mesh.file = name;
    takePolygons(mesh, std::move(polygons));
    finish(mesh);
    return mesh;
}

}  // namespace igeo
