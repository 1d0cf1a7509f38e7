#include <igeo/results/detail/drawn_surface.h>

#include <igeo/base/parallel.h>
#include <igeo/path/curve_normals.h>
#include <igeo/results/detail/band_mesh.h>

#include <algorithm>
#include <numbers>

namespace igeo {

namespace {

using CornerNormals = std::vector<std::array<Vec3f, 3>>;

/// The triangles at each vertex, one vertex after another.
struct Stars {
    std::vector<std::uint32_t> first, triangle;

    explicit Stars(const SurfaceTriangles& triangles)
        : first(triangles.points().size() + 1), triangle(3 * triangles.size()) {
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (const std::uint32_t v : triangles[t]) ++first[v + 1];
        for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
        std::vector<std::uint32_t> next = first;
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (const std::uint32_t v : triangles[t]) triangle[next[v]++] = std::uint32_t(t);
    }
};

/// Per triangle and corner: the mean normal of the nearly parallel faces around the corner.
CornerNormals creasedNormals(const SurfaceTriangles& triangles) {
    constexpr double kParallel = 0.766;  // 40 degrees
    const Stars stars(triangles);
    std::vector<Vec3d> area(triangles.size()), unit(triangles.size());
    parallelFor(triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Vec3d a = triangles.corner(t, 0);
            area[t] = cross(triangles.corner(t, 1) - a, triangles.corner(t, 2) - a);
            unit[t] = normalized(area[t]);
        }
    });
    CornerNormals normals(triangles.size());
    parallelFor(triangles.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                Vec3d sum = 1e-6 * unit[t];
                const std::uint32_t v = triangles[t][k];
                for (std::uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i) {
                    const std::uint32_t u = stars.triangle[i];
                    if (dot(unit[u], unit[t]) > kParallel) sum += area[u];
                }
                normals[t][k] = Vec3f(normalized(sum));
            }
    });
    return normals;
}

/// The mean edge length in voxels, from which the tolerance beside S follows.
double meanSide(const SurfaceMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) sum += length(mesh.position[t[1]] - mesh.position[t[0]]);
    return mesh.triangles.empty() ? 0 : sum / double(mesh.triangles.size());
}

/// Whether a mesh has no rim, and its normals point away from what it encloses.
bool isOutside(const SurfaceMesh& mesh) {
    // Edges count once from their lesser vertex and once toward it, as numbers that have nothing to
    // do with each other: their sum is 0 only without a rim.
    auto edge = [](std::uint64_t a, std::uint64_t b) {
        const std::uint64_t hash = (std::min(a, b) << 32 | std::max(a, b)) * 0x9e3779b97f4a7c15u,
                            mixed = (hash ^ hash >> 29) * 0xbf58476d1ce4e5b9u;
        return a < b ? mixed : 0 - mixed;
    };
    std::uint64_t rim = 0;
    double volume = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        rim += edge(a, b) + edge(b, c) + edge(c, a);
        volume += dot(mesh.position[a], cross(mesh.position[b], mesh.position[c]));
    }
    return rim == 0 && volume > 0;
}

}  // namespace

DrawnSurface::DrawnSurface(const Band& band)
    : DrawnSurface(band, band.triangles ? SurfaceMesh{} : bandMesh(band), false) {
    if (!band.triangles) return;
    triangles_ = band.triangles;
    closed_ = triangles_->closed();
    clearance_ = 0.01;
    creased_ = creasedNormals(*triangles_);
}

DrawnSurface::DrawnSurface(const Band& band, SurfaceMesh mesh, bool closed)
    : band_(band),
      closed_(closed),
      hidesBacks_(isOutside(mesh)),
      clearance_(std::max(0.5, 0.5 * meanSide(mesh))),
      normal_(std::move(mesh.normal)),
      distance_(std::move(mesh.distance)) {
    constexpr std::size_t kRun = 64;  // they come leaf by leaf
    triangles_ = std::make_shared<SurfaceTriangles>(
        std::move(mesh.position), std::move(mesh.triangles),
        /*neighbor, which rays do not need*/ std::vector<std::array<std::uint32_t, 3>>{}, kRun);
}

Vec3f DrawnSurface::cornerNormal(std::uint32_t triangle, unsigned corner) const {
    if (isCreased()) return creased_[triangle][corner];
    constexpr float kSmooth = 0.5f;
    const Vec3f mean = normal_[(*triangles_)[triangle][corner]];
    if (hasDistances()) return mean;
    // That of psi, where the band has it.
    const Vec3d p = triangles_->corner(triangle, corner);
    const BandCell cell = cellAt(band_, p);
    Vec3d sum;
    bool plain = cell.complete;
    for (std::size_t k = 0; k < 8 && plain; ++k) {
        const NodeIndex i = cell.node[k];
        plain = !band_.facing[i] && dot(band_.normal[i], mean) > kSmooth;
        sum += cell.weight[k] * Vec3d(band_.normal[i]);
    }
    const Vec3f n(plain ? normalized(sum) : normalAt(band_, p, Vec3d(mean)));
    return dot(n, mean) > kSmooth ? n : mean;
}

Vec3d DrawnSurface::normalNear(const Vec3d& p) const {
    const std::uint32_t t =
        triangles_->size() ? triangles_->nearest(p).triangle : SurfaceTriangles::kNone;
    return t == SurfaceTriangles::kNone ? Vec3d{} : triangles_->normal(t);
}

bool DrawnSurface::isVisible(const Vec3d& p, const Vec3d& n, const Vec3d& toEye) const {
    return mayBeVisible(n, toEye) &&
           !triangles_->meets(p + (dot(n, toEye) < 0 ? -clearance_ : clearance_) * n, toEye);
}

bool DrawnSurface::encloses(const Vec3d& p) const {
    if (!closed_ || triangles_->size() == 0) return false;
    // The winding number, by the solid angles of the triangles (van Oosterom and Strackee 1983).
    // Its sign depends on their orientation, which may be either in files.
    double half = 0;
    for (std::uint32_t t = 0; t < triangles_->size(); ++t) {
        const Vec3d a = triangles_->corner(t, 0) - p, b = triangles_->corner(t, 1) - p,
                    c = triangles_->corner(t, 2) - p;
        const double la = length(a), lb = length(b), lc = length(c);
        half += std::atan2(dot(a, cross(b, c)),
                           la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return std::abs(half) > std::numbers::pi;
}

}  // namespace igeo
