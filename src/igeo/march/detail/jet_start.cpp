#include <igeo/march/detail/jet_start.h>

#include <igeo/band/detail/chord.h>
#include <igeo/band/detail/mesh_fan.h>
#include <igeo/band/detail/mesh_ways.h>
#include <igeo/band/detail/short_walk.h>
#include <igeo/march/detail/mesh_read.h>

#include <queue>
#include <set>
#include <tuple>

namespace igeo {

namespace {

/// Voxels: nearer to a seed of a level set, nodes on the next face over an edge are in its disc.
constexpr double kNextFace = 1.5;

/// Cost of a chord at seed k, turned into its tangent plane.
double seedCost(const Band& band, const JetSeeds& seeds, std::uint32_t k, const Vec3f& chord) {
    const Vec2f flat = TangentFrame(band.normal[seeds.points[k].node]).flat(chord);
    const float l = length(flat);
    return l > 0 ? seeds.plane[k].cost((length(chord) / l) * flat) : 0;
}

/// The jet at the end of a walk from seed k.
/// @param cost  of the walk
Solved jetOver(const WalkEnds& way, double cost, const JetCore& core, const JetSeeds& seeds,
               std::uint32_t k, const LocalFrame& local, const SurfaceTriangles::Place& to) {
    const SurfaceTriangles& triangles = *core.band.triangles;
    const Vec3d normal(local.frame.normal());
    Solved s{seeds.points[k].start + cost, {}, seeds.source[k]};
    const Vec3d face = sideOf(triangles, to, normal) * triangles.normal(way.last);
    const Vec2f in = local.frame.flat(Vec3f(turned(way.in, face, normal)));
    if (length(in) > 0) s.g = (1 / length(in)) * in;
    return s;
}

/// The jet of a foot point of a mesh, by a walk on the triangles.
/// @return false without a walk of at most `most` voxels
bool jetByWalk(const JetCore& core, const JetSeeds& seeds, std::uint32_t k, const LocalFrame& local,
               const Vec3d& foot, double most, Solved& s) {
    const SurfaceTriangles& triangles = *core.band.triangles;
    const SurfacePoint& seed = seeds.points[k];
    const Vec3f& normal = local.frame.normal();
    const auto from = placeOn(triangles, seed, seed.nearestTo(foot)),
               to = footPlace(triangles, foot, Vec3d(normal));
    const WalkEnds way =
        ShortWalk(triangles).ends({from.triangle, from.point}, {to.triangle, foot}, most);
    if (!(way.length < kInfinity)) return false;
    const double mean = meanFromSeed(core.band, core.metric, seed, to.point, local.weight);
    s = jetOver(way, mean * way.length, core, seeds, k, local, to);
    return true;
}

/// A node to which a walk may lead from a seed.
struct OverWalk {
    NodeIndex node;
    double least;  ///< its value over a straight line
    std::uint32_t seed;
    bool operator<(const OverWalk& o) const {
        return std::tie(node, least, seed) < std::tie(o.node, o.least, o.seed);
    }
};

/// The start disc of one seed, found outward from the seed over the core, so that it reaches no
/// surface close by. It ends where links lead around something: where the path along them is
/// longer than the straight line by more than steps from node to node are.
class StartDisc {
public:
    StartDisc(const JetCore& core, const JetSeeds& seeds, std::uint32_t k)
        : core_(core), seeds_(seeds), k_(k), seed_(seeds.points[k]) {
        visitAroundSeed();
        while (!waiting_.empty()) {
            const Step next = waiting_.top();
            waiting_.pop();
            if (visit(next)) visitNeighbors(next);
        }
        visitSpine();
        visitWays();
        visitOverEdges();
    }
    const std::vector<std::pair<NodeIndex, Solved>>& jets() const { return found_; }
    /// Beyond an edge: StartDiscs::overEdges.
    const std::vector<std::pair<NodeIndex, Solved>>& overEdges() const { return overEdges_; }
    /// Nodes of a mesh in the disc, if walks lead to them.
    const std::vector<OverWalk>& overWalks() const { return overWalks_; }
    /// The node that is nearest to the seed; none if obstacles hide all.
    bool hasNearest() const { return nearest_ != kNoNode; }
    std::pair<NodeIndex, Solved> nearest() const {
        return {nearest_, {seed_.start + seed_.weight * least_, {}, seeds_.source[k_]}};
    }

private:
    /// A node, by the path to it from node to node.
    struct Step {
        double walked;  ///< voxels
        NodeIndex node;
        bool operator<(const Step& other) const {
            return std::tie(other.walked, other.node) < std::tie(walked, node);
        }
    };

    /// @param isBeside(i, node)  whether S joins a node of the core with the seed
    template <typename IsBeside>
    void visitWithin(int reach, const IsBeside& isBeside) {
        core_.band.forBox(&BandLeaf::core, seed_.node, {}, reach, [&](NodeIndex i, const Ijk&) {
            const JetNode& node = core_.nodes[i];
            if (isBeside(core_.inBand(node), node))
                waiting_.push({length(core_.footOf(node) - nearestOfSeed(i)), i});
        });
    }
    void visitAroundSeed() {
        const Band& band = core_.band;
        const Vec3f sheetNormal = band.normal[seed_.node];
        // On a mesh also nodes on the next face of a sharp edge.
        constexpr double kNear = 2;  // voxels
        if (band.triangles) {
            const auto at = placeOn(*band.triangles, seed_, seed_.pIndex);
            visitWithin(2, [&](NodeIndex j, const JetNode& node) {
                return length(core_.footOf(node) - seed_.pIndex) < kNear && meshJoins(band, at, j);
            });
        }
        // Two steps off, a node may be beyond a wall.
        auto isBeside = [&](NodeIndex j, const JetNode& node) {
            const Vec3d chord = core_.footOf(node) - seed_.pIndex;
            return dot(node.normal, sheetNormal) >= Band::kOtherSheet &&
                   !stacked(Vec3f(chord), node.normal, sheetNormal) && band.joined(seed_.node, j);
        };
        if (!band.triangles)
            visitWithin(2, [&](NodeIndex j, const JetNode& node) {
                return isBeside(j, node) && isNearPsi(seed_.pIndex, core_.footOf(node));
            });
        for (int reach = 1; reach <= 2 && waiting_.empty(); ++reach) visitWithin(reach, isBeside);
    }
    /// Around a seed on a page with few nodes the disc has no neighbors to grow over. It takes in
    /// those that a straight walk joins with the seed, as jumps do.
    void visitSpine() {
        if (!core_.isEven()) return;
        for (const NodeIndex j : core_.band.spineNear(seed_.pIndex)) {
            const NodeIndex i = core_.band.coreNode(j);
            const Vec3d foot = core_.footOf(core_.nodes[i]);
            Solved s;
            if (jetByWalk(core_, seeds_, k_, core_.localFrame(i), foot,
                          kBeforeTight * length(foot - nearestOfSeed(i)), s))
                found_.emplace_back(i, s);
        }
    }
    /// The same where sheets cross or fold within a voxel.
    void visitWays() {
        const Band& band = core_.band;
        if (!band.ways || !core_.stretch.empty() || !(seed_.segment == Vec3d{}) ||
            !hasWays(band, cellAt(band, seed_.pIndex), core_.isEven()))
            return;
        const auto at = placeOn(*band.triangles, seed_, seed_.pIndex);
        // Where costs vary, paths bend off longer lines.
        const double reach = core_.costsVary ? seeds_.startRadius : MeshWays::kReach;
        const MeshFan fan(*band.triangles, MeshPoint{at.triangle, at.point}, reach,
                          AtVertex::GoAround);
        WalkEnds way;
        for (std::size_t k = 0; k < fan.parts().size(); ++k)
            band.ways->nodes.forOn(fan.parts()[k].triangle, [&](NodeIndex node) {
                if (!fan.sees(k, band.footPoint(node), way)) return;
                const Vec3d foot = band.footPoint(node);
                if (isBlocked(core_.metric, *band.triangles, fan, k, foot)) return;
                const NodeIndex i = band.coreNode(node);
                const LocalFrame local = core_.localFrame(i);
                const double cost =
                    costOf(band, core_.metric, fan, k, foot, way, seed_.weight, local.weight);
                found_.emplace_back(
                    i, jetOver(way, cost, core_, seeds_, k_, local, band.footPlace(node)));
            });
    }
    /// Whether psi is 0 along the chord from the seed, or nearly so, where the band has it.
    bool isNearPsi(const Vec3d& from, const Vec3d& foot) const {
        constexpr double kOff = 0.3;
        for (const double t : {1.0 / 3, 2.0 / 3})
            if (std::abs(psiAt(core_.band, from + t * (foot - from))) > kOff) return false;
        return true;
    }
    void visitNeighbors(const Step& from) {
        const JetNode& node = core_.nodes[from.node];
        const std::uint32_t severed = core_.severedSteps(node);
        core_.band.forNeighbors(
            &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
                if (severed & SeveredLinks::bit(dx, dy, dz)) return;
                const JetNode& other = core_.nodes[j];
                const Vec3f chord = node.foot - other.foot - Vec3f(Ijk{dx, dy, dz});
                if (dot(node.normal, other.normal) >= Band::kOtherSheet &&
                    !stacked(chord, node.normal, other.normal))
                    waiting_.push({from.walked + double(length(chord)), j});
            });
    }
    Vec3d nearestOfSeed(NodeIndex i) const { return seed_.nearestTo(core_.footOf(core_.nodes[i])); }
    /// Whether an obstacle or a jump of the costs lies between a point of the seed and a node.
    bool isHidden(NodeIndex i, const Vec3d& from, const Vec3d& foot) const {
        const JetNode& node = core_.nodes[i];
        return node.obstacleState == Metric::Inside ||
               core_.metric.blocked(from, foot, Vec3d(seed_.normal)) ||
               costsJump(core_.band, core_.metric, seed_, foot, double(node.weight));
    }
    /// @return whether the disc goes on from the node
    bool visit(const Step& step) {
        constexpr double kDetour = 1.25, kRoom = 1;  // voxels
        const NodeIndex i = step.node;
        if (!visited_.insert(i).second) return false;
        const Vec3d foot = core_.footOf(core_.nodes[i]), from = nearestOfSeed(i);
        const double r = length(foot - from);
        if (isHidden(i, from, foot)) return false;
        if (step.walked > kDetour * r + kRoom) return false;
        if (r < least_) least_ = r, nearest_ = i;
        if (takesWalks(core_)) {
            if (r > seeds_.startRadius) return false;
            overWalks_.push_back(
                {i, leastOverWalk(core_, seeds_, k_, core_.localFrame(i), foot), k_});
            return true;
        }
        Solved s;
        if (!seedNeighborhoodJet(core_, seeds_, k_, core_.localFrame(i), foot, s)) {
            ends_.push_back(step);
            return false;
        }
        // With tensors the disc is large, and may reach over a hole.
        if (r > seeds_.startRadius && leadsOverRim(core_.band, from, foot)) return false;
        // From the next face of a level set the disc would grow over ribs.
        const bool straight =
            core_.band.triangles || isNearPsi(from, foot) || followsSurface(core_.band, from, foot);
        if (!straight) ends_.push_back(step);
        if (!straight && r > kNextFace) return false;
        found_.emplace_back(i, s);
        return straight;
    }
    /// Over the edges at which the disc of a level set ends.
    void visitOverEdges() {
        if (!core_.stretch.empty() || core_.band.triangles) return;
        std::set<NodeIndex> seen;
        for (const Step& end : ends_) waiting_.push(end);
        while (!waiting_.empty()) {
            const Step next = waiting_.top();
            waiting_.pop();
            if (seen.insert(next.node).second && visitOverEdge(next.node)) visitNeighbors(next);
        }
    }
    /// @return whether one edge lies between the seed and the node
    bool visitOverEdge(NodeIndex i) {
        const LocalFrame local = core_.localFrame(i);
        const Vec3f& normal = local.frame.normal();
        const Vec3d foot = core_.footOf(core_.nodes[i]), from = nearestOfSeed(i);
        if (length(foot - from) > seeds_.startRadius || isHidden(i, from, foot)) return false;
        const double far = overOneEdge(core_.band, from, foot, Vec3d(seed_.normal), Vec3d(normal));
        if (!(far < kInfinity)) return false;
        const Vec2f a =
            local.frame.unfold(Vec3f(foot - from), seed_.normal, dot(normal, seed_.normal));
        const double mean = meanFromSeed(core_.band, core_.metric, seed_, foot, local.weight);
        Solved s{seed_.start + mean * far, {}, seeds_.source[k_]};
        if (length(a) > 1e-6f) s.g = (1 / length(a)) * a;
        overEdges_.emplace_back(i, s);
        return true;
    }

    const JetCore& core_;
    const JetSeeds& seeds_;
    const std::uint32_t k_;
    const SurfacePoint& seed_;
    std::priority_queue<Step> waiting_;
    std::set<NodeIndex> visited_;
    std::vector<Step> ends_;  ///< nodes at which the disc ends
    std::vector<std::pair<NodeIndex, Solved>> found_, overEdges_;
    std::vector<OverWalk> overWalks_;
    NodeIndex nearest_ = kNoNode;
    double least_ = kInfinity;  ///< distance of nearest_, voxels
};

/// The unit normal of S at a seed; beside an edge, of the face that the seed is on.
Vec3f normalAt(const Band& band, const SurfacePoint& seed) {
    const Vec3d p = seed.pIndex + 0.5 * seed.segment;
    const Vec3f ofNode = band.normal[seed.node];
    if (band.triangles) {
        // Beside an edge the gradient of psi is between the normals of both faces.
        const auto at = placeOn(*band.triangles, seed, p);
        const Vec3d n = band.triangles->normal(at.triangle);
        return n == Vec3d{} ? ofNode : Vec3f(n);
    }
    const PsiSample psi = samplePsi(band, p);
    // Where two faces share a cell their gradients cancel.
    const bool clear = psi.valid && length(psi.gradient) > 0.5;
    const Vec3f mean = clear ? Vec3f(normalized(psi.gradient)) : ofNode;
    // Beside an edge the mean is of both faces: then that of the plane which runs through p.
    constexpr float kOneFace = 0.9f;
    const BandCell cell = cellAt(band, p);
    bool mixed = false;
    Vec3f ofPlane = mean;
    double least = kInfinity;
    for (const NodeIndex i : cell.node) {
        if (i == kNoNode) continue;
        const Vec3f& n = band.normal[i];
        const double off = std::abs(double(band.psi[i]) + dot(Vec3d(n), p - Vec3d(band.ijk(i))));
        mixed |= dot(n, mean) < kOneFace;
        if (off < least) least = off, ofPlane = n;
    }
    return mixed ? ofPlane : mean;
}

/// Sets the weight of a seed, and adds its plane of a tensor: those at the seed or, where obstacles
/// hide all corners of its cell, of its node.
void takeCosts(const JetCore& core, SurfacePoint& seed, std::vector<PlaneMetric>& plane) {
    const Metric& metric = core.metric;
    seed.weight = 1;
    if (!metric.weighted()) return;
    const SurfaceCell cell(core.band, metric, seed.pIndex + 0.5 * seed.segment, Vec3d(seed.normal));
    if (metric.anisotropic()) {
        const TangentFrame frame(core.band.normal[seed.node]);
        plane.push_back(cell.empty() ? metric.inPlane(frame, seed.node)
                                     : metric.inPlane(frame, cell));
        seed.weight = plane.back().weight;
    } else {
        seed.weight = cell.empty() ? metric.at(seed.node) : metric.at(cell);
    }
}

}  // namespace

JetSeeds::JetSeeds(const JetCore& core, const std::vector<SurfacePoint>& seeds, double radius)
    : points(seeds),
      source(sourcesOf(seeds)),
      near(points, radius * double(core.largestRatio)),
      startRadius(radius) {
    for (SurfacePoint& s : points) {
        s.normal = normalAt(core.band, s);
        takeCosts(core, s, plane);
        leastStart = std::min(leastStart, s.start);
    }
    lines = StraightLines(points, core.leastCost);
}

bool seedNeighborhoodJet(const JetCore& core, const JetSeeds& seeds, std::uint32_t k,
                         const LocalFrame& local, const Vec3d& foot, Solved& s) {
    const SurfacePoint& seed = seeds.points[k];
    const TangentFrame& frame = local.frame;
    const Vec3f chord(foot - seed.nearestTo(foot)), &normal = frame.normal();
    const float cosine = dot(normal, seed.normal), c = length(chord);
    const bool isotropic = core.stretch.empty();
    // With tensors as far in cost as such a chord in the most expensive direction: along the cheap
    // axis the lattice is coarse beside the bends of the front, further out than elsewhere.
    const double costThere = isotropic ? 0 : seedCost(core.band, seeds, k, chord);
    if (c > float(seeds.startRadius) &&
        (isotropic || costThere > seeds.startRadius * seeds.plane[k].largest()))
        return false;
    if (takesWalks(core)) return jetByWalk(core, seeds, k, local, foot, seeds.startRadius, s);
    // Across a crease or a step a chord says nothing, unless both faces are known, next to the
    // seed. A seed on the crease itself lies in the planes of all its faces.
    constexpr float kSmooth = 0.8f;
    const Vec3d chordInSpace(chord), from = foot - chordInSpace;
    const auto isOutOf = [&](const Vec3f& n) {
        return !liesInPlane(core.band, chordInSpace, Vec3d(n));
    };
    const bool overCrease =
        cosine < kSmooth && !runsInPlane(core.band, from, chordInSpace, Vec3d(normal));
    // Beside an edge one of the normals may be between those of both faces.
    const bool overStep = cosine >= kSmooth && isOutOf(normal) && isOutOf(seed.normal) &&
                          isOverStep(chordInSpace, Vec3d(normal), Vec3d(seed.normal));
    // Beside an edge the gradient of psi at the seed may turn a little beyond both faces.
    constexpr float kBeyond = 0.1f;
    const bool isKnownFace = overCrease && !core.band.triangles && c <= float(kNextFace) &&
                             cosine >= Band::kOtherSheet - kBeyond;
    if (overStep || (overCrease && !isKnownFace)) return false;
    const Vec2f a = cosine < kSmooth && !overCrease ? frame.flat(chord)
                                                    : frame.unfold(chord, seed.normal, cosine);
    const float arc = length(a);
    s = {seed.start, {}, seeds.source[k]};
    if (isotropic) {
        s.u += meanFromSeed(core.band, core.metric, seed, foot, local.weight) * double(arc);
        if (arc > 1e-6f) s.g = (1 / arc) * a;
        return true;
    }
    // Simpson's rule as for weights, each cost in its own plane.
    const Vec2f here = local.stretch.vector(a);
    const double ratio = c > 0 ? double(arc / c) : 1,
                 ends = (local.weight * double(length(here)) + ratio * costThere) / 2;
    const SurfaceCell middle(core.band, core.metric, 0.5 * (from + foot), Vec3d(seed.normal));
    const Vec3d along = tangential(chordInSpace, middle.normal);
    const double l = length(along);
    s.u += !middle.empty() && l > 0
               ? (ends + 2 * double(arc) / l * core.metric.stepCost(middle, along)) / 3
               : ends;
    if (arc > 1e-6f) s.g = local.stretch.covectorBack((1 / length(here)) * here);
    return true;
}

bool overtakesDisc(const JetCore& core, const JetSeeds& seeds, double u, double disc, double weight,
                   const Vec3d& foot) {
    constexpr double kEarlier = 0.25;  // voxels
    constexpr double kToRim = 0.05;    // voxels: between its points a rim is so much nearer
    if (!(seeds.points.size() > 1 && core.stretch.empty() && u < disc - kEarlier * weight))
        return false;
    double least = kInfinity;
    seeds.near.forNear(foot, [&](std::size_t k) {
        const SurfacePoint& seed = seeds.points[k];
        least = std::min(least, seed.start + core.leastCost * length(foot - seed.nearestTo(foot)));
    });
    return u >= least - kToRim * weight;
}

double leastOverWalk(const JetCore& core, const JetSeeds& seeds, std::uint32_t k,
                     const LocalFrame& local, const Vec3d& foot) {
    const SurfacePoint& seed = seeds.points[k];
    return seed.start + meanFromSeed(core.band, core.metric, seed, foot, local.weight) *
                            length(foot - seed.nearestTo(foot));
}

StartDiscs startDiscs(const JetCore& core, JetSeeds& seeds) {
    StartDiscs discs;
    const auto addTo = [&](JetsByNode& jets, const std::pair<NodeIndex, Solved>& jet) {
        seeds.largestInDisc = std::max(seeds.largestInDisc, jet.second.u);
        const auto [at, isNew] = jets.insert(jet);
        Solved& least = at->second;
        if (!isNew && std::tie(jet.second.u, jet.second.label) < std::tie(least.u, least.label))
            least = jet.second;
    };
    const auto add = [&](const std::pair<NodeIndex, Solved>& jet) { addTo(discs.jets, jet); };
    std::vector<OverWalk> overWalks;
    std::vector<std::pair<std::uint32_t, std::pair<NodeIndex, Solved>>> nearest;
    std::vector<bool> reaches(seeds.points.size());
    for (std::uint32_t k = 0; k < seeds.points.size(); ++k) {
        const StartDisc disc(core, seeds, k);
        for (const auto& jet : disc.jets()) add(jet), reaches[k] = true;
        for (const auto& jet : disc.overEdges()) addTo(discs.overEdges, jet);
        overWalks.insert(overWalks.end(), disc.overWalks().begin(), disc.overWalks().end());
        if (!reaches[k] && disc.hasNearest()) nearest.emplace_back(k, disc.nearest());
    }
    // A curve has many seeds around a node: only those count that may be the first.
    std::sort(overWalks.begin(), overWalks.end());
    for (const OverWalk& over : overWalks) {
        const auto at = discs.jets.find(over.node);
        const bool isLater = at != discs.jets.end() && at->second.u < over.least;
        Solved s;
        if (!isLater && jetByWalk(core, seeds, over.seed, core.localFrame(over.node),
                                  core.footOf(core.nodes[over.node]), seeds.startRadius, s))
            add({over.node, s}), reaches[over.seed] = true;
        if (isLater) reaches[over.seed] = true;
    }
    // A seed in a corner that obstacles hide from all nodes near it: straight to the nearest.
    for (const auto& [k, jet] : nearest)
        if (!reaches[k]) add(jet);
    return discs;
}

}  // namespace igeo
