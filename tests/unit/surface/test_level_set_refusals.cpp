// Every refusal and warning of checkLevelSet, by kind and key phrases.
#include <igeo/surface/level_set_check.h>
#include <support/bad_inputs.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <algorithm>

namespace igeo::test {
namespace {

constexpr double kDx = 0.05;

openvdb::FloatGrid::Ptr soundSphere() { return makeLevelSet(sphere(kOffLattice, 1), kDx, 3); }

openvdb::FloatGrid::Ptr bad(const std::string& kind) {
    for (const BadInput& b : badInputs())
        if (b.kind == kind) return openvdb::gridPtrCast<openvdb::FloatGrid>(b.make().front());
    throw std::logic_error("no bad input " + kind);
}

/// Refusals say which grid of which file.
void expectRefusal(const openvdb::FloatGrid::Ptr& grid, std::vector<std::string> phrases) {
    phrases.insert(phrases.end(), {"test", "grid '" + grid->getName() + "'"});
    expectError(Error::Kind::BadInput, phrases, [&] { checkedLevelSet(grid); });
}

std::vector<std::string> warningsOf(const openvdb::FloatGrid::Ptr& grid) {
    return checkedLevelSet(grid).warnings;
}

bool anyHolds(const std::vector<std::string>& texts, const std::string& phrase) {
    return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
        return text.find(phrase) != std::string::npos;
    });
}

/// psi changed where `where` holds for the world position.
template <typename Where, typename Change>
openvdb::FloatGrid::Ptr changed(const Where& where, const Change& change) {
    auto grid = soundSphere();
    for (auto it = grid->beginValueOn(); it; ++it)
        if (where(grid->indexToWorld(it.getCoord()))) it.setValue(change(*it));
    return grid;
}

}  // namespace

TEST_CASE("checkLevelSet refuses transforms that do not keep distances") {
    expectRefusal(bad("nonuniform"), {"not cubes", "0.1", "resample"});
    expectRefusal(bad("sheared"), {"shears", "degrees, not 90", "resample"});
    expectRefusal(bad("frustum"), {"not linear", "resample"});
}

TEST_CASE("checkLevelSet refuses values that are no numbers") {
    expectRefusal(bad("nan"), {"NaN or infinite", "the first at index", "rebuild"});
    expectRefusal(bad("inf"), {"NaN or infinite"});
    auto one = soundSphere();
    one->tree().setValueOn({2, -6, 28}, std::numeric_limits<float>::quiet_NaN());
    expectRefusal(one, {"1 voxels are NaN", "2,-6,28"});
}

TEST_CASE("checkLevelSet refuses grids without a surface") {
    expectRefusal(bad("empty"), {"no active voxels"});
    expectRefusal(bad("positive"), {"positive everywhere", "rebuilt(psi, D)", "TriangleMesh"});
    auto inside = soundSphere();
    for (auto it = inside->beginValueOn(); it; ++it) it.setValue(-std::abs(*it));
    expectRefusal(inside, {"negative everywhere"});
    // Nothing near 0: both signs, but far apart.
    auto far = soundSphere();
    for (auto it = far->beginValueOn(); it; ++it)
        if (std::abs(*it) < 1.2f * float(kDx)) it.setValueOff();
    expectRefusal(far, {"no voxel lies within one voxel of the surface"});
}

TEST_CASE("checkLevelSet refuses values that are no distances") {
    expectRefusal(bad("scaled-values"), {"not a distance", "multiplied by the voxel size"});
    const auto everywhere = [](const openvdb::Vec3d&) { return true; };
    expectRefusal(changed(everywhere, [](float v) { return 2 * v; }), {"not a distance"});
    expectRefusal(changed(everywhere, [](float v) { return 0.8f * v; }),
                  {"not a distance", "per unit length (median)"});
    // Voxels of a size that makes the band too thin.
    expectRefusal(changed(everywhere, [](float v) { return 0.2f * v; }),
                  {"reach only 0.6 voxels", "world units"});
    // In voxel units, and next to the surface only: no voxel has six neighbors to judge it by.
    auto thin = soundSphere();
    for (auto it = thin->beginValueOn(); it; ++it) {
        if (std::abs(*it) > 0.5f * float(kDx)) it.setValueOff();
        it.setValue(*it / float(kDx));
    }
    expectRefusal(thin, {"not a distance", "no voxel has six active neighbors", "voxel units"});
}

TEST_CASE("checkLevelSet says of dense grids that they are clamped") {
    const auto clampedAt = [](float voxels) {
        auto grid = openvdb::FloatGrid::create(3 * float(kDx));
        grid->setTransform(openvdb::math::Transform::createLinearTransform(kDx));
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
        grid->setName("psi");
        const float most = voxels * float(kDx);
        for (auto at : openvdb::CoordBBox(openvdb::Coord(-28), openvdb::Coord(28))) {
            const auto psi = float(grid->indexToWorld(at).length() - 1);
            grid->tree().setValueOn(at, std::clamp(psi, -most, most));
        }
        return grid;
    };
    expectRefusal(clampedAt(3), {"not a distance", "psi is clamped: ", " of the voxels", "0.15",
                                 "switch off", "rebuilt()"});
    expectRefusal(clampedAt(0.5f), {"reach only 0.5 voxels", "psi is clamped: ", "switch off"});
}

TEST_CASE("checkLevelSet refuses what an open mesh becomes") {
    expectRefusal(bad("hollow"), {"hollow", "open mesh", "TriangleMesh"});
}

TEST_CASE("checkLevelSet warns of unreliable input and goes on") {
    auto unknown = soundSphere();
    unknown->setGridClass(openvdb::GRID_UNKNOWN);
    CHECK(anyHolds(warningsOf(unknown), "class is not 'level set'"));

    CHECK(anyHolds(warningsOf(bad("cut")), "lie at the edge of the volume"));
    CHECK(anyHolds(warningsOf(makeLevelSet(planePatch(kOffLattice, {0, 0.6, 0.8}, 1), kDx, 3)),
                   "lie at the edge of the volume"));

    // psi = 1.4 of the distance in a cap of a tenth of the sphere.
    const auto cap = [](const openvdb::Vec3d& p) { return (p - kOffLattice).z() > 0.8; };
    const auto rough = warningsOf(changed(cap, [](float v) { return 1.4f * v; }));
    CHECK(anyHolds(rough, "% of the voxels have |grad psi| outside"));

    // Half of the sphere unsigned, as an open mesh would be: the crossing voxels are half as many.
    const auto half = [](const openvdb::Vec3d& p) { return (p - kOffLattice).x() > 0; };
    CHECK(anyHolds(warningsOf(changed(half, [](float v) { return std::abs(v); })),
                   "parts of psi look hollow"));
}

TEST_CASE("checkLevelSet finds nothing wrong with sound surfaces") {
    for (const Shape& shape :
         {sphere(kOffLattice, 1), torus(kOffLattice, 1, 0.4), box(kOffLattice, {1, 0.8, 0.7}),
          cylinder(kOffLattice, 0.6, 0.7), twoSpheres({-2, 0, 0}, 1, {1, 0.1, 0}, 0.8)}) {
        const auto warnings = warningsOf(makeLevelSet(shape, kDx, 3));
        INFO(shape.name << ": " << (warnings.empty() ? "" : warnings.front()));
        CHECK(warnings.empty());
    }
}

TEST_CASE("checkLevelSet switches off active tiles far from the surface") {
    const LevelSet s = checkedLevelSet(bad("tiles"));
    CHECK(s.warnings.empty());
    CHECK(s.psi->tree().activeTileCount() == 0);
    CHECK(s.stats.gradientShare == 1);
}

TEST_CASE("checkLevelSet stops when it is canceled") {
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    LoadedGrid loaded;
    loaded.grid = soundSphere();
    expectError(Error::Kind::Cancelled, {}, [&] { checkLevelSet(loaded, stop); });
}

}  // namespace igeo::test
