/// The links between the nodes of a core, laid out flat: what a solve asks of a neighbor and no
/// seed changes. Internal.
#pragma once

#include <igeo/band/band.h>

#include <array>
#include <atomic>
#include <span>
#include <vector>

namespace igeo {

struct JetCore;

/// A neighbor of a core node, laid out in the chart of that node.
struct JetLink {
    std::uint32_t key;   ///< twice node(), and overCrease()
    float ax, ay;        ///< a()
    float cosine, sine;  ///< of the angle by which directions of the neighbor's frame turn

    /// Normals further apart than 26 degrees are those of a crease.
    static constexpr float kSmooth = 0.9f;
    static constexpr std::uint32_t kCrease = 1;
    static constexpr std::uint32_t kMostNodes = std::uint32_t(1) << 31;
    static std::uint32_t keyOf(NodeIndex i) { return i << 1; }
    NodeIndex node() const { return key >> 1; }
    /// From the neighbor to the node; isotropic: times the mean of both weights, over the node's.
    Vec2f a() const { return {ax, ay}; }
    /// Whether the normals at both ends are more than 26 degrees apart.
    bool overCrease() const { return key & kCrease; }
    Vec2f turned(Vec2f g) const { return {cosine * g.x - sine * g.y, sine * g.x + cosine * g.y}; }
};

/// The neighbors of core nodes where links are not enough (kLinksRatio). If j is one of i's, i is
/// one of j's.
struct JetStencil {
    std::vector<NodeIndex> node;       ///< those of node i from begin[i] to begin[i + 1]
    std::vector<std::uint32_t> begin;  ///< at most JetLinks::kMax per node

    bool empty() const { return node.empty(); }
};

/// The links of core nodes, row by row, in blocks of nodes. If j is in the row of i, i is in that
/// of j: so an accepted node enqueues all that use it.
///
/// Many marches share blocks that are made at once, 46 bytes per node of the band. A single march
/// makes a block when it comes to one of its nodes, and drops it when all of them are accepted: it
/// holds blocks around its front only.
class JetLinks {
public:
    static constexpr std::size_t kBlock = 64;  ///< nodes
    static constexpr std::size_t kMax = 64;    ///< links per node
    static constexpr std::size_t kBehind = 3;  ///< links that may be read behind a row

    struct Block {
        std::array<std::uint16_t, kBlock + 1> begin;  ///< of the rows, and the end of the last
        std::uint64_t creased = 0;  ///< a bit per row: it has a link over a crease
        std::vector<JetLink> link;
        std::vector<float> leastAround;  ///< per node, where costs vary: the least of its own and
                                         ///< those of its neighbors
    };

    JetLinks() = default;
    explicit JetLinks(std::size_t nodes);
    JetLinks(JetLinks&& other) noexcept = default;
    JetLinks& operator=(JetLinks&& other) noexcept;
    ~JetLinks() { clear(); }

    bool empty() const { return blocks_.empty(); }
    std::size_t blockCount() const { return blocks_.size(); }
    /// Makes the block of a node, unless it is there. Several threads may ask for one at a time.
    /// @return whether it was not there
    bool make(const JetCore& core, NodeIndex i) {
        if (blockOf(i)) return false;
        makeBlock(core, i, kAllRows, {});
        return true;
    }
    void make(const JetCore& core, NodeIndex i, const JetStencil& stencil) {
        if (!blockOf(i)) makeBlock(core, i, kAllRows, stencil);
    }
    /// The same with some rows alone: the others are empty.
    /// @param rows  a bit per node of the block
    void makeRows(const JetCore& core, NodeIndex i, std::uint64_t rows) {
        if (!blockOf(i)) makeBlock(core, i, rows, {});
    }
    /// Drops the block of a node once this was called for all of its nodes. By one thread, while no
    /// other looks.
    void dropAccepted(NodeIndex i);
    /// Drops the block of a node, which no other thread looks at, if it is there.
    void drop(NodeIndex i) { delete blocks_[i / kBlock].exchange(nullptr); }

    struct Row {
        std::span<const JetLink> links;
        bool creased;  ///< one of them is over a crease
    };
    /// Of a node whose block is there.
    Row rowAt(NodeIndex i) const {
        const Block& block = *blockOf(i);
        const std::size_t k = i % kBlock, first = block.begin[k];
        return {{block.link.data() + first, block.begin[k + 1] - first},
                bool(block.creased >> k & 1)};
    }
    std::span<const JetLink> row(NodeIndex i) const { return rowAt(i).links; }
    float leastAround(NodeIndex i) const { return blockOf(i)->leastAround[i % kBlock]; }

    /// Brings the row of a node, or its place, nearer to the processor, if it is there: nine links,
    /// line by line.
    void prefetch(NodeIndex i) const {
        const Block* const block = blockOf(i);
        if (!block) return;
        const auto* const bytes =
            reinterpret_cast<const char*>(block->link.data() + block->begin[i % kBlock]);
        __builtin_prefetch(bytes);
        __builtin_prefetch(bytes + 64);
        __builtin_prefetch(bytes + 128);
        __builtin_prefetch(bytes + 179);
    }
    void prefetchPlace(NodeIndex i) const {
        const Block* const block = blockOf(i);
        if (!block) return;
        __builtin_prefetch(&block->link);
        __builtin_prefetch(&block->begin[i % kBlock]);
    }

private:
    static constexpr auto kAllRows = ~std::uint64_t(0);
    static_assert(kBlock == 64);

    void makeBlock(const JetCore& core, NodeIndex i, std::uint64_t rows, const JetStencil& stencil);
    const Block* blockOf(NodeIndex i) const {
        return blocks_[i / kBlock].load(std::memory_order_acquire);
    }
    void clear();

    std::vector<std::atomic<Block*>> blocks_;
    std::vector<std::uint8_t> left_;  ///< per block: nodes that are not accepted
};

}  // namespace igeo
