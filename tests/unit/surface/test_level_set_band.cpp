#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <map>

namespace igeo::test {
namespace {

/// Off every lattice line, plane and symmetry.

Band bandOf(const Shape& shape, double dx, double h, double halfWidth) {
    return bandFromLevelSet(checkedLevelSet(makeLevelSet(shape, dx, halfWidth)), h);
}

struct WorstErrors {
    double normal = 0, foot = 0;  ///< foot in voxels
};

/// Against the exact normal, and the exact foot point x - psi n.
WorstErrors worst(const Band& band,
                  const std::function<openvdb::Vec3d(const openvdb::Vec3d&)>& normalAt,
                  const SignedDistance& sdf) {
    WorstErrors w;
    const double dx = band.transform.dx;
    for (std::size_t k = 0; k < band.size(); ++k) {
        const auto i = NodeIndex(k);
        const openvdb::Vec3d p = worldOf(band, Vec3d(band.ijk(i)));
        const openvdb::Vec3d n = normalAt(p), foot = p - sdf(p) * n;
        const Vec3d computed(band.normal[i]);
        w.normal = std::max(w.normal, (openvdb::Vec3d(computed.x, computed.y, computed.z) -
                                       band.transform.axis[0].x * n)
                                          .length());
        w.foot = std::max(w.foot, (worldOf(band, band.footPoint(i)) - foot).length() / dx);
    }
    return w;
}

openvdb::Vec3d torusNormal(const openvdb::Vec3d& p) {
    const openvdb::Vec3d q = p - kOffLattice;
    const openvdb::Vec3d onCircle = openvdb::Vec3d(q.x(), q.y(), 0).unit();
    return (q - onCircle).unit();
}

}  // namespace

TEST_CASE("bandFromLevelSet: exactly the voxels with |psi| < h") {
    const double dx = 0.05, h = 2;
    const auto grid = makeLevelSet(sphere(kOffLattice, 1), dx, 3);
    const Band band = bandFromLevelSet(checkedLevelSet(grid), h);
    std::size_t expected = 0;
    for (auto it = grid->cbeginValueOn(); it; ++it) {
        const auto c = it.getCoord();
        const NodeIndex i = band.nodeAt({c.x(), c.y(), c.z()});
        const bool inside = std::abs(*it) < h * dx;
        expected += inside;
        if ((i != kNoNode) != inside) FAIL("voxel " << c << ", psi " << *it);
        // One rounding to float.
        if (inside && std::abs(band.psi[i] - *it / dx) > 1.3e-7) FAIL("psi differs at " << c);
    }
    CHECK(band.size() == expected);
    CHECK(band.h == h);
    CHECK(band.transform.dx == dx);
}

TEST_CASE("bandFromLevelSet: a plane's normals and foot points are exact") {
    const openvdb::Vec3d n = openvdb::Vec3d(0.36, 0.48, -0.8);
    const Band band = bandOf(planePatch(kOffLattice, n, 1.5), 0.05, 2, 3);
    for (std::size_t k = 0; k < band.size(); ++k) {
        // At the cut neighbors are missing.
        const openvdb::Vec3d fromCenter =
            worldOf(band, Vec3d(band.ijk(NodeIndex(k)))) - kOffLattice;
        if (fromCenter.length() > 0.7) continue;
        // psi / dx is a float below 4, off by 2.4e-7 with the rounding of the input; a difference
        // over two voxels of it, three times; foot points add |psi| < 2 times that.
        const Vec3d normal(band.normal[k]);
        REQUIRE(length(normal - Vec3d{n.x(), n.y(), n.z()}) < 2.15e-7);  // measured 1.4e-7
        const openvdb::Vec3d foot = worldOf(band, band.footPoint(NodeIndex(k)));
        REQUIRE(std::abs((foot - kOffLattice).dot(n)) < 1.45e-8);  // measured 9.7e-9
    }
}

TEST_CASE("bandFromLevelSet: |foot| = |psi| and normals have unit length") {
    for (const Shape& shape :
         {sphere(kOffLattice, 1), torus(kOffLattice, 1, 0.4), box(kOffLattice, {0.7, 0.8, 0.6}),
          thinSheet(kOffLattice, 0.6, 0.6, 0.1)}) {
        const Band band = bandOf(shape, 0.05, 2.5, 3);
        INFO(shape.name);
        for (std::size_t k = 0; k < band.size(); ++k) {
            // In single precision: each number is rounded to 6e-8, several times.
            REQUIRE(std::abs(length(Vec3d(band.normal[k])) - 1) < 1.5e-7);  // measured 9.7e-8
            // psi times these, rounded again.
            const Vec3d foot(band.footOf(NodeIndex(k)));
            REQUIRE(std::abs(length(foot) - std::abs(double(band.psi[k]))) <
                    2.86e-7);  // measured 1.91e-7
        }
    }
}

TEST_CASE("bandFromLevelSet: normals and foot points converge at order 2") {
    // Central differences: error proportional to (dx / R)^2 plus terms of the fourth power, a few
    // percent of it at R = 6 voxels. R is that of the parallel surface at the inner edge of the
    // band, h voxels closer to the middle of the sphere or tube, so it shrinks with dx as well.
    const auto sphereNormal = [](const openvdb::Vec3d& p) { return (p - kOffLattice).unit(); };
    struct Case {
        Shape shape;
        std::function<openvdb::Vec3d(const openvdb::Vec3d&)> normal;
    };
    for (const Case& c : {Case{sphere(kOffLattice, 1), sphereNormal},
                          Case{torus(kOffLattice, 1, 0.4), torusNormal}}) {
        INFO(c.shape.name);
        const double radius = c.shape.name == "sphere" ? 1 : 0.4;
        std::vector<double> relative, normal, foot;
        for (const double dx : {0.05, 0.025, 0.0125}) {
            const WorstErrors w = worst(bandOf(c.shape, dx, 2, 3), c.normal, c.shape.sdf);
            relative.push_back(dx / (radius - 2 * dx));
            normal.push_back(w.normal), foot.push_back(w.foot);
        }
        CHECK(fittedRate(relative, normal) == Approx(2).margin(0.1));
        CHECK(fittedRate(relative, foot) == Approx(2).margin(0.1));
        // The third derivatives of |x| are below 3 / R^2, so a central difference is off by at most
        // half of that, and three of them by sqrt(3) times as much.
        const double bound = std::sqrt(3.0) * 0.5 * std::pow(0.05 / (radius - 3 * 0.05), 2);
        CHECK(normal[0] < bound);
        CHECK(foot[0] < 2 * bound);
    }
}

TEST_CASE("bandFromLevelSet: a turned grid gives the same band bit by bit") {
    const auto grid = makeLevelSet(torus(kOffLattice, 1, 0.4), 0.05, 3);
    const auto turned = grid->deepCopy();
    turned->setTransform(rotatedTransform(0.05, {1, 2, 3}, 30, {5, -7, 11}));
    const Band a = bandFromLevelSet(checkedLevelSet(grid), 2);
    const Band b = bandFromLevelSet(checkedLevelSet(turned), 2);
    REQUIRE(a.size() == b.size());
    CHECK(a.psi == b.psi);
    CHECK(a.normal == b.normal);
    CHECK(a.foot == b.foot);
    CHECK(a.facing == b.facing);
}

TEST_CASE("bandFromLevelSet: sheets that face each other are not linked") {
    // 2.6 voxels thick: the middle lies within the band, at another place of the voxels each time.
    for (const double shift : {0.0, 0.013, 0.025, 0.037}) {
        const openvdb::Vec3d center = kOffLattice + openvdb::Vec3d(0, 0, shift);
        const Band band = bandOf(thinSheet(center, 1, 1, 0.13), 0.05, 2, 3);
        // Every column through the sheet is cut once, where the normal turns.
        std::map<std::pair<int, int>, int> cuts;
        for (std::size_t k = 0; k < band.size(); ++k) {
            const auto i = NodeIndex(k);
            const openvdb::Vec3d p = worldOf(band, Vec3d(band.ijk(i))) - center;
            // Away from the rim, where the path around is.
            if (std::abs(p.x()) > 0.7 || std::abs(p.y()) > 0.7) continue;
            const NodeIndex above = band.neighbor(i, 0, 0, 1);
            if (above == kNoNode) continue;
            const bool isCut = !band.linked(i, above);
            const bool opposed = band.normal[i].z < 0 && band.normal[above].z > 0;
            if (isCut != opposed) FAIL("at z = " << p.z() / 0.05 << " voxels from the middle");
            cuts[{band.ijk(i).x, band.ijk(i).y}] += isCut;
        }
        CHECK(cuts.size() > 700);
        for (const auto& column : cuts)
            if (column.second != 1) FAIL("a column is cut " << column.second << " times");
    }
    // Nothing faces anything on a sphere.
    const Band round = bandOf(sphere(kOffLattice, 1), 0.05, 2, 3);
    CHECK(std::count(round.facing.begin(), round.facing.end(), 0) == std::ptrdiff_t(round.size()));
}

TEST_CASE("bandFromLevelSet: a region holds what the whole band holds there") {
    const LevelSet surface =
        checkedLevelSet(makeLevelSet(torus({0.5, 0.5, 0.5}, 0.3, 0.1), 0.02, 3));
    const Band whole = bandFromLevelSet(surface, 2);
    const std::vector<Ball> region{{{40, 25, 25}, 9}, {{10.3, 25, 21}, 4}};
    const Band part = bandFromLevelSet(surface, 2, region);
    CHECK(part.size() < whole.size() / 2);
    std::size_t within = 0;
    for (NodeIndex i = 0; i < whole.size(); ++i) {
        const Vec3d p(whole.ijk(i));
        const NodeIndex j = part.nodeAt(whole.ijk(i));
        for (const Ball& ball : region)
            if (length(p - ball.center) <= ball.radius) {
                ++within;
                REQUIRE(j != kNoNode);
            }
        if (j == kNoNode) continue;
        REQUIRE(part.psi[j] == whole.psi[i]);
        REQUIRE(part.footOf(j) == whole.footOf(i));
        REQUIRE(part.normal[j] == whole.normal[i]);
    }
    CHECK(within > 200);
    CHECK(bandFromLevelSet(surface, 2, {{{-500, 0, 0}, 20}}).size() == 0);
}

TEST_CASE("bandFromLevelSet: refuses a width that the level set does not have") {
    const LevelSet surface = checkedLevelSet(makeLevelSet(sphere(kOffLattice, 1), 0.05, 3));
    const auto kind = Error::Kind::InvalidArgument;
    expectError(kind, {"a band of 4 voxels", "widen"}, [&] { bandFromLevelSet(surface, 4); });
    expectError(kind, {}, [&] { bandFromLevelSet(surface, 0); });
    expectError(kind, {}, [&] { bandFromLevelSet(surface, std::nan("")); });
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Error::Kind::Cancelled, {}, [&] { bandFromLevelSet(surface, 2, {}, stop); });
}

}  // namespace igeo::test
