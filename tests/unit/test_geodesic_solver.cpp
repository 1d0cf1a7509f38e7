// The public classes: Surface, GeodesicSolver, Distance, in world units.
#include <igeo/base/parallel.h>
#include <igeo/igeo.h>
#include <igeo/io/openvdb_interrupter.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <atomic>
#include <numbers>

namespace igeo::test {
namespace {

const openvdb::Vec3d kFarAway(3, -1, 2);

openvdb::FloatGrid::Ptr ball(double dx, double halfWidth = 3) {
    return makeLevelSet(sphere(kFarAway, 1), *rotatedTransform(dx, {1, 2, 3}, 25, {0.1, 0.2, 0.3}),
                        halfWidth);
}
Vec3d on(double x, double y, double z) {
    const Vec3d n = normalized(Vec3d{x, y, z});
    return {kFarAway.x() + n.x, kFarAway.y() + n.y, kFarAway.z() + n.z};
}

/// Asks to stop after so many updates.
struct StopAfter : Progress {
    explicit StopAfter(int updates) : left(updates) {}
    void update(const char*, double) override { --left; }
    bool cancelled() const override { return left <= 0; }
    std::atomic<int> left;
};

}  // namespace

TEST_CASE("GeodesicSolver: distances and paths on a turned sphere, in world units") {
    const auto grid = ball(0.05);
    const GeodesicSolver solver{Surface(*grid)};
    for (const Vec3d& seed : {on(0, 0, 1), on(1, 2, -1)}) {
        const igeo::Distance d = solver.distance({seed});
        const Vec3d target = on(-1, 0.5, 0.3);
        const Vec3d c{kFarAway.x(), kFarAway.y(), kFarAway.z()};
        const double exact = std::acos(dot(seed - c, target - c));
        // Measured: 2.3e-4 and 5e-5 of the length; paths inherit that.
        CHECK(d.at(target) == Approx(exact).epsilon(0.00011));  // measured 7.1e-05
        const Polyline path = d.path(target, /*straighten=*/true);
        REQUIRE(path.status == PathStatus::Reached);
        CHECK(path.length == Approx(exact).epsilon(0.00078));  // measured 0.00051
        CHECK(path.weightedLength == path.length);
        CHECK(length(path.points.front() - target) < 0.00043);  // measured 0.00028
        CHECK(length(path.points.back() - seed) < 0.00069);     // measured 0.00046
        CHECK(path.distance.front() >= path.distance.back());
        CHECK(d.largest() == Approx(std::numbers::pi).epsilon(0.008));
        const auto result = d.grid();
        CHECK(result->getName() == "psi_geodesic");
        CHECK(result->activeVoxelCount() == d.band().size());
        CHECK(result->transform() == grid->transform());
    }
}

TEST_CASE("Surface: without its volume there are results, and no more bands") {
    const Surface surface(*ball(0.05));
    const GeodesicSolver solver{surface};
    const igeo::Distance d = solver.distance({on(0, 0, 1)});
    const openvdb::FloatGrid::Ptr before = d.grid();
    surface.dropVolume();
    const openvdb::FloatGrid::Ptr after = d.grid();
    CHECK(after->getName() == before->getName());
    CHECK(after->transform() == before->transform());
    CHECK(after->activeVoxelCount() == before->activeVoxelCount());
    CHECK(d.at(on(1, 0, 0)) == Approx(std::numbers::pi / 2).epsilon(0.001));
    expectError(Error::Kind::InvalidArgument, {"volume of psi was dropped", "dropVolume"},
                [&] { d.levelSet(); });
    expectError(Error::Kind::InvalidArgument, {"dropped"},
                [&] { solver.distance({on(0, 0, 1)}, {.maxDistance = 0.1}); });
}

TEST_CASE("Distance: a grid tells how far it goes as the field does") {
    const GeodesicSolver solver{Surface(*ball(0.05))};
    for (const double limit : {kInfinity, 1.0}) {
        const MarchLimits limits{limit};
        const igeo::Distance byGrid = solver.distance({on(0, 0, 1)}, limits),
                             byField = solver.distance({on(0, 0, 1)}, limits);
        const auto grid = byGrid.grid();
        CHECK(grid->activeVoxelCount() == byGrid.reached());
        CHECK(byGrid.reached() == byField.field().reached);
        CHECK(byGrid.largest() == byField.largest());
        // Asked for afterwards, the field is extended all the same.
        CHECK(byGrid.field().distance == byField.field().distance);
        CHECK(byGrid.largest() == byField.largest());
    }
}

TEST_CASE("Surface: the caller's grid stays as it is") {
    const auto narrow = ball(0.05, 1.5);  // to be widened
    const auto tiles = ball(0.05);
    tiles->tree().addTile(1, openvdb::Coord(4096, 0, 0), tiles->background(), true);
    for (const auto& grid : {narrow, tiles}) {
        const openvdb::FloatGrid::ConstPtr before = grid->deepCopy();
        const GeodesicSolver solver{Surface(*grid)};
        solver.distance({on(0, 0, 1)});
        CHECK(grid->constTree().hasSameTopology(before->constTree()));
        for (auto it = before->cbeginValueOn(); it; ++it)
            if (grid->constTree().getValue(it.getCoord()) != *it) FAIL("a value has changed");
        CHECK(grid->getGridClass() == before->getGridClass());
        CHECK(grid->transform() == before->transform());
    }
}

TEST_CASE("Surface: a mesh and points through the same door") {
    const TriangleMesh mesh = sphereMesh({0, 0, 0}, 1, 4);
    const igeo::Distance onMesh =
        GeodesicSolver(Surface(mesh, {.size = 0.05})).distance({{0, 0, 1}});
    CHECK(onMesh.at({1, 0, 0}) ==
          Approx(std::numbers::pi / 2).epsilon(0.0012));  // measured 0.00079
    CHECK(onMesh.path({1, 0, 0}).length ==
          Approx(std::numbers::pi / 2).epsilon(0.00096));  // measured 0.00064
    CHECK(onMesh.surface().facts().kind == SurfaceFacts::Kind::Mesh);

    PointCloud cloud;
    cloud.points = mesh.points;
    const igeo::Distance onPoints = GeodesicSolver(Surface(cloud)).distance({{0, 0, 1}});
    CHECK(onPoints.at({1, 0, 0}) ==
          Approx(std::numbers::pi / 2).epsilon(6.1e-5));  // measured 4e-05
    CHECK(onPoints.surface().facts().kind == SurfaceFacts::Kind::Points);
}

TEST_CASE("GeodesicSolver: a point too far from the surface is refused, with the nearest one") {
    SolverOptions options;
    options.rules.maxSnap = 0.1;
    const GeodesicSolver solver{Surface(*ball(0.05)), options};
    const Vec3d off = on(0, 0, 1) + Vec3d{0, 0, 0.2}, near = on(0, 0, 1) + Vec3d{0, 0, 0.09};
    using Kind = Error::Kind;
    expectError(Kind::InvalidArgument, {"seed 0", "0.2", "0.1", "maxSnap"},
                [&] { solver.distance({off}); });
    expectError(Kind::InvalidArgument, {"target 1", "0.2", "maxSnap"}, [&] {
        solver.distance({near}, {.maxDistance = 0.5, .targets = {near, off}});
    });
    const igeo::Distance d = solver.distance({near});
    CHECK(d.at(near) == Approx(0).margin(1e-9));
    expectError(Kind::InvalidArgument, {"0.2", "maxSnap"}, [&] { d.at(off); });
    expectError(Kind::InvalidArgument, {"0.2", "maxSnap"}, [&] { d.path(off); });
    expectError(Kind::InvalidArgument, {"start", "maxSnap"}, [&] {
        solver.shoot(off, {1, 0, 0}, 1);
    });
    expectError(Kind::InvalidArgument, {"no seed"}, [&] { solver.distance(Seeds{}); });
}

TEST_CASE("GeodesicSolver: targets off the surface are skipped where that is asked for") {
    QueryRules rules;
    rules.skipOffSurface = true;
    const GeodesicSolver solver = GeodesicSolver{Surface(*ball(0.1))}.with(rules);
    const Vec3d far{9, 9, 9};
    const std::vector<Vec3d> good{on(1, 0, 0), on(0, 1, 0.2)}, all{far, good[0], good[1], far};
    MarchLimits limits;
    limits.targets = all;
    limits.stopAtTargets = GENERATE(false, true);
    MarchLimits without = limits;
    without.targets = good;
    const igeo::Distance d = solver.distance({on(0, 0, 1)}, limits),
                         plain = solver.distance({on(0, 0, 1)}, without);
    const std::vector<double> to = d.atTargets(), expected = plain.atTargets();
    REQUIRE(to.size() == 4);
    CHECK((std::isnan(to[0]) && std::isnan(to[3])));
    CHECK((to[1] == expected[0] && to[2] == expected[1]));
    const auto paths = d.paths(/*straighten=*/true);
    CHECK(paths[0].status == PathStatus::OffSurface);
    CHECK(paths[0].points.empty());
    CHECK(paths[2].status == PathStatus::Reached);
    DistanceMatrix m = d.matrix();
    CHECK((std::isnan(m.at(0, 0)) && m.at(0, 1) == plain.matrix().at(0, 0)));
    m.withReasons = true;
    const std::string csv = matrixCsv(m);
    CHECK(csv.starts_with("target,x,y,z,distance_0,reason\n0,,,,,"));
    CHECK(csv.find(" from the surface\n1,") != csv.npos);
    // Without the rule it is refused, and a seed always is.
    expectError(Error::Kind::InvalidArgument, {"target 0 (9,9,9)"},
                [&] { solver.with({}).distance({on(0, 0, 1)}, limits); });
    expectError(Error::Kind::InvalidArgument, {"seed 0 (9,9,9)"}, [&] { solver.distance({far}); });
}

TEST_CASE("GeodesicSolver: what is found near the seeds is what the whole surface gives") {
    const GeodesicSolver solver{Surface(*ball(0.02))};
    const Vec3d seed = on(0, 0, 1), target = on(0.3, 0.1, 1);
    const igeo::Distance whole = solver.distance({seed}),
                         near = solver.distance({seed}, {.maxDistance = 0.4}),
                         stopped =
                             solver.distance({seed}, {.targets = {target}, .stopAtTargets = true});
    CHECK(whole.ofWholeSurface());
    CHECK_FALSE(near.ofWholeSurface());
    CHECK_FALSE(stopped.ofWholeSurface());
    CHECK(near.band().size() < whole.band().size() / 4);
    CHECK(near.at(target) == whole.at(target));
    CHECK(stopped.at(target) == whole.at(target));
    CHECK(solver.pairs({seed}, {target})[0].distance == Approx(whole.at(target)));
    CHECK(near.at(on(1, 0, 1)) == kInfinity);
}

TEST_CASE("GeodesicSolver: nothing that is read exceeds the largest distance") {
    const TriangleMesh sphere = sphereMesh({}, 1, 4);
    const GeodesicSolver solver{Surface(sphere, {.size = 0.05})};
    for (const double limit : {0.5, 0.731, 1.2}) {
        const igeo::Distance d =
            solver.distance({{0, 0, 1}}, {.maxDistance = limit, .targets = sphere.points});
        const std::vector<double> targets = d.atTargets(), vertices = d.atVertices().distance;
        const std::vector<PointValue> values = d.valuesAt(sphere.points);
        std::size_t beyond = 0, within = 0;
        const auto judge = [&](double value, bool shouldReach) {
            beyond += value < kInfinity && value > limit;
            within += shouldReach && !(value < kInfinity);
        };
        for (std::size_t k = 0; k < sphere.points.size(); ++k) {
            const bool shouldReach = std::acos(sphere.points[k].z) < limit - 0.01;
            for (const double value : {targets[k], vertices[k], values[k].distance})
                judge(value, shouldReach);
            judge(d.path(sphere.points[k]).startDistance, shouldReach);
        }
        for (const double value : d.mesh().distance) judge(value, false);
        // Targets that end the march have their distances.
        const std::vector<igeo::Vec3d> few{sphere.points[7], sphere.points[400]};
        const igeo::Distance stopped =
            solver.distance({{0, 0, 1}}, {.targets = few, .stopAtTargets = true});
        for (const Polyline& path : stopped.paths()) CHECK(path.status == PathStatus::Reached);
        for (const double value : stopped.atTargets()) CHECK(value < kInfinity);
        CHECK(beyond == 0);  // up to 0.4 voxels more, at 5 % of the vertices with a distance
        CHECK(within == 0);
    }
}

TEST_CASE("Distance: the mesh is in world units") {
    const GeodesicSolver solver{Surface(*ball(0.04))};
    const igeo::Distance d = solver.distance({on(0, 0, 1)});
    const SurfaceMesh mesh = d.mesh();
    REQUIRE(mesh.position.size() > 100);
    const Vec3d middle = 0.5 * (on(0, 0, 1) + on(0, 0, -1));
    const double radius = length(on(0, 0, 1) - middle);
    for (std::size_t v = 0; v < mesh.position.size(); v += 50) {
        const Vec3d out = mesh.position[v] - middle;
        CHECK(length(out) == Approx(radius).epsilon(0.00061));  // measured 0.0004
        CHECK(dot(Vec3d(mesh.normal[v]), out) > 0.9 * radius);
        // Vertices are on the trilinear psi, up to 0.01 voxels off S. Measured 1.9e-5.
        CHECK(mesh.distance[v] == Approx(d.at(mesh.position[v])).margin(2.8e-5));
    }
    const auto& [a, b, c] = mesh.triangles[0];
    CHECK(dot(cross(mesh.position[b] - mesh.position[a], mesh.position[c] - mesh.position[a]),
              mesh.position[a] - middle) > 0);
}

TEST_CASE("GeodesicSolver: several kinds of seeds and a sign") {
    const Surface surface(*ball(0.04));
    const GeodesicSolver solver(surface);
    Curve equator;
    equator.closed = true;
    for (int k = 0; k < 90; ++k)
        equator.points.push_back(
            on(std::cos(k * std::numbers::pi / 45), std::sin(k * std::numbers::pi / 45), 0));
    Seeds seeds;
    seeds.curves = {equator};
    CHECK(solver.distance(seeds).at(on(0, 0, 1)) ==
          Approx(std::numbers::pi / 2).epsilon(0.00013));  // measured 8.5e-05

    auto region = std::make_shared<ObstacleSet>(surface.transform());
    region->addSphere(on(0, 0, 1), 2 * std::sin(0.5 / 2));  // the cap within 0.5 of the pole
    seeds = {};
    seeds.regions = {region};
    CHECK(solver.distance(seeds).at(on(0, 0, 1)) == 0);
    CHECK(solver.distance(seeds).at(on(1, 0, 0)) ==
          Approx(std::numbers::pi / 2 - 0.5).epsilon(6.8e-5));  // measured 4.5e-05
    seeds.isSigned = true;
    CHECK(solver.distance(seeds).at(on(0, 0, 1)) ==
          Approx(-0.5).epsilon(0.0022));  // measured 0.0015
    seeds.points = {on(1, 0, 0)};
    expectError(Error::Kind::InvalidArgument, {"signed"}, [&] { solver.distance(seeds); });
}

TEST_CASE("GeodesicSolver: both schemes, weights, obstacles; one set-up for many seeds") {
    const Surface surface(*ball(0.05));
    for (const Scheme scheme : {Scheme::Jet, Scheme::Godunov}) {
        SolverOptions options;
        options.scheme = scheme;
        auto wall = std::make_shared<ObstacleSet>(surface.transform());
        wall->addBox({-100, -100, kFarAway.z() - 0.1},
                     {100, kFarAway.y() + 0.5, kFarAway.z() + 0.1});
        options.metric.obstacles = wall;
        const GeodesicSolver around(surface, options);
        CHECK(around.distance({on(0, 0, 1)}).at(on(0, -1, -1)) > 1.1 * 3 * std::numbers::pi / 4);
        CHECK(around.wholeMetric() == around.wholeMetric());
        CHECK(around.wholeBand() == around.wholeBand());
        expectError(Error::Kind::InvalidArgument, {"seed 0", "obstacle"},
                    [&] { around.distance({on(0, -1, 0)}); });
        const igeo::Distance d = around.distance({on(0, 0, 1)});
        CHECK(d.field().gradient.size() == d.band().size());  // a field is complete
    }
}

TEST_CASE("GeodesicSolver: the same bits for any number of threads; stops when asked to") {
    const GeodesicSolver solver{Surface(*ball(0.03))};
    std::vector<double> one, four;
    for (const auto& [threads, found] : {std::pair(1, &one), std::pair(4, &four)}) {
        const ThreadLimit limit(threads);
        *found = solver.distance({on(1, 1, 1), on(0, 0, -1)}).field().distance;
    }
    CHECK(one == four);
    StopAfter stop(1);
    expectError(Error::Kind::Cancelled, {},
                [&] { GeodesicSolver(Surface(*ball(0.03))).distance({on(0, 0, 1)}, {}, stop); });
}

TEST_CASE("GeodesicSolver: refuses a band that takes more memory than allowed") {
    SolverOptions options;
    options.rules.memoryLimit = 1e5;
    const GeodesicSolver solver{Surface(*ball(0.03)), options};
    expectError(Error::Kind::InvalidArgument, {"GiB", "allowed", "maxDistance"},
                [&] { solver.distance({on(0, 0, 1)}); });
    CHECK_NOTHROW(solver.distance({on(0, 0, 1)}, {.maxDistance = 0.1}));
}

TEST_CASE("InterrupterProgress and OpenVdbInterrupter: either stops the other's work") {
    struct Host : openvdb::util::NullInterrupter {
        int asked = 0, started = 0, ended = 0;
        void start(const char*) override { ++started; }
        void end() override { ++ended; }
        bool wasInterrupted(int) override { return ++asked > 2; }
    } host;
    {
        InterrupterProgress<Host> progress(host);
        expectError(Error::Kind::Cancelled, {}, [&] {
            GeodesicSolver(Surface(*ball(0.03))).distance({on(0, 0, 1)}, {}, progress);
        });
        CHECK(host.started == 1);
        CHECK(progress.cancelled());
    }
    CHECK(host.ended == 1);

    LoadedGrid fog;
    fog.grid = ball(0.03);
    StopAfter stop(0);
    expectError(Error::Kind::Cancelled, {}, [&] { rebuilt(fog, 0, stop); });
}

TEST_CASE("GeodesicSolver: a group is one source, and each source has a column of its own",
          "[mesh]") {
    const TriangleMesh mesh = sphereMesh({0, 0, 0}, 1, 3);
    const GeodesicSolver solver{Surface(mesh, {.size = 0.05})};
    const std::vector<Vec3d>& p = mesh.points;
    Seeds seeds{{p[0]}};
    seeds.groups = {{"two", {p[5], p[40]}}, {"", {p[100]}}};
    const igeo::Distance d = solver.distance(seeds);
    CHECK(d.field().sourceCount() == 3);
    const VertexValues all = d.atVertices();
    CHECK(all.distance[0] == 0);
    CHECK(all.label[40] == 1);
    CHECK(all.label[100] == 2);

    const std::vector<VertexColumn> columns = solver.atVertices(seeds.sources());
    REQUIRE(columns.size() == 3);
    CHECK(columns[0].name == "distance_0");
    CHECK(columns[1].name == "distance_two");
    CHECK(columns[2].name == "distance_2");
    CHECK(columns[0].distance == solver.distance({p[0]}).atVertices().distance);
    const auto one = solver.distance({p[5]}).atVertices().distance,
               other = solver.distance({p[40]}).atVertices().distance;
    double off = 0, nearest = 0;
    for (std::size_t v = 0; v < p.size(); ++v) {
        off = std::max(off, std::abs(columns[1].distance[v] - std::min(one[v], other[v])));
        const double least =
            std::min({columns[0].distance[v], columns[1].distance[v], columns[2].distance[v]});
        nearest = std::max(nearest, std::abs(all.distance[v] - least));
    }
    CHECK(off < 1.35e-4);     // measured 8.9e-5: 0.002 voxels, where two points of the group meet
    CHECK(nearest < 3.7e-4);  // measured 2.4e-4

    const igeo::Distance asked = solver.distance(seeds, {.targets = {p[7], p[8]}});
    const std::vector<double> targets = asked.atTargets();
    CHECK(targets[1] == Approx(asked.at(p[8])));
    const DistanceMatrix m = asked.matrix();
    CHECK(m.rows() == 3);
    CHECK(std::min({m.at(0, 0), m.at(1, 0), m.at(2, 0)}) == Approx(targets[0]).margin(0.003));
    CHECK(asked.samples().position.size() > 1000);

    const ThreadLimit limit(1);
    CHECK(solver.atVertices(seeds.sources())[1].distance == columns[1].distance);
    expectError(Error::Kind::InvalidArgument, {"group 'none'"}, [&] {
        Seeds empty;
        empty.groups = {{"none", {}}};
        solver.distance(empty);
    });
    expectError(Error::Kind::InvalidArgument, {"seed 1 of group 'off'"}, [&] {
        Seeds away;
        away.groups = {{"off", {p[0], Vec3d{9, 9, 9}}}};
        solver.distance(away);
    });
    expectError(Error::Kind::InvalidArgument, {"no mesh"},
                [&] { GeodesicSolver(Surface(*ball(0.1))).atVertices({{on(0, 0, 1)}}); });
}

TEST_CASE("Distance: values at many points, with gradient and source") {
    const GeodesicSolver solver{Surface(*ball(0.05))};
    const std::vector<Vec3d> seeds{on(0, 0, 1), on(0, 0, -1)},
        points{on(1, 2, 1), on(-1, 0.5, -0.8), on(0.3, -1, 2)};
    const igeo::Distance d = solver.distance({seeds[0], seeds[1]});
    const std::vector<PointValue> values = d.valuesAt(points);
    REQUIRE(values.size() == points.size());
    const Vec3d c{kFarAway.x(), kFarAway.y(), kFarAway.z()};
    for (std::size_t k = 0; k < points.size(); ++k) {
        CHECK(values[k].distance == d.at(points[k]));
        CHECK(values[k].source == (points[k].z > kFarAway.z() ? 0 : 1));
        const Vec3d n = points[k] - c, away = seeds[values[k].source] - c;
        // Measured: 1.6e-3.
        CHECK(length(values[k].gradient + normalized(tangential(away, n))) < 2.4e-3);
    }
    CHECK(solver.unreached(true).valuesAt(points).front().source == kNoLabel);
    expectError(Error::Kind::InvalidArgument, {"point 1 at ", "raise maxSnap"}, [&] {
        d.valuesAt({points[0], {9, 9, 9}});
    });
}

TEST_CASE("LogMap: read between the nodes, as long as the distance; about points only") {
    const GeodesicSolver solver{Surface(*ball(0.05))};
    const Vec3d c{kFarAway.x(), kFarAway.y(), kFarAway.z()}, seed = on(0, 0, 1);
    const igeo::Distance d = solver.distance({seed});
    const Similarity& t = d.band().transform;
    const LogMap map = logMap(d.field());
    REQUIRE(map.frames.size() == 1);
    const Vec3d u = t.worldFromIndexDirection(map.frames[0].u),
                v = t.worldFromIndexDirection(map.frames[0].v);
    double worst = 0;
    for (int k = 0; k < 200; ++k) {
        const Vec3d p = on(std::sin(0.7 * k), std::cos(1.3 * k), std::sin(2.1 * k + 1));
        const double angle = std::acos(dot(p - c, seed - c));
        if (angle > 2.5) continue;
        const Vec2f at =
            positionAt(d.field(), map, d.surface().nearest(d.band(), t.indexFromWorld(p)));
        CHECK(double(length(at)) * t.dx == Approx(d.at(p)).epsilon(1e-6));
        const Vec3d along = normalized((p - c) - dot(p - c, seed - c) * (seed - c));
        const Vec3d found = t.dx * (double(at.x) * u + double(at.y) * v);
        worst = std::max(worst, length(found - angle * along));
    }
    CHECK(worst < 0.0062);  // measured 0.0041
    const Vec2f there =
        positionAt(d.field(), map, d.surface().nearest(d.band(), t.indexFromWorld(seed)));
    CHECK((there.x == 0 && there.y == 0));
    Seeds group;
    group.groups = {{"g", {on(0, 0, 1), on(0, 1, 0)}}};
    expectError(Error::Kind::InvalidArgument, {"about points", "give the seeds as points"},
                [&] { logMap(solver.distance(group).field()); });
}

TEST_CASE("GeodesicSolver: costs per node are those computed at its foot points") {
    const Surface surface(*ball(0.1));
    const GeodesicSolver plain{surface};
    const std::size_t nodes = plain.wholeBand()->size();
    SolverOptions options;
    options.metric.nodeWeights = {std::vector<float>(nodes, 3.0f)};
    MarchLimits limits;
    limits.maxDistance = 2;  // the whole band all the same
    const Vec3d seed = on(0, 0, 1), target = on(0.5, 0, 1);
    const double once = plain.distance({seed}).at(target);
    CHECK(GeodesicSolver(surface, options).distance({seed}, limits).at(target) ==
          Approx(3 * once).epsilon(1e-6));
    options.metric.nodeWeights.clear();
    options.metric.nodeTensors.assign(nodes, Tensor{4, 4, 4, 0, 0, 0});
    CHECK(GeodesicSolver(surface, options).distance({seed}).at(target) ==
          Approx(2 * once).epsilon(1e-6));
    options.metric.nodeTensors.pop_back();
    expectError(Error::Kind::InvalidArgument, {"costs for a band of"},
                [&] { GeodesicSolver(surface, options).distance({seed}); });
    options.metric.nodeTensors.assign(nodes, Tensor{4, -4, 4, 0, 0, 0});
    expectError(Error::Kind::InvalidArgument, {"eigenvalue"},
                [&] { GeodesicSolver(surface, options).distance({seed}); });
}

}  // namespace igeo::test
