/// From the core of a band to the rest of it, for scheme `jet`. Internal.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_extend_lanes.h>
#include <igeo/march/detail/jet_rays.h>
#include <igeo/march/detail/jet_start.h>
#include <igeo/march/detail/jet_update.h>
#include <igeo/march/detail/leaf_corners.h>
#include <igeo/march/field.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace igeo::jet {

/// Nodes around a foot point that have a jet, in its chart, with the sources of their fronts.
struct Around {
    struct Node {
        JetNeighbor jet;
        std::uint32_t source;
        bool overCrease;
        NodeIndex core;
    };
    std::array<Node, JetNeighbors::kMax> node;
    std::size_t count = 0;

    bool full() const { return count == node.size(); }
    bool overCrease() const {
        return std::any_of(node.begin(), node.begin() + count,
                           [](const Node& n) { return n.overCrease; });
    }
    /// Whether fronts meet across the foot point.
    /// @param g  direction of travel there
    bool frontsMeet(Vec2f g) const {
        FrontsMeet fronts(g);
        for (std::size_t k = 0; k < count; ++k) fronts.add(node[k].jet);
        return fronts.meet();
    }
    JetNeighbors all() const {
        JetNeighbors all;
        for (std::size_t k = 0; k < count; ++k) all.add(node[k].jet);
        return all;
    }
};

/// Gives nodes outside the core the jets of the core around their foot points.
class Extension {
public:
    /// @param lifted  liftedOf(jets), or empty: those that are needed are computed
    Extension(const CoreJets& jets, const LiftedJets& lifted)
        : jets_(jets),
          core_(*jets.core),
          band_(core_.band),
          metric_(core_.metric),
          lifted_(lifted),
          feetFromPsi_(band_.foot.empty()),
          weighted_(metric_.weighted()),
          laidOutFrom_(core_.stretch.empty() && !lifted.empty()
                           ? TangentFrame::creaseCosine(band_.faceted)
                           : 2),
          mayBePlain_(jets.label.empty() && jets.seeds.lines.ofOnePoint() &&
                      !metric_.anisotropic() && metric_.obstacleState.empty()),
          line_(jets.seeds.lines.only()) {}

    /// A jet, its gradient over the weight.
    using Found = NodeJet;
    /// A node outside the core.
    struct Outside {
        NodeIndex node;
        LeafIndex leaf;
        unsigned offset;
        NodeJet* to;
    };
    /// Where what the core carries is in doubt: nodes that are solved as in the march, side by side
    /// with others that have about as many neighbors.
    struct Doubtful {
        struct Node {
            Outside at;
            LocalFrame local;
            Around around;
        };
        struct Some {
            JetGroup fronts;
            std::array<std::unique_ptr<Node>, Lanes::kNodes> nodes;
        };
        std::array<Some, 3> some;
        std::vector<std::unique_ptr<Node>> unused;

        Some& withCount(std::size_t neighbors) {
            constexpr std::size_t kFew = 8, kMany = 11;
            return some[neighbors <= kFew ? 0 : neighbors <= kMany ? 1 : 2];
        }
        /// An unused node.
        std::unique_ptr<Node> make(const Outside& at, const LocalFrame& local) {
            if (unused.empty()) return std::make_unique<Node>(Node{at, local, {}});
            std::unique_ptr<Node> node = std::move(unused.back());
            unused.pop_back();
            node->at = at, node->local = local, node->around.count = 0;
            return node;
        }
    };
    /// Nodes across which fronts meet, as the march would solve them.
    struct Meetings {
        struct Node {
            Outside at;
            Found before;
        };
        std::vector<Node> nodes;
        std::vector<MeetingPoint> points;
    };
    /// Nodes outside the core that are extended side by side.
    struct Group {
        /// Of the leaf of the nodes, filled where needed; null: the nodes are of any leaves.
        LeafNumbers<2>* core = nullptr;
        LeafIndex numbered = kNoLeaf;                      ///< the leaf that it is filled for
        std::optional<std::span<const CornerSlot>> slots;  ///< of the nodes, if known
        std::size_t size = 0;
        std::array<Outside, Lanes::kNodes> nodes;
        FootLanes feet;
        CellPoints points;  ///< their foot points
        JetCorners corners;
        Doubtful doubtful;
        Meetings meetings;
        std::vector<Outside> waiting;  ///< in doubt, until jets by rays are found for all of them

        bool full() const { return size == nodes.size(); }
    };
    /// The jets of the nodes of a leaf.
    /// @param corners  of the leaf
    /// @param group    of size 0, with numbers; takes the nodes that are left to finish()
    /// @param to       a jet per node
    void extendLeaf(LeafIndex l, const LeafCorners& corners, Group& group, NodeJet* to) const;
    /// Extends what is left in a group.
    void finish(Group& group) const {
        solve(group);
        addWaiting(group);
        for (Doubtful::Some& some : group.doubtful.some) solveDoubtful(some, group);
        solveMeetings(group.meetings);
    }
    /// As Field::atCore.
    void at(std::span<const NodeIndex> nodes, NodeJet* to) const;

private:
    IGEO_INLINE Vec3f gradientOf(NodeIndex k) const {
        return lifted_.empty() ? jets_.gradientOf(k) : lifted_[k].g;
    }
    IGEO_INLINE double valueOf(NodeIndex k) const {
        if (lifted_.empty()) return jets_.valueOf(k);
        return jets_.buckets.startOf(jets_.state[k].bucket) + double(lifted_[k].rest);
    }
    /// @param voxel  of the core node
    IGEO_INLINE Found ofCore(NodeIndex k, const Ijk& voxel) const {
        if (!jets_.accepted(k)) return {};
        const std::uint32_t label = jets_.labelOf(k);
        // The march holds to the bound in single precision.
        const double bound = boundOf(label, Vec3d(voxel) + Vec3d(core_.nodes[k].foot));
        return {std::max(valueOf(k), bound), gradientOf(k), label};
    }
    /// StraightLines::from.
    IGEO_INLINE double boundOf(std::uint32_t label, const Vec3d& foot) const {
        if (!mayBePlain_) return jets_.seeds.lines.from(label, foot);
        return line_.start + jets_.seeds.lines.leastCost() * length(foot - line_.from);
    }
    Vec3d footPoint(NodeIndex i, LeafIndex l, unsigned at) const {
        return Vec3d(band_.leaves[l].origin + stepOf(at)) + Vec3d(band_.footOf(i));
    }
    /// That of the core nodes around a node of a group.
    std::uint32_t labelOf(const Group& group, std::size_t lane) const {
        if (jets_.label.empty()) return 0;
        return jets_.label[group.corners.node[0][lane]];
    }
    double weightOf(NodeIndex i) const {
        return metric_.anisotropic() ? core_.localFrameInBand(i).weight : metric_.at(i);
    }
    /// Whether no severed links part node i from a core node.
    bool isJoined(NodeIndex i, const JetNode& other) const {
        return !(band_.facing[i] & Band::kBesideSevered) || band_.joined(i, core_.inBand(other));
    }
    /// The same for one a step away.
    /// @param severed  Band::severedSteps of the node
    bool isJoined(const Outside& node, std::uint32_t severed, const Ijk& step,
                  const JetNode& other) const {
        return !(band_.facing[node.node] & other.facing & Band::kBesideSevered) ||
               band_.joined({node.leaf, node.offset}, step, severed, core_.severedSteps(other));
    }
    double largestCost(NodeIndex i) const {
        if (!metric_.anisotropic()) return metric_.at(i);
        const LocalFrame local = core_.localFrameInBand(i);
        return local.weight * double(local.stretch.largest());
    }
    /// The jets of the core nodes of a leaf; those that are moved are left to the group.
    /// @param nodes  offsets and 2^16 times places among the nodes of the leaf
    /// @param group  in which the leaf is set
    void takeCore(LeafIndex l, std::span<const std::uint32_t> nodes, Group& group,
                  NodeJet* to) const;
    IGEO_INLINE void begin(const Outside& node, Group& group) const;
    void solve(Group& group) const;
    /// The numbers of the core nodes around the foot points.
    IGEO_INLINE void findCorners(Group& group) const;
    const LeafNumbers<2>* numbersOf(Group& group, LeafIndex l) const {
        if (group.core && group.numbered != l) group.core->fill(band_, l), group.numbered = l;
        return group.core;
    }
    /// Whether the carried jet of a node is all there is to it, but for its bound. For most nodes.
    bool isPlain(const Group& group, std::size_t lane) const {
        return group.feet.plain[lane] && !mayMissFront(group, lane) &&
               !(band_.facing[group.nodes[lane].node] & Band::kBesideSevered);
    }
    IGEO_INLINE void extendTo(Group& group, std::size_t lane, const CarriedJets& carried) const;
    /// Whether all corners of a node are of one smooth sheet and of one source.
    IGEO_INLINE bool isSimple(const Group& group, std::size_t lane) const;
    void solveDoubtful(Doubtful::Some& some, Group& group) const;
    /// From both fronts, beside a locus along which they meet at a small angle; else none.
    /// @param before  value by a fit, over the weight, from the least start
    std::optional<Found> byTwoFronts(const Doubtful::Node& node, double before) const;
    void addMeeting(const Doubtful::Node& node, double u, const Found& before, Meetings& meetings,
                    FrontsAtPoints& fronts) const;
    /// By rays, where these find a jet.
    void solveMeetings(Meetings& meetings) const;
    /// Sets the jet of a node, or that of a start disc which holds its foot point.
    void finishOrInDisc(const Outside& at, const Found& s) const {
        finish(at, maybeInDisc(at.node, s.distance) ? inDisc(at.node, s) : s);
    }
    /// Sets the jet of a node, no less than a straight line.
    IGEO_INLINE void finish(const Outside& node, const Found& s) const {
        const Vec3d foot = footPoint(node.node, node.leaf, node.offset);
        const double d = std::max(s.distance, jets_.seeds.lines.from(s.label, foot));
        *node.to = finished(node.node, {d, s.gradient, s.label});
    }
    /// What is left to do for any node.
    IGEO_INLINE NodeJet finished(NodeIndex i, Found s) const {
        if (!(s.distance <= jets_.limit) || metric_.inside(i)) return {kInfinity, {}, s.label};
        if (metric_.weighted()) s.gradient *= float(weightOf(i));
        return s;
    }

    void addNeighbor(NodeIndex k, const Vec3f& chord, float cosine, const Vec3f& g,
                     const LocalFrame& local, Around& around) const;
    /// The same for node k of a box.
    IGEO_INLINE void addNeighbor(const BoxLanes& box, std::size_t k, const LocalFrame& local,
                                 Around& around) const;
    /// Adds a neighbor in the chart, without its value.
    IGEO_INLINE void add(NodeIndex k, JetNeighbor jet, float cosine, const LocalFrame& local,
                         Around& around) const;
    /// The corners of a node of a group.
    Around around(const Group& group, std::size_t lane, const LocalFrame& local) const;
    /// What they carry there, with tensors.
    Found carryInPlane(const Group& group, std::size_t lane) const;
    /// Finds the jets of the core by rays around the nodes that wait, and adds
    /// these as in doubt.
    void addWaiting(Group& group) const;
    /// Where the core around the foot point is not of one smooth front.
    void addDoubtful(const Outside& node, Group& group) const;
    /// Whether fronts meet beside one of the corners.
    bool meetNear(const Group& group, std::size_t lane) const {
        bool meet = false;
        if (jets_.meetings)
            for (std::size_t c = 0; c < group.corners.count[lane]; ++c)
                meet |= jets_.frontsMeetNear(group.corners.node[c][lane]);
        return meet;
    }
    /// Whether the foot point is that of its only corner, as on planes along the axes: the march
    /// has solved it.
    static bool isAtCorner(const Group& group, std::size_t lane) {
        constexpr float kSame2 = 1e-6f;
        const Vec3f chord = group.corners.chord(lane, 0);
        return group.corners.count[lane] == 1 && dot(chord, chord) < kSame2;
    }
    /// One or two corners do not show that fronts meet around them.
    bool mayMissFront(const Group& group, std::size_t lane) const {
        return group.corners.count[lane] < 3 && meetNear(group, lane) && !isAtCorner(group, lane);
    }
    /// Whether fronts meet across a node, where S is smooth and without obstacles.
    /// @param g  direction of travel there
    bool frontsMeet(const Doubtful::Node& node, Vec2f g) const {
        const Around& around = node.around;
        return metric_.clear(node.at.node) && !around.overCrease() &&
               std::any_of(around.node.begin(), around.node.begin() + around.count,
                           [&](const Around::Node& n) { return jets_.frontsMeetNear(n.core); }) &&
               around.frontsMeet(g);
    }
    /// A jet of the chart, back on S; u relative to the least start.
    Found fromChart(double u, Vec2f g, std::uint32_t label, const LocalFrame& local) const {
        return {jets_.seeds.leastStart + local.weight * u,
                local.frame.lift(core_.stretch.empty() ? g : local.stretch.covectorBack(g)), label};
    }
    /// Adds the nodes of the core around a node that have a jet.
    /// @param core  of its leaf, if known
    /// @return whether any of it is on the node's sheet, reached or not
    bool gatherAround(Doubtful::Node& node, const LeafNumbers<2>* core, const Ijk& middle,
                      int reach) const;
    /// From core nodes nearby, over the triangles of a mesh: where its sheets cross, links may not
    /// lead to a node.
    Found byWalks(const Outside& at, const LocalFrame& local) const;
    /// Whether a start disc may hold the foot point of a node at a distance.
    bool maybeInDisc(NodeIndex i, double distance) const {
        const double cost = metric_.weighted() ? largestCost(i) : 1;
        return !(distance > jets_.seeds.largestInDisc + kDiscMargin * cost);
    }
    /// The jet of the start disc that holds the foot point; s where none does.
    Found inDisc(NodeIndex i, const Found& s) const;

    const CoreJets& jets_;
    const JetCore& core_;
    const Band& band_;
    const Metric& metric_;
    const LiftedJets& lifted_;
    const bool feetFromPsi_, weighted_;
    const float laidOutFrom_;  ///< cosine from which BoxLanes has neighbors laid out
    const bool mayBePlain_;    ///< one source at a point, isotropic, no obstacles
    const StraightLines::Line line_;
};

}  // namespace igeo::jet
