#include <igeo/march/detail/jet_march.h>

#include <igeo/band/detail/chord.h>

#include <algorithm>

// Beyond links: over two of them, and over jumps.
namespace igeo {

namespace {
/// How much longer walks may be than the chord of a jump, voxels.
constexpr double kWalkRoom = 0.1;
}  // namespace

JetGroup::Solution JetMarch::overTwoLinks(NodeIndex i, const JetRows::Row& row, const Batch& batch,
                                          JetGroup::Solution s) const {
    if (core_.band.triangles) return walkTwoLinks(i, row, s);
    constexpr float kAlike = 0.2f;
    constexpr float kShorter = 0.25f;   // voxels: than its chord no unfolded line is
    constexpr float kInPlane = 0.1f;    // voxels
    constexpr float kAbove = 1e-3f;     // voxels
    constexpr float kRounding = 1e-3f;  // voxels
    constexpr double kOff = 0.15;       // voxels
    const JetNode& here = core_.nodes[i];
    const TangentFrame frame(here.normal, core_.band.faceted);
    const Ijk voxel = core_.voxelOf(here);
    const Vec3d foot = core_.footOf(here);
    // A path goes on to a neighbor, so one has to lie lower. All neighbors of a node on the edge
    // itself may be beyond it: it gets a value just above the least of them.
    float least = float(kInfinity);
    for (std::size_t k = 0; k < row.knownCount; ++k)
        least = std::min(least, valueIn(batch, row.knownLink(k).node()) / here.weight);
    std::vector<NodeIndex> seen;  // from several neighbors
    seen.reserve(JetLinks::kMax);
    const auto lower = [&](NodeIndex k) {
        const float value = valueIn(batch, k) / here.weight;
        if (!(value < s.u) || std::find(seen.begin(), seen.end(), k) != seen.end()) return;
        seen.push_back(k);
        const JetNode& other = core_.nodes[k];
        if (other.obstacleState != Metric::Clear) return;
        const Vec3f chord = here.foot - other.foot - Vec3f(core_.voxelOf(other) - voxel);
        const float cosine = dot(here.normal, other.normal);
        // A line over one edge is as long as its chord at least.
        if (!(value + length(chord) < s.u + (cosine < kAlike ? kRounding : kShorter))) return;
        const Vec2f a = frame.unfold(chord, other.normal, cosine);
        float u;
        if (cosine < kAlike) {
            u = value + float(overOneEdge(core_.band, foot - Vec3d(chord), foot,
                                          Vec3d(other.normal), Vec3d(here.normal)));
        } else {
            const bool inPlane = std::abs(dot(other.normal, chord)) < kInPlane;
            u = value + length(a);
            if (inPlane) u = std::max(u, least + kAbove);
        }
        if (!(u > least && u < s.u && length(a) > 0) ||
            (cosine >= kAlike && !staysNearPsi(core_.band, foot, -Vec3d(chord), 3, kOff)))
            return;
        s.u = u, s.g = (1 / length(a)) * a, s.source = jets_.labelOf(k);
    };
    for (std::size_t k = 0; k < row.knownCount; ++k) forAccepted(row.knownLink(k).node(), lower);
    return s;
}

template <typename Visit>
void JetMarch::forAccepted(NodeIndex i, const Visit& visit) const {
    const auto isAccepted = [&](NodeIndex j) { return jets_.accepted(j); };
    const auto ifAccepted = [&](NodeIndex j) {
        if (isAccepted(j)) visit(j);
    };
    // A single march drops the rows of what it has left behind.
    if (!core_.links.empty())
        for (const JetLink& link : core_.links.row(i)) ifAccepted(link.node());
    else
        forLinks(
            core_, i, [&](NodeIndex j, const Ijk&, const Vec3f&, float) { ifAccepted(j); },
            isAccepted);
}

std::vector<JetMarch::From> JetMarch::fromTwoLinks(NodeIndex i, const JetRows::Row& row,
                                                   double most, double around) const {
    const double weight = core_.nodes[i].weight;
    const Vec3d foot = core_.footOf(core_.nodes[i]);
    std::vector<From> from;
    const auto add = [&](NodeIndex k) {
        const double u = jets_.valueOf(k);
        if (u > most || k == i || core_.nodes[k].obstacleState != Metric::Clear) return;
        const double chord = length(core_.footOf(core_.nodes[k]) - foot);
        if (u + weight * chord > most) return;
        from.push_back({u + weight * chord, (most - u) / weight + around, k});
    };
    for (std::size_t k = 0; k < row.knownCount; ++k) {
        add(row.knownLink(k).node());
        forAccepted(row.knownLink(k).node(), add);
    }
    return from;
}

bool JetMarch::mayBeFinal(NodeIndex i, const std::vector<From>& from) const {
    const auto first = std::min_element(from.begin(), from.end());
    return first != from.end() && fromStart(first->least) < slackOf(i);
}

JetGroup::Solution JetMarch::walkTwoLinks(NodeIndex i, const JetRows::Row& row,
                                          JetGroup::Solution s) const {
    constexpr double kAround = 0.25;  // voxels: walks that are longer, but beside one another
    const float weight = core_.nodes[i].weight;
    std::vector<From> from =
        fromTwoLinks(i, row, batchStart_ + double(s.u) * double(weight), kAround);
    if (!mayBeFinal(i, from)) return s;
    const Jump least = firstByWalks(i, std::move(from), kAround);
    if (least.u < s.u * weight) s.u = least.u / weight, s.g = least.g, s.source = least.label;
    return s;
}

JetGroup::Solution JetMarch::solveByWalks(NodeIndex i, const JetRows::Row& row,
                                          JetGroup::Solution s) const {
    constexpr double kAround = 0.5;  // voxels: later ends of segments
    const float weight = core_.nodes[i].weight;
    double most = kInfinity;
    for (std::size_t k = 0; k < row.knownCount; ++k) {
        const JetLink& link = row.knownLink(k);
        most = std::min(most, jets_.valueOf(link.node()) + double(weight * length(link.a())));
    }
    std::vector<From> from = fromTwoLinks(i, row, most + kAround * double(weight), 0);
    if (!(s.u * weight < slackOf(i)) && !mayBeFinal(i, from)) return s;
    const Jump least = firstByWalks(i, std::move(from), kAround);
    if (!(least.u < float(kInfinity))) return s;
    s.u = least.u / weight, s.g = least.g, s.source = least.label, s.usedFallback = true;
    return s;
}

JetMarch::Jump JetMarch::firstByWalks(NodeIndex i, std::vector<From> from, double around) const {
    const JetNode& node = core_.nodes[i];
    const Vec3d up(node.normal);
    const Band& band = core_.band;
    const double weight = core_.largestCostAt(i);
    const SurfaceTriangles::Place place = band.footPlace(core_.inBand(node));
    const double side = sideOf(*band.triangles, place, up);
    JetsByWalks jets(band, core_.metric, place, weight);
    std::sort(from.begin(), from.end());
    from.erase(std::unique(from.begin(), from.end(),
                           [](const From& a, const From& b) { return a.node == b.node; }),
               from.end());
    double least = kInfinity;
    for (const From& f : from) {
        if (f.least > least + around * weight) break;
        const NodeIndex other = core_.inBand(core_.nodes[f.node]);
        if (f.line && jets.isBlocked(other, f.line->length)) continue;
        const NodeJet jet{jets_.valueOf(f.node), jets_.gradientOf(f.node), jets_.labelOf(f.node)};
        const double cost = core_.largestCostAt(f.node);
        least = std::min(least, f.line ? jets.add(*f.line, other, jet, cost)
                                       : jets.add(other, jet, cost, f.most));
    }
    Jump jump;
    for (const std::uint32_t source : jets.sources()) {
        const JetsByWalks::First first = jets.first(source);
        const float u = fromStart(first.distance);
        if (!(u < jump.u)) continue;
        const Vec2f g =
            core_.localFrame(i).frame.flat(Vec3f(turned(first.direction, side * first.normal, up)));
        jump = {u, length(g) > 0 ? (1 / length(g)) * g : Vec2f{}, source};
    }
    return jump;
}

NodeIndex JetMarch::nodeAlong(NodeIndex i, Vec3f direction, float far) const {
    constexpr float kAlong = 0.4f, kAside = 0.75f;  // voxels
    Vec3f aside{};                                  // from the straight line
    NodeIndex at = i;
    while (far > 0) {
        const Vec3f& n = core_.nodes[at].normal;
        direction = normalized(direction - dot(direction, n) * n);
        NodeIndex next = kNoNode;
        float least = kAside, step = 0;
        Vec3f off;
        forLinks(core_, at, [&](NodeIndex j, const Ijk&, const Vec3f& chord, float) {
            const float along = -dot(chord, direction);
            if (along < kAlong) return;
            const Vec3f w = aside - chord - along * direction, flat = w - dot(w, n) * n;
            if (const float l = length(flat); l < least)
                least = l, next = j, step = along, off = flat;
        });
        if (next == kNoNode) return kNoNode;
        at = next, far -= step, aside = off;
    }
    return at;
}

bool JetMarch::isConfirmedBehind(NodeIndex i, const JetGroup::Solution& s, float sameWay) const {
    constexpr float kFar = 2;      // voxels
    constexpr float kOff = 0.02f;  // of the chord to the node
    const LocalFrame local = core_.localFrame(i);
    const Vec2f ahead = local.stretch.vectorBack(s.g);
    const NodeIndex j = nodeAlong(i, local.frame.lift((-1 / length(ahead)) * ahead), kFar);
    if (j == kNoNode || !jets_.accepted(j)) return false;
    const JetNode &here = core_.nodes[i], &other = core_.nodes[j];
    const Vec3f chord = here.foot - other.foot - Vec3f(core_.voxelOf(other) - core_.voxelOf(here));
    const JetNeighbor n = stretched(
        local.stretch, flattened(local.frame, chord, other.normal, dot(here.normal, other.normal),
                                 (other.weight / here.weight) * jets_.gradientOf(j), 0));
    const float u = fromStart(jets_.valueOf(j)) / here.weight + dot(n.g, n.a);
    return dot(n.g, s.g) > sameWay && s.u > u - kOff * length(n.a);
}

JetMarch::Jump JetMarch::jumpTo(NodeIndex i) const {
    constexpr double kAround = 1;  // voxels: jumps that matter
    auto cost = [&](NodeIndex j) { return (core_.largestCostAt(i) + core_.largestCostAt(j)) / 2; };
    Jump jump;
    if (core_.band.triangles && isotropic_) {
        std::vector<From> from;
        forJumps(core_, i, [&](NodeIndex j, const Vec3f& chord) {
            if (!jets_.accepted(j)) return;
            const double far = double(length(chord));
            from.push_back({jets_.valueOf(j) + cost(j) * far, kBeforeTight * far + kWalkRoom, j});
        });
        forWays(core_, i, [&](NodeIndex j, const WalkEnds& line) {
            if (!jets_.accepted(j)) return;
            from.push_back({jets_.valueOf(j) + cost(j) * line.length, line.length, j, &line});
        });
        jump = firstByWalks(i, std::move(from), kAround);
        if (jump.u < float(kInfinity)) return jump;
    }
    // Across gaps, where there is no walk.
    forJumps(core_, i, [&](NodeIndex j, const Vec3f& chord) {
        if (!jets_.accepted(j) || isJumpBlocked(i, j, double(length(chord)))) return;
        const float u = fromStart(jets_.valueOf(j) + cost(j) * double(length(chord)));
        if (u < jump.u) jump = {u, {}, jets_.labelOf(j)};
    });
    return jump;
}

bool JetMarch::isJumpBlocked(NodeIndex i, NodeIndex j, double walk) const {
    const Metric& metric = core_.metric;
    if (!metric.obstacles) return false;
    const JetNode &to = core_.nodes[i], &from = core_.nodes[j];
    const Vec3d p = core_.footOf(to), q = core_.footOf(from);
    if (!metric.obstacles->mayBeNear(p, walk)) return false;
    return metric.blocked(q, p, normalized(Vec3d(to.normal + from.normal))) ||
           (core_.band.triangles && isotropic_ &&
            JetsByWalks(core_.band, metric, core_.band.footPlace(core_.inBand(to)), 1)
                .isBlocked(core_.inBand(from), walk));
}

void JetMarch::enqueueJumps(NodeIndex from, const Result& jet, const Batch& batch, Chunk& chunk) {
    forJumps(core_, from, [&](NodeIndex j, const Vec3f& chord) {
        if (jets_.accepted(j)) return;
        const double cost = (core_.largestCostAt(from) + core_.largestCostAt(j)) / 2;
        put(j, jet.u + float(cost) * length(chord), batch, chunk);
    });
    forWays(core_, from, [&](NodeIndex j, const WalkEnds& line) {
        if (jets_.accepted(j)) return;
        const double cost = (core_.largestCostAt(from) + core_.largestCostAt(j)) / 2;
        put(j, jet.u + float(cost * line.length), batch, chunk);
    });
}

}  // namespace igeo
