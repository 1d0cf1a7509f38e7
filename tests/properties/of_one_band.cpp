#include "property.h"

#include <igeo/path/straighten.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

namespace igeo::test {
namespace {

/// The largest of misfit(i) over the nodes that are reached from all seeds together.
template <typename Misfit>
double worstOver(const RandomCase& c, Nodes nodes, const Misfit& misfit) {
    double worst = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        if ((nodes == Nodes::All || c.band.inCore(i)) && c.all.distance[i] < kInfinity)
            worst = std::max(worst, misfit(i));
    return worst;
}

double notNumbers(const RandomCase& c) { return double(c.everywhere.notNumbers); }
double missed(const RandomCase& c) { return double(c.everywhere.missed); }
double stuck(const RandomCase& c) { return double(c.everywhere.stuck); }
double negative(const RandomCase& c) { return double(c.everywhere.negative); }
double shortcut(const RandomCase& c) { return c.marched.shortcut; }
double shortcutAll(const RandomCase& c) { return c.everywhere.shortcut; }
double jump(const RandomCase& c) { return c.marched.jump; }

/// d beyond the shortest path from node to node over the core, from the start disc on: what a front
/// may step over, it has to.
double detour(const RandomCase& c) {
    const Field& field = c.single[0];
    const Band& band = c.band;
    std::vector<double> way(band.size(), kInfinity);
    using Entry = std::pair<double, NodeIndex>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    const auto offer = [&](NodeIndex i, double d) {
        if (d < way[i]) queue.push({way[i] = d, i});
    };
    for (NodeIndex i = 0; i < band.size(); ++i)
        if (band.inCore(i) && field.distance[i] <= field.startRadius) offer(i, field.distance[i]);
    while (!queue.empty()) {
        const Entry top = queue.top();
        queue.pop();
        const NodeIndex i = top.second;
        if (top.first > way[i]) continue;
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (band.inCore(j) && !band.severed(i, j)) offer(j, way[i] + wayBetween(band, i, j));
        });
    }
    return worstOver(c, Nodes::Marched, [&](NodeIndex i) { return field.distance[i] - way[i]; });
}

double between(const RandomCase& c, const std::vector<Field>& fields, std::size_t from,
               std::size_t to) {
    return sampleDistance(fields[from], c.seeds[to].pIndex, Vec3d(c.band.normal[c.seeds[to].node]));
}

double symmetry(const RandomCase& c, const std::vector<Field>& fields) {
    double worst = 0;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < a; ++b)
            worst = std::max(worst, std::abs(between(c, fields, a, b) - between(c, fields, b, a)));
    return worst;
}
double symmetryOfJet(const RandomCase& c) { return symmetry(c, c.single); }
double symmetryOfGodunov(const RandomCase& c) {
    return symmetry(c, c.godunov) / c.allGodunov.maxDistance;
}

/// |d_s(a) - d_s(b)| - d_a(b), over seeds s and a and all marched nodes b.
double triangle(const RandomCase& c) {
    double worst = 0;
    for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t a = 0; a < 3; ++a) {
            if (a == s) continue;
            const double toA = between(c, c.single, s, a);
            worst = std::max(worst, worstOver(c, Nodes::Marched, [&](NodeIndex b) {
                                 return std::abs(toA - c.single[s].distance[b]) -
                                        c.single[a].distance[b];
                             }));
        }
    return worst;
}

double severalSeeds(const RandomCase& c, Nodes nodes) {
    return worstOver(
        c, nodes, [&](NodeIndex i) { return std::abs(c.all.distance[i] - c.least(c.single, i)); });
}
double severalSeedsMarched(const RandomCase& c) { return severalSeeds(c, Nodes::Marched); }
double severalSeedsAll(const RandomCase& c) { return severalSeeds(c, Nodes::All); }

/// Distance from the seed of a node's label beyond that from the nearest seed.
double label(const RandomCase& c, Nodes nodes) {
    return worstOver(c, nodes, [&](NodeIndex i) {
        return c.single[c.all.label[i]].distance[i] - c.least(c.single, i);
    });
}
double labelMarched(const RandomCase& c) { return label(c, Nodes::Marched); }
double labelAll(const RandomCase& c) { return label(c, Nodes::All); }

double pathsLost(const RandomCase& c) { return double(c.paths.lost); }
double pathsRise(const RandomCase& c) { return c.paths.rise; }

/// The worst of misfit(path, distance at its target) over some paths to the first seed and to all.
template <typename Misfit>
double worstPath(const RandomCase& c, const Misfit& misfit) {
    double worst = 0;
    for (const Field* field : {&c.single[0], &c.all}) {
        const auto targets = spreadPoints(*field, 12);
        for (const Path& path : tracePaths(*field, targets))
            if (path.status == PathStatus::Reached) worst = std::max(worst, misfit(path, *field));
    }
    return worst;
}
double pathsStraight(const RandomCase& c) {
    return worstPath(c, [](const Path& path, const Field&) {
        return length(path.vertices.front().pIndex - path.vertices.back().pIndex) -
               path.weightedLength;
    });
}
double pathsLength(const RandomCase& c) {
    return worstPath(c, [](const Path& path, const Field&) {
        return std::abs(path.weightedLength - path.distance);
    });
}
double pathsStraightened(const RandomCase& c) {
    return worstPath(c, [&](Path path, const Field& field) {
        const double before = path.weightedLength;
        straighten(field, path);
        return path.weightedLength - before;
    });
}
double pathsShortest(const RandomCase& c) {
    // straighten.h: on a tube of R voxels lengths are 1 / (6 R^2) short.
    constexpr double kShort = 1 / (6 * kLeastRadius * kLeastRadius);
    return worstPath(c, [&](Path path, const Field& field) {
        straighten(field, path);
        return path.distance * (1 - kShort) - path.weightedLength;
    });
}

double godunovMissed(const RandomCase& c) {
    double worst = 0;
    for (const Field& field : c.godunov) {
        std::vector<bool> known(c.band.size());
        std::vector<NodeIndex> front{field.seeds[0].node};
        known[front[0]] = true;
        std::size_t count = 0;
        for (; !front.empty(); ++count) {
            const NodeIndex i = front.back();
            front.pop_back();
            for (int side = 0; side < 6; ++side) {
                const NodeIndex j = c.band.neighbor(i, Band::faceStep(side));
                if (j == kNoNode || known[j] || !c.band.linked(i, j)) continue;
                known[j] = true;
                front.push_back(j);
            }
        }
        worst = std::max(worst, std::abs(double(count) - double(field.reached)));
    }
    return worst;
}
double godunovShortcut(const RandomCase& c) {
    double worst = 0;
    for (std::size_t s = 0; s < 3; ++s)
        for (NodeIndex i = 0; i < c.band.size(); ++i)
            if (const double d = c.godunov[s].distance[i]; d < kInfinity)
                worst = std::max(worst, length(Vec3d(c.band.ijk(i)) - c.seeds[s].pIndex) - d);
    return worst;
}
double godunovSeveral(const RandomCase& c) {
    double worst = 0;
    for (NodeIndex i = 0; i < c.band.size(); ++i)
        if (const double d = c.allGodunov.distance[i]; d < kInfinity)
            worst = std::max(worst, d - c.least(c.godunov, i));
    return worst / c.allGodunov.maxDistance;
}

/// Nodes of one bucket, half a voxel wide, are solved without each other; a neighbor of an earlier
/// one bounds a value by the path from there and 0.001 voxels.
constexpr double kBucket = 0.5 + 1e-3;
/// On a tube of radius R the arc-corrected chord c / sinc(t/2) to a point t around it and z along
/// it, c^2 = (2 R sin(t/2))^2 + z^2, is longer than the geodesic, (R t)^2 + z^2: by 0.26 voxels at
/// most for c = 3.5 and R = kLeastRadius. The march adds a share of (1 / R)^2 that is 0.02 % at
/// R = 6 (tests/accuracy), so 0.3 % of 40 voxels.
constexpr double kTooFar = 0.26 + 0.12;
/// Foot points, and paths over them, are off by parts of a voxel beside creases and where S bends
/// within two voxels; nodes off the core take their jets from a voxel away, and as much again.
constexpr double kTooNear = 0.5;
/// Fronts of two seeds are never fitted together: a node between them may be left with one
/// neighbor of its own front, sqrt(3) voxels away at most, and up to 45 degrees off its direction.
const double kMeeting = std::sqrt(3.0) * (1 - std::sqrt(0.5));
/// A node takes the label of one of its neighbors, sqrt(3) voxels away at most, and over a voxel
/// the distances from seeds whose fronts are taken for one part by 2 sin(45 degrees / 2).
const double kLabel = 2 * std::sin(M_PI / 8) * std::sqrt(3.0);

}  // namespace

const std::vector<Property> kOfOneBand{
    {"values are numbers, gradients at most 1", notNumbers, 0},
    {"what is connected is reached", missed, 0},
    {"no distance is negative", negative, 0},
    {"every marched node has one below", stuck, 0},
    // Of additions.
    {"below the straight line", shortcut, 1e-9},
    {"below the straight line, all nodes", shortcutAll, 1e-9},
    {"neighbors further apart than their path", jump, kBucket},
    {"beyond the path from node to node", detour, kBucket},
    {"there and back", symmetryOfJet, kTooFar + kTooNear, kMeasured},
    {"triangle inequality", triangle, kTooFar + kTooNear, kMeasured},
    {"several seeds: the least", severalSeedsMarched, kMeeting, kMeasured},
    {"several seeds: the least, all nodes", severalSeedsAll, kLabel, kMeasured},
    {"label of a nearest seed", labelMarched, kLabel, kMeasured},
    {"label of a nearest seed, all nodes", labelAll, kLabel, kMeasured},
    {"paths lost", pathsLost, 0},
    {"paths: rise of the distance", pathsRise, 0},
    // Of additions.
    {"paths shorter than the straight line", pathsStraight, 1e-9},
    {"paths longer once straightened", pathsStraightened, 1e-9},
    // Where fronts meet a path goes from foot point to foot point for a voxel or so.
    {"paths: length against distance", pathsLength, kTooFar + kTooNear + 1, kMeasured},
    {"straightened paths below distance", pathsShortest, kTooFar, kMeasured},
    {"godunov: what is connected is reached", godunovMissed, 0},
    // The straight distance is convex, so its backward differences are at most its gradient: it is
    // a lower solution of the scheme, which is monotone. Keys are rounded to 6e-8.
    {"godunov: below the straight line", godunovShortcut, 1e-4},
    {"godunov: several seeds above the least (share)", godunovSeveral, 1e-5},
    // 4.2 % in each direction (docs/trials.md).
    {"godunov: there and back (share)", symmetryOfGodunov, 0.084, kMeasured},
};

}  // namespace igeo::test
