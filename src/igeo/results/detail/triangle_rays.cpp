#include <igeo/results/detail/triangle_rays.h>

#include <igeo/base/parallel.h>

#include <algorithm>

namespace igeo {

namespace {

constexpr std::size_t kChunk = 4096;

/// The triangles at each vertex, one vertex after the other.
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

std::vector<std::array<Vec3f, 3>> cornerNormals(const SurfaceTriangles& triangles) {
    constexpr double kParallel = 0.866;  // 30 degrees
    const Stars stars(triangles);
    std::vector<std::array<Vec3f, 3>> normals(triangles.size());
    parallelFor(triangles.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Vec3d own = triangles.normal(t);
            for (std::size_t k = 0; k < 3; ++k) {
                Vec3d sum = 1e-6 * own;
                const std::uint32_t v = triangles[t][k];
                for (std::uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i) {
                    const std::uint32_t u = stars.triangle[i];
                    const Vec3d a = triangles.corner(u, 0),
                                area =
                                    cross(triangles.corner(u, 1) - a, triangles.corner(u, 2) - a);
                    if (dot(normalized(area), own) > kParallel) sum += area;
                }
                normals[t][k] = Vec3f(normalized(sum));
            }
        }
    });
    return normals;
}

}  // namespace

TriangleRays::TriangleRays(const Band& band)
    : band_(band),
      triangles_(*band.triangles),
      cornerNormals_(std::make_shared<const std::vector<std::array<Vec3f, 3>>>(
          cornerNormals(*band.triangles))) {}

std::unique_ptr<SurfaceRays> TriangleRays::copy() const {
    return std::make_unique<TriangleRays>(*this);
}

std::optional<double> TriangleRays::hit(const Vec3d& from, const Vec3d& dir) const {
    const auto hit = triangles_.hit(from, dir);
    if (!hit) return std::nullopt;
    return hit->along;
}

Vec3d TriangleRays::normal(const Vec3d& p, const Vec3d& dir) const {
    const std::uint32_t t = triangles_.nearest(p).triangle;
    const Vec3d own = triangles_.normal(t);
    Vec3d sum;
    for (unsigned k = 0; k < 3; ++k) {
        // Its share of the triangle: the part beyond it, seen from p.
        const Vec3d part = cross(triangles_.corner(t, k + 1) - p, triangles_.corner(t, k + 2) - p);
        sum += std::max(dot(part, own), 0.0) * Vec3d((*cornerNormals_)[t][k]);
    }
    const Vec3d n = normalized(sum);
    return n == Vec3d{} || dot(n, dir) * dot(own, dir) < 0 ? own : n;
}

bool TriangleRays::encloses(const Vec3d& p) const {
    if (!triangles_.closed()) return false;
    // What a ray to the middle of the nearest triangle meets first shows its outside or its inside.
    const std::uint32_t t = triangles_.nearest(p).triangle;
    const Vec3d middle =
        (1.0 / 3) * (triangles_.corner(t, 0) + triangles_.corner(t, 1) + triangles_.corner(t, 2));
    const Vec3d dir = normalized(middle - p);
    const auto hit = triangles_.hit(p, dir);
    return hit && dot(triangles_.normal(hit->triangle), dir) > 0;
}

std::size_t TriangleRays::chunks() const {
    return (triangles_.points().size() + kChunk - 1) / kChunk;
}

void TriangleRays::forPoints(std::size_t chunk,
                             const std::function<void(const Vec3d&)>& visit) const {
    const std::size_t end = std::min(triangles_.points().size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) visit(triangles_.points()[i]);
}

}  // namespace igeo
