#include <igeo/base/parallel.h>
#include <igeo/march/godunov.h>
#include <igeo/results/voronoi_cells.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/meshed.h>
#include <support/openvdb.h>

#include <cmath>

namespace igeo::test {
namespace {

double sumOf(const VoronoiCells& cells) {
    double sum = cells.unreachedArea;
    for (const VoronoiCell& c : cells.cells) sum += c.area;
    return sum;
}

/// A frame of unit vectors off all lattice lines.
struct Frame {
    openvdb::Vec3d u = genericDirection(0), v = u.cross(genericDirection(1)).unit(), w = u.cross(v);
};

VoronoiCells cellsOf(const Meshed& m) { return voronoiCells(m.field, m.mesh); }

}  // namespace

TEST_CASE("voronoiCells: one seed has all of the surface, or what it reaches of it") {
    const Meshed one = meshed(sphere(kCenter, 0.4), 0.02, {kCenter});
    const VoronoiCells all = cellsOf(one);
    REQUIRE(all.cells.size() == 1);
    CHECK(all.cells[0].area == all.area);
    CHECK(all.cells[0].boundary == 0);
    CHECK(all.area == Approx(meshArea(one.mesh)).epsilon(1e-12));

    const Meshed two =
        meshed(twoSpheres({0.25, 0.5, 0.5}, 0.15, {0.75, 0.5, 0.5}, 0.2), 0.01, {{0.1, 0.5, 0.5}});
    const VoronoiCells half = cellsOf(two);
    // Vertices lie up to 1 / (4 r) below the sphere (trilinear psi), triangles with corners 1 from
    // their middle 1 / (2 r) below them at most: twice that over r.
    for (const auto& [area, r] : {std::pair{half.cells[0].area, 15.0}, {half.unreachedArea, 20.0}})
        CHECK(area == Approx(4 * M_PI * r * r).epsilon(1.5 / (r * r)));
    CHECK(half.cells[0].boundary == 0);
    CHECK(sumOf(half) == Approx(half.area).epsilon(1e-12));
}

TEST_CASE("voronoiCells: triangles are cut where the march stopped") {
    const Frame f;
    const double r = 40;
    JetOptions options;
    // Measured 0.0017 for the small cap, whose rim is made of chords, and below 0.001 for the
    // others.
    for (const auto& [limit, most] :
         {std::pair(7.3, 0.0026), std::pair(20.0, 0.001), std::pair(51.9, 0.001)}) {
        options.maxDistance = limit;
        const VoronoiCells cells =
            cellsOf(meshed(sphere(kCenter, 0.4), 0.01, {kCenter + 0.4 * f.u}, options));
        CHECK(sumOf(cells) == Approx(cells.area).epsilon(1e-12));
        const double cap = 2 * M_PI * r * r * (1 - std::cos(limit / r));
        CHECK(cells.cells[0].area == Approx(cap).epsilon(most));
        CHECK(cells.cells[0].boundary == 0);
    }
    // Two caps that overlap: their border ends where the march does.
    options.maxDistance = 25;
    const double apart = 1, limit = 25 / r;
    const openvdb::Vec3d other = std::cos(apart) * f.u + std::sin(apart) * f.v;
    const VoronoiCells cells = cellsOf(
        meshed(sphere(kCenter, 0.4), 0.01, {kCenter + 0.4 * f.u, kCenter + 0.4 * other}, options));
    const double half = std::acos(std::cos(limit) / std::cos(apart / 2));
    for (const VoronoiCell& c : cells.cells)
        CHECK(c.boundary == Approx(2 * r * half).epsilon(0.00071));             // measured 0.00047
    CHECK(cells.cells[0].area == Approx(cells.cells[1].area).epsilon(3.5e-5));  // measured 2.3e-05
}

TEST_CASE("voronoiCells: two seeds share a sphere, also where one starts late") {
    const Frame f;
    const double r = 40;
    const openvdb::Vec3d north = kCenter + 0.4 * f.u, south = kCenter - 0.4 * f.u;
    Meshed m = meshed(sphere(kCenter, 0.4), 0.01, {north, south});
    for (const double late : {0.0, 10.0}) {
        if (late > 0) {
            std::vector<SurfacePoint> seeds = m.field.seeds;
            seeds[0].start = late;
            m.field = marchJet(m.band, {}, seeds);
            m.mesh = surfaceMesh(m.levelSet, m.field);
        }
        const VoronoiCells cells = cellsOf(m);
        // The border is the circle at r theta + late = r (pi - theta).
        const double theta = (M_PI - late / r) / 2;
        CHECK(
            cells.cells[0].area ==
            Approx(2 * M_PI * r * r * (1 - std::cos(theta))).epsilon(0.00055));  // measured 0.00036
        CHECK(
            cells.cells[1].area ==
            Approx(2 * M_PI * r * r * (1 + std::cos(theta))).epsilon(0.00057));  // measured 0.00038
        CHECK(cells.cells[0].boundary ==
              Approx(2 * M_PI * r * std::sin(theta)).epsilon(0.00027));  // measured 0.00017
        CHECK(cells.cells[1].boundary == cells.cells[0].boundary);
        CHECK(sumOf(cells) == Approx(cells.area).epsilon(1e-12));
    }
}

TEST_CASE("voronoiCells: three cells meet in a point") {
    const Frame f;
    const double r = 40;
    SECTION("three lunes") {
        std::vector<openvdb::Vec3d> seeds;
        for (const double a : {0.3, 0.3 + 2 * M_PI / 3, 0.3 - 2 * M_PI / 3})
            seeds.push_back(kCenter + 0.4 * (std::cos(a) * f.u + std::sin(a) * f.v));
        const VoronoiCells cells = cellsOf(meshed(sphere(kCenter, 0.4), 0.01, seeds));
        for (const VoronoiCell& c : cells.cells) {
            CHECK(c.area == Approx(4 * M_PI * r * r / 3).epsilon(0.00057));  // measured 0.00038
            CHECK(c.boundary == Approx(2 * M_PI * r).epsilon(0.0018));       // measured 0.0011
        }
        CHECK(sumOf(cells) == Approx(cells.area).epsilon(1e-12));
    }
    SECTION("the faces of a cube, blown up to a sphere") {
        std::vector<openvdb::Vec3d> seeds;
        for (const openvdb::Vec3d& axis : {f.u, f.v, f.w})
            for (const double sign : {-0.4, 0.4}) seeds.push_back(kCenter + sign * axis);
        const VoronoiCells cells = cellsOf(meshed(sphere(kCenter, 0.4), 0.01, seeds));
        for (const VoronoiCell& c : cells.cells) {
            CHECK(c.area == Approx(4 * M_PI * r * r / 6).epsilon(0.00057));  // measured 0.00038
            // Its sides are seen from the middle under the angle between corners, acos(1/3).
            CHECK(c.boundary ==
                  Approx(4 * r * std::acos(1.0 / 3)).epsilon(0.0017));  // measured 0.0011
        }
        CHECK(sumOf(cells) == Approx(cells.area).epsilon(1e-12));
    }
}

TEST_CASE("voronoiCells: two seeds share a torus by its symmetry") {
    const double big = 0.3, small = 0.12;
    const openvdb::Vec3d u(std::cos(0.7), std::sin(0.7), 0);
    const VoronoiCells cells =
        cellsOf(meshed(torus(kCenter, big, small), 0.01,
                       {kCenter + (big + small) * u, kCenter - (big + small) * u}));
    const double area = 4 * M_PI * M_PI * 30 * 12;
    CHECK(cells.area == Approx(area).epsilon(1e-3));
    for (const VoronoiCell& c : cells.cells) {
        CHECK(c.area == Approx(area / 2).epsilon(1e-3));
        CHECK(c.boundary == Approx(2 * 2 * M_PI * 12).epsilon(0.00063));  // measured 0.00041
    }
}

TEST_CASE("voronoiCells: the same bits for any number of threads") {
    VoronoiCells first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const VoronoiCells cells = cellsOf(
            meshed(sphere(kCenter, 0.4), 0.02,
                   {kCenter + 0.4 * genericDirection(0), kCenter + 0.4 * genericDirection(1)}));
        if (threads == 1) first = cells;
        CHECK(cells.area == first.area);
        CHECK(cells.cells[0].area == first.cells[0].area);
        CHECK(cells.cells[0].boundary == first.cells[0].boundary);
    }
}

TEST_CASE("voronoiCells need to know which seed is nearest") {
    Meshed m = meshed(sphere(kCenter, 0.4), 0.05, {kCenter});
    std::vector<SurfacePoint> seeds = m.field.seeds;
    seeds.push_back(pointOn(m.band, kCenter + openvdb::Vec3d(0, 0.4, 0)));
    m.field = marchGodunov(m.band, {}, seeds);
    m.mesh = surfaceMesh(m.levelSet, m.field);
    expectError(Error::Kind::InvalidArgument, {"godunov", "jet"}, [&] { cellsOf(m); });
}

}  // namespace igeo::test
