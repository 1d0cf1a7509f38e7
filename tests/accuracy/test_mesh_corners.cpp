// Corners around which fronts spread: those of holes and slots in open plates, and vertices with
// more than a full turn of faces around them. Exact distances by what sees what, and by angles.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/mesh_shapes.h>
#include <support/random_surface.h>
#include <support/shapes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace igeo::test {
namespace {

constexpr double kSide = 50;  // voxels

/// Errors at the vertices of meshes, in voxels.
struct VertexErrors {
    double low = 0, most = 0, sum = 0;
    std::size_t count = 0;

    void add(double error) {
        low = std::min(low, error), most = std::max(most, error);
        sum += std::abs(error), ++count;
    }
    double mean() const { return sum / double(count); }
    void print(const std::string& what) const {
        std::printf("%s: %.3f to %.3f voxels, mean %.4f\n", what.c_str(), low, most, mean());
    }
};

/// A rectangle that is cut out of a square plate.
struct Cut {
    std::string name;
    Vec2d low, high;

    bool holds(const Vec2d& p) const {
        return p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y;
    }
    /// Whether it lies between two points.
    bool parts(const Vec2d& p, const Vec2d& q) const {
        constexpr double kRounding = 1e-4;
        double from = 0, to = 1;
        for (const auto& [at, end, least, most] :
             {std::array{p.x, q.x, low.x, high.x}, {p.y, q.y, low.y, high.y}}) {
            const double step = end - at;
            double in = (least + kRounding - at) / step, out = (most - kRounding - at) / step;
            if (std::abs(step) < kRounding) {
                const bool inside = at > least + kRounding && at < most - kRounding;
                in = inside ? 0 : 2, out = inside ? 1 : 2;
            }
            from = std::max(from, std::min(in, out)), to = std::min(to, std::max(in, out));
        }
        return to > from;
    }
    /// The corners that paths go around: those within the plate.
    std::vector<Vec2d> corners() const {
        std::vector<Vec2d> found;
        for (const Vec2d& c : {low, Vec2d{low.x, high.y}, Vec2d{high.x, low.y}, high})
            if (c.x > 0 && c.x < kSide && c.y > 0 && c.y < kSide) found.push_back(c);
        return found;
    }
    /// The distance from a seed on the plate.
    double distance(const Vec2d& seed, const Vec2d& p) const {
        const auto straight = [&](const Vec2d& a, const Vec2d& b) {
            return parts(a, b) ? kInfinity : length(b - a);
        };
        const std::vector<Vec2d> all = corners();
        std::vector<double> at;
        for (const Vec2d& c : all) at.push_back(straight(seed, c));
        for (std::size_t round = 0; round < all.size(); ++round)
            for (std::size_t k = 0; k < all.size(); ++k)
                for (std::size_t j = 0; j < all.size(); ++j)
                    at[k] = std::min(at[k], at[j] + straight(all[j], all[k]));
        double least = straight(seed, p);
        for (std::size_t k = 0; k < all.size(); ++k)
            least = std::min(least, at[k] + straight(all[k], p));
        return least;
    }
};

/// Turned anywhere, or in one plane with the lattice between two of its planes.
openvdb::math::Transform::Ptr placed(Random& random, int turn) {
    constexpr std::array<double, 4> kBetween{0, 0.5, 0.45, 0.25};
    const openvdb::Vec3d axis = random.direction();
    const double degrees = random.between(0, 360);
    openvdb::Vec3d offset;
    for (int k = 0; k < 3; ++k) offset[k] = random.between(0, 1);
    if (turn >= 4) return rotatedTransform(1, axis, degrees, offset);
    offset[2] = kBetween[std::size_t(turn)];
    return rotatedTransform(1, openvdb::Vec3d(0, 0, 1), 0, offset);
}

Vec3d worldOf(const openvdb::math::Transform& transform, const Vec3d& p) {
    return fromVdb(transform.indexToWorld(openvdb::Vec3d(p.x, p.y, p.z)));
}

/// Eight triangles around a corner, ridges and valleys in turn, each of 60 degrees.
struct Saddle {
    static constexpr std::uint32_t kWedges = 8, kParts = 16;
    static constexpr double kWedge = 60, kTurn = kWedges * kWedge;  // degrees

    /// Where a wedge begins.
    static Vec3d edge(std::uint32_t w) {
        constexpr std::array<std::array<int, 3>, kWedges> kEdges{{{1, -1, 0},
                                                                  {1, 0, 1},
                                                                  {0, -1, 1},
                                                                  {-1, 0, 1},
                                                                  {-1, -1, 0},
                                                                  {-1, 0, -1},
                                                                  {0, -1, -1},
                                                                  {1, 0, -1}}};
        const auto& [x, y, z] = kEdges[w % kWedges];
        return Vec3d(x, y, z);
    }
    TriangleMesh mesh;
    std::vector<std::pair<double, double>> polar;  ///< of its vertices: distance, degrees

    explicit Saddle(double size) {
        const auto vertex = [](std::uint32_t ring, std::uint32_t at) {
            return ring == 0 ? 0 : 1 + kWedges * ring * (ring - 1) / 2 + at % (kWedges * ring);
        };
        mesh.points.push_back({}), polar.emplace_back(0, 0);
        for (std::uint32_t ring = 1; ring <= kParts; ++ring)
            for (std::uint32_t w = 0; w < kWedges; ++w)
                for (std::uint32_t j = 0; j < ring; ++j) {
                    const Vec3d p = size / kParts / std::sqrt(2.0) *
                                    ((ring - j) * edge(w) + double(j) * edge(w + 1));
                    const double cosine = dot(p, edge(w)) / (length(p) * std::sqrt(2.0));
                    mesh.points.push_back(p);
                    polar.emplace_back(length(p), w * kWedge + std::acos(std::min(cosine, 1.0)) *
                                                                   180 / std::acos(-1.0));
                    const std::uint32_t here = w * ring + j, inner = w * (ring - 1) + j;
                    mesh.triangles.push_back(
                        {vertex(ring, here), vertex(ring, here + 1), vertex(ring - 1, inner)});
                    if (j + 1 < ring)
                        mesh.triangles.push_back({vertex(ring, here + 1),
                                                  vertex(ring - 1, inner + 1),
                                                  vertex(ring - 1, inner)});
                }
    }
    double distance(std::size_t i, std::size_t j) const {
        const auto& [r, a] = polar[i];
        const auto& [s, b] = polar[j];
        const double turn = std::min(std::abs(a - b), kTurn - std::abs(a - b));
        if (turn >= 180) return r + s;
        return std::sqrt(
            std::max(0.0, r * r + s * s - 2 * r * s * std::cos(turn * std::acos(-1.0) / 180)));
    }
};

/// The errors from a vertex to all others.
template <typename Exact>
void addErrors(const TriangleMesh& mesh, std::size_t seed, const Exact& exact,
               VertexErrors& errors) {
    const GeodesicSolver solver(Surface(mesh, {.size = 1}));
    const VertexValues values = solver.distance({mesh.points[seed]}).atVertices();
    // No face has the vertices in a cut.
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        if (!std::isnan(values.distance[v])) errors.add(values.distance[v] - exact(v));
}

}  // namespace

TEST_CASE("mesh corners: fronts spread around the corners of holes and slots in open plates") {
    const std::array cuts{Cut{"L", {25, 25}, {60, 60}}, Cut{"hole", {17.5, 17.5}, {32.5, 32.5}},
                          Cut{"slot", {20, 15}, {30, 60}}};
    for (const Cut& cut : cuts) {
        VertexErrors errors;
        for (int turn = 0; turn < 24; ++turn) {
            Random random(static_cast<unsigned>(turn));
            const auto transform = placed(random, turn % 12);
            TriangleMesh mesh = sheet(
                20, 20,
                [](double u, double v) {
                    return Vec3d{kSide * u, kSide * v, 0};
                },
                [&](double u, double v) {
                    return !cut.holds({kSide * u, kSide * v});
                });
            std::vector<Vec2d> at;
            for (Vec3d& p : mesh.points) at.push_back({p.x, p.y}), p = worldOf(*transform, p);
            const auto seed = std::size_t(random.between(0, double(at.size())));
            if (cut.holds(at[seed])) continue;
            addErrors(
                mesh, seed, [&](std::size_t v) { return cut.distance(at[seed], at[v]); }, errors);
        }
        errors.print(cut.name);
        CHECK(errors.low > -0.39);      // measured -0.26
        CHECK(errors.most < 0.55);      // measured 0.363
        CHECK(errors.mean() < 0.0282);  // measured 0.0188
    }
}

TEST_CASE("mesh corners: fronts go over a corner with more than a full turn of faces") {
    VertexErrors errors;
    for (int turn = 0; turn < 12; ++turn) {
        Random random(static_cast<unsigned>(turn));
        const auto transform = placed(random, 4);
        Saddle saddle(25);
        for (Vec3d& p : saddle.mesh.points) p = worldOf(*transform, p);
        const auto seed = std::size_t(random.between(8, double(saddle.polar.size())));
        addErrors(
            saddle.mesh, seed, [&](std::size_t v) { return saddle.distance(seed, v); }, errors);
    }
    errors.print("saddle");
    CHECK(errors.low > -0.16);      // measured -0.106
    CHECK(errors.most < 0.375);     // measured 0.249
    CHECK(errors.mean() < 0.0315);  // measured 0.0209
}

}  // namespace igeo::test
