// Properties of any distance, on surfaces that nobody chose.
//
// Of the nodes that jet marches. Its values are off by a tenth of a voxel
// per crease, and radii are a few voxels, so the errors of smooth shapes are of no use as bounds.
#include <igeo/jet.h>
#include <igeo/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/field_checks.h>
#include <support/openvdb.h>
#include <support/random_surface.h>

namespace igeo::test {
namespace {

constexpr unsigned kSurfaces = 20;
/// Of random_surface.h: as wide as creases have to be to be seen on the grid, or none.
constexpr double kSmooth = 4, kSharp = 0;

/// A random surface with the fields of three seeds far apart, one by one and together.
struct RandomCase {
    Band band;
    std::vector<SurfacePoint> seeds;
    std::vector<Field> single;
    Field all;

    RandomCase(unsigned number, double blend) {
        const LevelSet levelSet = checkedLevelSet(randomLevelSet(number, blend));
        band = bandFromLevelSet(levelSet, std::sqrt(3.0));
        // On the outer surface: there may be cavities.
        const SurfacePoint first = nearestSurfacePoint(band, {30, 20, 10});
        seeds = spreadPoints(band, marchJet(band, {}, {first}), 3);
        for (const SurfacePoint& s : seeds) single.push_back(marchJet(band, {}, {s}));
        all = marchJet(band, {}, seeds);
    }
    double least(NodeIndex i) const {
        double d = kInfinity;
        for (const Field& f : single) d = std::min(d, f.distance[i]);
        return d;
    }
    std::vector<const Field*> fields() const { return {&single[0], &single[1], &single[2], &all}; }
};

/// |d_s(a) - d_s(b)| - d_a(b), the largest over seeds s and a and the nodes b.
double triangleMisfit(const RandomCase& c, Nodes nodes) {
    double worst = 0;
    for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t a = 0; a < 3; ++a) {
            if (a == s) continue;
            const double toA = sampleDistance(c.band, c.single[s], c.seeds[a].pIndex);
            for (std::size_t k = 0; k < c.band.size(); ++k) {
                const double toB = c.single[s].distance[k], between = c.single[a].distance[k];
                if ((nodes == Nodes::Marched && !c.band.inCore(NodeIndex(k))) || !(toB < kInfinity))
                    continue;
                worst = std::max(worst, std::abs(toA - toB) - between);
            }
        }
    return worst;
}

/// The largest of misfit(i) over the nodes that several seeds reach.
template <typename Misfit>
double worstOver(const RandomCase& c, Nodes nodes, const Misfit& misfit) {
    double worst = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        if ((nodes == Nodes::All || c.band.inCore(i)) && c.all.distance[i] < kInfinity)
            worst = std::max(worst, misfit(i));
    return worst;
}

/// |d - least of the single distances|, the largest.
double meetingMisfit(const RandomCase& c, Nodes nodes) {
    return worstOver(c, nodes,
                     [&](NodeIndex i) { return std::abs(c.all.distance[i] - c.least(i)); });
}

/// Distance from the seed of a node's label beyond that from the nearest seed, the largest.
double labelMisfit(const RandomCase& c, Nodes nodes) {
    return worstOver(
        c, nodes, [&](NodeIndex i) { return c.single[c.all.label[i]].distance[i] - c.least(i); });
}

/// A bucket is half a voxel wide: its nodes are solved without each other. A neighbour of an
/// earlier bucket bounds a value by the way from there, and 0.001 voxels.
constexpr double kBucket = 0.5 + 1e-3;
/// As for the straight line: some creases, each good for a tenth of a voxel or two.
constexpr double kTriangle = 0.5;
/// Fronts of two seeds are never fitted together, but a node between them sees fewer neighbours: as
/// far as fits over fewer neighbours differ, which is what the guard allows for (0.01) and what
/// creases leave open (a tenth).
constexpr double kMeeting = 0.15;
/// A node takes the label of one of its neighbours, sqrt(3) voxels away at most, and over a voxel
/// the distances from seeds whose fronts are taken for one part by 2 sin(45 degrees / 2).
const double kLabel = 2 * std::sin(M_PI / 8) * std::sqrt(3.0);

/// Holds the marched nodes of every smooth surface against a bound, and prints the worst of them.
void checkMisfit(const char* what, double (*misfit)(const RandomCase&, Nodes), double bound) {
    double worst = 0;
    for (unsigned number = 1; number <= kSurfaces; ++number) {
        const double now = misfit(RandomCase(number, kSmooth), Nodes::Marched);
        INFO("surface " << number);
        CHECK(now < bound);
        worst = std::max(worst, now);
    }
    std::printf("random surfaces: %s off by %.3f voxels\n", what, worst);
}

}  // namespace

TEST_CASE("random surfaces: every value is a distance") {
    FieldChecks worst;
    for (const double blend : {kSmooth, kSharp})
        for (unsigned number = 1; number <= kSurfaces; ++number) {
            const RandomCase c(number, blend);
            for (const Field* field : c.fields()) {
                const FieldChecks now = checkField(c.band, *field, Nodes::Marched);
                INFO("surface " << number << ", blend " << blend << ", seeds "
                                << field->seeds.size());
                CHECK(field->reached > c.band.size() / 2);
                CHECK(now.notNumbers == 0);
                CHECK(now.missed == 0);
                CHECK(now.negative == 0);
                CHECK(now.stuck == 0);
                // Next to creases foot points, and ways over them, are off by parts of a voxel.
                CHECK(now.shortcut < 0.5);
                worst.shortcut = std::max(worst.shortcut, now.shortcut);
                if (blend == kSharp) continue;
                CHECK(now.jump < kBucket);
                worst.jump = std::max(worst.jump, now.jump);
            }
        }
    std::printf("random surfaces: at most %.3f below the straight line, %.3f beyond the way\n",
                worst.shortcut, worst.jump);
}

TEST_CASE("random surfaces: triangle inequality") {
    checkMisfit("triangle inequality", triangleMisfit, kTriangle);
}

TEST_CASE("random surfaces: several seeds give the least of their single distances") {
    checkMisfit("several seeds", meetingMisfit, kMeeting);
}

TEST_CASE("random surfaces: nodes that are not marched keep the bounds on distances") {
    // Not that between neighbours: beside a groove narrower than two voxels they belong to two
    // faces.
    FieldChecks worst;
    double misfit = 0;
    for (unsigned number = 1; number <= kSurfaces; ++number) {
        const RandomCase c(number, kSmooth);
        INFO("surface " << number);
        for (const Field* field : c.fields()) {
            const FieldChecks now = checkField(c.band, *field, Nodes::All);
            CHECK(now.negative == 0);
            CHECK(now.shortcut < 0.5);
            worst.shortcut = std::max(worst.shortcut, now.shortcut);
        }
        CHECK(meetingMisfit(c, Nodes::All) < 0.5);
        misfit = std::max(misfit, meetingMisfit(c, Nodes::All));
    }
    std::printf(
        "random surfaces, all nodes: %.3f below the straight line, several seeds off by %.3f\n",
        worst.shortcut, misfit);
}

TEST_CASE("random surfaces: labels are those of a nearest seed") {
    for (unsigned number = 1; number <= kSurfaces; ++number) {
        const RandomCase c(number, kSmooth);
        const double marched = labelMisfit(c, Nodes::Marched);
        const double all = labelMisfit(c, Nodes::All);
        std::printf("random surface %u: labels off by %.3f, by %.3f beside marched nodes\n", number,
                    marched, all);
        INFO("surface " << number);
        CHECK(marched < kLabel);
        CHECK(all < kLabel);
    }
}

TEST_CASE("random surfaces: d falls along every path") {
    for (unsigned number = 1; number <= kSurfaces; ++number) {
        const RandomCase c(number, kSmooth);
        for (const Field* field : c.fields()) {
            const PathChecks p = checkPaths(c.band, *field);
            INFO("surface " << number << ", seeds " << field->seeds.size());
            CHECK(p.lost == 0);
            CHECK(p.rise < 0.1);
        }
    }
}

TEST_CASE("random surfaces: creases and narrow grooves") {
    for (unsigned number = 1; number <= kSurfaces; ++number) {
        const RandomCase c(number, kSharp);
        INFO("surface " << number);
        for (const Field* field : c.fields())
            CHECK(checkField(c.band, *field, Nodes::Marched).jump < kBucket);
        // Twice the creases.
        CHECK(triangleMisfit(c, Nodes::Marched) < 2 * kTriangle);
        // The guard solves at creases, and it is of first order.
        CHECK(meetingMisfit(c, Nodes::Marched) < 0.5);
        CHECK(labelMisfit(c, Nodes::Marched) < kLabel);
    }
}

}  // namespace igeo::test
