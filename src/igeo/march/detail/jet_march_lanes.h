/// What a march does for the nodes of a group, and for the links of a node, side by side in the
/// vector registers. Internal.
///
/// Each lane has the same bits in registers of any width.
#pragma once

#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_state.h>

#include <array>
#include <span>

namespace igeo {

/// The links of the nodes of a group: those to neighbors that have a jet, and those to neighbors
/// that wait and may be put into other buckets.
struct JetRows {
    /// Numbers of links in their row; zeros, or numbers of others, follow as far as they are read.
    using Numbers = std::array<std::uint8_t, JetLinks::kMax + 4>;
    struct Row {
        std::span<const JetLink> links;  ///< JetLinks::kBehind more are read
        Numbers known, waiting;
        std::size_t knownCount, waitingCount;

        const JetLink& knownLink(std::size_t k) const { return links.data()[known[k]]; }
        const JetLink& waitingLink(std::size_t k) const { return links.data()[waiting[k]]; }
    };
    std::array<const Row*, Lanes::kNodes> of;
};

/// Whether a waiting node may be put out of a bucket: not where that is next to the last of the
/// batch. The buckets of nodes in the batch, or taken out of it just now, are settled in
/// collect(), and without tensors such nodes come back soon enough. Once false, it stays so for
/// the batch.
inline bool mayPut(std::uint32_t bucket, std::uint32_t next, bool isotropic) {
    return isotropic ? bucket > next : bucket != next;
}
/// Sorts the links of nodes.
/// @param rows  of which the links are set
/// @param next  the bucket behind the batch, as mayPut() has it
void split(std::span<JetRows::Row> rows, const JetState* state, std::uint32_t next, bool isotropic);

/// Lays the known neighbors of a group out and pads its lanes. Isotropic metrics only.
/// @param first, width  values count from the start of this bucket, in units of `weight`
/// @param weight  of the nodes; null: 1
void layOut(const JetRows& rows, const JetState* state, std::uint32_t first, float width,
            const Lanes* weight, JetLanes& lanes);

/// How values beyond the start of a bucket become buckets.
struct BucketScale {
    std::uint32_t first = 0;
    float width = 1;
    float most = 0;  ///< buckets behind the first, of those there are
    BucketScale() = default;
    BucketScale(std::uint32_t bucket, float bucketWidth);
};
/// Jets of up to eight nodes that go on along their links: on circles about their sources, at the
/// mean cost of both ends.
struct JetsOnLinks {
    std::size_t size = 0;
    Lanes u{};  ///< beyond the start of the first bucket
    Lanes gx{}, gy{};
    Lanes radius{};  ///< distance from the source
    Lanes weight{};  ///< of the node
    std::array<const JetRows::Row*, Lanes::kNodes> row;
    /// Found by carry(): the first of Row::waiting of each node, the second of each, and so on.
    alignas(32) std::array<std::array<std::uint32_t, Lanes::kNodes>, JetLinks::kMax> bucket;

    bool empty() const { return size == 0; }
    void add(float value, Vec2f g, float distance, float cost, const JetRows::Row& links) {
        u[size] = value, gx[size] = g.x, gy[size] = g.y;
        radius[size] = distance, weight[size] = cost, row[size++] = &links;
    }
};
/// Finds the buckets of the values that the jets carry to waiting neighbors, or earlier ones if
/// these are 1e9 buckets away. Isotropic metrics only.
/// @param jets  at least one
void carry(const BucketScale& scale, JetsOnLinks& jets);

}  // namespace igeo
