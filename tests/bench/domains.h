/// What a run of `jet` on several machines would work and send: a march that one machine has done,
/// replayed bucket by bucket over domains of leaves. Nothing is sent, everything is counted.
#pragma once

#include <igeo/band/band.h>
#include <igeo/march/field.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace igeo::test {

/// Who owns the leaves of a band, and the nodes in them.
struct Domains {
    std::size_t count = 1;
    std::vector<std::uint32_t> owner;  ///< per leaf, below `count`
};

/// Orders the leaves by halving: across the longest side of what is left, at half of its core
/// nodes. Cuts that order into count * pieces runs of as many core nodes each as leaves allow; run
/// k goes to domain k mod count.
/// @param pieces  1: each domain is a compact patch. More: its pieces lie all over the surface, so
///                that a front is more likely to be in one of them, and borders are longer
/// Time O(leaves log^2 leaves).
Domains domainsOf(const Band& band, std::size_t count, std::size_t pieces);

/// In which superstep a march accepts the nodes of the core.
struct Schedule {
    static constexpr std::uint32_t kNever = ~std::uint32_t(0);
    std::vector<std::uint32_t> step;  ///< per core node; kNever where it was not reached
    std::size_t steps = 0;
};

/// Supersteps are the buckets that hold a value, in order: nodes count where their value lies. (A
/// march accepts some in a later bucket, for what is put back and solved again.)
/// @param field  of marchJet without weights
/// @param bucketWidth  voxels, JetOptions::bucketWidth
Schedule scheduleOf(const Field& field, double bucketWidth);

/// Records that domains send each other: a record is a node's jet, sent to a domain that holds a
/// copy of the node, once, in the superstep in which it was accepted. So there are as many as
/// copies of nodes that are reached.
struct Traffic {
    std::uint64_t records = 0;
    std::uint64_t messages = 0;  ///< from one domain to another in one superstep
    /// Sums over the supersteps of the most that any one domain sends or receives, whichever is
    /// more.
    std::uint64_t mostRecords = 0, mostMessages = 0;
    std::uint64_t mostCopies = 0;  ///< that one domain holds, reached
};

struct Replay {
    std::uint64_t nodes = 0;         ///< of the core, reached
    std::uint64_t largestShare = 0;  ///< the most of them that one domain owns
    std::uint64_t mostWork = 0;  ///< the sum over supersteps of the most that one domain accepts
    std::uint64_t busy = 0;      ///< pairs of superstep and domain that accept any
    Traffic links;               ///< copies of the nodes within a voxel of an own one
    Traffic leaves;              ///< copies of all nodes of the leaves around own ones
};

/// Time O(nodes + records log records).
Replay replay(const Band& band, const Schedule& schedule, const Domains& domains);

}  // namespace igeo::test
