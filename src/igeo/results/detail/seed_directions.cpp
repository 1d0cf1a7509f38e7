#include <igeo/results/detail/seed_directions.h>

#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace igeo {

namespace {

/// A slope further along: it falls as geodesics spread.
float spread(float slope, float along) {
    constexpr float kLeast = 0.5f;
    return slope / std::max(kLeast, 1 + std::abs(slope) * along);
}

/// The angle between the departures of two geodesics that pass each other at a distance: exact
/// around a seed in the plane.
/// @param a, b  slopes of the two
float angleBetween(float left, float a, float b) {
    constexpr float kMost = 0.9f;
    const bool fan = a * b > 0 && std::abs(a) < 2 * std::abs(b) && std::abs(b) < 2 * std::abs(a);
    const float mean = fan ? 2 * a * b / (a + b) : (a + b) / 2;
    return 2 * std::asin(std::clamp(left * mean / 2, -kMost, kMost));
}

}  // namespace

void SeedDirections::addNeighbor(NodeIndex i, const Chart& here, NodeIndex core, const Vec3f& chord,
                                 FrontNeighbors& all) const {
    constexpr float kOneWay = 0.9f, kEven = 1.3f;
    const NodeIndex j = nodes_[core], own = band_.coreNode(i);
    if (!measured_[core].known() || frames_.label(j) != frames_.label(i)) return;
    // Over the seam of a one-sided mesh normals oppose: seen from the other side, left is right.
    Vec3f normal = band_.normal[j];
    const bool isTurned = dot(here.frame.normal(), normal) < Band::kOtherSheet;
    if (isTurned) normal = -normal;
    const JetNeighbor n = flattened(here.frame, chord, normal, dot(here.frame.normal(), normal),
                                    normalized(frames_.gradient(j)), 0);
    const Vec2f g = normalized(n.g);
    const float there = frames_.weight(j), mean = (here.weight + there) / 2,
                cosine = dot(g, here.direction), size = length(n.a),
                rise = float(here.distance - frames_.distance(j)),
                slope = isTurned ? -measured_[core].slope : measured_[core].slope;
    FrontNeighbor found{core,
                        1 / (size * size + 0.1f),
                        mean * n.a,
                        mean * dot(g, n.a),
                        mean * cross(g, n.a),
                        0,
                        0,
                        rise,
                        slope,
                        false,
                        chord};
    const bool mayBend = mayBend_[core] || (own != kNoNode && mayBend_[own]);
    if (!mayBend && cosine < jet::kSameFront) return;
    const bool even = there < kEven * here.weight && here.weight < kEven * there;
    if (!mayBend || (even && cosine > kOneWay)) {
        const Vec2f way = normalized(g + here.direction);
        found.along = dot(way, found.vector), found.left = -cross(way, found.vector);
    } else {
        // The geodesic bends where the plane fronts at both ends agree, `back` from the node.
        constexpr float kBeyond = 0.2f;
        const float back = (rise - there * dot(g, n.a)) / (here.weight - there * cosine);
        const Vec2f before = n.a - back * here.direction;
        const float ahead = dot(g, before);
        if (!(rise > 0 && back > -kBeyond && back < size + kBeyond && ahead > -kBeyond)) return;
        found.along = std::max(rise, 0.1f * mean * size);
        found.left = -there * cross(g, before);
        found.bends = true;
    }
    all.add(found);
}

FrontNeighbors SeedDirections::neighbors(NodeIndex i, const Chart& here) const {
    FrontNeighbors all;
    forLinks(core_, band_.coreNode(i), [&](NodeIndex core, const Ijk&, const Vec3f& chord, float) {
        addNeighbor(i, here, core, chord, all);
    });
    if (band_.facing[i] & Band::kBridged)
        forJumps(core_, band_.coreNode(i), [&](NodeIndex core, const Vec3f& chord) {
            addNeighbor(i, here, core, chord, all);
        });
    return all;
}

/// Whether geodesics may bend at a core node: beside a rim, an obstacle, a crease or a jump of the
/// weight.
bool SeedDirections::mayBendAt(NodeIndex core) const {
    constexpr float kEven = 1.1f;
    const NodeIndex i = nodes_[core];
    bool bends = !metric_.clear(i) || (band_.facing[i] & Band::kBridged) ||
                 core_.rims.isBesideOpen(core_, core);
    if (!bends && metric_.weighted())
        band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            bends = bends || frames_.weight(j) > kEven * frames_.weight(i) ||
                    frames_.weight(i) > kEven * frames_.weight(j);
        });
    if (!bends)
        forLinks(core_, core, [&](NodeIndex, const Ijk&, const Vec3f&, float cosine) {
            bends = bends || cosine < JetLink::kSmooth;
        });
    return bends;
}

/// Whether geodesics to a core node bend, there or before.
bool SeedDirections::bendBefore(NodeIndex core, const FrontNeighbors& all) const {
    constexpr float kShare = 0.1f;
    if (mayBend_[core]) return true;
    float bent = 0, sum = 0;
    for (const FrontNeighbor& n : all) {
        if (!(n.along > 0)) continue;
        const float w = n.weight * n.along * n.along / dot(n.vector, n.vector);
        sum += w;
        if (measured_[n.core].bent) bent += w;
    }
    return bent > kShare * sum;
}

/// The frame and the departure at a core node, from those of nodes with smaller distances.
void SeedDirections::carry(NodeIndex i) {
    const NodeIndex core = band_.coreNode(i);
    const Chart here = frames_.chart(core);
    SeedFrame frame;
    Departure found;
    if (frames_.fromSeed(i, here, frame)) {
        found = {frames_.measure(i, frame), float(1 / here.distance)};
    } else {
        const FrontNeighbors all = neighbors(i, here);
        found = fromNeighbors(all);
        found.bent = bendBefore(core, all) || !frames_.fromNeighbors(here, all, frame);
        if (!found.bent && found.known()) found.direction = frames_.measure(i, frame);
    }
    if (!found.bent) frames_.set(core, here, frame);
    measured_[core] = found;
}

/// The departure is constant along geodesics.
Departure SeedDirections::fromNeighbors(const FrontNeighbors& all) const {
    constexpr float kPull = 0.005f;
    constexpr int kRounds = 3;
    auto weightOf = [](const FrontNeighbor& n) {
        return n.weight * n.along * n.along / (n.along * n.along + n.left * n.left);
    };
    Vec2f from;
    auto angleOf = [&](const FrontNeighbor& n) {
        return angleFrom(from, measured_[n.core].direction);
    };
    float sum = 0, guess = 0;
    for (const FrontNeighbor& n : all) {
        if (!(n.along > 0)) continue;
        if (sum == 0) from = measured_[n.core].direction;
        const float w = weightOf(n);
        sum += w, guess += w * (n.bends ? n.slope : spread(n.slope, n.rise));
    }
    if (!(sum > 0)) return {};
    guess /= sum;
    float angle = 0, slope = 0;
    for (int round = 0; round < kRounds; ++round) {
        LineFit fit;
        for (const FrontNeighbor& n : all) {
            if (!(n.along > 0)) continue;
            // Geodesics that spread as in the plane: b_ij = (2 / s_i - rise) sin(turn / 2).
            const float turn = angleOf(n) - angle, sine = std::sin(turn / 2);
            if (round == 0 || n.bends)
                fit.add(weightOf(n), n.left, turn);
            else
                fit.add(weightOf(n), n.left + n.rise * sine, 2 * sine);
        }
        float change;
        fit.solve(kPull, guess, change, slope);
        angle += change;
    }
    float off = 0;
    for (const FrontNeighbor& n : all)
        if (n.along > 0)
            off += weightOf(n) *
                   (angleOf(n) - angleBetween(n.left, n.slope, n.bends ? n.slope : slope));
    return {turned(from, off / sum), slope};
}

/// Fits a line along the front to the angles of a core node and its neighbors; outliers get small
/// weights.
Departure SeedDirections::smooth(NodeIndex i) const {
    constexpr int kRounds = 3;
    constexpr float kScatter = 0.002f, kPull = 0.01f;
    const NodeIndex core = band_.coreNode(i);
    const Departure own = measured_[core];
    const Chart here = frames_.chart(core);
    SeedFrame frame;
    if (frames_.fromSeed(i, here, frame)) return own;
    struct Estimate {
        float weight, left, angle;
    };
    std::array<Estimate, 41> estimates;
    std::size_t count = 0;
    estimates[count++] = {1, 0, 0};
    for (const FrontNeighbor& n : neighbors(i, here)) {
        const Departure& there = measured_[n.core];
        if (n.bends) continue;
        if (own.bent) {
            estimates[count++] = {n.weight, n.left,
                                  angleFrom(own.direction, there.direction) -
                                      angleBetween(n.left, n.slope, own.slope)};
            continue;
        }
        // Laid flat around the seed, where geodesics are straight lines.
        const auto d = float(frames_.distance(nodes_[n.core]));
        const Vec2f at = (d + n.ahead) * there.direction +
                         n.aside * Vec2f{-there.direction.y, there.direction.x};
        estimates[count++] = {n.weight, -n.aside, angleFrom(own.direction, at)};
    }
    float angle = 0, slope = 0;
    for (int round = 0; round < kRounds; ++round) {
        LineFit fit;
        for (std::size_t k = 0; k < count; ++k) {
            const float r = round == 0 ? 0 : estimates[k].angle - angle - slope * estimates[k].left;
            fit.add(estimates[k].weight / std::sqrt(kScatter * kScatter + r * r), estimates[k].left,
                    estimates[k].angle);
        }
        fit.solve(kPull, 0, angle, slope);
    }
    const float before = own.bent ? own.slope : float(1 / here.distance);
    return {turned(own.direction, angle), before + slope, own.bent};
}

/// Between core nodes: the mean of the nearest and of all that agree with it.
Vec2f SeedDirections::interpolate(NodeIndex i) const {
    constexpr float kAgree = 0.98f;
    const Chart here = frames_.chartAtFoot(i);
    if (SeedFrame frame; frames_.fromSeed(i, here, frame)) return frames_.measure(i, frame);
    FrontNeighbors all;
    auto addAround = [&](NodeIndex core) {
        const NodeIndex j = nodes_[core];
        if (dot(here.frame.normal(), band_.normal[j]) >= Band::kOtherSheet && band_.joined(i, j) &&
            !metric_.blocked(band_, i, j))
            addNeighbor(i, here, core, Vec3f(band_.footPoint(i) - core_.footOf(core_.nodes[core])),
                        all);
    };
    const Vec3f f = band_.footOf(i);
    const Ijk low{floorToInt(f.x), floorToInt(f.y), floorToInt(f.z)};
    band_.forCorners(&BandLeaf::core, i, low, [&](NodeIndex k, unsigned) { addAround(k); });
    if (all.empty())
        band_.forNeighbors(&BandLeaf::core, i, [&](NodeIndex k, int, int, int) { addAround(k); });
    if (all.empty()) return {};
    auto estimate = [&](const FrontNeighbor& n) {
        const Departure& there = departures_[n.core];
        // Along the neighbor's geodesic: beyond rims directions of the band are less exact.
        return turned(there.direction, n.bends ? -n.left * there.slope
                                               : std::atan(n.aside * spread(there.slope, n.ahead)));
    };
    const Vec2f lead = estimate(*std::max_element(
        all.begin(), all.end(),
        [](const FrontNeighbor& a, const FrontNeighbor& b) { return a.weight < b.weight; }));
    Vec2f sum;
    for (const FrontNeighbor& n : all)
        if (const Vec2f v = estimate(n); dot(v, lead) > kAgree) sum = sum + n.weight * v;
    return normalized(sum);
}

Vec2f SeedDirections::position(NodeIndex i) const {
    if (!(field_.distance[i] < kInfinity)) return kNoPosition;
    const double d = frames_.chartAtFoot(i).distance;
    const NodeIndex core = band_.coreNode(i);
    const Vec2f v =
        core != kNoNode && !isMoved(core_, core) ? departures_[core].direction : interpolate(i);
    // At the seed itself there is no direction.
    if (d > 1e-6 && v.x == 0 && v.y == 0) return kNoPosition;
    return float(d) * v;
}

std::vector<Vec2f> SeedDirections::positions(Progress& progress) {
    progress.update("logmap", 0);
    std::vector<NodeIndex> order;
    for (const NodeIndex i : nodes_)
        if (frames_.arrival(i) < kInfinity) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](NodeIndex a, NodeIndex b) {
        return std::pair(frames_.arrival(a), a) < std::pair(frames_.arrival(b), b);
    });
    auto forAll = [&](auto& out, double from, double to, const auto& value) {
        Steps steps(progress, "logmap", out.size(), from, to);
        parallelFor(out.size(), 1024, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) out[k] = value(NodeIndex(k));
            steps.add(end - begin);
        });
    };
    mayBend_.resize(nodes_.size());
    forAll(mayBend_, 0, 0.05, [&](NodeIndex k) { return mayBendAt(k); });
    constexpr std::size_t kAtOnce = 4096;
    Steps carrying(progress, "logmap", order.size(), 0.05, 0.6);
    for (std::size_t k = 0; k < order.size(); k += kAtOnce) {
        const std::size_t end = std::min(k + kAtOnce, order.size());
        for (std::size_t n = k; n < end; ++n) carry(order[n]);
        carrying.add(end - k);
        progress.throwIfCancelled();
    }
    departures_.resize(nodes_.size());
    forAll(departures_, 0.6, 0.85,
           [&](NodeIndex k) { return measured_[k].known() ? smooth(nodes_[k]) : Departure{}; });
    std::vector<Vec2f> positions(band_.size());
    forAll(positions, 0.85, 1, [&](NodeIndex i) { return position(i); });
    return positions;
}

}  // namespace igeo
