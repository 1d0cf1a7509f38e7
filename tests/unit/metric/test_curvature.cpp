#include <igeo/base/parallel.h>
#include <igeo/metric/curvature.h>
#include <igeo/metric/metric.h>
#include <igeo/surface/level_set_band.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/march_cases.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <random>

namespace igeo::test {
namespace {

using Kind = Error::Kind;

/// What the fit's ridge takes away, as a share: 1e-5 over the mean square of positions in units of
/// the reach, which is 1/8 in a plane and R^2 / (3 reach^2) if that is more than the sphere; twice
/// that where points lie unevenly.
double ridgeShare(double radius, double scale = kDefaultCurvatureScale) {
    return 2e-5 * std::max(8.0, 3 * 8 * scale * scale / (radius * radius));
}
/// Roundings of normals and positions, 6e-8, over the reach of some voxels.
constexpr double kRounding = 1e-6;

const Vec3d kMiddle(0.31, -0.17, 0.23);

/// Largest deviation of either principal curvature from (k1, k2)(foot point); NaN: leave it out.
template <typename Exact>
double worstOff(const Band& band, const Curvature& c, const Exact& exact) {
    double worst = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const auto [k1, k2] = exact(band.footPoint(i));
        if (std::isnan(k1)) continue;
        worst = std::max({worst, std::abs(double(c.k1[i]) - k1), std::abs(double(c.k2[i]) - k2)});
    }
    return worst;
}

/// Whether all is finite, k1 >= k2, and the direction is unit and tangent to half a per mill.
bool sound(const Band& band, const Curvature& c) {
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Vec3f d = c.direction1[i];
        if (!(std::abs(c.k1[i]) < kInfinity && std::abs(c.k2[i]) < kInfinity)) return false;
        if (!(c.k1[i] >= c.k2[i] && std::abs(length(d) - 1) < 5e-4f)) return false;
        if (!(std::abs(dot(d, band.normal[i])) < 5e-4f)) return false;
    }
    return c.k1.size() == band.size() && c.k2.size() == band.size();
}

/// Spheres of radius r < s about kMiddle. @param sign 1: solid in between, -1: hollow
Band shells(double r, double s, double sign, double h) {
    const double out = s + h + 1;
    const auto psi = [=](const Vec3d& p) {
        const double q = length(p - kMiddle);
        return sign * std::max(r - q, q - s);
    };
    const auto normal = [=](const Vec3d& p) {
        const Vec3d q = p - kMiddle;
        return (2 * length(q) > r + s ? sign : -sign) * normalized(q);
    };
    return analyticBand(psi, normal, floorToIjk(kMiddle - Vec3d(out, out, out)),
                        roundToIjk(kMiddle + Vec3d(out, out, out)), h);
}

openvdb::FloatGrid::Ptr noisySphere(double radius, double noise) {
    auto grid = makeLevelSet(sphere({0.31, -0.17, 0.23}, radius), 1, 3);
    std::mt19937 random(1);
    std::normal_distribution<double> shift(0, noise);
    for (auto it = grid->beginValueOn(); it; ++it) it.setValue(float(*it + shift(random)));
    return grid;
}

/// A prism on a circle of radius 1, 4 high, without ends.
TriangleMesh prism(std::uint32_t sides) {
    TriangleMesh mesh;
    for (std::uint32_t k = 0; k < sides; ++k) {
        const double a = 2 * M_PI * k / sides;
        for (const double z : {-2.0, 2.0}) mesh.points.push_back({std::cos(a), std::sin(a), z});
        const std::uint32_t here = 2 * k, next = 2 * ((k + 1) % sides);
        mesh.triangles.push_back({here, next, next + 1});
        mesh.triangles.push_back({here, next + 1, here + 1});
    }
    return mesh;
}

Curvature ofMeans(const std::vector<float>& means) {
    Curvature c;
    for (const float m : means) c.k1.push_back(m), c.k2.push_back(0), c.direction1.push_back({});
    return c;
}

class CancelAtOnce : public Progress {
public:
    bool cancelled() const override { return true; }
};

class Listener : public Progress {
public:
    void update(const char*, double fraction) override {
        if (fraction == 1) done = true;
    }
    bool done = false;
};

}  // namespace

TEST_CASE("a plane has no curvature") {
    const Band band = planeBand({1, -2, 3}, 0.3, {-9, -9, -9}, {9, 9, 9}, 2.2);
    const Curvature c = curvature(band);
    CHECK(sound(band, c));
    CHECK(worstOff(band, c, [](const Vec3d&) { return std::pair(0.0, 0.0); }) <= kRounding);
}

TEST_CASE("a sphere has 1 / R in all directions, within the reach of the fit or beyond") {
    for (const double radius : {3.0, 6.0, 20.0})
        for (const double scale : {1.0, kDefaultCurvatureScale, 4.0}) {
            const Band band = sphereBand(kMiddle, radius, 1.8);
            const Curvature c = curvature(band, scale);
            INFO("radius " << radius << ", scale " << scale);
            CHECK(sound(band, c));
            CHECK(worstOff(band, c, [&](const Vec3d&) {
                      return std::pair(1 / radius, 1 / radius);
                  }) <= ridgeShare(radius, scale) / radius + kRounding);
        }
}

TEST_CASE("a cylinder bends around its axis only") {
    const double radius = 7;
    const Vec3d axis = normalized(Vec3d(1, 2, -3));
    const auto out = [&](const Vec3d& p) { return tangential(p - kMiddle, axis); };
    const Band band = analyticBand([&](const Vec3d& p) { return length(out(p)) - radius; },
                                   [&](const Vec3d& p) { return normalized(out(p)); },
                                   {-16, -16, -16}, {16, 16, 16}, 1.8);
    const Curvature c = curvature(band);
    CHECK(sound(band, c));
    // Next to the cut few points lie on one side.
    const auto cut = [](const Vec3d& p) {
        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 10;
    };
    CHECK(worstOff(band, c, [&](const Vec3d& p) {
              return std::pair(cut(p) ? std::nan("") : 1 / radius, 0.0);
          }) <= ridgeShare(radius) / radius + kRounding);
    double along = 0;
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (!cut(band.footPoint(i)))
            along = std::max(along, std::abs(dot(Vec3d(c.direction1[i]), axis)));
    CHECK(along <= 7.1e-7);  // measured 4.7e-7
}

TEST_CASE("curvature changes sign with psi") {
    const Band band = bandOf(torusGrid(), 2.5);
    Band other = band;
    for (NodeIndex i = 0; i < band.size(); ++i)
        other.psi[i] = -band.psi[i], other.normal[i] = -band.normal[i];
    other.numberCore();
    Band plain = band;
    plain.numberCore();
    const Curvature a = curvature(plain), b = curvature(other);
    double worst = 0;
    for (NodeIndex i = 0; i < band.size(); ++i)
        worst = std::max({worst, std::abs(double(a.k1[i]) + double(b.k2[i])),
                          std::abs(double(a.k2[i]) + double(b.k1[i]))});
    CHECK(worst <= kRounding);
}

TEST_CASE("turns by 90 degrees leave curvature") {
    const auto grid = torusGrid();
    const Band band = bandOf(grid, 2.5);
    const Curvature c = curvature(band);
    const std::function<Ijk(const Ijk&)> turns[] = {[](const Ijk& v) {
                                                        return Ijk{-v.y, v.x, v.z};
                                                    },
                                                    [](const Ijk& v) {
                                                        return Ijk{v.y, v.z, v.x};
                                                    },
                                                    [](const Ijk& v) {
                                                        return Ijk{-v.x, -v.z, -v.y};
                                                    }};
    for (const auto& turn : turns) {
        const Band turned = bandOf(mapVoxels(*grid, turn), 2.5);
        const Curvature other = curvature(turned);
        double worst = 0;
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const NodeIndex j = turned.nodeAt(turn(band.ijk(i)));
            REQUIRE(j != kNoNode);
            worst = std::max({worst, std::abs(double(c.k1[i]) - double(other.k1[j])),
                              std::abs(double(c.k2[i]) - double(other.k2[j]))});
        }
        CHECK(worst <= 9e-8);  // measured 6.0e-8
    }
}

TEST_CASE("curvature knows no units, and no threads") {
    const auto grid = torusGrid();
    const Curvature c = [&] {
        const ThreadLimit one(1);
        return curvature(bandOf(grid, 2.5));
    }();
    const auto same = [&](const Curvature& other) {
        return c.k1 == other.k1 && c.k2 == other.k2 && c.direction1 == other.direction1;
    };
    {
        const ThreadLimit two(2);
        CHECK(same(curvature(bandOf(grid, 2.5))));
    }
    for (const double factor : {0x1p-10, 4.0}) {
        auto scaled = grid->deepCopy();
        scaled->setTransform(openvdb::math::Transform::createLinearTransform(factor));
        for (auto it = scaled->beginValueOn(); it; ++it) it.setValue(float(*it * factor));
        CHECK(same(curvature(bandOf(scaled, 2.5))));
    }
}

TEST_CASE("noise moves curvature by no more than it moves the Laplacian of a smoothed psi") {
    constexpr double kNoise = 0.1, kRadius = 20, kMean = 2 / kRadius;
    const Band band = bandFromLevelSet(checkedLevelSet(noisySphere(kRadius, kNoise)), 1.75);
    for (const double scale : {kDefaultCurvatureScale, 3.0}) {
        const Curvature c = curvature(band, scale);
        CHECK(sound(band, c));
        double off = 0, off2 = 0;
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const double e = double(c.mean(i)) - kMean;
            off += e / double(band.size()), off2 += e * e / double(band.size());
        }
        // With weights w, M is the integral of psi div(x w) / I, I that of w x^2: its variance is
        // 8 pi / 15 / (pi / 24)^2 / reach^6 = 0.191 / scale^6 for one point per unit area. The core
        // has one per column, along space diagonals sqrt(3) times fewer.
        const double bound = std::sqrt(0.191 * std::sqrt(3.0)) * kNoise / std::pow(scale, 3);
        INFO("scale " << scale << ": off by " << off << ", standard deviation "
                      << std::sqrt(off2 - off * off));
        CHECK(std::sqrt(off2 - off * off) <= bound);
        // Central differences tilt the tangent plane by noise / sqrt(2) along either direction,
        // which takes its square off in the mean; twice that.
        CHECK(std::abs(off) <= 2 * kNoise * kNoise / 2 * kMean);
    }
}

TEST_CASE("nodes whose foot points miss the core take the nearest of it") {
    const double radius = 10;
    Band band = sphereBand(kMiddle, radius, 1.8);
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (!band.inCore(i)) band.foot[i] += 1.8f * band.normal[i];
    const Curvature c = curvature(band);
    CHECK(sound(band, c));
    CHECK(worstOff(band, c, [&](const Vec3d&) { return std::pair(1 / radius, 1 / radius); }) <=
          ridgeShare(radius) / radius + kRounding);
}

TEST_CASE("sheets close together keep their own curvature") {
    const struct {
        double r, s, sign, h;
    } cases[] = {{10, 12, 1, 0.999}, {10, 12.6, -1, 1.299}, {10, 13, 1, 1.5}, {10, 11.5, -1, 0.75}};
    for (const auto& [r, s, sign, h] : cases) {
        const Band band = shells(r, s, sign, h);
        const Curvature c = curvature(band);
        INFO("radii " << r << " and " << s << ", sign " << sign);
        CHECK(sound(band, c));
        CHECK(worstOff(band, c, [&, rr = r, ss = s, sg = sign](const Vec3d& p) {
                  const bool outer = 2 * length(p - kMiddle) > rr + ss;
                  const double k = outer ? sg / ss : -sg / rr;
                  return std::pair(k, k);
              }) <= ridgeShare(r) / r + kRounding);
    }
}

TEST_CASE("curvature is not taken from beyond a step") {
    // Two spheres with one sense of normals, two voxels apart, as where a sheet in between is lost.
    constexpr double kInner = 20, kOuter = 22;
    const auto radius = [](const Vec3d& p) {
        return 2 * length(p - kMiddle) < kInner + kOuter ? kInner : kOuter;
    };
    const Band band = analyticBand([&](const Vec3d& p) { return length(p - kMiddle) - radius(p); },
                                   [&](const Vec3d& p) { return normalized(p - kMiddle); },
                                   {-25, -25, -25}, {25, 25, 25}, 0.999);
    CHECK(worstOff(band, curvature(band), [&](const Vec3d& p) {
              return std::pair(1 / radius(p), 1 / radius(p));
          }) <= ridgeShare(kInner) / kInner + kRounding);
}

TEST_CASE("a sharp box has flat faces and finite edges") {
    const openvdb::Vec3d center(0.31, -0.17, 0.23), half(14.3, 12.7, 11.9);
    const Band band = bandFromLevelSet(checkedLevelSet(makeLevelSet(box(center, half), 1, 3)), 1.8);
    for (const double scale : {1.0, kDefaultCurvatureScale, 5.0}) {
        const Curvature c = curvature(band, scale);
        CHECK(sound(band, c));
        float most = 0, onFaces = 0, onEdges = 0;
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const float k = std::max(std::abs(c.k1[i]), std::abs(c.k2[i]));
            most = std::max(most, k);
            const Vec3d p = band.footPoint(i);
            std::array<double, 3> in{half.x() - std::abs(p.x - center.x()),
                                     half.y() - std::abs(p.y - center.y()),
                                     half.z() - std::abs(p.z - center.z())};
            std::sort(in.begin(), in.end());
            // As far as the fit reaches, and normals with it.
            if (in[1] > std::sqrt(8.0) * scale + 3) onFaces = std::max(onFaces, k);
            if (in[1] < 0.5 && in[2] > 6) onEdges = std::max(onEdges, c.k1[i]);
        }
        INFO("scale " << scale);
        CHECK(onFaces <= kRounding);
        // Normals turn by at most 2 from voxel to voxel, and a right angle within the reach.
        CHECK(most <= 2);
        CHECK(double(onEdges) >= 1 / (2 * std::sqrt(8.0) * scale));
    }
}

TEST_CASE("curvature of nothing, of a scale out of range, and cancelled") {
    CHECK(curvature(Band{}).k1.empty());
    const Band band = sphereBand(kMiddle, 5, 1.8);
    for (const double scale : {0.0, -1.0, 0.99, 16.1, kInfinity, std::nan("")})
        expectError(Kind::InvalidArgument, {"scale", "1 to 16"}, [&] { curvature(band, scale); });
    CHECK(sound(band, curvature(band, 16)));
    CancelAtOnce cancel;
    expectError(Kind::Cancelled, {}, [&] { curvature(band, 2, cancel); });
    Listener listener;
    curvature(band, 2, listener);
    CHECK(listener.done);
}

TEST_CASE("curvature weights are those of the paper, per ten voxels") {
    // M per ten voxels: -2, 0, 1, 3.
    const Curvature means = ofMeans({-0.2f, 0, 0.1f, 0.3f});
    const auto check = [](const std::vector<float>& weight, const std::vector<double>& expected) {
        REQUIRE(weight.size() == expected.size());
        for (std::size_t k = 0; k < weight.size(); ++k)
            CHECK(std::abs(double(weight[k]) - expected[k]) <= 1e-5 * expected[k]);
    };
    check(curvatureWeights(means, CurvatureKind::Valley), {100, 108, 127, 225});
    check(curvatureWeights(means, CurvatureKind::Crest), {225, 127, 108, 100});
    check(curvatureWeights(means, CurvatureKind::Valley, 0.5, 1), {0.5, 2.5, 3.5, 5.5});
    check(curvatureWeights(means, CurvatureKind::Mean, 1, 2), {5, 1, 2, 10});

    Curvature c;
    c.k1 = {0.2f, 0.1f, -0.1f};
    c.k2 = {0.1f, -0.3f, -0.2f};
    c.direction1.resize(3);
    check(curvatureWeights(c, CurvatureKind::Gaussian, 1, 2), {5, 10, 5});
    check(curvatureWeights(c, CurvatureKind::Principal, 1, 2), {5, 10, 5});
    check(curvatureWeights(c, CurvatureKind::Mean, 1, 1), {4, 3, 4});
    CHECK(curvatureWeights({}, CurvatureKind::Valley).empty());
}

TEST_CASE("one spot does not decide what a valley is") {
    std::vector<float> means(3000, 0.1f);
    means[17] = -50, means[18] = -40;
    for (std::size_t k = 1000; k < 2000; ++k) means[k] = 0.3f;
    const auto weight = curvatureWeights(ofMeans(means), CurvatureKind::Valley, 100, 3);
    CHECK(weight[17] == 100);
    CHECK(weight[0] == 100);
    CHECK(std::abs(weight[1500] - 108) <= 1e-3f);
    for (float& m : means) m = -m;
    CHECK(curvatureWeights(ofMeans(means), CurvatureKind::Crest, 100, 3) == weight);
}

TEST_CASE("valley weights lead along the inside of a torus") {
    const Band band = bandOf(torusGrid(), 2.5);
    Metric metric;
    metric.weight = curvatureWeights(curvature(band), CurvatureKind::Valley);
    metric.check(band);
    CHECK(metric.least() == 100);
    // Inside k2 = -1/8, outside 1/20: M differs by 1.75 per ten voxels, less scale^2 / 2 times the
    // second derivatives of k2, 0.0061 and 0.0010 along the small circle: 8 %, or 22 % of the cube.
    const double cube = std::pow(1.75, 3), range = metric.largest() - 100;
    CHECK(range <= 1.02 * cube);
    CHECK(range >= 0.75 * cube);
    const auto least = std::min_element(metric.weight.begin(), metric.weight.end());
    const Vec3d p = band.footPoint(NodeIndex(least - metric.weight.begin()));
    CHECK(std::hypot(p.x - 3.137, p.y + 5.291) < 9);
}

TEST_CASE("curvature weights that make no metric are refused") {
    const Curvature c = ofMeans({0, 5, 10});
    const double nan = std::nan("");
    for (const double bad : {0.0, -1.0, kInfinity, nan}) {
        expectError(Kind::InvalidArgument, {"epsilon"},
                    [&] { curvatureWeights(c, CurvatureKind::Valley, bad, 3); });
        expectError(Kind::InvalidArgument, {"power"},
                    [&] { curvatureWeights(c, CurvatureKind::Mean, 100, bad); });
    }
    expectError(Kind::InvalidArgument, {"float", "power"},
                [&] { curvatureWeights(c, CurvatureKind::Crest, 100, 20); });
    expectError(Kind::InvalidArgument, {"float"},
                [&] { curvatureWeights(c, CurvatureKind::Valley, 1e300, 3); });
    expectError(Kind::InvalidArgument, {"float"},
                [&] { curvatureWeights(c, CurvatureKind::Valley, 1e-60, 3); });
}

TEST_CASE("facets wider than the scale of curvature are found, prisms with few sides are none") {
    // Sides 0.52 wide: 52, 26, 13 voxels, and 8.7, where costs are right to 1 %.
    const TriangleMesh coarse = prism(12);
    for (const double dx : {0.01, 0.02, 0.04}) CHECK(shareOfWideFacets(coarse, dx, 2) == 1);
    CHECK(shareOfWideFacets(coarse, 0.06, 2) == 0);
    CHECK(shareOfWideFacets(coarse, 0.02, 6) == 0);
    CHECK(shareOfWideFacets(prism(4), 0.01, 2) == 0);
    CHECK(shareOfWideFacets(prism(96), 0.01, 2) == 0);
    const std::string warning = wideFacetWarning(coarse, 0.01, 2);
    for (const char* phrase : {"on 100 % of the surface", "wider than 10 voxels", "a larger scale"})
        CHECK(warning.find(phrase) != std::string::npos);
    CHECK(wideFacetWarning(coarse, 0.06, 2).empty());
}

TEST_CASE("a flat side beside a finely divided bend is no wide facet") {
    // Two squares at a right angle, 100 voxels wide, and between them a bend of six strips.
    TriangleMesh mesh;
    const auto add = [&](double x, double z) {
        for (const double y : {0.0, 1.0}) mesh.points.push_back({x, y, z});
        const auto n = std::uint32_t(mesh.points.size());
        if (n < 4) return;
        mesh.triangles.push_back({n - 4, n - 2, n - 1});
        mesh.triangles.push_back({n - 4, n - 1, n - 3});
    };
    add(-1, 0);
    for (int k = 0; k <= 6; ++k) add(0.1 * std::sin(k * M_PI / 12), 0.1 * std::cos(k * M_PI / 12));
    add(0.1, -1);
    CHECK(shareOfWideFacets(mesh, 0.01, 2) == 0);
}

}  // namespace igeo::test
