#include <igeo/march/detail/jet_extend.h>

#include <bit>

namespace igeo::jet {

namespace {

using Flags = decltype(Four{} < Four{});

constexpr float kLight = 0.01f;

constexpr Ijk cornerOf(unsigned k) { return {int(k >> 2), int(k >> 1 & 1), int(k & 1)}; }

/// What corner (a, b, c) of a cell, 4 a + 2 b + c, is from its low corner.
struct CornerSteps {
    std::array<int, 8> index;
    std::array<Vec3f, 8> step;

    constexpr CornerSteps() : index(), step() {
        for (unsigned k = 0; k < 8; ++k)
            index[k] = LeafNumbers<2>::indexOfStep(cornerOf(k)), step[k] = Vec3f(cornerOf(k));
    }
};
constexpr CornerSteps kCorners;

/// The corners of a cell around a place in it.
struct Cell {
    alignas(16) std::array<float, 8> weight;  ///< trilinear
    unsigned found;                           ///< bits: those that are there and not light

    /// @param first  index of the low corner
    /// @param t      from there to the place
    Cell(const LeafNumbers<2>& core, int first, const Vec3f& t) {
        auto parts = [](float u) { return std::array{1 - std::abs(u), 1 - std::abs(u - 1)}; };
        const std::array<float, 2> x = parts(t.x), y = parts(t.y), z = parts(t.z);
        const Four inY{y[0], y[0], y[1], y[1]}, inZ{z[0], z[1], z[0], z[1]};
        const Four low = x[0] * inY * inZ, high = x[1] * inY * inZ;
        *reinterpret_cast<Four*>(weight.data()) = low;
        *reinterpret_cast<Four*>(weight.data() + 4) = high;
        // Which count changes from node to node: a set without branches.
        auto there = [&](std::size_t k) { return int(core.at(first + kCorners.index[k])); };
        constexpr int kNone = int(kNoNode);
        const Flags lowThere = Flags{there(0), there(1), there(2), there(3)} != kNone,
                    highThere = Flags{there(4), there(5), there(6), there(7)} != kNone;
        const Flags bits = (lowThere & (low >= kLight) & Flags{1, 2, 4, 8}) |
                           (highThere & (high >= kLight) & Flags{16, 32, 64, 128});
        found = unsigned((bits[0] | bits[1]) | (bits[2] | bits[3]));
    }
};

}  // namespace

/// The node of a group begun last, while its corners are added.
class Extension::CornerLane {
public:
    CornerLane(const Extension& extension, const Outside& node, Group& group)
        : jets_(extension.jets_),
          extension_(extension),
          nodes_(extension.core_.nodes.data()),
          states_(extension.jets_.state.data()),
          node_(node.node),
          normal_(extension.band_.normal[node.node]),
          weight_(float(extension.metric_.at(node.node))),
          bucketWidth_(float(extension.jets_.buckets.width)),
          besideSevered_((extension.band_.facing[node.node] & Band::kBesideSevered) != 0),
          labeled_(!extension.jets_.label.empty()),
          lane_(group.size++),
          to_(group.nodes[lane_]),
          corners_(group.corners) {
        static_cast<Outside&>(to_) = node;
        to_.weight = weight_;
        corners_.setNormal(lane_, normal_);
    }
    ~CornerLane() {
        to_.count = count_, to_.simple = simple_, to_.bucket = bucket_;
        corners_.count[lane_] = std::uint32_t(count_);
    }
    /// @param from  from the voxel of core node k to the foot point of the node
    void add(NodeIndex k, float weight, const Vec3f& from) {
        constexpr float kFlat = 0.8f;
        const JetNode& node = nodes_[k];
        const JetState& state = states_[k];
        if (!state.accepted() || dot(normal_, node.normal) < kFlat ||
            (besideSevered_ && !extension_.isJoined(node_, node)) ||
            (labeled_ && count_ > 0 && jets_.label[k] != jets_.label[to_.core[0]])) {
            simple_ = false;
            return;
        }
        // Relative to the first corner.
        if (count_ == 0) bucket_ = state.bucket;
        to_.core[count_] = k;
        const float u =
            (float(std::int64_t(state.bucket) - bucket_) * bucketWidth_ + state.rest) / weight_;
        corners_.set(lane_, count_++, weight, from - node.foot, node.normal,
                     extension_.gradientOf(k), u, meanWeight(node.weight, weight_));
    }

private:
    const CoreJets& jets_;
    const Extension& extension_;
    const JetNode* const nodes_;
    const JetState* const states_;
    const NodeIndex node_;
    const Vec3f normal_;
    const float weight_, bucketWidth_;
    const bool besideSevered_, labeled_;
    const std::size_t lane_;
    Group::Node& to_;
    JetCorners& corners_;
    std::size_t count_ = 0;
    std::uint32_t bucket_ = 0;
    bool simple_ = true;
};

/// As Band::forCornersOfFoot has it for the core, in the same order.
template <typename Visit>
void Extension::forCorners(const Outside& node, const Vec3f& foot, const LeafNumbers<2>* core,
                           const Visit& visit) const {
    const unsigned at = node.offset;
    const Ijk low{floorToInt(foot.x), floorToInt(foot.y), floorToInt(foot.z)};
    const Ijk cell = low + Ijk{int(at >> 6), int(at >> 3 & 7), int(at & 7)};
    if (!core || std::min({cell.x, cell.y, cell.z}) < -2 || std::max({cell.x, cell.y, cell.z}) > 8)
        return band_.forCornersOfFoot(&BandLeaf::core, node.node, node.leaf, at, visit);
    const int first = core->indexOf(cell);
    const Vec3f up = foot - Vec3f(low);
    const Cell corners(*core, first, up);
    for (unsigned found = corners.found; found; found &= found - 1) {
        const auto k = unsigned(std::countr_zero(found));
        visit(core->at(first + kCorners.index[k]), corners.weight[k], up - kCorners.step[k]);
    }
}

void Extension::begin(const Outside& node, Group& group) const {
    CornerLane lane(*this, node, group);
    forCorners(node, band_.footOf(node.node), group.core,
               [&](NodeIndex k, float w, const Vec3f& from) { lane.add(k, w, from); });
}

}  // namespace igeo::jet
