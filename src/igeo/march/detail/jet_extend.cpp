#include <igeo/march/detail/jet_extend.h>

#include <igeo/band/detail/chord.h>
#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_two_fronts_fit.h>
#include <igeo/march/detail/mesh_read.h>

namespace igeo {

namespace jet {

bool Extension::isSimple(const Group& group, std::size_t lane) const {
    const NodeIndex i = group.nodes[lane].node;
    if (!group.corners.count[lane] || !group.corners.smooth[lane] || !metric_.clear(i))
        return false;
    const bool besideSevered = band_.facing[i] & Band::kBesideSevered;
    if (!besideSevered && jets_.label.empty()) return true;
    const std::uint32_t label = labelOf(group, lane);
    bool simple = true;
    for (std::size_t c = 0; c < group.corners.count[lane]; ++c) {
        const NodeIndex k = group.corners.node[c][lane];
        simple &= jets_.labelOf(k) == label && (!besideSevered || isJoined(i, core_.nodes[k]));
    }
    return simple;
}

void Extension::extendTo(Group& group, std::size_t lane, const CarriedJets& carried) const {
    const Outside& node = group.nodes[lane];
    const JetCorners& corners = group.corners;
    const NodeIndex i = node.node;
    if (metric_.inside(i)) {
        *node.to = {};
        return;
    }
    bool simple = isSimple(group, lane) && !mayMissFront(group, lane);
    Found s;
    if (simple && metric_.anisotropic()) {
        s = carryInPlane(group, lane);
    } else if (simple) {
        simple = carried.spreads[lane] || (carried.oneFront[lane] && !meetNear(group, lane));
        s = {jets_.buckets.startOf(corners.bucket[lane]) +
                 double(group.points.weight[lane] * carried.u[lane]),
             {carried.gx[lane], carried.gy[lane], carried.gz[lane]},
             labelOf(group, lane)};
    }
    if (simple)
        finishOrInDisc(node, s);
    else if (jets_.meetings && lifted_.empty())
        group.waiting.push_back(node);
    else
        addDoubtful(node, group);
}

void Extension::findCorners(Group& group) const {
    CellPoints& points = group.points;
    for (std::size_t lane = 0; lane < group.size; ++lane) {
        const Outside& node = group.nodes[lane];
        const Vec3f foot = band_.footOf(node.node);
        points.clearNodes(lane);
        band_.forCorners(&BandLeaf::core, node.leaf, node.offset,
                         {floorToInt(foot.x), floorToInt(foot.y), floorToInt(foot.z)},
                         [&](NodeIndex j, unsigned k) { points.node[k][lane] = j; });
    }
    for (std::size_t lane = group.size; lane < Lanes::kNodes; ++lane) points.clearNodes(lane);
}

void Extension::solve(Group& group) const {
    if (group.size == 0) return;
    findCells(group.feet, feetFromPsi_, group.points);
    if (group.slots) {
        gatherCorners(jets_, lifted_, group.points, *group.slots, group.corners);
    } else {
        findCorners(group);
        gatherCorners(jets_, lifted_, group.points, group.corners);
    }
    CarriedJets carried;
    if (!metric_.anisotropic()) carryFromCorners(group.corners, band_.faceted, carried);
    if (mayBePlain_) findValues(jets_, group.corners, carried, group.points.weight, group.feet);
    for (std::size_t lane = 0; lane < group.size; ++lane) {
        if (!mayBePlain_ || !isPlain(group, lane)) {
            extendTo(group, lane, carried);
            continue;
        }
        const double d = group.feet.value[lane];
        const float weight = group.points.weight[lane];
        NodeJet& to = *group.nodes[lane].to;
        if (d <= jets_.limit)
            to = {d,
                  {weight * carried.gx[lane], weight * carried.gy[lane], weight * carried.gz[lane]},
                  0};
        else
            to = {};
    }
    group.size = 0;
}

void Extension::begin(const Outside& node, Group& group) const {
    const std::size_t lane = group.size++;
    group.nodes[lane] = node;
    group.feet.offset[lane] = node.offset;
    if (feetFromPsi_)
        group.feet.psi[lane] = band_.psi[node.node];
    else
        group.feet.setFoot(lane, band_.foot[node.node]);
    group.points.setNormal(lane, band_.normal[node.node]);
    if (weighted_) group.points.weight[lane] = float(metric_.at(node.node));
    if (group.full()) solve(group);
}

void Extension::takeCore(LeafIndex l, std::span<const std::uint32_t> nodes, Group& group,
                         NodeJet* to) const {
    const NodeIndex first = band_.leaves[l].band.firstNode,
                    firstCore = band_.leaves[l].core.firstNode;
    if (!mayBePlain_) {
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const std::uint32_t n = nodes[k] >> 16, at = nodes[k] & 0xffff;
            const auto core = NodeIndex(firstCore + k);
            if (isMoved(core_, core))
                begin({first + n, l, at, to + n}, group);
            else
                to[n] = finished(first + n, ofCore(core, band_.leaves[l].origin + stepOf(at)));
        }
        return;
    }
    FootLanes& feet = group.feet;
    for (std::size_t begin = 0; begin < nodes.size(); begin += Lanes::kNodes) {
        const std::size_t count = std::min(Lanes::kNodes, nodes.size() - begin);
        for (std::size_t k = 0; k < count; ++k) feet.offset[k] = nodes[begin + k] & 0xffff;
        findCoreValues(jets_, lifted_, NodeIndex(firstCore + begin), feet);
        for (std::size_t k = 0; k < count; ++k) {
            const auto core = NodeIndex(firstCore + begin + k);
            NodeJet& jet = to[nodes[begin + k] >> 16];
            jet = {};
            if (!(feet.value[k] <= jets_.limit)) continue;
            jet.distance = feet.value[k], jet.gradient = gradientOf(core);
            if (weighted_) jet.gradient *= core_.nodes[core].weight;
        }
    }
}

void Extension::extendLeaf(LeafIndex l, const LeafCorners& corners, Group& group,
                           NodeJet* to) const {
    const Ijk origin = band_.leaves[l].origin;
    for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) group.feet.setLeaf(lane, origin);
    const std::span nodes(corners.nodes);
    group.slots.reset();
    takeCore(l, nodes.first(corners.coreCount), group, to);
    solve(group);
    const NodeIndex first = band_.leaves[l].band.firstNode;
    const CornerSlot* slots = corners.slots.data();
    const std::uint8_t* most = corners.most.data();
    for (std::size_t k = corners.coreCount; k < nodes.size();
         k += Lanes::kNodes, slots += *most++) {
        group.slots = std::span(slots, *most);
        for (const std::uint32_t node : nodes.subspan(k, std::min(Lanes::kNodes, nodes.size() - k)))
            begin({first + (node >> 16), l, node & 0xffff, to + (node >> 16)}, group);
        solve(group);
    }
}

void Extension::at(std::span<const NodeIndex> nodes, NodeJet* to) const {
    Group group;  // large: not to be cleared
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (nodes[n] == kNoNode) continue;
        const auto [l, at] = band_.placeOf(nodes[n]);
        const NodeIndex k = band_.leaves[l].core.node(at);
        if (k != kNoNode && !isMoved(core_, k)) {
            to[n] = finished(nodes[n], ofCore(k, band_.leaves[l].origin + stepOf(at)));
            continue;
        }
        group.feet.setLeaf(group.size, band_.leaves[l].origin);
        begin({nodes[n], l, at, to + n}, group);
    }
    finish(group);
}

void Extension::add(NodeIndex k, JetNeighbor jet, float cosine, const LocalFrame& local,
                    Around& around) const {
    constexpr float kSmooth = 0.9f;
    // Relative to the least start: near a source the solve takes u for the distance to it.
    jet.u = valueOf(k) - jets_.seeds.leastStart;
    if (local.weight != 1) jet.u /= local.weight;
    around.node[around.count++] = {jet, jets_.labelOf(k), cosine < kSmooth, k};
}

void Extension::addNeighbor(NodeIndex k, const Vec3f& chord, float cosine, const Vec3f& g,
                            const LocalFrame& local, Around& around) const {
    const JetNode& other = core_.nodes[k];
    const auto here = float(local.weight);
    add(k,
        core_.stretch.empty()
            ? flattened(local.frame, meanWeight(other.weight, here) * chord, other.normal, cosine,
                        g, 0)
            : stretched(local.stretch, flattened(local.frame, chord, other.normal, cosine,
                                                 (other.weight / here) * g, 0)),
        cosine, local, around);
}

void Extension::addNeighbor(const BoxLanes& box, std::size_t k, const LocalFrame& local,
                            Around& around) const {
    const NodeIndex j = box.node[k];
    if (box.cosine[k] >= laidOutFrom_)
        add(j, {{box.ax[k], box.ay[k]}, {box.gx[k], box.gy[k]}}, box.cosine[k], local, around);
    else
        addNeighbor(j, box.chord(k), box.cosine[k], gradientOf(j), local, around);
}

Around Extension::around(const Group& group, std::size_t lane, const LocalFrame& local) const {
    const NodeIndex i = group.nodes[lane].node;
    Around around;
    for (std::size_t c = 0; c < group.corners.count[lane]; ++c) {
        const NodeIndex k = group.corners.node[c][lane];
        addNeighbor(k, group.corners.chord(lane, c), dot(band_.normal[i], core_.nodes[k].normal),
                    group.corners.g(lane, c), local, around);
    }
    return around;
}

Extension::Found Extension::carryInPlane(const Group& group, std::size_t lane) const {
    const LocalFrame local = core_.localFrameInBand(group.nodes[lane].node);
    BlendWeights weight{};
    for (std::size_t c = 0; c < group.corners.count[lane]; ++c)
        weight[c] = group.corners.corner[c].weight[lane];
    const Jet jet = blendJets(around(group, lane, local).all(), weight);
    return fromChart(jet.u, jet.g, labelOf(group, lane), local);
}

Extension::Found Extension::inDisc(NodeIndex i, const Found& s) const {
    // The core around such a node has been reached from its seed, but maybe along another path,
    // around a wall.
    constexpr double kOtherPath = 1.2, kBlunt = 0.5, kDoubtful = 2;  // but kOtherPath: voxels
    const JetSeeds& seeds = jets_.seeds;
    const Vec3d foot = band_.footPoint(i);
    const LocalFrame local = core_.localFrameInBand(i);
    Solved best;
    double leastStart = kInfinity;
    auto visit = [&](std::size_t k) {
        const SurfacePoint& seed = seeds.points[k];
        if (seeds.source[k] != s.label) return;
        leastStart = std::min(leastStart, seed.start);
        const Vec3d from = seed.nearestTo(foot);
        Solved disc;
        if (metric_.blocked(from, foot, Vec3d(seed.normal)) ||
            (takesWalks(core_) &&
             !(leastOverWalk(core_, seeds, std::uint32_t(k), local, foot) < best.u)) ||
            !seedNeighborhoodJet(core_, seeds, std::uint32_t(k), local, foot, disc))
            return;
        const double longer = s.distance - seed.start - kOtherPath * (disc.u - seed.start);
        const bool inReach = length(foot - from) <= seeds.startRadius;
        if ((longer <= (inReach ? kBlunt * local.weight : 0) ||
             (inReach && longer <= kDoubtful * local.weight &&
              followsSurface(band_, from, foot))) &&
            disc.u < best.u)
            best = disc;
    };
    seeds.near.forNear(foot, visit);
    if (best.u < kInfinity && !overtakesDisc(core_, seeds, s.distance, best.u, local.weight, foot))
        return {best.u, local.frame.lift(best.g), best.label};
    Found other = s;
    if (leastStart < kInfinity) other.distance = std::max(s.distance, leastStart);
    return other;
}

bool Extension::gatherAround(Doubtful::Node& node, const LeafNumbers<2>* core, const Ijk& middle,
                             int reach) const {
    const Outside& at = node.at;
    BoxLanes box;
    if (core && core->holdsBox(at.offset, middle, reach))
        box.count = core->nodesOfBox(at.offset, middle, reach, box.node.data(), box.step.data());
    else
        band_.forBox(&BandLeaf::core, at.leaf, at.offset, middle, reach,
                     [&](NodeIndex k, const Ijk& step) { box.add(k, step - middle); });
    layOut(core_, lifted_, band_.footOf(at.node), middle, node.local, box);
    const bool clear = metric_.clear(at.node),
               mayBeApart = !clear || band_.facing[at.node] & Band::kBesideSevered;
    const std::uint32_t severed = mayBeApart ? band_.severedSteps(at.node) : 0;
    bool onSheet = false;
    box.forOnSheet([&](std::size_t k) {
        const JetNode& other = core_.nodes[box.node[k]];
        if (mayBeApart && (!isJoined(at, severed, middle + box.stepOf(k), other) ||
                           (!clear && isHidden(core_, other, band_.footPoint(at.node),
                                               node.local.frame.normal() + other.normal))))
            return;
        onSheet = true;
        if (jets_.accepted(box.node[k]) && !node.around.full())
            addNeighbor(box, k, node.local, node.around);
    });
    return onSheet;
}

void Extension::addWaiting(Group& group) const {
    std::vector<NodeIndex> meetings;
    for (const Outside& at : group.waiting)
        band_.forBox(&BandLeaf::core, at.leaf, at.offset, roundToIjk(Vec3d(band_.footOf(at.node))),
                     1, [&](NodeIndex k, const Ijk&) {
                         if (jets_.meetings->at(k)) meetings.push_back(k);
                     });
    if (!meetings.empty()) jets_.meetings->findAhead(jets_, meetings);
    for (const Outside& at : group.waiting) addDoubtful(at, group);
    group.waiting.clear();
}

Extension::Found Extension::byWalks(const Outside& at, const LocalFrame& local) const {
    constexpr int kReach = 2;
    constexpr double kMost = 5;  // voxels
    if (!band_.triangles || metric_.anisotropic() || !metric_.clear(at.node)) return {};
    std::vector<NodeIndex> nodes;
    band_.forBox(&BandLeaf::core, at.leaf, at.offset, {}, kReach, [&](NodeIndex k, const Ijk&) {
        if (jets_.accepted(k)) nodes.push_back(k);
    });
    if (nodes.empty()) return {};
    const SurfaceTriangles::Place place = band_.footPlace(at.node);
    JetsByWalks jets(band_, metric_, place, local.weight);
    for (const NodeIndex k : nodes) {
        const JetNode& node = core_.nodes[k];
        jets.add(core_.inBand(node), {valueOf(k), gradientOf(k), jets_.labelOf(k)}, node.weight,
                 kMost);
    }
    Found found;
    const Vec3d up(local.frame.normal());
    const double side = sideOf(*band_.triangles, place, up);
    for (const std::uint32_t source : jets.sources()) {
        const JetsByWalks::First first = jets.first(source);
        if (!(first.distance < found.distance)) continue;
        found = {first.distance, Vec3f(turned(first.direction, side * first.normal, up)), source};
    }
    return found;
}

void Extension::addDoubtful(const Outside& at, Group& group) const {
    Doubtful& doubtful = group.doubtful;
    const NodeIndex i = at.node;
    auto node = doubtful.make(at, core_.localFrameInBand(i));
    // Where the foot point is off, the core passes within two voxels all the same.
    const Ijk middle = roundToIjk(Vec3d(band_.footOf(i)));
    const LeafNumbers<2>* const core = numbersOf(group, at.leaf);
    if (!gatherAround(*node, core, middle, 1)) gatherAround(*node, core, {}, 2);
    const Around& around = node->around;
    if (around.count == 0) {
        finish(at, byWalks(at, node->local));
        doubtful.unused.push_back(std::move(node));
        return;
    }
    Doubtful::Some& some = doubtful.withCount(around.count);
    JetGroup& fronts = some.fronts;
    if (fronts.size() == 0) fronts.clear(core_.pull());
    const double base = around.node[0].jet.u;
    fronts.begin(float(base), core_.longest2(node->local.stretch));
    for (std::size_t k = 0; k < around.count; ++k) {
        const Around::Node& n = around.node[k];
        fronts.add(n.jet.a, n.jet.g, float(n.jet.u - base), n.source, n.overCrease);
    }
    some.nodes[fronts.size() - 1] = std::move(node);
    if (fronts.full()) solveDoubtful(some, group);
}

void Extension::solveDoubtful(Doubtful::Some& some, Group& group) const {
    const std::size_t count = some.fronts.size();
    if (count == 0) return;
    const JetGroup::Solutions solutions = some.fronts.solve();
    FrontsAtPoints fronts;
    for (std::size_t k = 0; k < count; ++k) {
        const Doubtful::Node& node = *some.nodes[k];
        const JetGroup::Solution& best = solutions[k];
        const double u = node.around.node[0].jet.u + double(best.u);
        const Found s = fromChart(u, best.g, best.source, node.local);
        if (const std::optional<Found> of = byTwoFronts(node, u))
            finishOrInDisc(node.at, *of);
        else if (frontsMeet(node, best.g))
            addMeeting(node, u, s, group.meetings, fronts);
        else
            finishOrInDisc(node.at, s);
        group.doubtful.unused.push_back(std::move(some.nodes[k]));
    }
    fronts.finish(group.meetings.points);
    some.fronts.clear();
}

std::optional<Extension::Found> Extension::byTwoFronts(const Doubtful::Node& node,
                                                       double before) const {
    constexpr float kMostOff = 2;  // voxels from the locus: farther on there is one front
    const Around& around = node.around;
    const auto end = around.node.begin() + around.count;
    if (!jets_.meetings || std::none_of(around.node.begin(), end, [&](const Around::Node& n) {
            return jets_.meetings->bothAt(n.core);
        }))
        return {};
    if (!metric_.clear(node.at.node) || around.overCrease()) return {};
    std::array<TwoFrontsFit::Neighbor, JetNeighbors::kMax> neighbors;
    for (std::size_t k = 0; k < around.count; ++k) {
        const Around::Node& n = around.node[k];
        if (n.source != around.node[0].source) return {};
        neighbors[k] = {linkTo(node.local.frame, n.core, core_.nodes[n.core].normal, n.jet.a),
                        jets_.meetings->bothAt(n.core)};
    }
    const auto found = TwoFrontsFit(jets_).solve({neighbors.data(), around.count}, before, kMostOff,
                                                 TwoFrontsFit::kLargestAngle);
    if (!found || !found->isBeside()) return {};
    return fromChart(found->u, found->g, around.node[0].source, node.local);
}

void Extension::addMeeting(const Doubtful::Node& node, double u, const Found& before,
                           Meetings& meetings, FrontsAtPoints& fronts) const {
    const Outside& at = node.at;
    std::array<JetNeighbor, JetNeighbors::kMax> neighbors;
    for (std::size_t k = 0; k < node.around.count; ++k) {
        const Around::Node& n = node.around.node[k];
        if (n.source != before.label) return finishOrInDisc(at, before);
        neighbors[k] = n.jet;
    }
    fronts.add(meetings.points.size(), {neighbors.data(), node.around.count});
    meetings.nodes.push_back({at, before});
    meetings.points.push_back(
        {at.leaf, at.offset, band_.footOf(at.node), node.local, before.label, u});
}

void Extension::solveMeetings(Meetings& meetings) const {
    if (meetings.nodes.empty()) return;
    const auto found = solveByRays(jets_, meetings.points);
    for (std::size_t k = 0; k < found.size(); ++k) {
        const Meetings::Node& node = meetings.nodes[k];
        const std::optional<Solved>& s = found[k];
        finishOrInDisc(node.at,
                       s ? fromChart(s->u, s->g, s->label, meetings.points[k].local) : node.before);
    }
    meetings.nodes.clear(), meetings.points.clear();
}

}  // namespace jet

}  // namespace igeo
