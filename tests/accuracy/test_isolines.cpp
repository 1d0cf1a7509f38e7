// Isolines and cells against exact circles and shares.
#include <igeo/geodesic_solver.h>
#include <igeo/results/isolines.h>
#include <igeo/results/voronoi_cells.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/exact.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <cstdio>

namespace igeo::test {
namespace {

/// On the sphere of radius 0.4, by `jet`.
Distance distanceFrom(const Seeds& seeds, int n) {
    return GeodesicSolver(Surface(*makeLevelSet(sphere(kCenter, 0.4), 1.0 / n, 3))).distance(seeds);
}

struct CircleErrors {
    double radius = 0, length = 0;  ///< largest over all lines, %
};

/// Isolines of a sphere of radius 0.4, every `spacing` voxels up to a twentieth from the far end.
CircleErrors circlesOnSphere(int n, const openvdb::Vec3d& direction, double spacing) {
    const double r = 0.4 * n;
    const Distance d = distanceFrom({fromVdb(kCenter + 0.4 * direction)}, n);
    const openvdb::Vec3d seed = seedOf(d);
    CircleErrors e;
    for (const Isoline& line :
         isolines(d.field(), d.indexMesh(), levelsBySpacing(d.field(), spacing))) {
        if (line.level > 0.95 * M_PI * r) continue;
        CHECK(line.closed);
        for (const Vec3d& p : line.points)
            e.radius = std::max(
                e.radius,
                100 * std::abs(n * geodesicOnSphere(kCenter, 0.4, seed, worldOf(d.band(), p)) /
                                   line.level -
                               1));
        e.length = std::max(
            e.length, 100 * std::abs(line.length / (2 * M_PI * r * std::sin(line.level / r)) - 1));
    }
    return e;
}

}  // namespace

TEST_CASE("isolines on a sphere: radius to 0.02 %, length to 0.026 % at N = 200") {
    for (int k = 0; k < 4; ++k) {
        const CircleErrors e = circlesOnSphere(200, genericDirection(k), 10);
        std::printf("isolines, sphere N = 200, direction %d: radius %.4f %%, length %.4f %%\n", k,
                    e.radius, e.length);
        CHECK(e.radius <= 0.02);
        CHECK(e.length <= 0.026);  // measured 0.0171
    }
}

TEST_CASE("isolines are of second order in dx") {
    // The same levels in world units.
    const CircleErrors coarse = circlesOnSphere(50, genericDirection(), 5),
                       fine = circlesOnSphere(200, genericDirection(), 20);
    std::printf(
        "isolines, sphere N = 50: radius %.4f %%, length %.4f %%; N = 200: %.4f %%, %.4f %%\n",
        coarse.radius, coarse.length, fine.radius, fine.length);
    CHECK(fine.length <= coarse.length / 12.6);  // measured 1 / 18.9
    CHECK(fine.radius <= coarse.radius / 12.4);  // measured 1 / 18.7
}

TEST_CASE("cells of two seeds are hemispheres") {
    for (const int n : {100, 200}) {
        const double r = 0.4 * n, half = 2 * M_PI * r * r;
        for (int k = 0; k < 3; ++k) {
            const openvdb::Vec3d out = 0.4 * genericDirection(k);
            const Distance d = distanceFrom({fromVdb(kCenter + out), fromVdb(kCenter - out)}, n);
            const VoronoiCells cells = voronoiCells(d.field(), d.indexMesh());
            const double area = 100 * (cells.cells[0].area / half - 1),
                         border = 100 * (cells.cells[0].boundary / (2 * M_PI * r) - 1);
            std::printf("cells, sphere N = %d: area %.4f %%, boundary %.4f %%, surface %.4f %%\n",
                        n, area, border, 100 * (cells.area / (2 * half) - 1));
            CHECK(std::abs(area) <= 0.055);                         // measured 0.0364
            CHECK(std::abs(border) <= 0.027);                       // measured 0.0181
            CHECK(cells.area == Approx(2 * half).epsilon(5.5e-4));  // measured 3.6e-4
        }
    }
}

}  // namespace igeo::test
