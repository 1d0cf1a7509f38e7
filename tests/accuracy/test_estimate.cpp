// The accuracy estimate beside the real error, on surfaces whose distances are known.
#include <igeo/geodesic_solver.h>
#include <igeo/path/accuracy_estimate.h>
#include <igeo/warnings.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/errors.h>
#include <support/exact.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace igeo::test {
namespace {

using Point = openvdb::Vec3d;
using Between = std::function<double(const Point& p, const Point& q)>;

constexpr double kVoxel = 1.0 / 60;
const Point kHalf(0.45, 0.35, 0.25);

/// The point of the box about 0 nearest to one within it or a little outside.
Point ontoBox(Point p) {
    int nearest = 0;
    for (int a = 0; a < 3; ++a) {
        p[a] = std::clamp(p[a], -kHalf[a], kHalf[a]);
        if (kHalf[a] - std::abs(p[a]) < kHalf[nearest] - std::abs(p[nearest])) nearest = a;
    }
    p[nearest] = std::copysign(kHalf[nearest], p[nearest]);
    return p;
}

/// The estimate over the mean error, from five seeds.
/// Distances of meshes count half at nodes and half at vertices, as in the estimate; or at points
/// that are given.
class Factors {
public:
    double least = kInfinity, most = 0;

    Factors(const std::string& name, const Surface& surface, const Between& exact,
            const std::vector<Vec3d>& points = {}) {
        const GeodesicSolver solver(surface);
        const std::shared_ptr<const Band> band = solver.wholeBand();
        for (std::size_t k = 0; k < 5; ++k) {
            const Vec3d from = band->footPoint(NodeIndex((2 * k + 1) * band->size() / 10));
            const Distance d = solver.distance({band->transform.worldFromIndex(from)});
            double error = points.empty() ? atNodes(d, exact) : atPoints(d, points, exact);
            if (points.empty() && surface.triangles())
                error = (error + atPoints(d, surface.triangles()->points, exact)) / 2;
            const double factor =
                estimateAccuracy(d.field(), surface.facts().fit).meanError / error;
            std::printf("%s: real error %.4f %%, estimate / real %.2f\n", name.c_str(), 100 * error,
                        factor);
            least = std::min(least, factor), most = std::max(most, factor);
        }
    }

private:
    double sum_ = 0;
    std::size_t count_ = 0;

    /// Closer to the seed the distance is exact by construction.
    void add(const Distance& d, double distance, double exact) {
        const Field& field = d.field();
        if (!(exact > 3 * field.startRadius * field.band->transform.dx)) return;
        sum_ += std::abs(distance / exact - 1), ++count_;
    }
    double mean() {
        REQUIRE(count_ > 0);
        const double mean = sum_ / double(count_);
        sum_ = 0, count_ = 0;
        return mean;
    }
    double atNodes(const Distance& d, const Between& exact) {
        const Band& band = d.band();
        for (NodeIndex i = 0; i < band.size(); i += NodeIndex(band.size() / 2000))
            add(d, d.field().distance[i] * band.transform.dx,
                exact(seedOf(d), worldOf(band, band.footPoint(i))));
        return mean();
    }
    double atPoints(const Distance& d, const std::vector<Vec3d>& points, const Between& exact) {
        const Band& band = d.band();
        for (const Vec3d& p : points) {
            const SurfacePoint at = nearestSurfacePoint(band, band.transform.indexFromWorld(p));
            const double found = sampleDistance(d.field(), at.pIndex, Vec3d(band.normal[at.node]));
            add(d, found * band.transform.dx, exact(seedOf(d), {p.x, p.y, p.z}));
        }
        return mean();
    }
};

double onSphere(const Point& p, const Point& q) { return geodesicOnSphere(kCenter, 0.45, p, q); }
double onBox(const Point& p, const Point& q) {
    return geodesicOnBox({0, 0, 0}, kHalf, ontoBox(p), ontoBox(q));
}

/// The side of a cylinder of radius 0.3, of 720 faces: a polygon around, unrolled.
TriangleMesh tube() {
    return sheet(720, 40, [](double u, double v) {
        return Vec3d{0.3 * std::cos(2 * M_PI * u), 0.3 * std::sin(2 * M_PI * u), v - 0.5};
    });
}
double onTube(const Point& p, const Point& q) {
    return geodesicOnCylinder({0, 0, 0}, 0.3 * 720 * std::sin(M_PI / 720) / M_PI, p, q);
}

openvdb::math::Transform::Ptr turn() { return rotatedTransform(1, {1, 2, 3}, 40, kOffLattice); }
/// The box turned off the lattice, each side 16 by 16 quadrilaterals.
TriangleMesh turnedBox() {
    TriangleMesh mesh;
    for (const int axis : {0, 1, 2})
        for (const double side : {-1.0, 1.0})
            mesh = together(std::move(mesh), sheet(16, 16, [&](double u, double v) {
                                Point p;
                                p[axis] = side * kHalf[axis];
                                p[(axis + 1) % 3] = (2 * u - 1) * kHalf[(axis + 1) % 3];
                                p[(axis + 2) % 3] = (2 * v - 1) * side * kHalf[(axis + 2) % 3];
                                return fromVdb(turn()->indexToWorld(p));
                            }));
    weld(mesh);
    return mesh;
}
double onTurnedBox(const Point& p, const Point& q) {
    return onBox(turn()->worldToIndex(p), turn()->worldToIndex(q));
}

/// Points of the box turned off the lattice, by chance.
PointCloud cloudOnBox(std::size_t count) {
    std::mt19937 random(1);
    auto uniform = [&] { return double(random()) / 4294967296.0; };
    const Point area(kHalf[1] * kHalf[2], kHalf[2] * kHalf[0], kHalf[0] * kHalf[1]);
    PointCloud cloud;
    cloud.file = "box";
    for (std::size_t i = 0; i < count; ++i) {
        const double which = uniform() * (area[0] + area[1] + area[2]);
        const int axis = which < area[0] ? 0 : which < area[0] + area[1] ? 1 : 2;
        Point p;
        for (int a = 0; a < 3; ++a) p[a] = (2 * uniform() - 1) * kHalf[a];
        p[axis] = std::copysign(kHalf[axis], p[axis]);
        cloud.points.push_back(fromVdb(turn()->indexToWorld(p)));
    }
    return cloud;
}

/// The sides of a prism over a regular polygon about the z axis, to |z| = 0.5.
struct Prism {
    int sides;

    static constexpr double kRadius = 0.4;
    double turn() const { return 2 * M_PI / sides; }
    double face() const { return 2 * kRadius * std::sin(turn() / 2); }

    /// Of the side nearest to a point: out of it and along it, from its middle, and its number.
    struct Place {
        double out, along;
        int side;
    };
    Place placeOf(const Point& p) const {
        const int side = int(std::floor((std::atan2(p.y(), p.x()) + 2 * M_PI) / turn()));
        const double a = (side + 0.5) * turn();
        return {p.x() * std::cos(a) + p.y() * std::sin(a) - kRadius * std::cos(turn() / 2),
                p.y() * std::cos(a) - p.x() * std::sin(a), side % sides};
    }
    Shape shape() const {
        Shape shape;
        shape.name = "prism";
        shape.sdf = [*this](const Point& p) {
            const auto [out, along, side] = placeOf(p);
            const double beyond = std::abs(along) - face() / 2;
            return out > 0 && beyond > 0 ? std::hypot(out, beyond) : out;
        };
        shape.bounds = {Point(-kRadius, -kRadius, -0.6), Point(kRadius, kRadius, 0.6)};
        shape.closed = false;
        shape.domain = [](const Point& p) { return std::abs(p.z()) - 0.5; };
        return shape;
    }
    /// A point at shares of the circumference and of the height; turned off the lattice.
    Vec3d at(double around, double up) const {
        const double corner = std::floor(around * sides), t = around * sides - corner;
        auto edge = [&](double k) {
            return kRadius * Point(std::cos(k * turn()), std::sin(k * turn()), 0);
        };
        const Point p = (1 - t) * edge(corner) + t * edge(corner + 1) + Point(0, 0, up - 0.5);
        return fromVdb(test::turn()->indexToWorld(p));
    }
    TriangleMesh mesh() const {
        TriangleMesh mesh =
            sheet(std::size_t(sides), 1, [&](double u, double v) { return at(u, v); });
        weld(mesh);
        return mesh;
    }
    std::vector<Vec3d> points(int count) const {
        std::mt19937 random(1);
        auto uniform = [&] { return double(random()) / 4294967296.0; };
        std::vector<Vec3d> points;
        for (int i = 0; i < count; ++i) {
            const double around = uniform();
            points.push_back(at(around, uniform()));
        }
        return points;
    }
    double between(const Point& p, const Point& q) const {
        const Place a = placeOf(p), b = placeOf(q);
        const double around = std::abs((a.side - b.side) * face() + a.along - b.along);
        return std::hypot(std::min(around, sides * face() - around), p.z() - q.z());
    }
};

/// A torus of obtuse triangles that lie across its tube, as in Schwarz's lantern: of the rings of
/// vertices every second one is turned by half a side.
TriangleMesh lantern() {
    constexpr int kRings = 64, kSides = 20;
    return sheet(kRings, kSides, [](double u, double v) {
        const int ring = int(std::lround(u * kRings)) % kRings, side = int(std::lround(v * kSides));
        const double around = 2 * M_PI * ring / kRings,
                     t = 2 * M_PI * std::fmod(side + 0.5 * (ring % 2), kSides) / kSides,
                     r = 0.35 + 0.1 * std::cos(t);
        return Vec3d{r * std::cos(around), r * std::sin(around), 0.1 * std::sin(t)};
    });
}

/// Points of the triangles: as many by chance, or the middles.
PointCloud cloudOn(const TriangleMesh& mesh, bool middles) {
    std::mt19937 random(3);
    auto uniform = [&] { return double(random()) / 4294967296.0; };
    std::vector<double> area{0};
    const auto corner = [&](std::size_t t, std::size_t k) {
        return mesh.points[mesh.triangles[t][k]];
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        area.push_back(area.back() +
                       length(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0))));
    PointCloud cloud;
    cloud.file = "lantern";
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
        std::size_t t = k;
        double a = 1.0 / 3, b = 1.0 / 3;
        if (!middles) {
            const auto at = std::upper_bound(area.begin(), area.end(), uniform() * area.back());
            t = std::min(std::size_t(at - area.begin()), area.size() - 1) - 1;
            a = uniform(), b = uniform();
            if (a + b > 1) a = 1 - a, b = 1 - b;
        }
        cloud.points.push_back((1 - a - b) * corner(t, 0) + a * corner(t, 1) + b * corner(t, 2));
    }
    return cloud;
}

}  // namespace

TEST_CASE("the estimate of a level set is near the real error, smooth or creased") {
    const Factors smooth("sphere", Surface(*makeLevelSet(sphere(kCenter, 0.45), kVoxel, 3)),
                         onSphere);
    // Before, 0.53 to 0.60: the chords of a path are too short by about half the distance's error.
    CHECK(smooth.least > 0.64);  // measured 0.96
    CHECK(smooth.most < 1.53);   // 1.02
    const auto turned = rotatedTransform(kVoxel, {1, 2, 3}, 40, kOffLattice);
    // Lengths are taken over both sheets of a sharp edge. Where voxels round it off they lack up to
    // 0.6 voxels, and distances hardly any. Those of 120 degrees had up to 4.7 times the error as
    // long as a path that psi turns at an edge counted by the mean of its directions.
    const struct {
        int sides;
        double least, most;
    } prisms[] = {{8, 0.5, 1.75}, {4, 0.62, 3.7}, {3, 0.38, 1.65}};
    for (const auto& [sides, least, most] : prisms) {  // measured 0.76 to 1.16, 0.93 to 2.46,
        const Prism prism{sides};                      // 0.57 to 1.10
        const auto exact = [&](const Point& p, const Point& q) { return prism.between(p, q); };
        const std::string name = "edges of " + std::to_string(360 / sides) + " degrees";
        const Factors bends(name, Surface(*makeLevelSet(prism.shape(), *turned, 3)), exact);
        CHECK(bends.least > least);
        CHECK(bends.most < most);
    }
    const Factors edges("box, level set", Surface(*makeLevelSet(box({0, 0, 0}, kHalf), *turned, 3)),
                        onBox);
    CHECK(edges.least > 0.5);  // measured 0.75
    CHECK(edges.most < 2.2);   // 1.48
}

TEST_CASE("the estimate of a mesh is near the real error, smooth or creased", "[mesh]") {
    const Factors smooth("tube, mesh", Surface(tube(), {.size = kVoxel}), onTube);
    CHECK(smooth.least > 0.63);  // measured 0.95
    CHECK(smooth.most < 1.62);   // 1.08
    const Factors creased("box, mesh", Surface(turnedBox(), {.size = kVoxel}), onTurnedBox);
    CHECK(creased.least > 0.55);  // measured 0.83
    CHECK(creased.most < 1.85);   // 1.23
    // Between foot points errors are larger, and large triangles have no vertices there. Those
    // beside the ends of edges are most of the mean, and a rough path that leads another way is a
    // false one. Of the prisms of 3 to 24 sides before, 11 of 110 factors were outside of 1/3 to 3,
    // from 0.19 to 28; now one, 0.30.
    for (const int sides : {3, 8, 12}) {
        const Prism prism{sides};
        const Factors coarse(
            "large triangles, " + std::to_string(sides) + " sides",
            Surface(prism.mesh(), {.size = kVoxel}),
            [&](const Point& p, const Point& q) {
                return prism.between(turn()->worldToIndex(p), turn()->worldToIndex(q));
            },
            prism.points(3000));
        CHECK(coarse.least > 0.3);
        CHECK(coarse.most < 3);
    }
}

// Creased: "The estimate sees how far fits to points round edges off" of test_points.cpp.
TEST_CASE("the estimate of points is near the real error where they do not scatter") {
    const Factors smooth("sphere, points", Surface(sphereCloud(9000, 0.45, fromVdb(kCenter))),
                         onSphere);
    CHECK(smooth.least > 0.6);  // measured 0.90; before, 0.43
    CHECK(smooth.most < 1.62);  // 1.08
    const Factors creased("box, points", Surface(cloudOnBox(20000), {.size = kVoxel}), onTurnedBox);
    CHECK(creased.least > 0.42);  // measured 0.63
    CHECK(creased.most < 3.9);    // 2.60
}

// The triangles make geodesics longer than the smooth surface through points on them.
TEST_CASE("the estimate of points sees triangles that lie askew") {
    const TriangleMesh mesh = lantern();
    const GeodesicSolver exact(Surface(mesh, {.size = 0.004}));
    for (const bool middles : {false, true}) {
        const PointCloud cloud = cloudOn(mesh, middles);
        const GeodesicSolver solver{Surface(cloud)};
        for (const std::size_t start : {100, 1500}) {
            const Vec3d seed = cloud.points[start];
            const Distance d = solver.distance({seed}), truth = exact.distance({seed});
            const auto at = [](const Distance& of, const Vec3d& p) {
                const Band& band = of.band();
                const SurfacePoint q = nearestSurfacePoint(band, band.transform.indexFromWorld(p));
                return sampleDistance(of.field(), q.pIndex, Vec3d(band.normal[q.node])) *
                       band.transform.dx;
            };
            double sum = 0;
            std::size_t count = 0;
            for (const Vec3d& p : cloud.points)
                if (const double far = at(truth, p); far > 0.15)
                    sum += std::abs(at(d, p) / far - 1), ++count;
            const double error = sum / double(count);
            const AccuracyEstimate e = estimateAccuracy(d.field(), solver.surface().facts().fit);
            std::printf("triangles askew, %s: real error %.4f %%, estimate / real %.2f\n",
                        middles ? "middles" : "by chance", 100 * error, e.meanError / error);
            // Measured 1.14, 1.23 and 0.45, 0.45; before, 0.65, 0.19 and 0.44, 0.42.
            CHECK(e.meanError / error > (middles ? 0.34 : 0.75));
            CHECK(e.meanError / error < 1.85);
            // Points by chance have neighbors close enough to tell facets from scatter.
            CHECK((e.withoutFacets < e.meanError) == middles);
            CHECK(estimateWarnings(e).empty());
        }
    }
}

}  // namespace igeo::test
