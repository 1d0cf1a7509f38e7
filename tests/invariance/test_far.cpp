// Far from the origin of the voxels, up to where 32 bits number them, and far from that of the
// world: the same distances, or a refusal in words.
#include <igeo/march/seeds.h>
#include <igeo/metric/grid_sampling.h>
#include <igeo/path/trace.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/mesh_band.h>
#include <igeo/surface/point_band.h>
#include <igeo/surface/rebuild.h>
#include <openvdb/tools/Composite.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/march_cases.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/pinned.h>
#include <support/shapes.h>

namespace igeo::test {
namespace {

constexpr double kH = 2.5;
/// The torus reaches 28 voxels from its origin: its last leaf is the last but one below 2^30.
constexpr std::int32_t kEnd = (1 << 30) - 40;
const Ijk kCorner{kEnd, -kEnd, kEnd};

openvdb::FloatGrid::Ptr torusAt(const Ijk& place) {
    return mapVoxels(*torusGrid(), [&](const Ijk& v) { return v + place; });
}

/// The torus at the origin with a seed and the distances from it.
struct AtOrigin : Pinned {
    Band band = bandOf(torusGrid(), kH);
    SurfacePoint seed = dyadicSeed(band, torusPoints()[0]);
    int order;
    Field field;

    explicit AtOrigin(int anOrder) : order(anOrder), field(marchFrom(band, {seed}, order)) {}
};

/// godunov: the same bits. jet starts from foot points, whose positions are rounded to 2^-23.
double rounding(const AtOrigin& home) { return roundingTolerance(home.field, home.order, 0); }

}  // namespace

TEST_CASE("far: level sets at the ends of the supported indices give the same distances") {
    for (const int order : {kJet, 1, 2}) {
        const AtOrigin home(order);
        for (const Ijk& by : {kCorner, -kCorner, Ijk{0, kEnd, 0}}) {
            const Band band = bandOf(torusAt(by), kH);
            const SurfacePoint seed = shifted(home.seed, home.band, band, by);
            const Field field = marchFrom(band, {seed}, order);
            CHECK(worstDifference(home.field, field, [&](const Ijk& v) { return v + by; }) <=
                  rounding(home));
        }
    }
}

TEST_CASE("far: paths are those at the origin but for the rounding of positions") {
    const AtOrigin home(kJet);
    const Band band = bandOf(torusAt(kCorner), kH);
    const Field field = marchFrom(band, {shifted(home.seed, home.band, band, kCorner)}, kJet);
    const Vec3d to = torusPoints()[1];
    const Path near = tracePath(home.field, nearestSurfacePoint(home.band, to));
    const Path far = tracePath(field, nearestSurfacePoint(band, to + Vec3d(kCorner)));
    CHECK(far.status == PathStatus::Reached);
    // 2^-23 voxels at each of some 60 vertices; the steps are good to 1e-3 (TraceOptions).
    CHECK(far.vertices.size() == near.vertices.size());
    CHECK(far.weightedLength == Approx(near.weightedLength).margin(1e-4));
    CHECK(far.distance == Approx(near.distance).margin(1e-5));
}

TEST_CASE("far: two pieces 2^31 voxels apart know nothing of each other") {
    const auto grid = torusAt(kCorner), other = torusAt(-kCorner);
    openvdb::tools::compReplace(*grid, *other);
    for (const int order : {kJet, 1, 2}) {
        const AtOrigin home(order);
        const Band band = bandOf(grid, kH);
        CHECK(band.size() == 2 * home.band.size());
        for (const Ijk& by : {kCorner, -kCorner}) {
            const Field field = marchFrom(band, {shifted(home.seed, home.band, band, by)}, order);
            CHECK(worstDifference(home.field, field, [&](const Ijk& v) { return v + by; }) <=
                  rounding(home));
            CHECK(sampleDistance(field, home.seed.pIndex - Vec3d(by)) == kInfinity);
        }
    }
    const Band band = bandOf(grid, kH);
    const Vec3d p = torusPoints()[0], q = torusPoints()[1];
    // From far away, by the search over all nodes.
    CHECK(nearestSurfacePoint(band, p + Vec3d(kCorner) * 1.5).snapDistance > kEnd / 2.0);
    expectError(Error::Kind::InvalidArgument, {"between points 0 and 1 a curve leaves"}, [&] {
        seedsAlong(band, {{p + Vec3d(kCorner), q - Vec3d(kCorner)}}, 1);
    });
    const Field field = march(band, {p + Vec3d(kCorner)}, kJet);
    const SurfaceMesh mesh = surfaceMesh(checkedLevelSet(torusGrid()), bandOf(torusGrid(), kH));
    CHECK(surfaceMesh(checkedLevelSet(grid), field).triangles.size() == 2 * mesh.triangles.size());
}

TEST_CASE("far: voxels at 2^30 and beyond are refused") {
    constexpr std::int32_t kLast = std::numeric_limits<std::int32_t>::max() - 7;
    for (const std::int32_t at : {1 << 30, -(1 << 30), kLast - 24, -kLast + 24})
        for (int axis = 0; axis < 3; ++axis) {
            Ijk by{};
            by[axis] = at;
            expectError(Error::Kind::BadInput, {"2^30", "grid 'torus'", "transform"}, [&] {
                auto grid = torusAt(by);
                grid->setName("torus");
                checkedLevelSet(grid);
            });
        }
    // One leaf alone at the very ends, where a neighbor has no number.
    for (const openvdb::Coord end : {openvdb::Coord::max(), openvdb::Coord::min()}) {
        const auto grid = torusGrid();
        grid->tree().setValueOn(end, 1.0f);
        expectError(Error::Kind::BadInput, {"2^30"}, [&] { checkedLevelSet(grid); });
    }
}

TEST_CASE("far: a world that is far away leaves distances bitwise") {
    const AtOrigin home(kJet);
    for (const openvdb::Vec3d& to : {openvdb::Vec3d(1e15, -1e12, 3), openvdb::Vec3d(-1e300)}) {
        const auto grid = torusGrid();
        grid->setTransform(rotatedTransform(1, {1, 2, 3}, 30, to));
        const Band band = bandOf(grid, kH);
        CHECK(worstDifference(home.field, marchFrom(band, {home.seed}, kJet)) == 0);
    }
}

TEST_CASE("far: volumes are rebuilt wherever the world has them") {
    const auto volumeAt = [](const openvdb::Vec3d& place, const openvdb::FloatGrid::Ptr& grid) {
        grid->setTransform(rotatedTransform(1, {0, 0, 1}, 0, place));
        LoadedGrid loaded;
        loaded.grid = grid;
        return loaded;
    };
    const LoadedGrid near = rebuilt(volumeAt(openvdb::Vec3d(0.0), torusGrid()), 0);
    const openvdb::Vec3d away(1e9, -1e12, 7);
    const LoadedGrid far = rebuilt(volumeAt(away, torusGrid()), 0);
    CHECK(far.grid->indexToWorld(openvdb::Vec3d(0.0)) == away);
    CHECK(far.grid->activeVoxelCount() == near.grid->activeVoxelCount());
    for (auto it = near.grid->cbeginValueOn(); it; ++it)
        REQUIRE(far.grid->tree().getValue(it.getCoord()) == *it);
    expectError(Error::Kind::BadInput, {"single precision", "131072", "transform"}, [&] {
        rebuilt(volumeAt(openvdb::Vec3d(0.0), torusAt({0, 1 << 20, 0})), 0);
    });
}

TEST_CASE("far: weights that lie beyond all indices do not cover the surface") {
    // A grid with voxels of 1e-9: the torus is at 1e10 of them.
    const Band band = bandOf(torusGrid(), kH);
    LoadedGrid weight;
    weight.grid = openvdb::FloatGrid::create(0.0f);
    editable(weight).tree().setValueOn({0, 0, 0}, 2.0f);
    editable(weight).setTransform(openvdb::math::Transform::createLinearTransform(1e-4));
    editable(weight).transform().postTranslate({1e9, 0, 0});
    weight.file = "weight.vdb";
    expectError(Error::Kind::BadInput, {"weight.vdb"}, [&] { sampleWeight(weight, band); });
}

TEST_CASE("far: meshes and clouds just within 2^30 voxels") {
    const Vec3d place{1 << 29, -(1 << 30) + 64.0, 3 << 20}, from{10, 0.25, 0.5};
    const Vec3d to{-3, 7, 6};
    // Positions are rounded to 2^-23 voxels, which may tip a decision of jet: 0.01 voxels.
    const auto same = [&](const Band& near, const Band& far) {
        const auto reach = [&](const Band& band, const Vec3d& at) {
            const Field field = march(band, {from + at}, kJet);
            CHECK(field.reached == band.size());
            return sampleDistance(field, nearestSurfacePoint(band, to + at).pIndex);
        };
        CHECK(reach(near, {}) > 10);
        CHECK(reach(far, place) == Approx(reach(near, {})).margin(0.01));
    };
    const auto move = [&](const Vec3d& p) { return p + place; };
    const TriangleMesh ball = sphereMesh({}, 10, 3);
    same(bandFromMesh(ball, 1, 1.8), bandFromMesh(test::moved(ball, move), 1, 1.8));

    const PointCloud cloud = sphereCloud(3000, 10, {});
    const auto bandOfCloud = [](const PointCloud& points) {
        return bandFromPoints(PointSurface(points), PointBandKind::Fits, 0.5, 1.8);
    };
    const Vec3d half = 0.5 * place;
    same(bandOfCloud(cloud),
         bandOfCloud(movedCloud(cloud, [&](const Vec3d& p) { return p + half; })));
}

}  // namespace igeo::test
