// Distances from curves and regions, where they are known: along meridians from circles of
// latitude.
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/march/seeds.h>
#include <igeo/march/signed_field.h>
#include <igeo/metric/obstacles.h>
#include <igeo/path/trace.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <cstdio>

namespace igeo::test {
namespace {

using openvdb::Vec3d;
const Vec3d kCenter(0.5, 0.5, 0.5);
constexpr double kRadius = 0.4, kLatitude = 0.5;  // radians from the equator

Band bandOf(const Shape& shape, int n) {
    const auto transform = rotatedTransform(1.0 / n, {1, 2, 3}, 20, {0.1, 0.2, 0.3});
    return bandFromLevelSet(checkedLevelSet(makeLevelSet(shape, *transform, 3)), std::sqrt(3.0));
}

igeo::Vec3d indexOf(const Band& band, const Vec3d& p) {
    return band.transform.indexFromWorld({p.x(), p.y(), p.z()});
}

/// An axis that no lattice line follows, and two more across it.
struct Axes {
    Vec3d z = genericDirection(), x = z.cross(Vec3d(0, 0, 1)).unit(), y = z.cross(x);
};

Curve circleOf(const Band& band, const Vec3d& center, double radius, const Axes& a,
               double turns = 1) {
    Curve curve;
    const int n = 1000;  // sagitta 5e-6 of the radius
    for (int k = 0; k < n; ++k) {
        const double t = 2 * M_PI * turns * k / n;
        curve.points.push_back(
            indexOf(band, center + radius * (std::cos(t) * a.x + std::sin(t) * a.y)));
    }
    curve.closed = turns == 1;
    return curve;
}

/// A circle of latitude on the sphere.
Curve parallel(const Band& band) {
    const Axes a;
    return circleOf(band, kCenter + kRadius * std::sin(kLatitude) * a.z,
                    kRadius * std::cos(kLatitude), a);
}

double latitudeOf(const Vec3d& p) {
    const Vec3d v = (p - kCenter).unit();
    return std::atan2(v.dot(Axes().z), v.cross(Axes().z).length());
}

double fromParallel(const Vec3d& p) { return kRadius * std::abs(latitudeOf(p) - kLatitude); }

}  // namespace

TEST_CASE("seeds along a circle of latitude: to thousandths of a voxel, and one front") {
    const struct {
        int n;
        double mean, max;
    } figures[] = {{50, 0.0034, 0.059},     // measured 0.0023, 0.039
                   {100, 0.00145, 0.077},   // 0.00097, 0.051
                   {200, 0.00094, 0.039}};  // 0.00087, 0.026
    for (const auto& f : figures) {
        const int n = f.n;
        const Band band = bandOf(sphere(kCenter, kRadius), n);
        const auto seeds = seedsAlong(band, parallel(band), 1);
        const Field field = marchJet(band, {}, seeds);
        CHECK(field.sourceCount() == 1);
        CHECK(field.label.empty());
        const Errors e = errorsOnSurface(band, field, fromParallel);
        const Errors g =
            errorsOnSurface(band, marchGodunov(band, {}, seeds, GodunovOptions{}), fromParallel);
        std::printf("seeds on a circle, N = %3d: jet mean %.5f max %.4f %%, godunov %.3f %.3f %%\n",
                    n, e.mean, e.max, g.mean, g.max);
        CHECK(e.unreached == 0);
        // Both poles are cut loci, where fronts run into themselves from all sides at once: the
        // largest error is a share of a voxel there.
        CHECK(e.max < f.max);
        // No focusing elsewhere: pieces end on psi = 0 of the trilinear interpolant, 1 / (8 R)
        // voxels below S, which shifts them by less along it, 0.00094 % at N = 200.
        CHECK(e.mean < f.mean);
    }
}

TEST_CASE("seeds along the outer equator of a torus: arcs of its tube") {
    const Band band = bandOf(torus(kCenter, 0.3, 0.12), 100);
    Axes a{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
    const auto seeds = seedsAlong(band, circleOf(band, kCenter, 0.42, a), 1);
    const Field field = marchJet(band, {}, seeds);
    const Errors e = errorsOnSurface(band, field, [](const Vec3d& p) {
        const Vec3d q = p - kCenter;
        const double out = std::hypot(q.x(), q.y()) - 0.3;
        return 0.12 * std::abs(std::atan2(q.z(), out));
    });
    std::printf("seeds on a torus, N = 100: mean %.5f max %.4f %%\n", e.mean, e.max);
    CHECK(e.mean < 0.0137);  // measured 0.0091
    CHECK(e.max < 0.041);    // measured 0.0268

    // A path ends on the curve, not at one of the points it was made of.
    const SurfacePoint target = pointOn(band, kCenter + Vec3d(-0.3 * 0.6, 0.3 * 0.8, 0.12));
    const Path path = tracePath(band, field, field.gradient, target);
    REQUIRE(path.status == PathStatus::Reached);
    // 1 / (8 R) voxels below S, as above, and the sagitta.
    const Vec3d end = worldOf(band, path.vertices.back().pIndex) - kCenter;
    CHECK(end.dot(Vec3d(-0.6, 0.8, 0)) == Approx(0.42).margin(0.01 * 1.5 / (8 * 12)));
    CHECK(path.weightedLength / 100 == Approx(0.12 * M_PI / 2).epsilon(0.002));
}

TEST_CASE("seeds around a region: its inside is 0, its rim where the body's is") {
    for (const int n : {50, 100}) {
        const Band band = bandOf(sphere(kCenter, kRadius), n);
        // The sphere about the pole that cuts S in the parallel.
        ObstacleSet region(band.transform);
        const Vec3d pole = kCenter + kRadius * Axes().z;
        region.addSphere({pole.x(), pole.y(), pole.z()},
                         2 * kRadius * std::sin((M_PI / 2 - kLatitude) / 2));
        Field field = marchJet(band, {}, seedsAround(band, region));
        const Errors both = errorsOnSurface(band, field, fromParallel);
        const auto inside = nodesInside(band, region);
        Field withSign = field;
        signInside(inside, withSign);
        CHECK(withSign.sign[pointOn(band, pole).node] == -1);
        clearInside(inside, field);
        // Between nodes as well; a cell that the rim cuts has corners outside, a voxel off or so.
        for (const double voxels : {0.5, 4.0, 0.5 * n * kRadius}) {
            const Axes a;
            const double latitude = kLatitude + voxels / (kRadius * n);
            const Vec3d p =
                kCenter + kRadius * (std::cos(latitude) * a.x + std::sin(latitude) * a.z);
            CHECK(sampleDistance(band, field, pointOn(band, p).pIndex) <= (voxels < 1 ? 0.5 : 0));
        }
        const Errors out = errorsOnSurface(band, field, [](const Vec3d& p) {
            return kRadius * std::max(kLatitude - latitudeOf(p), 0.0);
        });
        std::printf("seeds around a region, N = %3d: mean %.4f max %.4f %%, outside %.4f %.4f %%\n",
                    n, both.mean, both.max, out.mean, out.max);
        // Points a third of a voxel apart: 0.05 voxels next to the rim.
        const double voxel = 100.0 / n / (kRadius * (M_PI / 2 + kLatitude));
        CHECK(both.mean < 0.0116 * voxel);  // measured 0.0077
        // At the far pole the front comes in from all sides at once, and the fallback decides.
        CHECK(both.max < 0.8 * voxel);     // measured 0.53
        CHECK(out.mean < 0.0076 * voxel);  // measured 0.0050
    }
}

TEST_CASE("signs of curves: the smaller part is negative, and rings alternate") {
    const Band band = bandOf(sphere(kCenter, kRadius), 60);
    auto seeds = seedsAlong(band, parallel(band), 1);
    const Axes a;
    const auto south = seedsAlong(
        band, circleOf(band, kCenter - kRadius * std::sin(0.9) * a.z, kRadius * std::cos(0.9), a),
        1);
    auto wrong = [&](const std::vector<SurfacePoint>& from, const auto& inside) {
        const Field field = marchJet(band, {}, from);
        const auto sign = signsOfCurves(band, field);
        std::size_t count = 0;
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const double t = latitudeOf(worldOf(band, band.footPoint(i)));
            // Closer than this to a curve, pieces half a voxel long decide.
            if (field.distance[i] > 0.05) count += (sign[i] < 0) != inside(t);
        }
        return count;
    };
    CHECK(wrong(seeds, [](double t) { return t > kLatitude; }) == 0);
    seeds.insert(seeds.end(), south.begin(), south.end());
    CHECK(wrong(seeds, [](double t) { return t > kLatitude || t < -0.9; }) == 0);
}

TEST_CASE("signs of curves: what parts nothing is refused") {
    const Band band = bandOf(torus(kCenter, 0.3, 0.12), 60);
    auto signs = [&](const std::vector<SurfacePoint>& seeds) {
        return signsOfCurves(band, marchJet(band, {}, seeds));
    };
    const Axes flat{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, upright{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
    const Curve meridian = circleOf(band, kCenter + Vec3d(0.3, 0, 0), 0.12, upright);
    const Curve open = circleOf(band, kCenter, 0.42, flat, 0.9);
    const Curve equator = circleOf(band, kCenter, 0.42, flat),
                inner = circleOf(band, kCenter, 0.18, flat);
    for (const Curve& curve : {meridian, open, equator})
        expectError(Error::Kind::InvalidArgument, {"inside and an outside", "--signed"},
                    [&] { signs(seedsAlong(band, curve, 1)); });
    expectError(Error::Kind::InvalidArgument, {"--signed"},
                [&] { signs({pointOn(band, kCenter + Vec3d(0.42, 0, 0))}); });
    // Two equators do part it.
    auto both = seedsAlong(band, equator, 1);
    for (const SurfacePoint& s : seedsAlong(band, inner, 1)) both.push_back(s);
    CHECK_NOTHROW(signs(both));
}

}  // namespace igeo::test
