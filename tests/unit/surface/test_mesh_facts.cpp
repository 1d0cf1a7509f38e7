#include <igeo/surface/detail/mesh_crossings.h>
#include <igeo/surface/mesh_facts.h>
#include <support/catch.h>
#include <support/mesh_shapes.h>

#include <numbers>
#include <random>
#include <set>

namespace igeo {
namespace {

using Triangle = TriangleMesh::Triangle;

TriangleMesh meshOf(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles) {
    TriangleMesh mesh;
    mesh.points = points;
    mesh.triangles = triangles;
    return mesh;
}

std::size_t pairsOf(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles) {
    return meshCrossings(meshOf(points, triangles), 1e-6).pairs;
}

Vec3d cornerOf(const TriangleMesh& mesh, std::size_t t, std::size_t k) {
    return mesh.points[mesh.triangles[t][k % 3]];
}

double volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return dot(cross(b - a, c - a), d - a);
}

/// Whether an edge of triangle t goes through triangle u, of two in general position.
bool pierces(const TriangleMesh& mesh, std::size_t t, std::size_t u) {
    const Vec3d a = cornerOf(mesh, u, 0), b = cornerOf(mesh, u, 1), c = cornerOf(mesh, u, 2);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p = cornerOf(mesh, t, k), q = cornerOf(mesh, t, k + 1);
        if (volume(a, b, c, p) * volume(a, b, c, q) >= 0) continue;
        const double x = volume(p, q, a, b), y = volume(p, q, b, c), z = volume(p, q, c, a);
        if (x * y > 0 && y * z > 0) return true;
    }
    return false;
}

std::size_t piercingPairs(const TriangleMesh& mesh) {
    std::size_t pairs = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t u = 0; u < t; ++u) pairs += pierces(mesh, t, u) || pierces(mesh, u, t);
    return pairs;
}

MeshFacts factsOf(const TriangleMesh& mesh) { return meshFacts(mesh); }

TEST_CASE("what touches does not cross", "[mesh]") {
    const std::vector<Vec3d> p{{0, 0, 0},     {1, 0, 0},      {0, 1, 0}, {1, 1, 0},
                               {0.2, 0.2, 1}, {0.2, 0.2, -1}, {3, 3, 0}, {0.3, 0.3, 0},
                               {0.5, 0, 0.5}, {0, 0, 1}};
    CHECK(pairsOf(p, {{0, 1, 2}, {1, 3, 2}}) == 0);  // neighbors in one plane
    CHECK(pairsOf(p, {{0, 1, 2}, {0, 1, 9}}) == 0);  // neighbors at a right angle
    CHECK(pairsOf(p, {{0, 1, 2}, {0, 6, 9}}) == 0);  // around a corner, across the other's plane
    CHECK(pairsOf(p, {{0, 1, 2}, {7, 4, 9}}) == 0);  // a corner on a face
    CHECK(pairsOf(p, {{0, 1, 2}, {8, 4, 9}}) == 0);  // above
    CHECK(pairsOf(p, {{0, 1, 2}, {4, 5, 5}, {0, 7, 3}}) == 0);  // without area
}

TEST_CASE("points on faces of others are contacts, and move off them", "[mesh]") {
    // A table, and a pyramid with its base on it: one corner on an edge between two triangles.
    const std::vector<Vec3d> p{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0},
                               {2, 2, 0}, {5, 2, 0}, {5, 5, 0}, {4, 3, 3}};
    TriangleMesh mesh =
        meshOf(p, {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 5, 7}, {5, 6, 7}, {6, 4, 7}});
    const MeshFacts facts = factsOf(mesh);
    std::set<std::uint32_t> touching;
    for (const MeshContact& c : facts.contacts) {
        touching.insert(c.point);
        CHECK(std::abs(c.normal.z) == 1);
    }
    CHECK(touching == std::set<std::uint32_t>{4, 5, 6});
    separate(mesh, facts.contacts, 1e-3);
    for (std::uint32_t k = 0; k < p.size(); ++k) {
        INFO("point " << k);
        if (touching.count(k) == 0)
            CHECK(mesh.points[k] == p[k]);
        else
            CHECK((mesh.points[k].z > 0.99e-3 && length(mesh.points[k] - p[k]) < 0.01));
    }
    CHECK(meshCrossings(mesh, 1e-6).contacts.empty());
    // A face in the plane of another moves to one side.
    TriangleMesh flat =
        meshOf({p[0], p[1], p[2], {4, 1, 0}, {6, 1, 0}, {6, 2, 0}}, {{0, 1, 2}, {3, 4, 5}});
    separate(flat, meshCrossings(flat, 1e-6).contacts, 1e-3);
    for (std::size_t k = 3; k < 6; ++k) CHECK(std::abs(flat.points[k].z) == 1e-3);
}

TEST_CASE("what passes through or overlaps crosses", "[mesh]") {
    const std::vector<Vec3d> p{{0, 0, 0},        {1, 0, 0},       {0, 1, 0},   {1, 1, 0},
                               {0.2, 0.2, 1},    {0.2, 0.2, -1},  {2, 2, 0.1}, {0.2, 0.3, 0},
                               {-0.5, 0.2, 0.1}, {0.6, 0.2, -0.1}};
    CHECK(pairsOf(p, {{0, 1, 2}, {4, 5, 6}}) == 1);  // an edge through a face
    CHECK(pairsOf(p, {{0, 1, 2}, {0, 4, 5}}) == 1);  // beside a corner of both
    CHECK(pairsOf(p, {{0, 1, 2}, {0, 1, 7}}) == 1);  // folded over at an edge, in one plane
    CHECK(pairsOf(p, {{0, 1, 2}, {0, 3, 1}}) == 1);
    CHECK(pairsOf(p, {{0, 1, 3}, {0, 3, 2}, {4, 5, 8}, {4, 5, 9}}) == 2);  // at an edge
}

TEST_CASE("crossings are those of all pairs", "[mesh]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    auto point = [&](double r) {
        return Vec3d{r * uniform(random), r * uniform(random), r * uniform(random)};
    };
    TriangleMesh mesh;
    for (int k = 0; k < 400; ++k) {
        const double size = std::pow(10.0, -2.0 + 2.2 * k / 400);
        const Vec3d middle = point(1);
        const auto first = std::uint32_t(mesh.points.size());
        for (int i = 0; i < 3; ++i) mesh.points.push_back(middle + point(size));
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const std::size_t expected = piercingPairs(mesh);
    CHECK(expected > 400);
    CHECK(meshCrossings(mesh, 1e-9).pairs == expected);

    const TriangleMesh balls =
        test::together(test::sphereMesh({}, 1, 3), test::sphereMesh({0.83, 0.11, 0.07}, 0.9, 3));
    CHECK(piercingPairs(balls) > 100);
    CHECK(factsOf(balls).crossingPairs == piercingPairs(balls));
    CHECK(factsOf(test::sphereMesh({}, 1, 4)).crossingPairs == 0);
}

TEST_CASE("crossings are counted up to a million", "[mesh]") {
    // Needles through one point, 1,800,000 pairs.
    TriangleMesh mesh;
    constexpr int kNeedles = 1900;
    for (int k = 0; k < kNeedles; ++k) {
        const double angle = std::numbers::pi * k / kNeedles;
        const Vec3d to{std::cos(angle), std::sin(angle), 0};
        const auto first = std::uint32_t(mesh.points.size());
        mesh.points.insert(mesh.points.end(),
                           {to, -1.0 * to + Vec3d{0, 0, 1e-2}, -1.0 * to - Vec3d{0, 0, 1e-2}});
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    const MeshFacts facts = factsOf(mesh);
    CHECK(facts.crossingPairs == 1'000'000);
    CHECK(crossingsOf(facts) == "1000000 pairs or more of faces cross");
}

TEST_CASE("holes are lines of boundary edges", "[mesh]") {
    const auto flat = [](double u, double v) { return Vec3d{u, v, 0}; };
    const auto sheet = [&](const std::function<bool(double, double)>& keep) {
        return factsOf(test::sheet(9, 9, flat, keep));
    };
    CHECK(sheet(nullptr).holes == 1);
    CHECK(sheet([](double u, double v) {
              return std::abs(u - 0.5) > 0.1 || std::abs(v - 0.5) > 0.1;
          }).holes == 2);
    // Two quadrilaterals out that touch in a corner: one line around both.
    CHECK(sheet([](double u, double v) {
              return !(u > 4.0 / 9 && u < 6.0 / 9 && v > 4.0 / 9 && v < 6.0 / 9 &&
                       (u < 5.0 / 9) == (v < 5.0 / 9));
          }).holes == 2);
    CHECK(factsOf(test::moebius(1, 0.4, 40)).holes == 1);
    CHECK(factsOf(test::sphereMesh({}, 1, 2)).holes == 0);
    const MeshFacts bowTie = factsOf(
        meshOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}));
    CHECK(bowTie.holes == 2);
    CHECK(bowTie.boundaryEdges == 6);
    // Oriented differently: corners at which no boundary edge begins.
    CHECK(factsOf(meshOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 2}}))
              .holes == 1);
}

TEST_CASE("vertices at which parts meet without an edge are counted", "[mesh]") {
    const std::vector<Vec3d> points{{0, 0, 0},   {1, 0, 0},  {1, 1, 0}, {-1, 0, 0},
                                    {-1, -1, 0}, {0, -1, 0}, {0, 0, 1}};
    CHECK(factsOf(meshOf(points, {{0, 1, 2}, {0, 3, 4}})).pinches == 1);
    CHECK(factsOf(meshOf(points, {{0, 1, 2}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1}})).pinches == 0);
    // At an edge of three triangles paths cross between any two.
    CHECK(factsOf(meshOf(points, {{0, 1, 2}, {0, 1, 5}, {0, 1, 6}})).pinches == 0);
    CHECK(factsOf(test::sphereMesh({}, 1, 2)).pinches == 0);
}

TEST_CASE("a mesh is described in the words of meshes", "[mesh]") {
    const auto saddle = [](double u, double v) { return Vec3d{u, v, (u - 0.5) * v}; };
    CHECK(meshWarnings(factsOf(test::sphereMesh({}, 1, 2))).empty());
    TriangleMesh twice = test::sheet(4, 4, saddle);
    for (std::size_t t = 0; t < 32; ++t) {
        const auto [a, b, c] = twice.triangles[t];
        twice.triangles.push_back(t % 2 ? Triangle{b, a, c} : Triangle{b, c, a});
    }
    weld(twice);
    const MeshFacts facts = factsOf(twice);
    CHECK(facts.triangles == 32);
    CHECK(facts.repeated == 32);
    CHECK(meshWarnings(facts) ==
          std::vector<std::string>{"32 triangles repeat others, in the same or the opposite order "
                                   "of corners (as in two-sided exports): dropped"});
    CHECK(openness(facts) == "open: 16 boundary edges in 1 hole");
    CHECK(openness(factsOf(test::sphereMesh({}, 1, 2))).empty());
    const TriangleMesh crossed = test::together(test::sheet(1, 1,
                                                            [](double u, double v) {
                                                                return Vec3d{u, v, 0};
                                                            }),
                                                test::sheet(1, 1, [](double u, double v) {
                                                    return Vec3d{0.3, u, v - 0.4};
                                                }));
    CHECK(meshWarnings(factsOf(crossed)).back() ==
          "3 pairs of faces cross: the mesh passes through itself");
    const TriangleMesh strip =
        test::together(test::moebius(1, 0.4, 60), test::sphereMesh({}, 9, 2));
    CHECK(meshWarnings(factsOf(strip)) ==
          std::vector<std::string>{"the mesh has one side only (as a Moebius strip) in 1 of 2 "
                                   "parts: godunov cuts it along a line there, which its paths go "
                                   "around; jet does not"});
}

}  // namespace
}  // namespace igeo
