#include <igeo/base/parallel.h>
#include <igeo/results/engrave.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/meshed.h>
#include <support/openvdb.h>

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetMeasure.h>

#include <cmath>
#include <limits>

namespace igeo::test {
namespace {

/// A sphere with three isolines, a path across them, and all that cut into it.
struct Carved {
    Meshed m;
    std::vector<Isoline> lines;
    std::vector<Path> paths;
    openvdb::FloatGrid::Ptr grid;

    explicit Carved(double radius = kGrooveRadius, double degrees = 0)
        : m(meshed(sphere(kCenter, 0.4), *rotatedTransform(0.02, {1, 2, 3}, degrees, {1, 2, 3}),
                   {kCenter + 0.4 * genericDirection()})) {
        lines = isolines(m.field, m.mesh, levelsByCount(m.field, 3));
        REQUIRE(lines.size() == 3);
        paths = {tracePath(m.field, pointOn(m.band, kCenter + 0.4 * genericDirection(1)))};
        grid = engraved(m.levelSet, lines, paths, radius);
    }

    std::vector<Vec3d> points() const {
        std::vector<Vec3d> all;
        for (const Isoline& line : lines)
            all.insert(all.end(), line.points.begin(), line.points.end());
        for (const PathVertex& v : paths[0].vertices) all.push_back(v.pIndex);
        return all;
    }
    /// Voxels.
    double psi(const Vec3d& p) const {
        return openvdb::tools::BoxSampler::sample(grid->tree(), openvdb::Vec3d(p.x, p.y, p.z)) /
               m.band.transform.dx;
    }
};

}  // namespace

TEST_CASE("engraved: a groove along every line and path, as deep as its radius") {
    const double radius = GENERATE(1.2, 2.0);
    const Carved c(radius, 30);
    // Trilinear interpolation of a distance errs by half a cell's diagonal at most.
    const double slack = std::sqrt(3.0) / 2;
    const auto points = c.points();
    REQUIRE(points.size() > 200);
    for (const Vec3d& p : points) {
        CHECK(c.psi(p) > radius - slack);
        CHECK(c.psi(p) < radius + slack);
    }
    // Deeper it is solid; beside crossings only the nearest groove counts.
    const std::vector<Vec3d>& line = c.lines[1].points;
    for (const Vec3d& p : line) {
        const Vec3d n = SurfaceCell(c.m.band, *c.m.field.metric, p, {}).normal;
        CHECK(c.psi(p - (radius + slack + 0.1) * n) < 0);
    }
}

TEST_CASE("engraved: still a level set, and no different further away") {
    const Carved c;
    CHECK(c.grid->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(c.grid->getName() == c.m.levelSet.name + "_engraved");
    CHECK(c.grid->transform() == c.m.levelSet.psi->transform());
    CHECK(c.grid->background() == c.m.levelSet.psi->background());
    const LevelSet again = checkedLevelSet(c.grid);
    CHECK(again.stats.halfWidth == Approx(c.m.levelSet.stats.halfWidth));
    CHECK(again.stats.cutVoxels == 0);
    CHECK(again.stats.gradientMedian == Approx(1).margin(0.00074));  // measured 0.00049

    const auto points = c.points();
    const double reach = kGrooveRadius + c.m.levelSet.stats.halfWidth;
    const auto before = c.m.levelSet.psi->getConstAccessor(), after = c.grid->getConstAccessor();
    std::size_t same = 0, changed = 0;
    for (auto it = c.m.levelSet.psi->cbeginValueAll(); it; ++it) {
        if (!it.isVoxelValue()) continue;
        const openvdb::Coord ijk = it.getCoord();
        const bool equal = before.getValue(ijk) == after.getValue(ijk) &&
                           before.isValueOn(ijk) == after.isValueOn(ijk);
        if (equal) continue;
        ++changed;
        CHECK(after.getValue(ijk) > before.getValue(ijk));
        double nearest = kInfinity;
        for (const Vec3d& p : points)
            nearest = std::min(nearest, length(Vec3d(ijk.x(), ijk.y(), ijk.z()) - p));
        // Points are up to a triangle's side apart.
        if (nearest > reach + 1) ++same;
    }
    CHECK(changed > 1000);
    CHECK(same == 0);
}

TEST_CASE("engraved: takes out half a tube along the line") {
    // Deep enough to be resolved: the volume of a level set is measured by its smeared inside.
    const double radius = 2.5;
    Carved c(radius);
    c.lines = {c.lines[1]};
    const auto grid = engraved(c.m.levelSet, c.lines, {}, radius);
    const double removed = openvdb::tools::levelSetVolume(*c.m.levelSet.psi, false) -
                           openvdb::tools::levelSetVolume(*grid, false);
    const double expected = M_PI / 2 * radius * radius * c.lines[0].length;
    CHECK(removed == Approx(expected).epsilon(0.14));  // measured 0.087
}

TEST_CASE("engraved: closed lines are closed, open ones are not, corners are round") {
    const Carved c;
    // Chords far below the surface.
    const Vec3d middle = c.m.band.transform.indexFromWorld({0.5, 0.5, 0.5});
    Isoline line;
    line.points = {middle, middle + Vec3d{8, 0, 0}, middle + Vec3d{0, 8, 0}};
    for (const bool closed : {false, true}) {
        line.closed = closed;
        const auto grid = engraved(c.m.levelSet, {line}, {}, 2);
        auto inside = [&](double x, double y) {
            const Vec3d p = middle + Vec3d{x, y, 0};
            return openvdb::tools::BoxSampler::sample(grid->tree(), openvdb::Vec3d(p.x, p.y, p.z)) <
                   0;
        };
        CHECK_FALSE(inside(4, 0));
        CHECK_FALSE(inside(4, 4));
        CHECK(inside(0, 4) == !closed);
        CHECK(inside(-3, 0));
        CHECK(inside(11, 0));
    }
}

TEST_CASE("engraved: nothing to engrave leaves the surface as it is") {
    const Carved c;
    const auto grid = engraved(c.m.levelSet, {}, {Path{}});
    CHECK(grid->tree().hasSameTopology(c.m.levelSet.psi->tree()));
    for (auto it = c.m.levelSet.psi->cbeginValueOn(); it; ++it)
        REQUIRE(grid->tree().getValue(it.getCoord()) == *it);
}

TEST_CASE("engraved: of a wide level set a narrow band is left") {
    // Where psi is known is where tubes would have to be known: the work would grow without bound.
    const auto wide = makeLevelSet(sphere(kCenter, 0.4), 0.02, 18);
    const LevelSet levelSet = checkedLevelSet(wide);
    Isoline line;
    line.points = {levelSet.transform.indexFromWorld({0.5, 0.5, 0.9}),
                   levelSet.transform.indexFromWorld({0.5, 0.9, 0.5})};
    const auto grid = engraved(levelSet, {line}, {});
    CHECK(checkedLevelSet(grid).stats.halfWidth ==
          Approx(kEngravedWidth).margin(0.026));  // measured 0.017
    std::size_t changed = 0;
    for (auto it = grid->cbeginValueOn(); it; ++it)
        changed += *it != wide->tree().getValue(it.getCoord());
    CHECK(changed > 100);
    CHECK(changed < 0.5 * double(grid->activeVoxelCount()));
    CHECK(grid->tree().getValue(openvdb::Coord(25, 25, 25)) < 0);  // the inside
}

TEST_CASE("engraved: the same voxels for any number of threads") {
    openvdb::FloatGrid::Ptr first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const auto grid = Carved().grid;
        if (!first) first = grid;
        CHECK(grid->tree().hasSameTopology(first->tree()));
        for (auto it = first->cbeginValueOn(); it; ++it)
            REQUIRE(grid->tree().getValue(it.getCoord()) == *it);
    }
}

TEST_CASE("engraved: radii that no grid shows are refused") {
    const Carved c;
    for (const double radius : {0.4, -1.0, 10.1, std::nan(""), kInfinity})
        expectError(Error::Kind::InvalidArgument, {"radius", "0.5 to 10"},
                    [&] { engraved(c.m.levelSet, c.lines, c.paths, radius); });
}

}  // namespace igeo::test
