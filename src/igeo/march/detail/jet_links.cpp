#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/march/detail/leaf_numbers.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>

namespace igeo {

namespace {

constexpr float kSmooth = JetLink::kSmooth;

/// Up to eight nodes, the nodes that may be linked to each, and their links: the first of each
/// node, the second of each, and so on.
struct Candidates {
    static constexpr std::size_t kNodes = 8, kMax = JetLinks::kMax;
    template <typename T>
    using PerNode = std::array<T, kNodes>;
    template <typename T>
    using Slots = std::array<PerNode<T>, kMax>;
    using StepCode = LeafNumbers<1>::StepCode;

    PerNode<NodeIndex> here;
    std::size_t size = 0;  ///< nodes
    alignas(32) PerNode<std::uint32_t> count;
    alignas(32) PerNode<std::uint32_t> neighbors;  ///< the first ones, a step away; the others are
                                                   ///< linked for certain
    alignas(32) Slots<NodeIndex> node;
    alignas(32) Slots<StepCode> step;  ///< of neighbors
    bool anySure = false;
    alignas(32) Slots<float> x, y, z;  ///< chord from its foot point: given for those that are sure

    // What layOut() finds.
    alignas(32) Slots<float> cosine;           ///< between the normals
    alignas(32) Slots<std::int32_t> together;  ///< onOneSheet
    unsigned rough = 0;  ///< bits: nodes with one not on its sheet, or over a crease
    PerNode<std::array<JetLink, kMax>> link;  ///< over smooth parts of S

    void clear() {
        size = 0, anySure = false;
        count = neighbors = {};
    }
    bool isSure(std::size_t lane, std::size_t k) const { return k >= neighbors[lane]; }
    Vec3f chord(std::size_t lane, std::size_t k) const {
        return {x[k][lane], y[k][lane], z[k][lane]};
    }
    /// A node that is linked by a bridge or a stencil, whatever the normals say.
    void addLinked(std::size_t lane, NodeIndex j, const Vec3f& chord) {
        anySure = true;
        const std::size_t k = count[lane]++;
        node[k][lane] = j, step[k][lane] = 0;
        x[k][lane] = chord.x, y[k][lane] = chord.y, z[k][lane] = chord.z;
    }
};

/// Lays candidates out in the charts of their nodes, for the nodes that fit into a register.
template <int Width>
class Layout {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

public:
    IGEO_INLINE Layout(const JetCore& core, std::size_t lane, Candidates& all)
        : nodes_(core.nodes.data()),
          weighted_(core.costsVary && core.stretch.empty()),
          smooth_(core.band.faceted ? 1.0f : kSmooth),
          lane_(lane),
          all_(all) {
        std::uint32_t here[Width];
        for (int k = 0; k < Width; ++k)
            here[k] = all.here[std::min(lane + std::size_t(k), all.size - 1)];
        V rest[4];
        load(here, here_, n_, rest);
        hereWeight_ = rest[2];
        t1_ = anyNormalTo<Width>(n_);
        t2_ = cross(n_, t1_);
    }

    IGEO_INLINE void layOut() const {
        const Integers count = loadAs<Integers>(&all_.count[lane_]);
        Integers rough{};
        for (std::int32_t k = 0; any(count > k); ++k) {
            const Integers there = count > k;
            rough |= layOut(std::size_t(k), there) & there;
        }
        all_.rough |= bitsOf<Width>(rough) << lane_;
    }

private:
    /// @return flags: not on one sheet, or over a crease
    IGEO_INLINE Integers layOut(std::size_t k, const Integers& there) const {
        // What lies beyond the last one of a node is laid out as well.
        const Integers node = there & loadAs<Integers>(&all_.node[k][lane_]);
        std::uint32_t index[Width];
        std::memcpy(index, &node, sizeof index);
        Vectors foot, normal;
        V rest[4];
        load(index, foot, normal, rest);
        const Integers step = loadAs<Integers>(&all_.step[k][lane_]);
        Vectors chord = here_ - foot - Vectors{part(step >> 4), part(step >> 2), part(step)};
        if (all_.anySure) {
            const Integers isNeighbor = loadAs<Integers>(&all_.neighbors[lane_]) > std::int32_t(k);
            chord.x = isNeighbor ? chord.x : loadAs<V>(&all_.x[k][lane_]);
            chord.y = isNeighbor ? chord.y : loadAs<V>(&all_.y[k][lane_]);
            chord.z = isNeighbor ? chord.z : loadAs<V>(&all_.z[k][lane_]);
        }
        storeLanes(chord.x, &all_.x[k][lane_]), storeLanes(chord.y, &all_.y[k][lane_]);
        storeLanes(chord.z, &all_.z[k][lane_]);
        const Vectors axis = anyNormalTo<Width>(normal);
        const V cosine = dot(n_, normal), rise = dot(n_, chord), riseOther = dot(normal, chord);
        const Integers together = areOnOneSheet(cosine, rise, riseOther, dot(chord, chord));
        // As TangentFrame::unfold has it.
        const V x = dot(chord, t1_), y = dot(chord, t2_), in2 = x * x + y * y,
                square = in2 + rise * rise;
        const V bend = rise - riseOther, kc2 = bend * bend / square;
        V stretch = 1 + rise * rise / in2;
        takeRoots<Width>(stretch);
        stretch *= 1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640));
        const V s = in2 > 1e-12f ? stretch : V{} + 1;
        // The least rotation that takes the normal of the neighbor to the one here.
        const V turn = dot(axis, n_) / (1 + cosine);
        V of[4] = {s * x, s * y, dot(axis, t1_) - turn * dot(normal, t1_),
                   dot(axis, t2_) - turn * dot(normal, t2_)};
        if (weighted_) {  // meanWeight
            const V weight = rest[2],
                    mean = weight == hereWeight_ ? V{} + 1 : (1 + weight / hereWeight_) / 2;
            of[0] *= mean, of[1] *= mean;
        }
        storeFours<Width>(of, &all_.link[lane_][k].ax, sizeof all_.link[0]);
        for (int lane = 0; lane < Width; ++lane)
            all_.link[lane_ + std::size_t(lane)][k].key = JetLink::keyOf(index[lane]);
        storeLanes(cosine, &all_.cosine[k][lane_]);
        storeLanes(together, &all_.together[k][lane_]);
        return ~together | (cosine < smooth_);
    }
    IGEO_INLINE void load(const std::uint32_t* index, Vectors& foot, Vectors& normal,
                          V (&rest)[4]) const {
        V footAndX[4];
        loadFours<Width>(nodes_, sizeof(JetNode), index, footAndX);
        loadFours<Width>(&nodes_->normal.y, sizeof(JetNode), index, rest);
        foot = {footAndX[0], footAndX[1], footAndX[2]};
        normal = {footAndX[3], rest[0], rest[1]};
    }

    IGEO_INLINE static Integers areOnOneSheet(const V& cosine, const V& along, const V& alongOther,
                                              const V& square) {
        constexpr float kFar2 = 3.2f, kAlong2 = 0.25f;
        const Integers stacked = (min(along, alongOther) > 1) | (max(along, alongOther) < -1);
        const Integers acrossGap = (cosine < 0.5f) & (square > kFar2) & (along * alongOther < 0) &
                                   (min(along * along, alongOther * alongOther) > kAlong2 * square);
        return (cosine >= kOppositeNormals) & ~stacked & ~acrossGap;
    }
    IGEO_INLINE static V min(const V& a, const V& b) { return a < b ? a : b; }
    IGEO_INLINE static V max(const V& a, const V& b) { return a > b ? a : b; }
    /// Of a step in bits.
    IGEO_INLINE static V part(const Integers& code) {
        return __builtin_convertvector((code & 3) - 1, V);
    }

    const JetNode* nodes_;
    bool weighted_;
    float smooth_;  ///< least cosine where TangentFrame::unfold does the same
    std::size_t lane_;
    Vectors here_, n_, t1_, t2_;  ///< foot points and frames of the nodes
    V hereWeight_;
    Candidates& all_;
};

void layOutByFour(const JetCore& core, Candidates& all) {
    for (std::size_t lane = 0; lane < all.size; lane += 4) Layout<4>(core, lane, all).layOut();
}
#ifdef IGEO_AVX2
IGEO_AVX2 void layOutByEight(const JetCore& core, Candidates& all) {
    Layout<8>(core, 0, all).layOut();
}
#endif

/// TangentFrame::unfold, onOneSheet.
void layOut(const JetCore& core, Candidates& candidates) {
    candidates.rough = 0;
#ifdef IGEO_AVX2
    if (eightAtATime()) return layOutByEight(core, candidates);
#endif
    layOutByFour(core, candidates);
}

/// Lays the neighbors of core nodes out in their charts.
class LinkBuilder {
public:
    LinkBuilder(const JetCore& core, const JetStencil& stencil) : core_(core), stencil_(stencil) {}

    /// @param wanted  bits: nodes of the block that get a row
    void fill(JetLinks::Block& block, NodeIndex begin, std::uint64_t wanted) const {
        constexpr std::size_t kUsual = 10;  // links per node
        std::vector<JetLink> links;
        links.reserve(kUsual * JetLinks::kBlock);
        LeafNumbers<1> numbers;
        LeafIndex leaf = kNoLeaf;
        Candidates candidates;
        std::size_t next = 0;  // row of the block
        auto beginRows = [&](std::size_t last) {
            while (next <= last) block.begin[next++] = std::uint16_t(links.size());
        };
        const auto end = NodeIndex(begin + std::size_t(std::bit_width(wanted)));
        while (wanted) {
            candidates.clear();
            std::size_t lane = 0;
            for (; wanted && lane < Candidates::kNodes; wanted &= wanted - 1, ++lane) {
                const auto i = NodeIndex(begin + std::size_t(std::countr_zero(wanted)));
                const LeafIndex here = core_.nodes[i].leaf;
                if (stencil_.empty() && here != leaf) {
                    leaf = here;
                    fill(numbers, i, end);
                }
                candidates.here[lane] = i;
                find(lane, numbers, candidates);
            }
            candidates.size = lane;
            layOut(core_, candidates);
            for (lane = 0; lane < candidates.size; ++lane) {
                const std::size_t k = candidates.here[lane] - begin;
                beginRows(k);
                if (addRow(lane, candidates, links)) block.creased |= std::uint64_t(1) << k;
            }
        }
        beginRows(JetLinks::kBlock);
        links.resize(links.size() + JetLinks::kBehind);
        block.link.assign(links.begin(), links.end());
        if (core_.costsVary) findLeastAround(block, begin, end);
    }

private:
    /// Fills the numbers around the nodes of a leaf from one on, of those before `end`.
    void fill(LeafNumbers<1>& numbers, NodeIndex i, NodeIndex end) const {
        const LeafIndex l = core_.nodes[i].leaf;
        const LeafNodes& leaf = core_.band.leaves[l].core;
        const NodeIndex last = std::min(end, leaf.firstNode + leaf.count) - 1;
        numbers.fill(core_.band, l, core_.nodes[i].offset >> 6, core_.nodes[last].offset >> 6);
    }

    void find(std::size_t lane, const LeafNumbers<1>& numbers, Candidates& candidates) const {
        const NodeIndex i = candidates.here[lane];
        const JetNode& node = core_.nodes[i];
        auto addLinked = [&](NodeIndex j, const Ijk&, const Vec3f& chord, float) {
            candidates.addLinked(lane, j, chord);
        };
        if (!stencil_.empty()) return forStencil(core_, stencil_, i, addLinked);
        std::uint32_t count = 0;
        numbers.forNeighbors(node.offset, core_.severedSteps(node),
                             [&](NodeIndex j, Candidates::StepCode code) {
                                 candidates.node[count][lane] = j;
                                 candidates.step[count++][lane] = code;
                             });
        candidates.count[lane] = candidates.neighbors[lane] = count;
        if (node.facing & Band::kBridged) forBridges(core_, node, addLinked);
    }
    /// @return whether one is over a crease
    bool addRow(std::size_t lane, const Candidates& candidates, std::vector<JetLink>& row) const {
        const JetNode& node = core_.nodes[candidates.here[lane]];
        const JetLink* const links = candidates.link[lane].data();
        const std::size_t count = candidates.count[lane];
        const bool mayBeHidden = node.obstacleState != Metric::Clear;
        // As long as they are along a mesh.
        const bool isStretched = node.facing & Band::kStretched;
        if (!(candidates.rough >> lane & 1) && !mayBeHidden && !isStretched) {
            row.insert(row.end(), links, links + count);
            return false;
        }
        const TangentFrame frame(node.normal, core_.band.faceted);
        std::array<float, 27> stretch;  // by the bit of a step
        stretch.fill(1);
        if (isStretched)
            core_.band.forStretched(core_.inBand(node),
                                    [&](const StretchedLink& l) { stretch[l.bit] = l.stretch(); });
        const float mayBeCrease = core_.band.faceted ? 1.0f : kSmooth;
        const bool weighted = core_.costsVary && core_.stretch.empty();
        bool creased = false;
        for (std::size_t k = 0; k < count; ++k) {
            const JetNode& other = core_.nodes[candidates.node[k][lane]];
            if (!candidates.isSure(lane, k) &&
                (!candidates.together[k][lane] ||
                 (mayBeHidden &&
                  isHidden(core_, other, core_.footOf(node), node.normal + other.normal))))
                continue;
            JetLink link = links[k];
            const float cosine = candidates.cosine[k][lane];
            if (cosine < mayBeCrease) {  // TangentFrame decides
                Vec2f a = frame.unfold(candidates.chord(lane, k), other.normal, cosine);
                // docs/method.md, "The metric": weights.
                if (weighted) a = meanWeight(other.weight, node.weight) * a;
                link.ax = a.x, link.ay = a.y;
            }
            if (isStretched && !candidates.isSure(lane, k)) {
                const auto code = candidates.step[k][lane];
                const std::size_t bit = 9 * (code >> 4) + 3 * (code >> 2 & 3) + (code & 3);
                link.ax *= stretch[bit], link.ay *= stretch[bit];
            }
            if (cosine < kSmooth) link.key |= JetLink::kCrease, creased = true;
            row.push_back(link);
        }
        return creased;
    }

    void findLeastAround(JetLinks::Block& block, NodeIndex begin, NodeIndex end) const {
        for (NodeIndex i = begin; i < end; ++i) {
            double least = core_.leastCostAt(i);
            for (std::size_t k = block.begin[i - begin]; k < block.begin[i - begin + 1]; ++k)
                least = std::min(least, core_.leastCostAt(block.link[k].node()));
            block.leastAround.push_back(float(least));
        }
    }

    const JetCore& core_;
    const JetStencil& stencil_;
};

}  // namespace

JetLinks::JetLinks(std::size_t nodes)
    : blocks_((nodes + kBlock - 1) / kBlock), left_(blocks_.size(), std::uint8_t(kBlock)) {
    if (nodes % kBlock) left_.back() = std::uint8_t(nodes % kBlock);
}

JetLinks& JetLinks::operator=(JetLinks&& other) noexcept {
    clear();
    blocks_ = std::move(other.blocks_);
    left_ = std::move(other.left_);
    other.blocks_.clear();
    return *this;
}

void JetLinks::clear() {
    for (const std::atomic<Block*>& block : blocks_) delete block.load();
    blocks_.clear();
}

void JetLinks::makeBlock(const JetCore& core, NodeIndex i, std::uint64_t rows,
                         const JetStencil& stencil) {
    const auto begin = NodeIndex(i / kBlock * kBlock);
    const std::size_t behind = kBlock - std::min(core.nodes.size() - begin, kBlock);
    auto made = std::make_unique<Block>();
    LinkBuilder(core, stencil).fill(*made, begin, rows & kAllRows >> behind);
    // Another thread may have made the same block meanwhile.
    Block* none = nullptr;
    if (blocks_[i / kBlock].compare_exchange_strong(none, made.get())) made.release();
}

void JetLinks::dropAccepted(NodeIndex i) {
    if (--left_[i / kBlock] == 0) drop(i);
}

void buildLinks(JetCore& core, const JetStencil& stencil) {
    core.links = JetLinks(core.nodes.size());
    parallelFor(core.links.blockCount(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            core.links.make(core, NodeIndex(b * JetLinks::kBlock), stencil);
    });
}

}  // namespace igeo
