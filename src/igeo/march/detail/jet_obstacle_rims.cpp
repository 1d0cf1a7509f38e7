#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

// Nodes at the rims and corners of obstacles.
namespace igeo {

namespace {

constexpr std::uint32_t kNoRim = ~0u;  ///< a node that is not on a rim
/// How far outside of an obstacle a node on its rim is: so far that steps of 1.5 voxels along a rim
/// with a radius of 6 voxels stay outside. Voxels.
constexpr float kRimOff = 0.05f;

/// The largest part t of a range from 0 to 1 for which `holds(t)`, if it does up to there and
/// nowhere beyond, to a thousandth.
template <typename Holds>
double lastOf(const Holds& holds) {
    double yes = 0, no = 1;
    for (int round = 0; round < 10; ++round) {
        const double t = (yes + no) / 2;
        (holds(t) ? yes : no) = t;
    }
    return yes;
}

/// How far a point goes from `from` along `step` before an obstacle, as a part of the step.
float freePart(const Metric& metric, const Vec3d& from, const Vec3f& step, const Vec3d& normal) {
    return float(lastOf([&](double t) {
        const Vec3d p = from + Vec3d(float(t) * step);
        return !metric.blocked(p, p, normal);
    }));
}

/// A node inside an obstacle, or just outside of it, that moves onto its rim.
struct RimNode {
    std::size_t node;
    Vec3f inside, out;  ///< its foot point, and the direction to the rim along a link, unit
    float rim, length;  ///< how far the rim is, and the node outside
    float off;          ///< of the moved foot point beyond the rim

    Vec3f foot() const { return inside + (rim + off) * out; }
};

/// The point of the rim nearest to a node inside an obstacle, on its links to nodes outside.
std::optional<RimNode> nearestRim(const JetCore& core, std::size_t k) {
    const JetNode& node = core.nodes[k];
    std::optional<RimNode> nearest;
    const std::uint32_t severed = core.severedSteps(node);
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            const JetNode& outside = core.nodes[j];
            if (outside.obstacleState == Metric::Inside ||
                severed & SeveredLinks::bit(dx, dy, dz) ||
                dot(node.normal, outside.normal) < Band::kOtherSheet)
                return;
            const Vec3f step = node.foot - outside.foot - Vec3f(Ijk{dx, dy, dz});
            const float free =
                freePart(core.metric, core.footOf(outside), step, Vec3d(node.normal));
            const float len = length(step), back = (1 - free) * len;
            if (back + kRimOff > len || (nearest && back >= nearest->rim)) return;
            nearest = {k, node.foot, (-1 / len) * step, back, len, kRimOff};
        });
    return nearest;
}

/// The point of the rim nearest to a node outside an obstacle, on its links to nodes inside, if it
/// is nearer than nodes are that move onto the rim: steps along it would be blocked.
std::optional<RimNode> closeRim(const JetCore& core, std::size_t k) {
    const JetNode& node = core.nodes[k];
    std::optional<RimNode> nearest;
    float least = kRimOff;
    const std::uint32_t severed = core.severedSteps(node);
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            const JetNode& inside = core.nodes[j];
            if (inside.obstacleState != Metric::Inside || severed & SeveredLinks::bit(dx, dy, dz) ||
                dot(node.normal, inside.normal) < Band::kOtherSheet)
                return;
            const Vec3f step = inside.foot + Vec3f(Ijk{dx, dy, dz}) - node.foot;
            const float len = length(step), ahead = freePart(core.metric, core.footOf(node), step,
                                                             Vec3d(inside.normal)) *
                                                    len;
            if (ahead >= least) return;
            least = ahead;
            nearest = {k, node.foot + (ahead / len) * step, (-1 / len) * step, 0, len, kRimOff};
        });
    if (!nearest) return {};
    // Between two obstacles it stays.
    const Vec3d moved = core.footOf(node) + Vec3d(nearest->foot() - node.foot);
    return core.metric.blocked(moved, moved, Vec3d(node.normal)) ? std::nullopt : nearest;
}

/// An order of positions that does not depend on the numbers of nodes.
template <typename T>
bool before(const Vec3<T>& a, const Vec3<T>& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// A corner of an obstacle.
struct Corner {
    Vec3d point, out;    ///< out: half-way between both sides, unit
    double off;          ///< so far outside a node is kRimOff off both sides
    NodeIndex neighbor;  ///< a core node beside it
};

/// The point of an obstacle that is highest over a step along S that it blocks, on one side of the
/// step. None where the obstacle goes on there, or is round and lower than what steps along balls
/// of 1.2 voxels cut off.
std::optional<Vec3d> highestOver(const Metric& metric, const Vec3d& a, const Vec3d& b,
                                 const Vec3d& normal, const Vec3d& out) {
    constexpr double kLeast = 0.02, kLeastRound = 0.2, kHighest = 1.2, kPassage = 0.3,
                     kBelow = 0.005, kWide = 0.1, kBeside = 0.02;
    const auto blocks = [&](double h) { return metric.blocked(a + h * out, b + h * out, normal); };
    // Above a narrow passage there may be another obstacle.
    double free = kHighest;
    while (blocks(free))
        if ((free -= kPassage) < kPassage / 2) return {};
    const double height = free * lastOf([&](double t) { return blocks(t * free); });
    if (height < kLeast) return {};
    const Vec3d from = a + (height - kBelow) * out, along = b - a;
    const double first =
        lastOf([&](double t) { return !metric.blocked(from, from + t * along, normal); });
    const double last = 1 - lastOf([&](double t) {
                            return !metric.blocked(from + (1 - t) * along, from + along, normal);
                        });
    // Over an end of the step the obstacle may go on.
    if (first < kBeside || last > 1 - kBeside) return {};
    // Just below its top a round one is wide.
    if (height < kLeastRound && (last - first) * length(along) > kWide) return {};
    return a + (first + last) / 2 * along + height * out;
}

/// The point of S next to a point, if that is nearer than a length.
std::optional<Vec3d> onSurface(const Band& band, const Vec3d& p, const Vec3f& normal, double most) {
    if (band.triangles) {
        const SurfaceTriangles::Place place = band.triangles->nearest(p, most);
        if (place.triangle == SurfaceTriangles::kNone) return {};
        return place.point;
    }
    const double psi = psiAt(band, p);
    if (!(std::abs(psi) <= most)) return {};
    return p - psi * Vec3d(normal);
}

/// The corner at a point of an obstacle: a small circle around it is blocked in one part, less than
/// half of it. That of a wall is in two parts, that of a side half of it. None where S bends or
/// ends there: the obstacle may go on over the edge.
/// @param up  away from the obstacle; parts on that side are of another, beyond a narrow passage
std::optional<Corner> cornerAt(const JetCore& core, const Vec3d& beside, const Vec3f& normal,
                               const Vec3d& up) {
    constexpr std::size_t kSides = 32, kMostBlocked = 15;
    constexpr double kRadius = 0.3, kMostOff = 0.16, kPi = std::numbers::pi, kOffChord = 0.25,
                     kOffPlane = 0.1;
    const auto found = onSurface(core.band, beside, normal, kOffChord);
    if (!found) return {};
    const Vec3d point = *found;
    const TangentFrame frame(normal);
    const auto at = [&](double k, double radii = 1) {
        const double angle = 2 * kPi * k / kSides;
        return point + radii * kRadius *
                           (std::cos(angle) * Vec3d(frame.axis(0)) +
                            std::sin(angle) * Vec3d(frame.axis(1)));
    };
    std::array<bool, kSides> blocked{};
    for (std::size_t k = 0; k < kSides; ++k) {
        if (!onSurface(core.band, at(double(k)), normal, kOffPlane)) return {};
        blocked[k] = core.metric.blocked(at(double(k)), at(double(k + 1)), Vec3d(normal));
    }
    std::size_t sides = 0, parts = 0;
    Vec3d inside{};
    for (std::size_t k = 0; k < kSides; ++k) {
        if (!blocked[k] || blocked[(k + kSides - 1) % kSides]) continue;
        std::size_t count = 0;
        Vec3d sum{};
        for (; blocked[(k + count) % kSides]; ++count) sum += at(double(k + count) + 0.5) - point;
        if (dot(sum, up) > 0) continue;
        sides = count, inside = sum, ++parts;
    }
    if (parts != 1 || sides > kMostBlocked) return {};
    // A point, as a single vertex, has no corner.
    bool goesOn = false;
    for (std::size_t k = 0; k < kSides && !goesOn; ++k)
        goesOn = core.metric.blocked(at(double(k), 2), at(double(k + 1), 2), Vec3d(normal));
    if (!goesOn) return {};
    const Vec3d out = -normalized(inside);
    const double off = std::min(double(kRimOff) / std::sin(kPi * double(sides) / kSides), kMostOff);
    const Vec3d moved = point + off * out;
    if (core.metric.blocked(moved, moved, Vec3d(normal))) return {};
    return Corner{point, out, off, kNoNode};
}

/// The corner that the step from a node to a neighbor cuts off.
std::optional<Corner> cornerBetween(const JetCore& core, NodeIndex i, NodeIndex j) {
    const bool swap = before(core.voxelOf(core.nodes[j]), core.voxelOf(core.nodes[i]));
    if (swap) std::swap(i, j);
    const JetNode &node = core.nodes[i], &other = core.nodes[j];
    const Vec3d a = core.footOf(node), b = core.footOf(other);
    const Vec3f normal = normalized(node.normal + other.normal);
    if (!core.metric.blocked(a, b, Vec3d(normal))) return {};
    const Vec3d across = normalized(cross(Vec3d(normal), b - a));
    for (const Vec3d& out : {across, -across})
        if (const auto point = highestOver(core.metric, a, b, Vec3d(normal), out))
            if (auto corner = cornerAt(core, *point, normal, out)) {
                corner->neighbor = i;
                return corner;
            }
    return {};
}

/// The corners that steps between nodes outside of obstacles cut off; most are found several times.
std::vector<Corner> findCorners(const JetCore& core) {
    constexpr double kNear = 1.8;  // voxels: the longest step
    std::vector<NodeIndex> beside;
    for (NodeIndex k = 0; k < core.nodes.size(); ++k)
        if (core.nodes[k].obstacleState == Metric::Beside &&
            core.metric.obstacles->mayBeNear(core.footOf(core.nodes[k]), kNear))
            beside.push_back(k);
    std::vector<std::vector<Corner>> found(beside.size());
    parallelFor(beside.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const JetNode& node = core.nodes[beside[k]];
            const std::uint32_t severed = core.severedSteps(node);
            core.band.forNeighbors(&BandLeaf::core, node.leaf, node.offset,
                                   [&](NodeIndex j, int dx, int dy, int dz) {
                                       const JetNode& other = core.nodes[j];
                                       if (j < beside[k] || other.obstacleState != Metric::Beside ||
                                           severed & SeveredLinks::bit(dx, dy, dz) ||
                                           dot(node.normal, other.normal) < Band::kOtherSheet)
                                           return;
                                       if (const auto corner = cornerBetween(core, beside[k], j))
                                           found[k].push_back(*corner);
                                   });
        }
    });
    std::vector<Corner> corners;
    for (const auto& of : found) corners.insert(corners.end(), of.begin(), of.end());
    std::sort(corners.begin(), corners.end(),
              [](const Corner& a, const Corner& b) { return before(a.point, b.point); });
    return corners;
}

/// Moves nodes to the corners of obstacles, so that fronts turn around these, not around nodes up
/// to a voxel outside: the nearest inside, which have no distance of their own, else the nearest.
/// @param rim      gets them
/// @param numbers  per core node: its place in `rim`, or kNoRim
void placeCorners(JetCore& core, std::vector<RimNode>& rim, std::vector<std::uint32_t>& numbers) {
    constexpr double kSame = 0.15, kInside = 1.2, kOutside = 0.8;
    std::vector<bool> isTaken(core.nodes.size());
    for (const Corner& corner : findCorners(core)) {
        const JetNode& neighbor = core.nodes[corner.neighbor];
        NodeIndex nearest = kNoNode;
        double least = kInside;
        bool isPlaced = false;
        const auto compare = [&](NodeIndex k, int, int, int) {
            const JetNode& node = core.nodes[k];
            if (isTaken[k]) isPlaced |= length(core.footOf(node) - corner.point) < kSame;
            if (isTaken[k] || node.obstacleState == Metric::Inside) return;
            const bool isInside = core.metric.inside(core.inBand(node));
            const Vec3f& own = isInside ? rim[numbers[k]].inside : node.foot;
            const double away = length(corner.point - Vec3d(core.voxelOf(node)) - Vec3d(own)) +
                                (isInside ? 0 : kInside - kOutside);
            if (away < least) least = away, nearest = k;
        };
        compare(corner.neighbor, 0, 0, 0);
        core.band.forNeighbors(&BandLeaf::core, neighbor.leaf, neighbor.offset, compare);
        if (isPlaced || nearest == kNoNode) continue;
        JetNode& node = core.nodes[nearest];
        if (numbers[nearest] == kNoRim) {
            numbers[nearest] = std::uint32_t(rim.size());
            rim.emplace_back();
        }
        const RimNode& moved =
            rim[numbers[nearest]] = {nearest,
                                     Vec3f(corner.point - Vec3d(core.voxelOf(node))),
                                     Vec3f(corner.out),
                                     0,
                                     1,
                                     float(corner.off)};
        node.foot = moved.foot();
        isTaken[nearest] = true;
    }
}

/// Whether the obstacle blocks the step from a node of the rim to a neighbor on the same side of
/// it: a small ball bends more between them than their distance from it allows.
/// @param numbers  per core node: its place in `rim`, or kNoRim
bool isStepBlocked(const JetCore& core, const std::vector<RimNode>& rim,
                   const std::vector<std::uint32_t>& numbers, const RimNode& here) {
    constexpr float kSameSide = 0.5f;  // of the directions outward: not through a thin wall
    const JetNode& node = core.nodes[here.node];
    const std::uint32_t severed = core.severedSteps(node);
    bool blocked = false;
    core.band.forNeighbors(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            if (blocked || numbers[j] == kNoRim || severed & SeveredLinks::bit(dx, dy, dz) ||
                dot(rim[numbers[j]].out, here.out) < kSameSide)
                return;
            const JetNode& other = core.nodes[j];
            blocked = core.metric.blocked(core.footOf(node), core.footOf(other),
                                          Vec3d(normalized(node.normal + other.normal)));
        });
    return blocked;
}

/// Moves nodes of the rim outward, by up to 0.16 voxels, until steps between them go around it.
void clearSteps(JetCore& core, std::vector<RimNode>& rim,
                const std::vector<std::uint32_t>& numbers) {
    constexpr int kRounds = 8;
    constexpr float kMore = 0.02f;
    std::vector<std::uint32_t> check(rim.size());
    std::iota(check.begin(), check.end(), 0);
    for (int round = 0; round < kRounds && !check.empty(); ++round) {
        std::vector<std::uint8_t> blocked(check.size());
        parallelFor(check.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                blocked[k] = isStepBlocked(core, rim, numbers, rim[check[k]]);
        });
        std::size_t left = 0;
        for (std::size_t k = 0; k < check.size(); ++k) {
            RimNode& node = rim[check[k]];
            if (!blocked[k] || node.rim + node.off + kMore > node.length) continue;
            node.off += kMore;
            core.nodes[node.node].foot = node.foot();
            check[left++] = check[k];
        }
        check.resize(left);
    }
}

}  // namespace

void placeRimNodes(JetCore& core) {
    std::vector<RimNode> rim;
    for (std::size_t k = 0; k < core.nodes.size(); ++k) {
        const auto state = core.nodes[k].obstacleState;
        if (state == Metric::Clear) continue;
        if (const auto found = state == Metric::Inside ? nearestRim(core, k) : closeRim(core, k))
            rim.push_back(*found);
    }
    for (const RimNode& moved : rim) {
        JetNode& node = core.nodes[moved.node];
        node.foot = moved.foot(), node.obstacleState = Metric::Beside;
    }
    std::vector<std::uint32_t> numbers(core.nodes.size(), kNoRim);
    for (std::size_t r = 0; r < rim.size(); ++r) numbers[rim[r].node] = std::uint32_t(r);
    placeCorners(core, rim, numbers);
    clearSteps(core, rim, numbers);
}

}  // namespace igeo
