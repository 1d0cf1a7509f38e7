// Distances between pairs: what a march on the whole surface says, from a part of it.
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/results/pair_distances.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>

namespace igeo::test {
namespace {

const double kH = std::sqrt(3.0);

struct Surface {
    LevelSet levelSet;
    Band whole;

    Surface(const Shape& shape, double dx, double turn)
        : levelSet(checkedLevelSet(
              makeLevelSet(shape, *rotatedTransform(dx, {1, 2, 3}, turn, {3, -1, 2}), 3))),
          whole(bandFromLevelSet(levelSet, kH)) {}
    Vec3d index(const openvdb::Vec3d& p) const {
        return levelSet.transform.indexFromWorld({p.x(), p.y(), p.z()});
    }
    double wholeDistance(const Vec3d& from, const Vec3d& to) const {
        const SurfacePoint s = nearestSurfacePoint(whole, from), t = nearestSurfacePoint(whole, to);
        return sampleDistance(marchJet(whole, {}, {s}), t.pIndex, Vec3d(whole.normal[t.node]));
    }
};

/// Without weights.
PairSurface pairSurface(const LevelSet& levelSet, double h) {
    PairSurface surface;
    surface.band = [&levelSet, h](const std::vector<Ball>& region, Progress& progress) {
        return std::make_shared<Band>(bandFromLevelSet(levelSet, h, region, progress));
    };
    surface.diagonal =
        std::sqrt(levelSet.psi->evalActiveVoxelBoundingBox().dim().asVec3d().lengthSqr());
    return surface;
}

openvdb::Vec3d onTorus(double u, double v) {
    const double d = 0.3 + 0.12 * std::cos(v);
    return kCenter + openvdb::Vec3d(d * std::cos(u), d * std::sin(u), 0.12 * std::sin(v));
}

}  // namespace

TEST_CASE("pairDistances: as on the whole torus, near, far and around the bend") {
    for (const double turn : {0.0, 33.0}) {
        const Surface s(torus(kCenter, 0.3, 0.12), 0.01, turn);
        std::vector<Vec3d> from, to;
        auto add = [&](const openvdb::Vec3d& a, const openvdb::Vec3d& b) {
            from.push_back(s.index(a)), to.push_back(s.index(b));
        };
        add(onTorus(0.1, 0.2), onTorus(0.15, 0.3));
        add(onTorus(0.1, 0.2), onTorus(0.3, -0.4));  // the same source
        add(onTorus(1, 1), onTorus(1, 1));           // no path at all
        add(onTorus(2, 0.5), onTorus(2, 2.9));       // a third around the tube
        add(onTorus(2, 0.1), onTorus(2, 3.2));       // around it: far more than 1.5 straight lines
        add(onTorus(0, 0), onTorus(3.1, 0));         // across the whole torus
        add(onTorus(0.1, 0.2), onTorus(4, 2));       // the first source again
        const auto pairs = pairDistances(pairSurface(s.levelSet, kH), from, to, 1.0);
        REQUIRE(pairs.size() == from.size());
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            INFO("pair " << k);
            CHECK(pairs[k].distance == s.wholeDistance(from[k], to[k]));
            CHECK(pairs[k].source.pIndex == nearestSurfacePoint(s.whole, from[k]).pIndex);
            CHECK(pairs[k].target.pIndex == nearestSurfacePoint(s.whole, to[k]).pIndex);
            CHECK(pairs[k].source.node == kNoNode);
            for (const int threads : {1, 3}) {
                const ThreadLimit limit(threads);
                const auto again =
                    pairDistances(pairSurface(s.levelSet, kH), {from[k]}, {to[k]}, 1.0);
                CHECK(again[0].distance == pairs[k].distance);
            }
        }
        CHECK(pairs[2].distance == 0);
    }
}

TEST_CASE("pairDistances: two sheets of a thin wall are far apart, two pieces infinitely") {
    const Surface sheet(thinSheet(kCenter, 0.3, 0.25, 0.06), 0.01, 10);
    const Vec3d above = sheet.index(kCenter + openvdb::Vec3d(0.01, 0, 0.03));
    const Vec3d below = sheet.index(kCenter + openvdb::Vec3d(0.01, 0, -0.03));
    const auto through = pairDistances(pairSurface(sheet.levelSet, kH), {above}, {below}, 1.0);
    // To the rim and back: 6 voxels straight, more than 40 along the surface.
    CHECK(through[0].distance > 40);
    CHECK(through[0].distance == sheet.wholeDistance(above, below));

    const Surface two(twoSpheres(kCenter, 0.1, kCenter + openvdb::Vec3d(0.3, 0, 0), 0.1), 0.01, 0);
    const Vec3d a = two.index(kCenter + openvdb::Vec3d(0.1, 0, 0));
    const Vec3d b = two.index(kCenter + openvdb::Vec3d(0.2, 0, 0));
    const auto apart = pairDistances(pairSurface(two.levelSet, kH), {a, a}, {b, a}, 1.0);
    CHECK(apart[0].distance == kInfinity);
    CHECK(apart[1].distance == 0);
}

TEST_CASE("pairDistances: refuses what is no pair, not finite, or off the surface") {
    const Surface s(sphere(kCenter, 0.2), 0.01, 0);
    const Vec3d on = s.index(kCenter + openvdb::Vec3d(0.2, 0, 0));
    const Vec3d near = on + Vec3d{2, 0, 0}, far = on + Vec3d{50, 0, 0};
    const auto solve = [&](const std::vector<Vec3d>& from, const std::vector<Vec3d>& to,
                           double snap) {
        return [=, &s] { pairDistances(pairSurface(s.levelSet, kH), from, to, snap); };
    };
    using Kind = Error::Kind;
    expectError(Kind::InvalidArgument, {"2 sources", "1 targets"}, solve({on, on}, {on}, 1));
    expectError(Kind::InvalidArgument, {"pair 1", "finite"},
                solve({on, on}, {on, {0, std::nan(""), 0}}, 1));
    expectError(Kind::InvalidArgument, {"less than 0"}, solve({on}, {on}, -1));
    expectError(Kind::InvalidArgument, {"target of pair 1", "1.9"},
                solve({on, on}, {on, near}, 1.9));
    expectError(Kind::InvalidArgument, {"source of pair 1"},
                solve({on, far, far}, {on, far, on}, 1));
    CHECK(pairDistances(pairSurface(s.levelSet, kH), {near}, {on}, 2.1)[0].distance < 0.1);
    CHECK(pairDistances(pairSurface(s.levelSet, kH), {}, {}, 1).empty());
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Kind::Cancelled, {},
                [&] { pairDistances(pairSurface(s.levelSet, kH), {on}, {on}, 1, stop); });
}

}  // namespace igeo::test
