// Points of a mesh without a distance: lost, or where no path leads.
#include <igeo/band/surface_triangles.h>
#include <igeo/march/jet.h>
#include <igeo/metric/obstacles.h>
#include <igeo/results/lost_points.h>
#include <igeo/surface/mesh_band.h>
#include <support/catch.h>

#include <cmath>
#include <limits>

namespace igeo {
namespace {

/// Two squares of 16 voxels in one plane, with a gap between x = 16 and 20.
TriangleMesh squares() {
    TriangleMesh mesh;
    for (const double left : {0.0, 20.0})
        for (int i = 0; i <= 8; ++i)
            for (int j = 0; j <= 8; ++j) {
                if (i < 8 && j < 8) {
                    const auto a = std::uint32_t(mesh.points.size()), b = a + 9;
                    mesh.triangles.push_back({a, b, b + 1});
                    mesh.triangles.push_back({a, b + 1, a + 1});
                }
                mesh.points.push_back({left + 2 * i, 2.0 * j, 0.3});
            }
    return mesh;
}

struct Marched {
    Band band;
    MetricPtr metric;
    Field field;

    explicit Marched(double gap = 0, std::shared_ptr<const Obstacles> obstacles = nullptr)
        : band(bandFromMesh(squares(), 1, std::sqrt(3.0), Progress::none(), gap)) {
        auto costs = std::make_shared<Metric>();
        if (obstacles) costs->setObstacles(band, obstacles);
        metric = costs;
        field = marchJet(band, metric, {nearestSurfacePoint(band, {3, 8, 0.3})});
    }
    std::size_t lost(const std::vector<Vec3d>& points, const std::vector<double>& d) const {
        LostPoints all(band, metric, points);
        all.add(field.seeds, d.data());
        return all.count();
    }
};

const Vec3d kBeside{5, 3, 0.3}, kFarther{13, 8, 0.3}, kOnOther{30, 8, 0.3};
const double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("lost points: those that triangles join to a seed", "[results]") {
    const Marched m;
    CHECK(m.lost({kBeside, kFarther, kOnOther}, {5.4, 10, kInfinity}) == 0);
    CHECK(m.lost({kBeside, kFarther, kOnOther}, {5.4, kInfinity, kInfinity}) == 1);
    CHECK(m.lost({kBeside, kFarther}, {kNaN, kInfinity}) == 1);
    LostPoints rows(m.band, m.metric, {kBeside, kFarther, kOnOther});
    const double row[] = {5.4, kInfinity, kInfinity};
    rows.addSource(m.field, 0, row);
    rows.addSource(m.field, 0, row);
    rows.add(m.field.seeds, 1, kInfinity);
    CHECK(rows.count() == 3);
    CHECK(rows.warning("distances").find("3 of 7 distances") == 0);
    const std::string said =
        lostWarning(m.field, "targets", {kBeside, kFarther, kBeside}, {5, kInfinity, kNaN});
    INFO(said);
    CHECK(said.find("1 of 2 targets (50 %) have no distance") == 0);
    CHECK(lostWarning(m.field, "targets", {kOnOther}, {kInfinity}).empty());
}

TEST_CASE("lost points: a limit explains them, unless it is beyond the surface", "[results]") {
    Marched m;
    m.field.greatest = 1000;
    CHECK_FALSE(lostWarning(m.field, "targets", {kFarther}, {kInfinity}).empty());
    m.field.greatest = 9;
    CHECK(lostWarning(m.field, "targets", {kFarther}, {kInfinity}).empty());
    m.field.greatest = kInfinity, m.field.stoppedEarly = true;
    CHECK(lostWarning(m.field, "targets", {kFarther}, {kInfinity}).empty());
}

TEST_CASE("lost points: obstacles explain those that they enclose", "[results]") {
    for (const double end : {17.0, 8.0}) {
        auto wall = std::make_shared<ObstacleSet>(Similarity{});
        wall->addBox({9.5, -1, -1}, {10.5, end, 1});
        const Marched m(0, wall);
        INFO("wall up to y = " << end);
        CHECK(m.lost({kFarther}, {kInfinity}) == (end < 16 ? 1 : 0));
        CHECK(m.lost({{10, 4, 0.3}}, {kInfinity}) == 0);  // inside
    }
}

TEST_CASE("lost points: over joined gaps parts with a distance count", "[results]") {
    const Marched m(5);
    REQUIRE(m.band.joints == 1);
    CHECK(m.lost({{25, 8, 0.3}, kOnOther}, {22, kInfinity}) == 1);
}

}  // namespace
}  // namespace igeo
