#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/march/detail/leaf_numbers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace igeo {

namespace {

using Four = JetNeighbors::Four;
using Mask = decltype(Four{} < Four{});

struct Vec3Four {
    Four x, y, z;
    Vec3Four() = default;
    explicit Vec3Four(const Vec3f& v) : x(Four{} + v.x), y(Four{} + v.y), z(Four{} + v.z) {}
};
inline Four dot(const Vec3Four& a, const Vec3Four& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Four abs(const Four& v) { return v < 0 ? -v : v; }

/// igeo::anyNormalTo, with the same bits.
inline Vec3Four anyNormalTo(const Vec3Four& n) {
    const Four x = abs(n.x), y = abs(n.y), z = abs(n.z), zero{};
    const Mask byX = (x <= y) & (x <= z), byY = ~byX & (y <= z);
    Vec3Four t;
    t.x = byX ? zero : byY ? -n.z : n.y;
    t.y = byX ? n.z : byY ? zero : -n.x;
    t.z = byX ? -n.y : byY ? n.x : zero;
    const Four len = jet::roots(dot(t, t));
    const Four inverse = len > 0 ? 1 / len : zero + 1;
    t.x *= inverse, t.y *= inverse, t.z *= inverse;
    return t;
}

/// Nodes that may be linked to one node, four side by side.
class Candidates {
public:
    void clear() { count_ = 0; }
    std::size_t count() const { return count_; }
    /// @param chord   from its foot point
    /// @param linked  by a bridge or a stencil, whatever the normals say
    void add(NodeIndex j, const Vec3f& chord, const Vec3f& normal, bool linked) {
        const std::size_t k = count_++;
        node_[k] = j, linked_[k] = linked;
        set(chord_, k, chord), set(normal_, k, normal);
    }
    NodeIndex node(std::size_t k) const { return node_[k]; }
    Vec3f chord(std::size_t k) const { return get(chord_, k); }
    Vec3f normal(std::size_t k) const { return get(normal_, k); }
    float cosine(std::size_t k) const { return cosine_[k]; }
    bool isSure(std::size_t k) const { return linked_[k]; }
    bool onOneSheet(std::size_t k) const { return onOneSheet_[k]; }
    /// The link in the chart, over smooth parts of S.
    JetLink link(std::size_t k) const {
        return {node_[k], {ax_[k], ay_[k]}, turnCosine_[k], turnSine_[k]};
    }

    /// Lays all out in the chart of a node: TangentFrame::unfold, onOneSheet.
    void layOut(const TangentFrame& frame) {
        for (std::size_t k = 0; k < count_; k += 4) layOutFour(frame, k);
    }

private:
    static constexpr std::size_t kMax = JetLinks::kMax;
    using Array = std::array<float, kMax>;
    using Vectors = std::array<Array, 3>;

    static void set(Vectors& v, std::size_t k, const Vec3f& value) {
        v[0][k] = value.x, v[1][k] = value.y, v[2][k] = value.z;
    }
    static Vec3f get(const Vectors& v, std::size_t k) { return {v[0][k], v[1][k], v[2][k]}; }
    static Four load(const Array& a, std::size_t k) {
        return *reinterpret_cast<const Four*>(a.data() + k);
    }
    static Vec3Four load(const Vectors& v, std::size_t k) {
        Vec3Four four;
        four.x = load(v[0], k), four.y = load(v[1], k), four.z = load(v[2], k);
        return four;
    }
    static void store(Array& a, std::size_t k, Four value) {
        *reinterpret_cast<Four*>(a.data() + k) = value;
    }
    static Four min(Four a, Four b) { return a < b ? a : b; }
    static Four max(Four a, Four b) { return a > b ? a : b; }

    static Mask areOnOneSheet(Four cosine, Four along, Four alongOther, Four square) {
        constexpr float kFar2 = 3.2f, kAlong2 = 0.25f;
        const Mask stacked = (min(along, alongOther) > 1) | (max(along, alongOther) < -1);
        const Mask acrossGap = (cosine < 0.5f) & (square > kFar2) & (along * alongOther < 0) &
                               (min(along * along, alongOther * alongOther) > kAlong2 * square);
        return (cosine >= kOppositeNormals) & ~stacked & ~acrossGap;
    }

    void layOutFour(const TangentFrame& frame, std::size_t k) {
        const Vec3Four chord = load(chord_, k), normal = load(normal_, k),
                       axis = anyNormalTo(normal), n(frame.normal()), t1(frame.axis(0)),
                       t2(frame.axis(1));
        const Four cosine = dot(n, normal), rise = dot(n, chord), riseOther = dot(normal, chord);
        const Mask sheet = areOnOneSheet(cosine, rise, riseOther, dot(chord, chord));
        // As TangentFrame::unfold has it.
        const Four x = dot(chord, t1), y = dot(chord, t2), in2 = x * x + y * y,
                   square = in2 + rise * rise;
        const Four bend = rise - riseOther, kc2 = bend * bend / square;
        const Four stretch =
            jet::roots(1 + rise * rise / in2) * (1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640)));
        const Four s = in2 > 1e-12f ? stretch : Four{} + 1;
        // The least rotation that takes the normal of the neighbor to the one here.
        const Four turn = dot(axis, n) / (1 + cosine);
        store(ax_, k, s * x), store(ay_, k, s * y);
        store(turnCosine_, k, dot(axis, t1) - turn * dot(normal, t1));
        store(turnSine_, k, dot(axis, t2) - turn * dot(normal, t2));
        store(cosine_, k, cosine);
        for (std::size_t l = 0; l < 4; ++l) onOneSheet_[k + l] = sheet[l];
    }

    std::size_t count_ = 0;
    std::array<NodeIndex, kMax> node_;
    std::array<bool, kMax> linked_, onOneSheet_;
    alignas(16) Vectors chord_{}, normal_{};
    alignas(16) Array ax_, ay_, turnCosine_, turnSine_, cosine_;
};

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
            addRow(i, candidates, links);
        }
        block.begin[end - begin] = std::uint16_t(links.size());
        block.link.assign(links.begin(), links.end());
        if (core_.costsVary) findLeastAround(block, begin, end);
    }

private:
    void find(NodeIndex i, const LeafNumbers<1>& numbers, Candidates& candidates) const {
        candidates.clear();
        const JetNode& node = core_.nodes[i];
        auto add = [&](NodeIndex j, const Vec3f& chord, bool linked) {
            candidates.add(j, chord, core_.nodes[j].normal, linked);
        };
        auto addLinked = [&](NodeIndex j, const Ijk&, const Vec3f& chord, float) {
            add(j, chord, true);
        };
        if (!stencil_.empty()) return forStencil(core_, stencil_, i, addLinked);
        const std::uint32_t severed = core_.severedSteps(node);
        numbers.forNeighbors(node.offset, [&](NodeIndex j, const Ijk& step) {
            if (severed && severed & SeveredLinks::bit(step.x, step.y, step.z)) return;
            add(j, node.foot - core_.nodes[j].foot - Vec3f(step), false);
        });
        if (node.facing & Band::kBridged) forBridges(core_, node, addLinked);
    }

    void addRow(NodeIndex i, Candidates& candidates, std::vector<JetLink>& row) const {
        constexpr float kSmooth = 0.9f;
        const float mayBeCrease = core_.band.faceted ? 1.0f : kSmooth;
        const JetNode& node = core_.nodes[i];
        const TangentFrame frame(node.normal, core_.band.faceted);
        candidates.layOut(frame);
        const bool mayBeHidden = node.obstacleState != Metric::Clear,
                   weighted = core_.costsVary && core_.stretch.empty();
        for (std::size_t k = 0; k < candidates.count(); ++k) {
            const JetNode& other = core_.nodes[candidates.node(k)];
            if (!candidates.isSure(k) && (!candidates.onOneSheet(k) ||
                                          (mayBeHidden && isHidden(core_, other, core_.footOf(node),
                                                                   node.normal + other.normal))))
                continue;
            JetLink link = candidates.link(k);
            const float cosine = candidates.cosine(k);
            if (cosine < mayBeCrease)  // TangentFrame decides
                link.a = frame.unfold(candidates.chord(k), candidates.normal(k), cosine);
            // docs/method.md, "The metric": weights.
            if (weighted) link.a = meanWeight(other.weight, node.weight) * link.a;
            if (cosine < kSmooth) link.key |= JetLink::kCrease;
            row.push_back(link);
        }
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

void JetLinks::make(const JetCore& core, NodeIndex i, const JetStencil& stencil) {
    if (blockOf(i)) return;
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
