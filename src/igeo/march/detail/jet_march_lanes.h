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
        const JetLink* link;
        Numbers known, waiting;
        std::size_t knownCount, waitingCount;

        const JetLink& knownLink(std::size_t k) const { return link[known[k]]; }
        const JetLink& waitingLink(std::size_t k) const { return link[waiting[k]]; }
    };
    std::array<Row, Lanes::kNodes> of;
};

/// Whether a waiting node may be put out of a bucket: not where that is next to the last of the
/// batch. The buckets of nodes in the batch, or taken out of it just now, are settled in
/// collect(), and without tensors such nodes come back soon enough. Once false, it stays so for
/// the batch.
inline bool mayPut(std::uint32_t bucket, std::uint32_t next, bool isotropic) {
    return isotropic ? bucket > next : bucket != next;
}
/// Sorts the links of a node.
/// @param links  its row; JetLinks::kBehind more are read
/// @param next   the bucket behind the batch, as mayPut() has it
void split(std::span<const JetLink> links, const JetState* state, std::uint32_t next,
           bool isotropic, JetRows::Row& row);

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
/// A jet that goes on along links: on a circle about its source, at the mean cost of both ends.
struct CarriedJet {
    float u;  ///< beyond the start of the first bucket
    Vec2f g;
    float radius;  ///< distance from the source
    float weight;  ///< of the node
};
/// The buckets of the values that a jet carries to waiting neighbors, or earlier ones if these are
/// 1e9 buckets away. Isotropic metrics only.
/// @param bucket  of a size that is a multiple of four
void carry(const CarriedJet& jet, const BucketScale& scale, const JetRows::Row& row,
           std::uint32_t* bucket);

}  // namespace igeo
