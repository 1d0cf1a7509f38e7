#include <igeo/base/parallel.h>
#include <igeo/surface/medial_radii.h>
#include <support/catch.h>

#include <cmath>

namespace igeo::test {
namespace {

struct Samples {
    std::vector<Vec3d> points, normals;

    void add(const Vec3d& p, const Vec3d& n) {
        points.push_back(p);
        normals.push_back(n);
    }
    MedialRadii radii() const { return medialRadii(points, normals); }
};

constexpr double kGolden = 2.399963229728653;  // radians

/// n points on a sphere, evenly.
Samples sphere(const Vec3d& center, double radius, int n) {
    Samples s;
    for (int k = 0; k < n; ++k) {
        const double z = 1 - (2 * k + 1) / double(n), r = std::sqrt(1 - z * z);
        const Vec3d up{r * std::cos(kGolden * k), r * std::sin(kGolden * k), z};
        s.add(center + radius * up, up);
    }
    return s;
}

/// A square of side 2 about `center`, spanned by a and b, with points 0.05 apart; it looks along
/// a x b.
void addSquare(Samples& s, const Vec3d& center, const Vec3d& a, const Vec3d& b) {
    for (int i = -20; i <= 20; ++i)
        for (int j = -20; j <= 20; ++j)
            s.add(center + 0.05 * i * a + 0.05 * j * b, normalized(cross(a, b)));
}

}  // namespace

TEST_CASE("medial radii: of a sphere its radius") {
    const double radius = 3;
    const int n = 4000;
    const MedialRadii radii = sphere({10, -20, 30}, radius, n).radii();
    REQUIRE(radii.radius.size() == std::size_t(n));
    // Every ball through two points of a sphere, tangent to it at one of them, is the sphere.
    CHECK(radii.radius.front() == Approx(radius).epsilon(1e-9));
    CHECK(radii.radius.back() == Approx(radius).epsilon(1e-9));
    CHECK(radii.facing.front() == Approx(radius).epsilon(1e-9));
}

TEST_CASE("medial radii: of a plane none, of two half the distance between them") {
    Samples one;
    addSquare(one, {1, 2, 3}, {1, 0, 0}, {0, 1, 0});
    CHECK(one.radii().radius.front() == kInfinity);

    const double gap = 0.4;
    Samples two = one;
    addSquare(two, {1, 2, 3 + gap}, {0, 1, 0}, {1, 0, 0});
    const MedialRadii radii = two.radii();
    // Both have the same points one above the other.
    CHECK(radii.radius.front() == Approx(gap / 2).epsilon(1e-9));
    CHECK(radii.radius.back() == Approx(gap / 2).epsilon(1e-9));
    CHECK(radii.facing.back() == Approx(gap / 2).epsilon(1e-9));
}

TEST_CASE("medial radii: an edge of 90 degrees counts as near as the point is, one of 30 not") {
    const auto wedge = [](double degrees) {
        const double t = degrees * M_PI / 180;
        Samples s;
        addSquare(s, {1.025, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const Vec3d up{-std::cos(t), 0, std::sin(t)};
        addSquare(s, 1.025 * up, -up, {0, 1, 0});
        return s.radii();
    };
    // The ball in a right angle touches both faces as far from the edge as its radius: the first
    // row of points is 0.025 off it, the last 2.025.
    const MedialRadii right = wedge(90);
    CHECK(right.radius.front() == Approx(0.025).epsilon(1e-9));
    CHECK(MedialRadii::quantile(right.radius, 0.5) ==
          Approx(1.025).margin(0.037));  // measured 0.025
    CHECK(right.facing.front() == kInfinity);
    CHECK(wedge(30).radius.front() == kInfinity);
    // Beyond 100 degrees it is a fold of two sheets that face each other.
    CHECK(wedge(150).facing.front() < 0.011);  // measured 0.0067
}

TEST_CASE("medial radii: samples, and none") {
    const Samples s = sphere({0, 0, 0}, 1, 1000);
    CHECK(medialRadii(s.points, s.normals, 100).radius.size() == 100);
    const MedialRadii none = medialRadii({}, {});
    CHECK(none.radius.empty());
    CHECK(MedialRadii::quantile(none.radius, 0.5) == kInfinity);
    CHECK(MedialRadii::quantile({1, 2, 3, 4}, 0.5) == 3);
    CHECK(MedialRadii::quantile({1, 2, 3, 4}, 0) == 1);
    CHECK(MedialRadii::quantile({1, 2, 3, 4}, 1) == 4);
}

TEST_CASE("medial radii: the same bits for any number of threads") {
    const Samples s = sphere({0, 0, 0}, 1, 1000);
    std::vector<double> first;
    for (const int threads : {1, 2, 3}) {
        const ThreadLimit limit(threads);
        const MedialRadii radii = s.radii();
        if (threads == 1) first = radii.radius;
        CHECK(radii.radius == first);
    }
}

}  // namespace igeo::test
