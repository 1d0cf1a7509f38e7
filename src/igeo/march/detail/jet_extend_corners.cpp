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

/// The corners of the core around the foot point of a node.
struct Cell {
    std::array<NodeIndex, 8> node;            ///< kNoNode where there is none
    alignas(16) std::array<float, 8> weight;  ///< trilinear
    Vec3f place;                              ///< from the low corner to the foot point
    unsigned found;                           ///< bits: corners that are there and not light

    /// @param core  of the leaf of the node, if known
    Cell(const Band& band, const Extension::Outside& at, const LeafNumbers<2>* core) {
        const Vec3f foot = band.footOf(at.node);
        const Ijk low{floorToInt(foot.x), floorToInt(foot.y), floorToInt(foot.z)};
        place = foot - Vec3f(low);
        const Ijk voxel =
            low + Ijk{int(at.offset >> 6), int(at.offset >> 3 & 7), int(at.offset & 7)};
        const bool near = core && std::min({voxel.x, voxel.y, voxel.z}) >= -2 &&
                          std::max({voxel.x, voxel.y, voxel.z}) <= 8;
        if (near) {
            const int first = core->indexOf(voxel);
            for (std::size_t k = 0; k < 8; ++k) node[k] = core->at(first + kCorners.index[k]);
        } else {
            node.fill(kNoNode);
            band.forCorners(&BandLeaf::core, at.leaf, at.offset, low,
                            [&](NodeIndex j, unsigned k) { node[k] = j; });
        }
        weigh();
    }

private:
    /// As Band::forCornersOfFoot has it.
    void weigh() {
        auto parts = [](float u) { return std::array{1 - std::abs(u), 1 - std::abs(u - 1)}; };
        const std::array<float, 2> x = parts(place.x), y = parts(place.y), z = parts(place.z);
        const Four inY{y[0], y[0], y[1], y[1]}, inZ{z[0], z[1], z[0], z[1]};
        const Four low = x[0] * inY * inZ, high = x[1] * inY * inZ;
        *reinterpret_cast<Four*>(weight.data()) = low;
        *reinterpret_cast<Four*>(weight.data() + 4) = high;
        // Which count changes from node to node: a set without branches.
        constexpr int kNone = int(kNoNode);
        auto there = [&](std::size_t k) {
            return Flags{int(node[k]), int(node[k + 1]), int(node[k + 2]), int(node[k + 3])} !=
                   kNone;
        };
        const Flags bits = (there(0) & (low >= kLight) & Flags{1, 2, 4, 8}) |
                           (there(4) & (high >= kLight) & Flags{16, 32, 64, 128});
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

void Extension::begin(const Outside& node, Group& group) const {
    const Cell cell(band_, node, group.core);
    CornerLane lane(*this, node, group);
    for (unsigned found = cell.found; found; found &= found - 1) {
        const auto k = unsigned(std::countr_zero(found));
        lane.add(cell.node[k], cell.weight[k], cell.place - kCorners.step[k]);
    }
}

}  // namespace igeo::jet
