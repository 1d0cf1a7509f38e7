#include <igeo/results/surface_mesh.h>

#include <igeo/base/detail/four_doubles.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>
#include <igeo/march/signed_field.h>
#include <igeo/results/detail/level_set_mesh.h>

#include <algorithm>
#include <utility>

namespace igeo {

namespace {

using Quad = QuadMesh::Quad;

/// Four quadrilaterals side by side.
class QuadLanes {
    using V = FourDoubles;

    IGEO_INLINE static FourVectors corners(const Quad* quads, std::size_t corner,
                                           const std::vector<Vec3d>& p) {
        std::array<double, 4> x, y, z;
        for (std::size_t lane = 0; lane < 4; ++lane) {
            const Vec3d& at = p[quads[lane][corner]];
            x[lane] = at.x, y[lane] = at.y, z[lane] = at.z;
        }
        return {loadAs<V>(&x), loadAs<V>(&y), loadAs<V>(&z)};
    }
    /// Area over the squares of the sides, negative for a flipped triangle.
    IGEO_INLINE static V quality(const FourVectors& i, const FourVectors& j, const FourVectors& l,
                                 const FourVectors& n) {
        const FourVectors ij = j - i, jl = l - j, li = i - l;
        return dot(cross(ij, jl), n) / (dot(ij, ij) + dot(jl, jl) + dot(li, li));
    }
    IGEO_INLINE static V lesser(const V& a, const V& b) { return b < a ? b : a; }

public:
    /// Bits: those whose diagonal from the first corner is the better one.
    IGEO_INLINE static unsigned fromFirst(const Quad* quads, const std::vector<Vec3d>& p) {
        const FourVectors a = corners(quads, 0, p), b = corners(quads, 1, p),
                          c = corners(quads, 2, p), d = corners(quads, 3, p),
                          n = normalized(cross(c - a, d - b));
        return bitsOf(lesser(quality(a, b, c, n), quality(a, c, d, n)) >=
                      lesser(quality(b, c, d, n), quality(b, d, a, n)));
    }
};
unsigned fromFirstByTwo(const Quad* quads, const std::vector<Vec3d>& p) {
    return QuadLanes::fromFirst(quads, p);
}
#ifdef IGEO_AVX2
IGEO_AVX2 unsigned fromFirstByFour(const Quad* quads, const std::vector<Vec3d>& p) {
    return QuadLanes::fromFirst(quads, p);
}
#else
constexpr auto fromFirstByFour = fromFirstByTwo;
#endif

/// Splits quadrilaterals along the diagonal whose worse triangle is better.
std::vector<SurfaceMesh::Triangle> split(const std::vector<Quad>& quads,
                                         const std::vector<Vec3d>& p) {
    std::vector<SurfaceMesh::Triangle> triangles(2 * quads.size());
    const auto fromFirst = eightAtATime() ? fromFirstByFour : fromFirstByTwo;
    parallelFor((quads.size() + 3) / 4, 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = 4 * begin; k < std::min(4 * end, quads.size()); k += 4) {
            std::array<Quad, 4> four{};
            const std::size_t count = std::min<std::size_t>(quads.size() - k, 4);
            std::copy_n(&quads[k], count, four.begin());
            const unsigned first = fromFirst(four.data(), p);
            for (std::size_t i = 0; i < count; ++i) {
                const auto [a, b, c, d] = four[i];
                using Triangle = SurfaceMesh::Triangle;
                const bool ac = first >> i & 1;
                triangles[2 * (k + i)] = ac ? Triangle{a, b, c} : Triangle{b, c, d};
                triangles[2 * (k + i) + 1] = ac ? Triangle{a, c, d} : Triangle{b, d, a};
            }
        }
    });
    return triangles;
}

/// Per vertex the unit mean normal of its triangles, weighted by area.
std::vector<Vec3f> vertexNormals(const SurfaceMesh& mesh) {
    std::vector<Vec3d> sum(mesh.position.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d n =
            cross(mesh.position[b] - mesh.position[a], mesh.position[c] - mesh.position[a]);
        sum[a] += n, sum[b] += n, sum[c] += n;
    }
    std::vector<Vec3f> normal(sum.size());
    for (std::size_t i = 0; i < sum.size(); ++i) normal[i] = Vec3f(normalized(sum[i]));
    return normal;
}

}  // namespace

SurfaceMesh surfaceMesh(const LevelSet& levelSet, const Band& band, Progress& progress) {
    progress.update("mesh", 0);
    QuadMesh quads = levelSetMesh(levelSet, band);
    progress.throwIfCancelled();
    progress.update("mesh", 0.6);

    SurfaceMesh mesh;
    mesh.position = std::move(quads.points);
    mesh.triangles = split(quads.quads, mesh.position);
    mesh.normal = vertexNormals(mesh);
    return mesh;
}

SurfaceMesh surfaceMesh(const LevelSet& levelSet, const Field& field, Progress& progress) {
    SurfaceMesh mesh = surfaceMesh(levelSet, *field.band, progress);
    sampleField(mesh, field, progress);
    return mesh;
}

void sampleDistances(SurfaceMesh& mesh, const Field& field, Progress& progress) {
    const std::size_t n = mesh.position.size();
    mesh.distance.resize(n);
    mesh.label.resize(n);
    constexpr double kTolerance = 0.01;  // voxels
    const std::vector<Arrival> first =
        arrivalsAt(field, mesh.position, mesh.normal, kTolerance, progress);
    for (std::size_t i = 0; i < n; ++i) {
        mesh.distance[i] = first[i].distance;
        mesh.label[i] = first[i].distance < kInfinity ? first[i].source : kNoLabel;
    }
}

void finish(SurfaceMesh& mesh, const Field& field) {
    for (std::size_t i = 0; i < mesh.distance.size(); ++i)
        if (!(mesh.distance[i] <= field.greatest)) {
            mesh.distance[i] = kInfinity, mesh.label[i] = kNoLabel;
            if (!mesh.gradient.empty()) mesh.gradient[i] = {};
        } else if (signAt(field, mesh.position[i]) < 0) {
            mesh.distance[i] *= -1;
            if (!mesh.gradient.empty()) mesh.gradient[i] *= -1;
        }
}

void sampleField(SurfaceMesh& mesh, const Field& field, Progress& progress) {
    const std::size_t n = mesh.position.size();
    mesh.normal = vertexNormals(mesh);
    mesh.distance.resize(n);
    mesh.label.resize(n);
    mesh.gradient.resize(n);
    Steps reading(progress, "mesh", n, 0.7, 1);
    parallelFor(n, 1024, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d p = mesh.position[i], sheetNormal(mesh.normal[i]);
            const SurfaceCell cell(*field.band, *field.metric, p, sheetNormal);
            if (cell.normal != Vec3d{}) mesh.normal[i] = Vec3f(cell.normal);
            const Arrival first = arrivalAt(field, p, sheetNormal);
            mesh.distance[i] = first.distance;
            mesh.label[i] = first.distance < kInfinity ? first.source : kNoLabel;
            mesh.gradient[i] = Vec3f(gradientAt(field, first, p, cell));
        }
        reading.add(end - begin);
    });
}

SurfaceMesh inWorld(SurfaceMesh mesh, const Similarity& transform) {
    for (Vec3d& p : mesh.position) p = transform.worldFromIndex(p);
    for (std::vector<Vec3f>* vectors : {&mesh.normal, &mesh.gradient})
        for (Vec3f& v : *vectors) v = Vec3f(transform.worldFromIndexDirection(Vec3d(v)));
    for (double& d : mesh.distance) d *= transform.dx;
    if (transform.mirrors())
        for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
    return mesh;
}

MeshEdges meshEdges(const SurfaceMesh& mesh) {
    struct HalfEdge {
        std::uint32_t low, high;
        bool up;          // from low to high
        std::uint32_t k;  // 3 * triangle + corner
        bool operator<(const HalfEdge& o) const {
            return std::tie(low, high, up, k) < std::tie(o.low, o.high, o.up, o.k);
        }
    };
    std::vector<HalfEdge> half;
    half.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            half.push_back({std::min(a, b), std::max(a, b), a < b, std::uint32_t(3 * t + k)});
        }
    std::sort(half.begin(), half.end());

    MeshEdges edges;
    edges.ofTriangle.resize(mesh.triangles.size());
    for (std::size_t begin = 0; begin < half.size();) {
        // Edges down come first; the i-th of them and the i-th edge up are the two sides of one
        // edge.
        std::size_t up = begin, end = begin;
        for (; end < half.size() && half[end].low == half[begin].low &&
               half[end].high == half[begin].high;
             ++end)
            if (!half[end].up) ++up;
        for (std::size_t i = 0; i < std::max(up - begin, end - up); ++i) {
            const auto edge = std::uint32_t(edges.ends.size());
            edges.ends.push_back({half[begin].low, half[begin].high});
            for (const auto& [from, to] : {std::pair{begin, up}, std::pair{up, end}})
                if (from + i < to) {
                    const std::uint32_t k = half[from + i].k;
                    edges.ofTriangle[k / 3][k % 3] = edge;
                }
        }
        begin = end;
    }
    return edges;
}

}  // namespace igeo
