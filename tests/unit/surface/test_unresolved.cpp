// What the voxels do not show: said with its share, and not where they do.
#include <igeo/base/detail/text.h>
#include <igeo/geodesic_solver.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/mesh_band.h>
#include <igeo/surface/unresolved.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/MeshToVolume.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <cstdio>
#include <iterator>

namespace igeo::test {
namespace {

Unresolved unresolved(const openvdb::FloatGrid::Ptr& grid) {
    const LevelSet levelSet = checkedLevelSet(grid);
    return unresolvedOf(levelSet, bandFromLevelSet(levelSet, std::sqrt(3.0)));
}

bool warns(const Unresolved& of, const std::string& word) {
    for (const std::string& w : unresolvedWarnings(of))
        if (w.find(word) != std::string::npos) return true;
    return false;
}

/// Turned about two axes, and moved off the lattice.
TriangleMesh turnedMesh(TriangleMesh mesh) {
    const auto transform = rotatedTransform(1, {1, 2, 3}, 40, {0.1, 0.2, 0.3});
    return moved(std::move(mesh), [&](const Vec3d& p) {
        const openvdb::Vec3d q = transform->indexToWorld(openvdb::Vec3d(p.x, p.y, p.z));
        return Vec3d{q.x(), q.y(), q.z()};
    });
}

/// As OpenVDB converts a mesh, voxels of 1.
openvdb::FloatGrid::Ptr converted(const TriangleMesh& mesh) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (const Vec3d& p : mesh.points) points.emplace_back(p.x, p.y, p.z);
    for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
        *openvdb::math::Transform::createLinearTransform(1), points, triangles);
}

//// Two blocks side by side, a gap between them.
TriangleMesh blocks(double gap) {
    const TriangleMesh block = boxMesh({16, 24, 20});
    return turnedMesh(together(block, moved(block, [&](const Vec3d& p) {
                                   return p + Vec3d{16 + gap, 0, 0};
                               })));
}

/// As saved as half floats.
openvdb::FloatGrid::Ptr inHalf(const openvdb::FloatGrid::Ptr& psi) {
    const openvdb::FloatGrid::Ptr half = psi->deepCopy();
    for (auto it = half->beginValueAll(); it; ++it) it.setValue(float(openvdb::math::half(*it)));
    return half;
}

Unresolved onVoxels(const TriangleMesh& mesh, double dx) {
    return unresolvedOf(meshFacts(mesh), bandFromMesh(mesh, dx, std::sqrt(3.0)));
}

}  // namespace

TEST_CASE("unresolved: nothing of smooth and creased shapes") {
    for (const Shape& shape :
         {sphere(kOffLattice, 0.5), torus(kOffLattice, 1, 0.4), box(kOffLattice, {0.9, 0.7, 0.5}),
          roundedBox(kOffLattice, {0.9, 0.7, 0.5}, 0.2), cylinder(kOffLattice, 0.5, 0.8),
          trefoilTube(kOffLattice, 0.3, 0.12), frustum(kOffLattice, 0.5, 0.2, 0.5)}) {
        INFO(shape.name);
        const Unresolved u =
            unresolved(makeLevelSet(shape, *rotatedTransform(0.05, {1, 2, 3}, 40, {5, 6, 7}), 3));
        CHECK(*u.closed == 0);
        CHECK(*u.thin == 0);
        CHECK(*u.cutOff == 0);
        CHECK(unresolvedWarnings(u).empty());
    }
}

TEST_CASE("unresolved: grooves that no front reaches, where a fin meets a ball at an acute angle") {
    for (const double low : {8.5, 10.5, 11.5}) {
        Shape part = sphere(openvdb::Vec3d(0), 12);
        const Shape fin = partOf({{{0, -9, low}, {26, 9, low + 4}}});
        part.sdf = [ball = part.sdf, fin = fin.sdf](const openvdb::Vec3d& p) {
            return std::min(ball(p), fin(p));
        };
        part.bounds.expand(fin.bounds);
        const auto grid = makeLevelSet(part, *rotatedTransform(1, {1, 2, 3}, 40, {5, 6, 7}), 3);
        const Unresolved u = unresolved(grid);
        const Distance d = GeodesicSolver(Surface(*grid)).distance({{-12, 0.3, 0}});
        const Band& band = d.band();
        std::size_t unreached = 0;
        for (NodeIndex i = 0; i < band.size(); ++i)
            unreached += band.inCore(i) && !(d.field().distance[i] < kInfinity);
        std::printf("fin from %.1f voxels on: %.3g %% cut off, %zu of %zu nodes unreached\n", low,
                    100 * *u.cutOff, unreached, band.coreSize());
        CHECK(*u.cutOff * double(band.coreSize()) == Approx(double(unreached)));
        CHECK(warns(u, "walls or grooves narrower than the voxels can show"));
    }
}

TEST_CASE("unresolved: gaps that a conversion closed, by psi alone") {
    for (const double gap : {0.3, 0.9, 1.5}) {
        INFO("gap of " << gap);
        const Unresolved u = unresolved(converted(blocks(gap)));
        std::printf("gap of %.1f voxels: psi contradicts itself next to %.3g %%\n", gap,
                    100 * *u.closed);
        CHECK(*u.closed > 0.01);
        CHECK(warns(u, "closed when the level set was made"));
    }
    for (const double gap : {3.0, 4.0}) {
        INFO("gap of " << gap);
        const Unresolved u = unresolved(converted(blocks(gap)));
        CHECK(*u.closed == 0);
        CHECK(unresolvedWarnings(u).empty());
    }
}

TEST_CASE("unresolved: gaps between round parts, which a conversion closes without a trace") {
    for (const double gap : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0}) {
        INFO("gap of " << gap);
        const double r = 10, at = r + gap / 2;
        const TriangleMesh two =
            together(sphereMesh({-at, 0, 0}, r, 4), sphereMesh({at, 0, 0}, r, 4));
        double least = 1, most = 0;
        int seen = 0, joined = 0, seenInHalf = 0;
        for (int k = 0; k < 6; ++k) {
            const auto transform = rotatedTransform(1, {1.0 + k, 2, 3.0 - k}, 40 + 25.0 * k,
                                                    {0.13 * k, 0.31 * k, 0.2});
            const auto placed = [&](const Vec3d& p) {
                const openvdb::Vec3d q = transform->indexToWorld(openvdb::Vec3d(p.x, p.y, p.z));
                return Vec3d{q.x(), q.y(), q.z()};
            };
            const auto psi = converted(moved(two, placed));
            const Unresolved u = unresolved(psi);
            seen += warns(u, "closes parts of such gaps") || warns(u, "closed when the level set");
            least = std::min(least, *u.gap);
            most = std::max(most, *u.gap);
            const Unresolved half = unresolved(inHalf(psi));
            seenInHalf += warns(half, "values in half precision do not show") ||
                          warns(half, "closed when the level set");
            const Distance d = GeodesicSolver(Surface(*psi)).distance({placed({-at - r, 0, 0})});
            joined += d.at(placed({at + r, 0, 0})) < kInfinity;
        }
        std::printf("balls, gap of %.1f voxels: narrow on %.2g to %.2g %%, joined %d times of 6\n",
                    gap, 100 * least, 100 * most, joined);
        CHECK(seen == (gap < 2.5 ? 6 : 0));
        CHECK(seenInHalf == (gap < 2.5 ? 6 : 0));
        if (gap > 2.5) CHECK(joined == 0);
    }
    CHECK_FALSE(unresolved(makeLevelSet(sphere(kOffLattice, 0.5), 0.05, 3)).gap);
    CHECK(*unresolved(inHalf(makeLevelSet(sphere(kOffLattice, 0.5), 0.05, 3))).gap == 0);
}

TEST_CASE("unresolved: no closed gaps beside the hollow edges of unions and differences") {
    const openvdb::Vec3d o(0);
    const struct {
        const char* name;
        Shape a, b;
        bool less;      ///< a without b
        double before;  ///< measured, %; now 0
    } cases[] = {
        {"balls", sphere(o, 1), sphere({1.5, 0, 0}, 1), false, 2.4},
        {"boxes", box(o, {0.9, 0.9, 0.9}), box({1, 0.2, 0.1}, {0.5, 0.5, 0.5}), false, 1.1},
        {"box on a plate", box(o, {1.5, 1.5, 0.2}), box({0, 0, 0.6}, {0.3, 0.3, 0.6}), false, 0.62},
        {"bar through a cylinder", cylinder(o, 0.5, 1.2), box(o, {1, 0.3, 0.3}), false, 1.5},
        {"box less a ball", box(o, {0.9, 0.9, 0.9}), sphere({0.9, 0, 0}, 0.5), true, 1.1}};
    for (const auto& c : cases) {
        double most = 0;
        for (int k = 0; k < 24; ++k) {
            const auto transform =
                rotatedTransform(0.05, {1.0 + k % 3, 2, 3.0 - k % 5}, 15.0 * k + 7,
                                 {0.013 * k, 0.031 * k, 0.017 * k});
            const auto grid = makeLevelSet(c.a, *transform, 3),
                       b = makeLevelSet(c.b, *transform, 3);
            if (c.less)
                openvdb::tools::csgDifference(*grid, *b);
            else
                openvdb::tools::csgUnion(*grid, *b);
            most = std::max(most, *unresolved(grid).closed);
        }
        std::printf("%s: psi contradicts itself next to %.3g %%; before, up to %.3g %%\n", c.name,
                    100 * most, c.before);
        CHECK(most == 0);
    }
}

TEST_CASE("unresolved: no closed gaps in cones, of which a conversion makes voxels too deep") {
    for (const auto& [radius, height] : {std::pair{7.4, 14.9}, {12.5, 17.7}, {6.1, 15.7}}) {
        TriangleMesh cone;
        constexpr std::uint32_t kSides = 24;
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const double angle = 2 * std::acos(-1.0) * k / kSides;
            cone.points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
            const std::uint32_t next = (k + 1) % kSides;
            cone.triangles.push_back({k, next, kSides});
            cone.triangles.push_back({next, k, kSides + 1});
        }
        cone.points.push_back({0, 0, height});
        cone.points.push_back({0, 0, 0});
        // Measured 0; up to 0.26 where a voxel too deep contradicts its neighbors.
        double most = 0;
        for (int k = 0; k < 64; ++k) {
            const Vec3d to{0.25 * (k & 3), 0.25 * (k >> 2 & 3), 0.25 * (k >> 4)};
            const Unresolved u =
                unresolved(converted(moved(cone, [&](const Vec3d& p) { return p + to; })));
            most = std::max(most, *u.closed);
        }
        std::printf("cone of %.1f x %.1f voxels: psi contradicts itself next to %.3g %%\n", radius,
                    height, 100 * most);
        CHECK(most == 0);
    }
}

TEST_CASE("unresolved: walls of about a voxel") {
    // On a plate, voxels of 1.
    const auto wall = [](double thickness) {
        const double h = thickness / 2;
        return unresolved(
            makeLevelSet(partOf({{{-12, -12, -5}, {12, 12, 0}}, {{-h, -12, 0}, {h, 12, 9}}}),
                         *rotatedTransform(1, {0.3, 0.5, 0.8}, 33, {0.01, 0.33, -0.21}), 3));
    };
    for (const double voxels : {0.8, 1.0}) {
        const Unresolved u = wall(voxels);
        std::printf("wall of %.1f voxels: thin on %.3g %%\n", voxels, 100 * *u.thin);
        CHECK(*u.thin > 0.1);
        CHECK(warns(u, "thinner than 1.1 voxels"));
    }
    for (const double voxels : {1.3, 2.0}) {
        INFO("wall of " << voxels);
        CHECK_FALSE(warns(wall(voxels), "thinner than"));
    }
}

TEST_CASE("unresolved: the faces of sharp edges face no other sheet") {
    const TriangleMesh::Triangle base[] = {{3, 2, 1}, {3, 1, 0}};
    for (const double angle : {70.5, 60.0, 45.0, 30.0})
        for (const double voxels : {20.0, 50.0}) {
            TriangleMesh pyramid;
            const double height = std::tan(angle * M_PI / 180);
            pyramid.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, height}};
            pyramid.triangles.assign(std::begin(base), std::end(base));
            for (std::uint32_t k = 0; k < 4; ++k) pyramid.triangles.push_back({k, (k + 1) % 4, 4});
            const TriangleMesh mesh =
                turnedMesh(moved(pyramid, [&](const Vec3d& p) { return voxels * p; }));
            const Unresolved u = onVoxels(mesh, 1), made = unresolved(converted(mesh));
            std::printf("edges of %.1f degrees, %g voxels: facing on %.3g %%, thin on %.3g %%\n",
                        angle, voxels, 100 * *u.facing, 100 * *made.thin);
            CHECK_FALSE(warns(u, "sheets face each other within two voxels on"));
            CHECK_FALSE(warns(made, "thinner than"));
        }
    // A gap between blocks, and the slot of a fold.
    for (const double gap : {1.0, 2.0}) {
        const Unresolved u = onVoxels(blocks(gap), 1);
        std::printf("gap of %.1f voxels: facing on %.3g %%\n", gap, 100 * *u.facing);
        CHECK(warns(u, "sheets face each other"));
    }
}

TEST_CASE(
    "unresolved: the Euler characteristic on the voxels is that of the mesh, or is reported") {
    const auto ring = [](double u, double v) {
        const double a = 2 * M_PI * u, b = 2 * M_PI * v, r = 10 + 4 * std::cos(b);
        return Vec3d{r * std::cos(a), r * std::sin(a), 4 * std::sin(b)};
    };
    TriangleMesh torusMesh = sheet(80, 40, ring);
    weld(torusMesh);
    CHECK(meshFacts(torusMesh).euler == 0);
    CHECK(*onVoxels(torusMesh, 1).eulerDifference == 0);

    const TriangleMesh two = together(sphereMesh({0, 0, 0}, 6, 3), sphereMesh({14, 0, 0}, 6, 3));
    CHECK(meshFacts(two).euler == 4);
    CHECK(*onVoxels(two, 1).eulerDifference == 0);

    CHECK(meshFacts(turnedMesh(plateWithTunnel(3))).euler == 0);
    for (const double width : {2.5, 4.0})
        CHECK(*onVoxels(turnedMesh(plateWithTunnel(width)), 1).eulerDifference == 0);
    for (const double width : {0.2, 0.4}) {
        const Unresolved u = onVoxels(turnedMesh(plateWithTunnel(width)), 1);
        CHECK(*u.eulerDifference != 0);
        CHECK(*u.facing > 0);
        CHECK(warns(u, "tunnels or gaps"));
        CHECK(warns(u, "as narrow as voxels, as is " + percent(*u.facing) + " of the surface"));
    }
    // A side along a diagonal of the lattice: voxels beside it are as deep as the band is.
    TriangleMesh diagonal;
    diagonal.points = {{16, 0, 0}, {-16, 0, 0}, {0, 16, 0}, {0, -16, 0}, {0, 0, 16}, {0, 0, -16}};
    diagonal.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                          {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (const double shift : {0.0, 0.5, 1.0 / 3})
        CHECK(*onVoxels(moved(diagonal,
                              [=](const Vec3d& p) {
                                  return p + Vec3d{shift, 0, 0};
                              }),
                        1)
                   .eulerDifference == 0);
    // What has no inside has none.
    CHECK_FALSE(onVoxels(sheet(8, 8,
                               [](double u, double v) {
                                   return Vec3d{16 * u, 16 * v, 0};
                               }),
                         1)
                    .eulerDifference);
}

}  // namespace igeo::test
