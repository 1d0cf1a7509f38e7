#include "property.h"

#include <igeo/base/parallel.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/path/trace.h>
#include <support/errors.h>
#include <support/field_checks.h>
#include <support/march_cases.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

enum : unsigned { kUnits = 2, kTransform, kTurn, kWeight };

template <typename T>
double unequal(const std::vector<T>& a, const std::vector<T>& b) {
    if (a.size() != b.size()) return kInfinity;
    std::size_t count = 0;
    for (std::size_t k = 0; k < a.size(); ++k) count += a[k] != b[k];
    return double(count);
}
double unequalPlaces(const Band& a, const Band& b) {
    if (a.size() != b.size()) return kInfinity;
    double count = 0;
    for (NodeIndex i = 0; i < a.size(); ++i) count += a.placeOf(i).offset != b.placeOf(i).offset;
    return count;
}
double unequalBands(const Band& a, const Band& b) {
    return unequalPlaces(a, b) + unequal(a.psi, b.psi) + unequal(a.foot, b.foot) +
           unequal(a.normal, b.normal) + unequal(a.facing, b.facing) +
           std::abs(double(a.coreSize()) - double(b.coreSize()));
}
double unequalFields(const Field& a, const Field& b) {
    return unequal(a.distance, b.distance) + unequal(a.gradient, b.gradient) +
           unequal(a.label, b.label);
}
double unequalPaths(const std::vector<Path>& a, const std::vector<Path>& b) {
    if (a.size() != b.size()) return kInfinity;
    double count = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        std::vector<Vec3d> p, q;
        for (const PathVertex& v : a[k].vertices) p.push_back(v.pIndex);
        for (const PathVertex& v : b[k].vertices) q.push_back(v.pIndex);
        count += unequal(p, q) + (a[k].weightedLength != b[k].weightedLength);
    }
    return count;
}

Field godunov(const Band& band, const std::vector<SurfacePoint>& seeds) {
    GodunovOptions options;
    options.order = 1;
    return marchGodunov(band, {}, seeds, options);
}

/// Values of `grid`, which has the voxels of the case, that are not those of the case.
double unequalOn(const RandomCase& c, const openvdb::FloatGrid::Ptr& grid) {
    const Band band = bandOf(checkedLevelSet(grid));
    if (band.size() != c.band.size()) return kInfinity;
    return unequalBands(band, c.band) + unequalFields(marchJet(band, {}, c.seeds), c.all) +
           unequalFields(godunov(band, c.seeds), c.allGodunov);
}

double unitsOfTwo(const RandomCase& c) {
    Random random = c.random(kUnits);
    const int power = int(random.between(-6, 31));
    return unequalOn(c, inUnits(*c.psi, std::ldexp(1.0, power)));
}

double transformMoved(const RandomCase& c) {
    Random random = c.random(kTransform);
    const openvdb::Vec3d axis = random.direction(), to = random.direction();
    const double angle = random.between(0, 360), far = std::pow(10.0, random.between(0, 6));
    const double dx = c.band.transform.dx;
    auto moved = c.psi->deepCopy();
    moved->setTransform(rotatedTransform(dx, axis, angle, far * dx * to));
    return unequalOn(c, moved);
}

/// |a - b| at the marched nodes that both have.
double worstBetween(const Field& a, const Field& b, const Turn& turn) {
    const Band &band = *a.band, &other = *b.band;
    double worst = 0;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const NodeIndex j = other.nodeAt(turn(band.ijk(i)));
        // psi is rounded again, and may come to lie on the other side of h or of the core's edge.
        if (j == kNoNode || !band.inCore(i) || !other.inCore(j)) continue;
        if (a.distance[i] == b.distance[j]) continue;
        worst = std::max(worst, std::abs(a.distance[i] - b.distance[j]));
    }
    return worst;
}

std::vector<SurfacePoint> turned(const RandomCase& c, const Band& to, const Turn& turn) {
    std::vector<SurfacePoint> seeds = c.seeds;
    for (SurfacePoint& s : seeds) {
        s.node = to.nodeAt(turn(c.band.ijk(s.node)));
        s.pIndex = turn(s.pIndex);
    }
    return seeds;
}

double unitsOfAnySize(const RandomCase& c) {
    Random random = c.random(kUnits);
    const double factor = std::pow(10.0, random.between(-2, 3));
    const Band band = bandOf(checkedLevelSet(inUnits(*c.psi, factor)));
    const Field field = marchJet(band, {}, turned(c, band, {}));
    return worstBetween(c.all, field, {});
}

double axesTurned(const RandomCase& c) {
    Random random = c.random(kTurn);
    const Turn turn = allTurns()[std::size_t(random.between(1, 48))];
    const Band band = bandOf(checkedLevelSet(mapVoxels(*c.psi, turn)));
    if (band.size() != c.band.size()) return kInfinity;
    const Field field = marchJet(band, {}, turned(c, band, turn));
    return worstBetween(c.all, field, turn);
}
double axesTurnedGodunov(const RandomCase& c) {
    Random random = c.random(kTurn);
    const Turn turn = allTurns()[std::size_t(random.between(1, 48))];
    const Band band = bandOf(checkedLevelSet(mapVoxels(*c.psi, turn)));
    if (band.size() != c.band.size()) return kInfinity;
    const Field field = godunov(band, turned(c, band, turn));
    return worstBetween(c.allGodunov, field, turn) / c.allGodunov.maxDistance;
}

double threads(const RandomCase& c) {
    const auto targets = spreadPoints(c.all, 12);
    std::vector<Path> paths;
    double count = 0;
    for (const int number : {1, 2, 3}) {
        const ThreadLimit limit(number);
        const Band band = bandOf(c.levelSet);
        const Field field = marchJet(band, {}, c.seeds);
        const auto traced = tracePaths(field, targets);
        if (number == 1) paths = traced;
        count +=
            unequalBands(band, c.band) + unequalFields(field, c.all) + unequalPaths(traced, paths);
    }
    return count;
}

double weightOfFour(const RandomCase& c) {
    auto metric = std::make_shared<Metric>();
    metric->weight.assign(c.band.size(), 4);
    const Field jet = marchJet(c.band, metric, c.seeds);
    GodunovOptions options;
    options.order = 1;
    const Field g = marchGodunov(c.band, metric, c.seeds, options);
    double count = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        count += (jet.distance[i] != 4 * c.all.distance[i]) +
                 (g.distance[i] != 4 * c.allGodunov.distance[i]);
    return count;
}

/// Costs between 1 and 2 that change over ten voxels and more.
constexpr double kDearest = 2;
MetricPtr randomWeights(const RandomCase& c) {
    Random random = c.random(kWeight);
    const openvdb::Vec3d way = random.direction();
    const double phase = random.between(0, 6.28);
    auto metric = std::make_shared<Metric>();
    for (NodeIndex i = 0; i < c.band.size(); ++i) {
        const Vec3d p = c.band.footPoint(i);
        const double wave = std::sin(phase + 0.2 * dot(p, Vec3d{way.x(), way.y(), way.z()}));
        metric->weight.push_back(float((1 + kDearest) / 2 + (kDearest - 1) / 2 * wave));
    }
    return metric;
}

double weightsBelow(const RandomCase& c) {
    const Field field = marchJet(c.band, randomWeights(c), {c.seeds[0]});
    double worst = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        if (c.band.inCore(i) && field.distance[i] < kInfinity)
            worst = std::max(worst, c.single[0].distance[i] - field.distance[i]);
    return worst;
}
double weightsAbove(const RandomCase& c) {
    const Field field = marchJet(c.band, randomWeights(c), {c.seeds[0]});
    double worst = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        if (c.band.inCore(i) && c.single[0].distance[i] < kInfinity)
            worst = std::max(worst, field.distance[i] - kDearest * c.single[0].distance[i]);
    return worst;
}
double weightsBack(const RandomCase& c) {
    const MetricPtr metric = randomWeights(c);
    const SurfacePoint &a = c.seeds[0], &b = c.seeds[1];
    const auto far = [&](const SurfacePoint& from, const SurfacePoint& to) {
        return sampleDistance(marchJet(c.band, metric, {from}), to.pIndex,
                              Vec3d(c.band.normal[to.node]));
    };
    return std::abs(far(a, b) - far(b, a));
}
double weightsGodunov(const RandomCase& c) {
    GodunovOptions options;
    options.order = 1;
    const Field field = marchGodunov(c.band, randomWeights(c), {c.seeds[0]}, options);
    double worst = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        if (field.distance[i] < kInfinity)
            worst = std::max({worst, c.godunov[0].distance[i] - field.distance[i],
                              field.distance[i] - kDearest * c.godunov[0].distance[i]});
    return worst / field.maxDistance;
}

/// A rounding may tip which front a node belongs to where two meet (kMeeting in of_one_band.cpp);
/// elsewhere one that tips a fit changes a value by the 0.01 voxels within which its two answers
/// count as one.
const double kTipped = std::sqrt(3.0) * (1 - std::sqrt(0.5));
/// As without weights (kTooFar and kTooNear in of_one_band.cpp), at the largest weight.
constexpr double kOff = kDearest * (0.38 + 0.5);

}  // namespace

const std::vector<Property> kOfChanges{
    {"units times a power of two: bits", unitsOfTwo, 0},
    {"transform moved and turned: bits", transformMoved, 0},
    {"1, 2 and 3 threads: bits", threads, 0},
    {"weight 4 everywhere: four times the bits", weightOfFour, 0},
    {"units of any size", unitsOfAnySize, kTipped, kMeasured},
    {"axes turned and mirrored", axesTurned, kTipped, kMeasured},
    // Keys are rounded to 6e-8, and sums run in another order.
    {"godunov: axes turned and mirrored (share)", axesTurnedGodunov, 1e-5},
    {"weights of 1 to 2: below weight 1", weightsBelow, kOff, kMeasured},
    {"weights of 1 to 2: above weight 2", weightsAbove, kOff, kMeasured},
    {"weights of 1 to 2: there and back", weightsBack, kOff, kMeasured},
    // The scheme is monotone: more expensive everywhere is further everywhere.
    {"godunov: weights of 1 to 2 out of bounds (share)", weightsGodunov, 1e-5},
};

}  // namespace igeo::test
