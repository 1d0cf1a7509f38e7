// General metrics on meshes with holes, against distances known in closed form: a constant tensor
// measures the plane sheared until the tensor is 1, where fronts go around the image of the hole.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/mesh_shapes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>
#include <vector>

namespace igeo::test {
namespace {

constexpr double kPi = 3.14159265358979;

double cross2(const Vec2d& a, const Vec2d& b) { return a.x * b.y - a.y * b.x; }

/// Whether the straight line between two points crosses a convex polygon, counterclockwise.
bool crosses(const std::vector<Vec2d>& polygon, const Vec2d& p, const Vec2d& q) {
    constexpr double kRounding = 1e-7;
    double from = 0, to = 1;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec2d &a = polygon[k], side = polygon[(k + 1) % polygon.size()] - a;
        const double atP = cross2(side, p - a) / length(side) - kRounding,
                     atQ = cross2(side, q - a) / length(side) - kRounding;
        if (atP <= 0 && atQ <= 0) return false;
        if (atP > 0 && atQ > 0) continue;
        double& end = atP > 0 ? to : from;
        end = atP > 0 ? std::min(to, atP / (atP - atQ)) : std::max(from, atP / (atP - atQ));
    }
    return to > from;
}

/// The distance of two points around a hole: the shorter path around the convex hull of all three.
double around(const std::vector<Vec2d>& hole, const Vec2d& p, const Vec2d& q) {
    if (!crosses(hole, p, q)) return length(q - p);
    std::vector<Vec2d> points = hole, hull;
    for (const Vec2d& end : {p, q})
        if (std::none_of(hole.begin(), hole.end(), [&](auto& c) { return length(c - end) == 0; }))
            points.push_back(end);
    std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
        return std::pair(a.x, a.y) < std::pair(b.x, b.y);
    });
    for (int side = 0; side < 2; ++side) {
        const std::size_t first = hull.size();
        for (const Vec2d& c : points) {
            while (hull.size() > first + 1 &&
                   cross2(hull.back() - hull[hull.size() - 2], c - hull.back()) < 0)
                hull.pop_back();
            hull.push_back(c);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    std::array<double, 2> way{};
    bool between = false;
    for (std::size_t k = 0; k < hull.size(); ++k) {
        const Vec2d &a = hull[k], &b = hull[(k + 1) % hull.size()];
        if (length(a - p) == 0 || length(a - q) == 0) between = !between;
        way[between] += length(b - a);
    }
    return std::min(way[0], way[1]);
}

/// A flat ring in a plane turned anyhow, its hole a polygon with a radius in voxels.
struct Ring {
    static constexpr std::uint32_t kSides = 80, kParts = 8;
    TriangleMesh mesh;
    std::vector<Vec2d> at;  ///< of its vertices
    Vec3d n, x, y;

    Ring(double radius, const Vec3d& normal)
        : n(normal), x(normalized(cross(n, Vec3d(0.3, 1, 0.2)))), y(cross(n, x)) {
        for (std::uint32_t k = 0; k < kSides; ++k)
            for (std::uint32_t part = 0; part <= kParts; ++part) {
                const double r = radius * (1 + 1.3 * part / kParts), angle = 2 * kPi * k / kSides;
                at.push_back({r * std::cos(angle), r * std::sin(angle)});
                mesh.points.push_back(Vec3d(0.2, 0.7, 0.4) + at.back().x * x + at.back().y * y);
                if (part == kParts) continue;
                const std::uint32_t p = k * (kParts + 1) + part,
                                    q = (k + 1) % kSides * (kParts + 1) + part;
                mesh.triangles.push_back({p, p + 1, q + 1});
                mesh.triangles.push_back({p, q + 1, q});
            }
    }
    std::vector<Vec2d> hole(const std::function<Vec2d(const Vec2d&)>& image) const {
        std::vector<Vec2d> corners;
        for (std::size_t v = 0; v < at.size(); v += kParts + 1) corners.push_back(image(at[v]));
        return corners;
    }
};

}  // namespace

TEST_CASE("jet with a constant tensor: fronts go around the hole of a mesh", "[mesh]") {
    // Errors in voxels, at the cost of the expensive axis.
    struct Case {
        double ratio, least, most, mean;  // allowed
    };
    // Measured: -0.026 to 0.825, 0.129; -0.147 to 1.135, 0.122; -0.115 to 1.180, 0.115; -0.217 to
    // 0.946, 0.069; -0.534 to 1.022, 0.055. Before fits from the side were doubted: down to -5.4,
    // -5.6, -7.4, -23 and -16, means 0.93, 0.50, 0.59, 1.71 and 0.94.
    const std::vector<Case> cases{{1, -0.039, 1.24, 0.193},
                                  {1.5, -0.22, 1.7, 0.184},
                                  {2, -0.172, 1.77, 0.173},
                                  {4, -0.325, 1.42, 0.103},
                                  {10, -0.8, 1.53, 0.0825}};
    for (const Case& allowed : cases)
        for (const double radius : {14.0, 28.0}) {
            const double ratio = allowed.ratio;
            double least = 0, most = 0, mean = 0;
            std::size_t count = 0;
            for (const double degrees : {20.0, 75.0, 130.0}) {
                const Ring ring(radius,
                                degrees < 50 ? Vec3d(0, 0, 1) : normalized(Vec3d(1, -2, 3)));
                const double angle = degrees * kPi / 180;
                const Vec2d along{std::cos(angle), std::sin(angle)}, across{-along.y, along.x};
                const auto image = [&](const Vec2d& p) {
                    return Vec2d{dot(p, along), ratio * dot(p, across)};
                };
                const Vec3d a = along.x * ring.x + along.y * ring.y, b = cross(ring.n, a);
                const auto g = [&](int i, int j) {
                    return float(a[i] * a[j] + ratio * ratio * b[i] * b[j] +
                                 4 * ring.n[i] * ring.n[j]);
                };
                const Surface surface(ring.mesh, {.size = 1});
                SolverOptions options;
                options.metric.nodeTensors.assign(
                    GeodesicSolver(surface).wholeBand()->size(),
                    Tensor{g(0, 0), g(1, 1), g(2, 2), g(0, 1), g(0, 2), g(1, 2)});
                const GeodesicSolver solver(surface, options);
                const std::vector<Vec2d> hole = ring.hole(image);
                for (const std::size_t seed : {std::size_t(4), std::size_t(270)}) {
                    const VertexValues values =
                        solver.distance({ring.mesh.points[seed]}).atVertices();
                    for (std::size_t v = 0; v < ring.at.size(); ++v) {
                        const double exact = around(hole, image(ring.at[seed]), image(ring.at[v])),
                                     error = (values.distance[v] - exact) / ratio;
                        least = std::min(least, error), most = std::max(most, error);
                        mean += std::abs(error), ++count;
                    }
                }
            }
            mean /= double(count);
            std::printf(
                "jet, around a hole of %g voxels, tensors of ratio %g: %.3f to %.3f voxels, mean "
                "%.4f\n",
                radius, ratio, least, most, mean);
            CHECK(least > allowed.least);
            CHECK(most < allowed.most);
            CHECK(mean < allowed.mean);
        }
}

}  // namespace igeo::test
