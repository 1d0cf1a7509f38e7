#include <igeo/march/detail/jet_two_fronts.h>

#include <igeo/march/detail/jet_two_fronts_fit.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

namespace igeo {

namespace {

using Meeting = Meetings::Meeting;

/// The links of the core after a march.
class LinksOnDemand {
public:
    /// @param own  of the march, where the core has none: made again where they are needed
    LinksOnDemand(const JetCore& core, JetLinks& own) : core_(core), own_(own) {}

    JetLinks::Row rowOf(NodeIndex i) {
        if (!core_.links.empty()) return core_.links.rowAt(i);
        if (own_.make(core_, i)) made_.push_back(i);
        return own_.rowAt(i);
    }
    /// Drops what was made.
    void dropAll() {
        for (const NodeIndex i : made_) own_.drop(i);
        made_.clear();
    }

private:
    const JetCore& core_;
    JetLinks& own_;
    std::vector<NodeIndex> made_;  ///< one per block
};

/// Follows loci through the core.
class Loci {
public:
    Loci(CoreJets& jets, JetLinks& own, std::vector<Meeting>& meetings,
         std::vector<std::uint8_t>& near)
        : jets_(jets),
          core_(*jets.core),
          links_(core_, own),
          meetings_(meetings),
          near_(near),
          fit_(jets) {}

    std::vector<TwoFronts> carry() {
        // Equal distances, in symmetric places, by voxel: numbers of nodes depend on the leaves.
        std::vector<std::tuple<double, int, int, int, Meeting*>> narrow;
        for (Meeting& m : meetings_)
            if (m.fronts.count == 2 && cosineOf(m) > kNarrow) {
                const Ijk at = core_.voxelOf(core_.nodes[m.node]);
                narrow.push_back({marchedAt(jets_, m.node), at.x, at.y, at.z, &m});
            }
        std::sort(narrow.begin(), narrow.end());
        for (const auto& [u, x, y, z, m] : narrow) {
            if (solved_.contains(m->node)) continue;
            for (const Meeting& start : wideBehind(*m))
                if (begin(start)) break;
            while (!queue_.empty()) solveNext();
            links_.dropAll();
        }
        std::vector<TwoFronts> all;
        for (const auto& [k, both] : solved_)
            if (near_[k] & Meetings::kBoth) all.push_back(both);
        std::sort(all.begin(), all.end(),
                  [](const TwoFronts& a, const TwoFronts& b) { return a.node < b.node; });
        return all;
    }

private:
    using Neighbor = TwoFrontsFit::Neighbor;
    using Queued = std::pair<double, NodeIndex>;
    // Angles of 20, 36 and 30 degrees.
    static constexpr float kNarrow = 0.94f, kWide = 0.809f, kBegin = 0.866f;  // cosines

    static constexpr float kMostAtBegin = 1.2f, kGrowth = 0.15f;  // radians

    static float cosineOf(const Meeting& m) { return dot(m.fronts.g[0], m.fronts.g[1]); }
    Meeting* meetingAt(NodeIndex k) {
        if (!near_[k]) return nullptr;
        const auto at = std::lower_bound(meetings_.begin(), meetings_.end(), k,
                                         [](const Meeting& m, NodeIndex i) { return m.node < i; });
        return at != meetings_.end() && at->node == k ? &*at : nullptr;
    }

    /// Meetings along a locus, from the first that is wide on to a narrow one; none if they were
    /// looked at before.
    std::vector<Meeting> wideBehind(const Meeting& narrow) {
        std::vector<Meeting> wide;
        for (std::optional<Meeting> at = narrow; at;) {
            if (!seen_.insert(at->node).second) return {};
            if (cosineOf(*at) < kBegin) wide.push_back(*at);
            if (cosineOf(*at) < kWide) break;
            at = behind(*at);
        }
        std::reverse(wide.begin(), wide.end());
        return wide;
    }
    /// The next one back along the locus, within some three voxels: the nearest at which both
    /// fronts were found, or else can be.
    std::optional<Meeting> behind(const Meeting& m) {
        constexpr float kStraight = 0.7f, kLeast = 0.3f, kFar = 2.2f;  // cosine, voxels
        const JetNode& node = core_.nodes[m.node];
        const Vec3f back = normalized(
            core_.localFrame(m.node).frame.lift(-1.0f * (m.fronts.g[0] + m.fronts.g[1])));
        struct {
            float off = float(kInfinity);
            const Meeting* meeting = nullptr;
        } nearest[2];
        const auto lookAt = [&](NodeIndex j, const Ijk& step) {
            if (!near_[j]) return;
            const Vec3f to = core_.nodes[j].foot + Vec3f(step) - node.foot;
            const float l = length(to);
            if (l < kLeast || dot(to, back) < kStraight * l) return;
            const Meeting* const other = meetingAt(j);
            if (!other || other->fronts.count - 1 > 1) return;
            if (auto& of = nearest[other->fronts.count - 1]; l < of.off) of = {l, other};
        };
        core_.band.forNeighbors(&BandLeaf::core, node.leaf, node.offset,
                                [&](NodeIndex j, int dx, int dy, int dz) {
                                    lookAt(j, {dx, dy, dz});
                                });
        if (!nearest[1].meeting)
            core_.band.forBox(&BandLeaf::core, node.leaf, node.offset,
                              roundToIjk(Vec3d(kFar * back)), 1, lookAt);
        if (nearest[1].meeting) return *nearest[1].meeting;
        if (!nearest[0].meeting) return {};
        const MeetingFronts fronts = frontsAt(*nearest[0].meeting);
        if (fronts.count != 2) return {};
        return Meeting{nearest[0].meeting->node, fronts};
    }
    /// The fronts at a meeting. Where one of them comes a little later, its direction is that at a
    /// meeting beside.
    MeetingFronts frontsAt(const Meeting& m) {
        MeetingFronts fronts = m.fronts;
        if (fronts.count != 1) return fronts;
        const JetNode& node = core_.nodes[m.node];
        const bool faceted = core_.band.faceted;
        const TangentFrame frame(node.normal, faceted);
        float least = 0.98f;  // cosine
        core_.band.forNeighbors(
            &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int, int, int) {
                const Meeting* const other = meetingAt(j);
                if (!other || other->fronts.count == 0) return;
                const Vec3f& normal = core_.nodes[j].normal;
                const Vec2f g = turnedInto(frame, normal, dot(node.normal, normal),
                                           TangentFrame(normal, faceted).lift(other->fronts.g[0]));
                if (const float cosine = dot(g, fronts.g[0]); cosine < least)
                    least = cosine, fronts.g[1] = g, fronts.count = 2;
            });
        return fronts;
    }

    /// Sets the neighbors of a node.
    /// @param before  those solved again count up to here
    /// @return whether S is smooth there
    bool gather(NodeIndex i, double before) {
        around_.clear();
        const JetNode& node = core_.nodes[i];
        if (node.obstacleState != Metric::Clear || node.facing & Band::kStretched) return false;
        const auto [row, creased] = links_.rowOf(i);
        if (creased) return false;
        const std::uint32_t label = jets_.labelOf(i);
        for (const JetLink& link : row) {
            if (!jets_.accepted(link.node()) || jets_.labelOf(link.node()) != label) continue;
            const auto at = solved_.find(link.node());
            const bool counts =
                at != solved_.end() && at->second.locus == locus_ && at->second.key < before;
            around_.push_back({link, counts ? &at->second : nullptr});
        }
        return true;
    }

    /// Begins a locus at a meeting.
    bool begin(const Meeting& start) {
        ++locus_;
        const double before = marchedAt(jets_, start.node);
        if (solved_.contains(start.node) || !gather(start.node, 0)) return false;
        std::optional<TwoFrontsFit::Found> found = fit_.begin(around_, before, start.fronts);
        if (!found || found->angle > kMostAtBegin) return false;
        largest_ = found->angle;
        take(start.node, before, 0, *found);
        return true;
    }

    void solveNext() {
        const auto [key, i] = queue_.top();
        queue_.pop();
        if (solved_.contains(i) || !gather(i, key)) return;
        const double before = marchedAt(jets_, i);
        std::optional<TwoFrontsFit::Found> found = fit_.solve(around_, before);
        // Where other fronts meet, or the angle grows, rays do better.
        if (!found || found->angle > largest_ + kGrowth || (!found->isBeside() && meetingAt(i)))
            return;
        if (found->angle < TwoFrontsFit::kLargestAngle) write(i, *found);
        take(i, key, std::abs(found->u - before), *found);
    }
    void write(NodeIndex i, const TwoFrontsFit::Found& found) {
        const JetNode& node = core_.nodes[i];
        JetState& state = jets_.state[i];
        const double bound = jets_.seeds.lines.from(jets_.labelOf(i), core_.footOf(node)),
                     u = jets_.seeds.leastStart + double(node.weight) * found.u;
        state.rest = float(std::max(u, bound) - jets_.buckets.startOf(state.bucket));
        state.g = found.g;
        if (Meeting* const meeting = meetingAt(i)) meeting->fronts.count = 0;
    }

    /// Takes what was found at a node, and queues the nodes that depend on it.
    /// @param change  of its value
    void take(NodeIndex i, double key, double change, TwoFrontsFit::Found& found) {
        constexpr double kChange = 0.002;  // voxels
        TwoFronts& both = found.both;
        both.node = i, both.locus = locus_, both.key = key;
        if (found.isBeside()) near_[i] |= Meetings::kBoth;
        const float width = (TwoFrontsFit::kWidth + 1) * length(both.turn);
        for (const Neighbor& n : around_) {
            const NodeIndex j = n.link.node();
            if (n.both || solved_.contains(j)) continue;
            const double apart = std::abs(both.apart - double(dot(both.turn, n.link.a())));
            // The later front of a node comes so late.
            const bool beside = found.isBeside() && apart <= double(width);
            const double at = marchedAt(jets_, j) + (beside ? apart : 0);
            if (at > key && (beside || change > kChange)) queue_.push({at, j});
        }
        solved_.insert({i, both});
    }

    CoreJets& jets_;
    const JetCore& core_;
    LinksOnDemand links_;
    std::vector<Meeting>& meetings_;
    std::vector<std::uint8_t>& near_;
    TwoFrontsFit fit_;
    std::uint32_t locus_ = 0;
    float largest_ = 0;  ///< angle at the begin of the locus
    std::unordered_map<NodeIndex, TwoFronts> solved_;
    std::unordered_set<NodeIndex> seen_;
    std::priority_queue<Queued, std::vector<Queued>, std::greater<>> queue_;
    std::vector<Neighbor> around_;
};

}  // namespace

std::vector<TwoFronts> carryTwoFronts(CoreJets& jets, JetLinks& own, std::vector<Meeting>& meetings,
                                      std::vector<std::uint8_t>& near) {
    return Loci(jets, own, meetings, near).carry();
}

}  // namespace igeo
