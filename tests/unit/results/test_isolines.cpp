#include <igeo/base/parallel.h>
#include <igeo/distance.h>
#include <igeo/geodesic_solver.h>
#include <igeo/results/curve_files.h>
#include <igeo/results/isolines.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/exact.h>
#include <support/expect_error.h>
#include <support/meshed.h>
#include <support/openvdb.h>
#include <support/signed_cap.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <tuple>

namespace igeo::test {
namespace {

std::vector<Isoline> linesOf(const Meshed& m, const std::vector<double>& levels) {
    return isolines(m.field, m.mesh, levels);
}

/// What holds for every line, but for those that end.
/// @param radius least radius of curvature of S, voxels
void checkLines(const Meshed& m, const std::vector<Isoline>& lines, double radius) {
    std::size_t points = 0, rough = 0;
    for (const Isoline& line : lines) {
        INFO("level " << line.level << ", " << line.points.size() << " points");
        std::set<std::tuple<double, double, double>> distinct;
        double longest = 0, total = 0, off = 0, wrong = 0;
        const std::size_t n = line.points.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3d p = line.points[i];
            distinct.insert({p.x, p.y, p.z});
            const PsiSample s = samplePsi(m.band, p);
            if (s.valid) off = std::max(off, std::abs(s.psi));
            const double error = std::abs(sampleDistance(m.field, p) - line.level);
            wrong = std::max(wrong, error);
            ++points;
            if (error > 2e-6) ++rough;
            if (i + 1 == n && !line.closed) continue;
            const double piece = length(line.points[(i + 1) % n] - p);
            longest = std::max(longest, piece);
            total += piece;
        }
        CHECK(distinct.size() == n);
        CHECK(line.normals.size() == n);
        CHECK(line.length == Approx(total).epsilon(1e-12));
        CHECK(off <= 1.5e-06);  // measured 1e-06
        // Where a corner of the cell is not in the band, points stay on the chord of their edge.
        CHECK(wrong <= 3 / (8 * radius) + 2e-6);
        // A triangle has vertices in three cells around one lattice edge.
        CHECK(longest <= std::sqrt(3.0) + 0.1);
    }
    CHECK(double(rough) <= 0.02 * double(points));
}

std::size_t countAt(const std::vector<Isoline>& lines, double level) {
    return std::size_t(std::count_if(lines.begin(), lines.end(),
                                     [&](const Isoline& l) { return l.level == level; }));
}

/// Angle by which a closed line turns to the left, seen from outside, in all.
double totalTurning(const Meshed& m, const Isoline& line) {
    double turning = 0;
    const std::size_t n = line.points.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d p = line.points[i], in = p - line.points[(i + n - 1) % n],
                    out = line.points[(i + 1) % n] - p;
        const Vec3d normal = SurfaceCell(m.band, *m.field.metric, p, {}).normal;
        turning += std::atan2(dot(normal, cross(in, out)), dot(in, out));
    }
    return turning;
}

/// A wall without thickness, parallel to the plane x = 0.
struct Wall : Obstacles {
    Vec3d middle;
    double half;
    Wall(const Vec3d& m, double h) : middle(m), half(h) {}
    bool block(const Vec3d& a, const Vec3d& b, const Vec3d&) const override {
        if ((a.x < middle.x) == (b.x < middle.x)) return false;
        const double t = (middle.x - a.x) / (b.x - a.x);
        return std::abs(a.y + t * (b.y - a.y) - middle.y) <= half;
    }
    bool mayBeNear(const Vec3d& p, double r) const override {
        return std::abs(p.x - middle.x) <= r && std::abs(p.y - middle.y) <= half + r;
    }
};

}  // namespace

TEST_CASE("isolines: circles on a sphere, the nearer side to their left") {
    const int n = 50;
    const double r = 0.4 * n;
    const Meshed m = meshed(sphere(kCenter, 0.4), 1.0 / n, {kCenter + 0.4 * genericDirection()});
    const auto levels = levelsByCount(m.field, 9);
    const auto lines = linesOf(m, levels);
    REQUIRE(lines.size() == levels.size());
    checkLines(m, lines, r);
    for (std::size_t k = 0; k < lines.size(); ++k) {
        INFO("level " << levels[k]);
        CHECK(lines[k].level == levels[k]);
        CHECK(lines[k].closed);
        const double theta = levels[k] / r;
        // dx^2 from the accuracy test's 0.1 % at four times as many voxels.
        CHECK(lines[k].length == Approx(2 * M_PI * r * std::sin(theta)).epsilon(0.016));
        // Gauss-Bonnet: 2 pi less the cap's area over r^2.
        CHECK(totalTurning(m, lines[k]) == Approx(2 * M_PI * std::cos(theta)).margin(0.05));
    }
}

TEST_CASE("isolines: the nearer side to their left in the world, where voxels are mirrored too") {
    const openvdb::Vec3d seed = kCenter + 0.4 * genericDirection();
    const auto mirrored = openvdb::math::Transform::createLinearTransform(0.02);
    mirrored->preScale(openvdb::Vec3d(1, -1, 1));
    const Meshed m = meshed(sphere(kCenter, 0.4), *mirrored, {seed});
    for (const NamedCurve& line : namedCurves(linesOf(m, {10}), m.band.transform)) {
        const Vec3d along = line.points[1] - line.points[0];
        const Vec3d toSeed = Vec3d{seed.x(), seed.y(), seed.z()} - line.points[0];
        CHECK(dot(cross(line.normals[0], along), toSeed) > 0);
    }
}

TEST_CASE("isolines: on a torus a front goes around the tube and becomes two") {
    const double big = 0.3, small = 0.12, dx = 0.01;
    const Meshed m =
        meshed(torus(kCenter, big, small), dx,
               {kCenter + (big + small) * openvdb::Vec3d(std::cos(0.7), std::sin(0.7), 0)});
    // Before it closes around the tube at pi small = 0.377 at the soonest, between that and the
    // turn around the axis, and none beyond the end.
    const double one = 0.3 / dx, two = 0.7 / dx, end = 1.01 * m.field.maxDistance;
    const auto lines = linesOf(m, {end, two, one});
    checkLines(m, lines, small / dx);
    for (const Isoline& line : lines) CHECK(line.closed);
    CHECK(countAt(lines, one) == 1);
    REQUIRE(countAt(lines, two) == 2);
    CHECK(countAt(lines, end) == 0);
    CHECK(lines.front().level == one);
    // The two are mirror images of each other, each around the tube.
    CHECK(lines[1].length == Approx(lines[2].length).epsilon(0.00016));  // measured 0.0001
    CHECK(lines[1].length > 2 * M_PI * small / dx);
}

TEST_CASE("isolines: always closed on a closed surface, at whatever level") {
    const Meshed m = meshed(torus(kCenter, 0.3, 0.12), 0.02, {{0.81, 0.57, 0.61}});
    std::vector<double> levels = levelsByCount(m.field, 200);
    // Levels at which a vertex lies, the lowest and the highest among them.
    std::vector<double> at = m.mesh.distance;
    std::sort(at.begin(), at.end());
    for (std::size_t k = 0; k < at.size(); k += 37) levels.push_back(at[k]);
    levels.push_back(at.front());
    levels.push_back(at.back());
    levels.push_back(0);
    const auto lines = linesOf(m, levels);
    checkLines(m, lines, 0.12 / 0.02);
    std::set<double> seen;
    for (const Isoline& line : lines) {
        CHECK(line.closed);
        seen.insert(line.level);
    }
    for (const double level : levels)
        if (level > at.front() && level < at[at.size() - 20]) CHECK(seen.count(level) == 1);
    CHECK(countAt(lines, 0) == 0);
    CHECK(countAt(lines, at.front()) == 0);
    CHECK(std::is_sorted(lines.begin(), lines.end(),
                         [](const Isoline& a, const Isoline& b) { return a.level < b.level; }));
}

TEST_CASE("isolines: a level given twice is drawn once") {
    const Meshed m = meshed(sphere(kCenter, 0.4), 0.05, {kCenter});
    CHECK(linesOf(m, {5, 5, 5}).size() == 1);
    CHECK(linesOf(m, {}).empty());
}

TEST_CASE("isolines: an open patch cuts lines open") {
    // A square of 40 voxels: circles of 10 lie in it, of 24 its corners cut into four arcs.
    const Meshed m = meshed(planePatch(kCenter, {1, 2, 3}, 0.8), 0.02, {kCenter});
    const auto lines = linesOf(m, {10, 24});
    checkLines(m, lines, kInfinity);
    REQUIRE(lines.size() == 5);
    CHECK(lines[0].closed);
    CHECK(lines[0].length == Approx(20 * M_PI).epsilon(0.00022));  // measured 0.00015
    double arcs = 0;
    for (std::size_t k = 1; k < 5; ++k) {
        CHECK_FALSE(lines[k].closed);
        arcs += lines[k].length;
    }
    // What is left of each quarter, for a square that ends within a voxel of 20.
    auto left = [](double half) { return 4 * 24 * (M_PI / 2 - 2 * std::acos(half / 24)); };
    CHECK(arcs > left(18.5));
    CHECK(arcs < left(21));
}

TEST_CASE("isolines: they end where nothing is known") {
    JetOptions options;
    options.maxDistance = 20;
    const Meshed m = meshed(sphere(kCenter, 0.4), 0.01, {{0.9, 0.5, 0.5}}, options);
    const auto lines = linesOf(m, {10, 30});
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].closed);
    // At the front's last values, known pieces of a line are joined by nothing.
    double last = 0;
    for (const double d : m.mesh.distance)
        if (d < kInfinity) last = std::max(last, d);
    const auto ragged = linesOf(m, {last - 0.2, last - 0.05, last - 0.01});
    CHECK(std::any_of(ragged.begin(), ragged.end(), [](const Isoline& l) { return !l.closed; }));
    for (const Isoline& line : ragged)
        for (const Vec3d& p : line.points) CHECK(sampleDistance(m.field, p) < kInfinity);
}

TEST_CASE("isolines: an obstacle cuts lines open") {
    Meshed m = meshed(planePatch(kCenter, {0, 0, 1}, 0.8), 0.02, {kCenter});
    auto metric = std::make_shared<Metric>();
    const auto wall = std::make_shared<Wall>(m.field.seeds[0].pIndex + Vec3d{6.3, 1, 0}, 6);
    metric->setObstacles(m.band, wall);
    m.field = marchJet(m.band, metric, m.field.seeds);
    m.mesh = surfaceMesh(m.levelSet, m.field);
    // Both sides of the wall are reached: the one at 6.3 and more, the other past its ends.
    const auto lines = linesOf(m, {4, 7});
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].closed);
    CHECK_FALSE(lines[1].closed);
    const std::vector<Vec3d>& points = lines[1].points;
    for (std::size_t i = 1; i < points.size(); ++i)
        CHECK_FALSE(wall->block(points[i - 1], points[i], {}));
    for (const Vec3d& end : {points.front(), points.back()}) {
        CHECK(end.x < wall->middle.x);
        CHECK(end.x > wall->middle.x - 1.5);
    }
}

TEST_CASE("isolines: on two components, from two seeds") {
    const Meshed m = meshed(twoSpheres({0.25, 0.5, 0.5}, 0.15, {0.75, 0.5, 0.5}, 0.2), 0.02,
                            {{0.1, 0.5, 0.5}, {0.95, 0.5, 0.5}});
    const auto lines = linesOf(m, {10, 28});
    checkLines(m, lines, 7.5);
    REQUIRE(lines.size() == 3);  // half around the smaller sphere is 23.6 voxels
    CHECK(countAt(lines, 10) == 2);
    CHECK(countAt(lines, 28) == 1);
    for (const Isoline& line : lines) CHECK(line.closed);
}

TEST_CASE("isolines: where a grid lies in the world does not matter") {
    const openvdb::Vec3d middle(3, -2, 1);
    const double r = 0.8, dx = 0.02;
    const auto transform = rotatedTransform(dx, {1, 2, 3}, 40, {7, 8, 9});
    const Meshed m = meshed(sphere(middle, r), *transform, {middle + r * genericDirection()});
    const openvdb::Vec3d seed = m.world(m.field.seeds[0].pIndex);
    const auto lines = linesOf(m, {1.0 / dx});
    REQUIRE(lines.size() == 1);
    for (const Vec3d& p : lines[0].points)
        CHECK(geodesicOnSphere(middle, r, seed, m.world(p)) ==
              Approx(1.0).epsilon(3.9e-5));  // measured 2.6e-05
    double turned = 0;
    const NamedCurve curve = namedCurves(lines, m.band.transform)[0];
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
        const Vec3d exact = (1 / r) * (curve.points[k] - Vec3d{middle.x(), middle.y(), middle.z()});
        turned = std::max(turned, length(curve.normals[k] - exact));
    }
    CHECK(turned <= 0.00024);  // measured 0.00016
    CHECK(lines[0].length * dx ==
          Approx(2 * M_PI * r * std::sin(1.0 / r)).epsilon(0.00016));  // measured 0.0001
}

TEST_CASE("isolines: the same bytes for any number of threads") {
    std::string first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const Meshed m = meshed(torus(kCenter, 0.3, 0.12), 0.01, {{0.81, 0.57, 0.61}});
        const auto lines = linesOf(m, levelsByCount(m.field, 20));
        const auto curves = namedCurves(lines, m.band.transform);
        const std::string bytes = curveFile(".ply", CurveKind::Isoline, curves) +
                                  curveFile(".obj", CurveKind::Isoline, curves);
        if (first.empty()) first = bytes;
        CHECK(bytes == first);
    }
}

TEST_CASE("isolines: levels have the sign of a signed distance") {
    const double dx = 0.05, half = std::acos(0.5);
    const Surface surface(*makeLevelSet(sphere({0, 0, 0}, 1), dx, 3));
    const Distance d = GeodesicSolver(surface).distance(signedCap(surface, half));
    const SurfaceMesh mesh = d.indexMesh();
    const auto levelsOf = [&](const std::vector<double>& levels) {
        std::vector<double> found;
        for (const Isoline& line : isolines(d.field(), mesh, levels)) {
            found.push_back(line.level);
            for (const Vec3d& p : line.points) {
                const Vec3d q = normalized(surface.transform().worldFromIndex(p));
                CHECK(std::acos(q.z) - half == Approx(line.level * dx).margin(0.01));
            }
        }
        return found;
    };
    // The cap ends at -20.9 voxels, the sphere at 41.9.
    CHECK(levelsOf({10}) == std::vector<double>{10});
    CHECK(levelsOf({-10}) == std::vector<double>{-10});
    const std::vector<double> both = onBothSides(d.field(), levelsBySpacing(d.field(), 10));
    CHECK(both == std::vector<double>{-40, -30, -20, -10, 10, 20, 30, 40});
    CHECK(levelsOf(both) == std::vector<double>{-20, -10, 10, 20, 30, 40});
    CHECK(onBothSides(Field(), {0, 2}) == std::vector<double>{0, 2});
}

TEST_CASE("isolines: bad levels are refused") {
    const Meshed m = meshed(sphere(kCenter, 0.4), 0.05, {kCenter});
    for (const double level : {-1.0, std::nan(""), kInfinity})
        expectError(Error::Kind::InvalidArgument, {"level"}, [&] { linesOf(m, {5, level}); });
}

TEST_CASE("levels by spacing and by count") {
    Field field;
    field.maxDistance = 10;
    field.seeds.resize(2);
    CHECK(levelsBySpacing(field, 2.5) == std::vector<double>{2.5, 5, 7.5, 10});
    CHECK(levelsBySpacing(field, 11).empty());
    CHECK(levelsByCount(field, 4) == std::vector<double>{2, 4, 6, 8});
    field.seeds[0].start = 6, field.seeds[1].start = 5;
    CHECK(levelsBySpacing(field, 2.5) == std::vector<double>{7.5, 10});
    CHECK(levelsByCount(field, 4) == std::vector<double>{6, 7, 8, 9});
    for (const double spacing : {0.0, -1.0, std::nan(""), kInfinity, 1e-5, 1e-320})
        expectError(Error::Kind::InvalidArgument, {"spacing", "100000"},
                    [&] { levelsBySpacing(field, spacing); });
    for (const int count : {0, -3, 100001})
        expectError(Error::Kind::InvalidArgument, {"100000"}, [&] { levelsByCount(field, count); });
}

}  // namespace igeo::test
