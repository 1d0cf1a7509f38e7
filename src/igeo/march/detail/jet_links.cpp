#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/march/detail/leaf_numbers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace igeo {

namespace {

constexpr float kSmooth = JetLink::kSmooth;

/// Nodes that may be linked to one node, and their links.
struct Candidates {
    static constexpr std::size_t kMax = JetLinks::kMax;
    template <typename T>
    using Array = std::array<T, kMax>;

    std::size_t count = 0;
    std::size_t neighbors = 0;  ///< the first ones, a step away; the others are linked for certain
    alignas(32) Array<NodeIndex> node;
    alignas(32) Array<LeafNumbers<1>::StepCode> step;  ///< of neighbors
    /// Chord from its foot point: given for the others, found for neighbors.
    alignas(32) Array<float> x, y, z;

    // What layOut() finds.
    alignas(32) Array<float> cosine;           ///< between the normals
    alignas(32) Array<std::int32_t> together;  ///< onOneSheet
    bool smooth = true;   ///< all are on one sheet, with normals less than 26 degrees apart
    Array<JetLink> link;  ///< over smooth parts of S

    bool isSure(std::size_t k) const { return k >= neighbors; }
    Vec3f chord(std::size_t k) const { return {x[k], y[k], z[k]}; }
    /// A node that is linked by a bridge or a stencil, whatever the normals say.
    void addLinked(NodeIndex j, const Vec3f& chord) {
        node[count] = j;
        x[count] = chord.x, y[count] = chord.y, z[count++] = chord.z;
    }
};

/// Lays candidates out in the chart of a node, side by side.
template <int Width>
class Layout {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

public:
    IGEO_INLINE Layout(const JetCore& core, const JetNode& node, const TangentFrame& frame,
                       Candidates& all)
        : nodes_(core.nodes.data()),
          weighted_(core.costsVary && core.stretch.empty()),
          smooth_(core.band.faceted ? 1.0f : kSmooth),
          here_(node),
          n_(same(frame.normal())),
          t1_(same(frame.axis(0))),
          t2_(same(frame.axis(1))),
          all_(all) {}

    IGEO_INLINE void layOut() const {
        // What lies beyond the last one is laid out as well.
        for (std::size_t k = all_.count; k % Width; ++k) all_.node[k] = 0, all_.step[k] = 0;
        Integers rough{};
        for (std::size_t k = 0; k < all_.count; k += Width) {
            Integers here;
            for (int lane = 0; lane < Width; ++lane) here[lane] = std::int32_t(k) + lane;
            rough |= layOut(k) & (here < std::int32_t(all_.count));
        }
        all_.smooth = !any(rough);
    }

private:
    /// @return flags: not on one sheet, or over a crease
    IGEO_INLINE Integers layOut(std::size_t k) const {
        V footAndX[4], rest[4];
        loadFours<Width>(nodes_, sizeof(JetNode), &all_.node[k], footAndX);
        loadFours<Width>(&nodes_->normal.y, sizeof(JetNode), &all_.node[k], rest);
        const Vectors foot{footAndX[0], footAndX[1], footAndX[2]},
            normal{footAndX[3], rest[0], rest[1]};
        const V weight = rest[2];
        if (k < all_.neighbors) {
            const Integers step = loadAs<Integers>(&all_.step[k]);
            const Vectors chord =
                same(here_.foot) - foot - Vectors{part(step >> 4), part(step >> 2), part(step)};
            Integers isNeighbor;
            for (int lane = 0; lane < Width; ++lane) isNeighbor[lane] = std::int32_t(k) + lane;
            isNeighbor = isNeighbor < std::int32_t(all_.neighbors);
            storeLanes(isNeighbor ? chord.x : loadAs<V>(&all_.x[k]), &all_.x[k]);
            storeLanes(isNeighbor ? chord.y : loadAs<V>(&all_.y[k]), &all_.y[k]);
            storeLanes(isNeighbor ? chord.z : loadAs<V>(&all_.z[k]), &all_.z[k]);
        }
        const Vectors chord{loadAs<V>(&all_.x[k]), loadAs<V>(&all_.y[k]), loadAs<V>(&all_.z[k])};
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
            const V mean = weight == here_.weight ? V{} + 1 : (1 + weight / here_.weight) / 2;
            of[0] *= mean, of[1] *= mean;
        }
        storeFours<Width>(of, &all_.link[k].ax, sizeof(JetLink));
        for (int lane = 0; lane < Width; ++lane) {
            const std::size_t l = k + std::size_t(lane);
            all_.link[l].key = JetLink::keyOf(all_.node[l]);
        }
        storeLanes(cosine, &all_.cosine[k]);
        storeLanes(together, &all_.together[k]);
        return ~together | (cosine < smooth_);
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
    IGEO_INLINE static Vectors same(const Vec3f& v) { return {V{} + v.x, V{} + v.y, V{} + v.z}; }
    /// Of a step in bits.
    IGEO_INLINE static V part(const Integers& code) {
        return __builtin_convertvector((code & 3) - 1, V);
    }

    const JetNode* nodes_;
    bool weighted_;
    float smooth_;  ///< least cosine where TangentFrame::unfold does the same
    const JetNode& here_;
    Vectors n_, t1_, t2_;
    Candidates& all_;
};

void layOutByFour(const JetCore& core, const JetNode& node, const TangentFrame& frame,
                  Candidates& all) {
    Layout<4>(core, node, frame, all).layOut();
}
#ifdef IGEO_AVX2
IGEO_AVX2 void layOutByEight(const JetCore& core, const JetNode& node, const TangentFrame& frame,
                             Candidates& all) {
    Layout<8>(core, node, frame, all).layOut();
}
#endif

/// TangentFrame::unfold, onOneSheet.
void layOut(const JetCore& core, const JetNode& node, const TangentFrame& frame,
            Candidates& candidates) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return layOutByEight(core, node, frame, candidates);
#endif
    layOutByFour(core, node, frame, candidates);
}

/// Lays the neighbors of core nodes out in their charts.
class LinkBuilder {
public:
    LinkBuilder(const JetCore& core, const JetStencil& stencil) : core_(core), stencil_(stencil) {}

    void fill(JetLinks::Block& block, NodeIndex begin, NodeIndex end) const {
        constexpr std::size_t kUsual = 10;  // links per node
        std::vector<JetLink> links;
        links.reserve(kUsual * JetLinks::kBlock);
        LeafNumbers<1> numbers;
        LeafIndex leaf = kNoLeaf;
        Candidates candidates;
        for (NodeIndex i = begin; i < end; ++i) {
            block.begin[i - begin] = std::uint16_t(links.size());
            if (stencil_.empty() && core_.nodes[i].leaf != leaf)
                numbers.fill(core_.band, leaf = core_.nodes[i].leaf);
            find(i, numbers, candidates);
            if (addRow(i, candidates, links)) block.creased |= std::uint64_t(1) << (i - begin);
        }
        block.begin[end - begin] = std::uint16_t(links.size());
        links.resize(links.size() + JetLinks::kBehind);
        block.link.assign(links.begin(), links.end());
        if (core_.costsVary) findLeastAround(block, begin, end);
    }

private:
    void find(NodeIndex i, const LeafNumbers<1>& numbers, Candidates& candidates) const {
        candidates.count = candidates.neighbors = 0;
        const JetNode& node = core_.nodes[i];
        auto addLinked = [&](NodeIndex j, const Ijk&, const Vec3f& chord, float) {
            candidates.addLinked(j, chord);
        };
        if (!stencil_.empty()) return forStencil(core_, stencil_, i, addLinked);
        candidates.neighbors =
            numbers.neighbors(node.offset, candidates.node.data(), candidates.step.data());
        if (const std::uint32_t severed = core_.severedSteps(node))
            dropSevered(severed, candidates);
        candidates.count = candidates.neighbors;
        if (node.facing & Band::kBridged) forBridges(core_, node, addLinked);
    }

    static void dropSevered(std::uint32_t severed, Candidates& candidates) {
        std::size_t left = 0;
        for (std::size_t k = 0; k < candidates.neighbors; ++k) {
            const auto code = int(candidates.step[k]);
            const Ijk step = Ijk{code >> 4, code >> 2 & 3, code & 3} - Ijk{1, 1, 1};
            if (severed & SeveredLinks::bit(step.x, step.y, step.z)) continue;
            candidates.node[left] = candidates.node[k];
            candidates.step[left++] = candidates.step[k];
        }
        candidates.neighbors = left;
    }

    /// @return whether one is over a crease
    bool addRow(NodeIndex i, Candidates& candidates, std::vector<JetLink>& row) const {
        const JetNode& node = core_.nodes[i];
        const TangentFrame frame(node.normal, core_.band.faceted);
        layOut(core_, node, frame, candidates);
        const bool mayBeHidden = node.obstacleState != Metric::Clear;
        // As long as they are along a mesh.
        const bool isStretched = node.facing & Band::kStretched;
        if (candidates.smooth && !mayBeHidden && !isStretched) {
            const JetLink* const links = candidates.link.data();
            row.insert(row.end(), links, links + candidates.count);
            return false;
        }
        std::array<float, 27> stretch;  // by the bit of a step
        stretch.fill(1);
        if (isStretched)
            core_.band.forStretched(core_.inBand(node),
                                    [&](const StretchedLink& l) { stretch[l.bit] = l.stretch(); });
        const float mayBeCrease = core_.band.faceted ? 1.0f : kSmooth;
        const bool weighted = core_.costsVary && core_.stretch.empty();
        bool creased = false;
        for (std::size_t k = 0; k < candidates.count; ++k) {
            const JetNode& other = core_.nodes[candidates.node[k]];
            if (!candidates.isSure(k) && (!candidates.together[k] ||
                                          (mayBeHidden && isHidden(core_, other, core_.footOf(node),
                                                                   node.normal + other.normal))))
                continue;
            JetLink link = candidates.link[k];
            const float cosine = candidates.cosine[k];
            if (cosine < mayBeCrease) {  // TangentFrame decides
                Vec2f a = frame.unfold(candidates.chord(k), other.normal, cosine);
                // docs/method.md, "The metric": weights.
                if (weighted) a = meanWeight(other.weight, node.weight) * a;
                link.ax = a.x, link.ay = a.y;
            }
            if (isStretched && k < candidates.neighbors) {
                const auto code = candidates.step[k];
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

void JetLinks::makeBlock(const JetCore& core, NodeIndex i, const JetStencil& stencil) {
    const auto begin = NodeIndex(i / kBlock * kBlock);
    auto made = std::make_unique<Block>();
    LinkBuilder(core, stencil)
        .fill(*made, begin, NodeIndex(std::min(core.nodes.size(), begin + kBlock)));
    // Another thread may have made the same block meanwhile.
    Block* none = nullptr;
    if (blocks_[i / kBlock].compare_exchange_strong(none, made.get())) made.release();
}

void JetLinks::dropAccepted(NodeIndex i) {
    if (--left_[i / kBlock] > 0) return;
    delete blocks_[i / kBlock].exchange(nullptr);
}

void buildLinks(JetCore& core, const JetStencil& stencil) {
    core.links = JetLinks(core.nodes.size());
    parallelFor(core.links.blockCount(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            core.links.make(core, NodeIndex(b * JetLinks::kBlock), stencil);
    });
}

}  // namespace igeo
