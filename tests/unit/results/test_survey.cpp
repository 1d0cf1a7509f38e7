#include <igeo/base/parallel.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/survey.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

struct Surveyed {
    LevelSet levelSet;
    Band band;
    SurfaceSurvey survey;

    std::size_t count(Unreliable kind) const { return survey.unreliableBy[std::size_t(kind)]; }
    double area() const { return survey.area * levelSet.transform.dx * levelSet.transform.dx; }
};

Surveyed surveyed(const openvdb::FloatGrid::Ptr& grid) {
    Surveyed s;
    s.levelSet = checkedLevelSet(grid);
    s.band = bandFromLevelSet(s.levelSet, std::sqrt(3.0));
    s.survey = survey(s.levelSet, s.band, surfaceMesh(s.levelSet, s.band));
    return s;
}

Surveyed surveyed(const Shape& shape, double dx) { return surveyed(makeLevelSet(shape, dx, 3)); }

}  // namespace

TEST_CASE("survey: a sphere is one closed component of genus 0, its area right to second order") {
    for (const double dx : {0.1, 0.05, 0.025}) {
        const Surveyed s = surveyed(sphere(kOffLattice, 1), dx);
        const double r = 1 / dx;
        REQUIRE(s.survey.components.size() == 1);
        const SurfaceComponent& component = s.survey.components[0];
        CHECK(component.rims == 0);
        CHECK(component.genus == 0);
        CHECK(component.area == Approx(s.survey.area).epsilon(1e-12));
        // Vertices lie up to 1 / (4 r) below the sphere (trilinear psi), triangles with corners 1
        // from their middle 1 / (2 r) below them at most: twice that over r.
        CHECK(component.area == Approx(4 * M_PI * r * r).epsilon(1.5 / (r * r)));
        // Foot points are of second order as well: 1 / r^2 of r, and no further from the poles than
        // the lattice lets them.
        for (int a = 0; a < 3; ++a) {
            CHECK(component.low[a] == Approx(kOffLattice[a] - 1).margin(dx * dx));
            CHECK(component.high[a] == Approx(kOffLattice[a] + 1).margin(dx * dx));
        }
        // The Hessian is off by a part of the order of 1 / r^2; it is at most 1 here.
        CHECK(s.survey.largestCurvature == Approx(1 / r).epsilon(1 / (r * r) + 0.02));
        CHECK(s.survey.bounds.resolved);
        CHECK(s.survey.unreliable == 0);
        CHECK(s.survey.facingShare == 0);
        // A voxel size at which 1 / curvature is sqrt(3) voxels; curvature in bins of 0.4 %.
        CHECK(s.survey.resolvingSize ==
              Approx(r / std::sqrt(3.0)).epsilon(5.7e-5));  // measured 3.8e-05
    }
}

TEST_CASE("survey: handles, components, and a placement that does not matter") {
    const Surveyed ring = surveyed(torus(kOffLattice, 1, 0.4), 0.05);
    REQUIRE(ring.survey.components.size() == 1);
    CHECK(ring.survey.components[0].genus == 1);
    CHECK(ring.survey.components[0].rims == 0);
    // As for the sphere, with the smaller radius: 8 voxels.
    CHECK(ring.area() == Approx(4 * M_PI * M_PI * 0.4).epsilon(1.5 / 64));

    const Surveyed turned = surveyed(makeLevelSet(
        torus(kOffLattice, 1, 0.4), *rotatedTransform(0.05, {1, 2, 3}, 40, {5, 6, 7}), 3));
    REQUIRE(turned.survey.components.size() == 1);
    CHECK(turned.survey.components[0].genus == 1);
    CHECK(turned.area() == Approx(ring.area()).epsilon(1.5 / 64));
    const Vec3d extent{1.4, 1.4, 0.4};
    for (int a = 0; a < 3; ++a)
        CHECK(turned.survey.components[0].high[a] ==
              Approx(kOffLattice[a] + extent[a]).margin(0.05 / 4));

    const Surveyed two = surveyed(twoSpheres({-0.7, 0, 0}, 0.4, {0.7, 0, 0}, 0.5), 0.05);
    REQUIRE(two.survey.components.size() == 2);
    for (const auto& [component, r] :
         {std::pair{two.survey.components[0], 10.0}, {two.survey.components[1], 8.0}}) {
        CHECK(component.genus == 0);
        CHECK(component.rims == 0);
        CHECK(component.area == Approx(4 * M_PI * r * r).epsilon(1.5 / (r * r)));
    }
    CHECK(two.survey.components[0].low[0] == Approx(0.2).margin(0.01));
    CHECK(two.survey.components[1].high[0] == Approx(-0.3).margin(0.01));
}

TEST_CASE("survey: spheres that nearly touch are two components, and unreliable where they do") {
    // A fifth of a voxel apart.
    const Surveyed s = surveyed(twoSpheres({-0.505, 0, 0}, 0.5, {0.505, 0, 0}, 0.5), 0.05);
    REQUIRE(s.survey.components.size() == 2);
    for (const SurfaceComponent& p : s.survey.components) {
        CHECK(p.parts == 1);
        CHECK(p.genus == 0);
        CHECK(p.rims == 0);
    }
    CHECK(s.area() == Approx(2 * M_PI).epsilon(1.5 / 100));
    CHECK(s.count(Unreliable::Facing) > 0);
    for (NodeIndex i = 0; i < s.band.size(); ++i) {
        // Sheets less than 2 sqrt(3) voxels apart: r (1 - cos) on either side is half of it less a
        // tenth, so sin^2 < 2 (sqrt(3) - 0.1) / 10 and y^2 + z^2 < (0.29)^2; and a voxel for nodes
        // that take it over.
        const openvdb::Vec3d p = worldOf(s.band, s.band.footPoint(i));
        if (s.survey.unreliability[i] > 0 && std::hypot(p.y(), p.z()) > 0.29 + 0.05)
            FAIL_CHECK("a doubt at " << p.str());
    }
}

TEST_CASE("survey: faces side by side are one component of two parts") {
    // A gap of a voxel, its middle on a lattice plane: psi is positive there, so that the mesh
    // knows two boxes, but no grid keeps a front on their upper faces from passing to the next.
    const double dx = 0.05;
    const Shape left = box({-0.525, 0.013, 0.017}, {0.5, 0.4, 0.3}),
                right = box({0.525, 0.013, 0.017}, {0.5, 0.4, 0.3});
    Shape both = left;
    both.bounds.expand(right.bounds);
    both.sdf = [=](const openvdb::Vec3d& p) { return std::min(left.sdf(p), right.sdf(p)); };
    const Surveyed s = surveyed(both, dx);
    REQUIRE(s.survey.components.size() == 1);
    CHECK(s.survey.components[0].parts == 2);
    CHECK(s.survey.components[0].genus == 0);
    CHECK(s.survey.components[0].rims == 0);
    CHECK(s.survey.components[0].high[0] - s.survey.components[0].low[0] ==
          Approx(2.05).margin(dx));
}

TEST_CASE("survey: a plane patch has one rim, and is unreliable along it only") {
    const double dx = 0.05, size = 2;
    const openvdb::Vec3d n = openvdb::Vec3d(1, 1, 2).unit();
    const Surveyed s = surveyed(planePatch(kOffLattice, n, size), dx);
    REQUIRE(s.survey.components.size() == 1);
    CHECK(s.survey.components[0].rims == 1);
    CHECK(s.survey.components[0].genus == 0);
    // The mesh ends within two voxels of the cut (surface_mesh.h).
    CHECK(s.area() <= size * size);
    CHECK(s.area() >= std::pow(size - 4 * dx, 2));
    CHECK(s.count(Unreliable::Cut) > 4 * 30);  // 40 voxels a side
    CHECK(s.count(Unreliable::Cut) == s.survey.unreliable);
    for (NodeIndex i = 0; i < s.band.size(); ++i) {
        if (s.survey.unreliability[i] == 0) continue;
        CHECK(s.survey.unreliability[i] == 1);
        // The domain is a square in the plane: within three voxels of its boundary, the diagonal
        // of a voxel for the missing neighbor and as much again for nodes that take it over.
        const openvdb::Vec3d p = worldOf(s.band, s.band.footPoint(i)) - kOffLattice;
        const double outward = std::sqrt(p.dot(p));
        if (outward < size / 2 - 2 * std::sqrt(3.0) * dx) FAIL_CHECK("a doubt at " << p.str());
    }
}

TEST_CASE("survey: the sheets of a plate that is too thin are found, and how far apart they are") {
    const double dx = 0.05;
    const Surveyed thin = surveyed(thinSheet(kOffLattice, 0.8, 0.6, 0.1), dx);  // 2 voxels
    CHECK_FALSE(thin.survey.bounds.resolved);
    // Sheets face each other on the flat part, 1.5 x 1.1 on both sides, less two voxels along its
    // rim; all of the surface has the half-round rim as well.
    const double flat = 2 * (1.5 - 4 * dx) * (1.1 - 4 * dx),
                 all = 2 * 1.5 * 1.1 + M_PI * 0.05 * (2 * 1.5 + 2 * 1.1 + 2 * M_PI * 0.05);
    CHECK(double(thin.count(Unreliable::Facing)) > flat / all * double(thin.band.size()));
    CHECK(thin.survey.facingShare > flat / all);
    REQUIRE(thin.survey.components.size() == 1);
    CHECK(thin.survey.components[0].genus == 0);
    // In the middle, sheets 2 voxels apart: sqrt(3) voxels are too much by sqrt(3). psi is exact.
    std::size_t middle = 0;
    for (NodeIndex i = 0; i < thin.band.size(); ++i) {
        const openvdb::Vec3d p = worldOf(thin.band, thin.band.footPoint(i)) - kOffLattice;
        if (std::abs(p.x()) > 0.6 || std::abs(p.y()) > 0.4) continue;
        ++middle;
        if (std::abs(double(thin.survey.unreliability[i]) - std::sqrt(3.0)) > 0.02)
            FAIL_CHECK("doubt " << thin.survey.unreliability[i] << " at " << p.str());
    }
    CHECK(middle > 1000);
    CHECK(thin.survey.resolvingSize < 1);

    // 6 voxels apart the sheets are further than the band sees.
    const Surveyed thick = surveyed(thinSheet(kOffLattice, 0.8, 0.6, 0.3), dx);
    CHECK(thick.survey.bounds.resolved);
    CHECK(thick.count(Unreliable::Facing) == 0);
    CHECK(thick.survey.unreliable == 0);
}

TEST_CASE("survey: a box is unreliable at its edges, everywhere there, and nowhere else") {
    const double dx = 0.05;
    const openvdb::Vec3d half(0.9, 0.7, 0.5);
    const Surveyed s = surveyed(box(kOffLattice, half), dx);
    REQUIRE(s.survey.components.size() == 1);
    CHECK(s.survey.components[0].genus == 0);
    // Edges are rounded off within a voxel: less than a voxel of area along their 33.6 length.
    CHECK(s.area() == Approx(8 * (0.9 * 0.7 + 0.7 * 0.5 + 0.9 * 0.5)).margin(33.6 * dx));
    CHECK(s.count(Unreliable::Bend) > 0);
    std::vector<std::uint8_t> alongX(100);  // bins of 0.018 beside the edge y, z = +half
    for (NodeIndex i = 0; i < s.band.size(); ++i) {
        if (s.survey.unreliability[i] == 0) continue;
        CHECK(s.survey.unreliability[i] >= 1);
        const openvdb::Vec3d p = worldOf(s.band, Vec3d(s.band.ijk(i))) - kOffLattice;
        std::array<double, 3> off;  // from the planes of the faces; an edge lies in two of them
        for (int a = 0; a < 3; ++a) off[std::size_t(a)] = half[a] - std::abs(p[a]);
        std::sort(off.begin(), off.end());
        // The kink is within a voxel of the core's node that judges, which is within a voxel of
        // this one's foot point, sqrt(3) away.
        if (off[1] > 4 * dx) FAIL_CHECK("a doubt at " << p.str());
        if (std::abs(p.y() - half.y()) < 3 * dx && std::abs(p.z() - half.z()) < 3 * dx &&
            std::abs(p.x()) < half.x())
            alongX[std::size_t((p.x() / half.x() + 1) * 18)] = 1;  // 36 bins of a voxel
    }
    CHECK(std::count(alongX.begin(), alongX.end(), 1) == 36);

    const auto grid =
        unreliableGrid(s.band, s.survey.unreliability, s.levelSet.psi->transform(), "doubt");
    CHECK(grid->activeVoxelCount() == s.survey.unreliable);
    CHECK(grid->transform() == s.levelSet.psi->transform());
    CHECK(grid->getGridClass() == openvdb::GRID_UNKNOWN);
    float least = 9, largest = 0;
    for (auto it = grid->cbeginValueOn(); it; ++it)
        least = std::min(least, *it), largest = std::max(largest, *it);
    CHECK(least >= 1);
    CHECK(largest > 1);
}

TEST_CASE("survey: a rough distance is unreliable where it is rough") {
    auto grid = makeLevelSet(sphere(kOffLattice, 1), 0.05, 3);
    // psi^3-like on one side: |grad psi| = 1.5 at S for x above the center by 0.8.
    for (auto it = grid->beginValueOn(); it; ++it)
        if (grid->indexToWorld(it.getCoord()).x() > kOffLattice.x() + 0.8) it.setValue(1.5f * *it);
    const Surveyed s = surveyed(grid);
    CHECK(s.count(Unreliable::Rough) > 100);
    for (NodeIndex i = 0; i < s.band.size(); ++i) {
        const openvdb::Vec3d p = worldOf(s.band, Vec3d(s.band.ijk(i))) - kOffLattice;
        if (s.survey.unreliability[i] > 0 && p.x() < 0.8 - 4 * 0.05)
            FAIL_CHECK("a doubt at " << p.str());
        // |1.5 - 1| / 0.25.
        if (std::abs(s.band.psi[i]) < 0.5 && p.x() > 0.9 &&
            std::abs(s.survey.unreliability[i] - 2) > 0.05)
            FAIL_CHECK("doubt " << s.survey.unreliability[i] << " at " << p.str());
    }
}

TEST_CASE("survey: the same bits for any number of threads") {
    SurfaceSurvey first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const SurfaceSurvey s =
            surveyed(twoSpheres({-0.7, 0, 0}, 0.4, {0.7, 0, 0}, 0.5), 0.05).survey;
        if (threads == 1) first = s;
        CHECK(s.area == first.area);
        CHECK(s.unreliability == first.unreliability);
        CHECK(s.largestCurvature == first.largestCurvature);
        CHECK(s.components[1].area == first.components[1].area);
        CHECK(s.components[1].high == first.components[1].high);
    }
}

}  // namespace igeo::test
