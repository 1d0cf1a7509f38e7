/// The march of scheme `jet` over the core of a band. Internal.
#pragma once

#include <igeo/march/detail/jet_meeting.h>
#include <igeo/march/detail/jet_queue.h>
#include <igeo/march/detail/jet_start.h>
#include <igeo/march/detail/jet_update.h>
#include <igeo/march/field.h>
#include <igeo/march/jet_options.h>

#include <algorithm>

namespace igeo {

/// The march over the core of a band, batch by batch: the nodes of the first buckets are solved
/// from nodes accepted before, accepted together, and put their neighbors into later buckets.
///
/// Within a batch values are single, relative to its start, in units of cost; a group of nodes
/// (JetGroup) counts them in units of the weight of each node.
class JetMarch {
public:
    JetMarch(std::shared_ptr<const JetCore> core, const std::vector<SurfacePoint>& seeds,
             const JetOptions& options);
    void march(Progress& progress);
    /// The field; the march is over then.
    Field take();

private:
    struct Queued {
        std::uint32_t bucket;
        NodeIndex node;
    };
    struct Accepted {
        NodeIndex node;
        std::uint32_t label;
        JetState state;
    };
    /// Part of a batch, for one thread: what it found out, to be written once all are solved.
    struct Chunk {
        std::vector<Accepted> accepted;
        std::vector<Queued> queued;         ///< neighbors, into an earlier bucket than before
        std::vector<Queued> deferred;       ///< nodes of the batch that are not final
        std::vector<Queued> requeueLater;   ///< neighbors that are in the batch themselves
        std::size_t byFallback = 0;         ///< of the accepted nodes
        std::vector<NodeIndex> frontsMeet;  ///< accepted nodes: JetGroup::Solution::frontsMeet
        std::size_t stopNodes = 0;          ///< of the accepted nodes
        bool tooFar = false;                ///< a value beyond the last bucket
        double heaviest = 0;

        void clear() {
            accepted.clear(), queued.clear(), deferred.clear(), requeueLater.clear();
            frontsMeet.clear();
            byFallback = stopNodes = 0;
        }
    };
    /// A node of a group.
    struct Node {
        NodeIndex core;
        /// Links to nodes without a jet that may be put into other buckets.
        std::array<std::uint8_t, JetLinks::kMax> waiting;
        std::size_t waitingCount;
        float jump;               ///< the least value over jumps, +inf without
        std::uint32_t jumpLabel;  ///< its source
    };
    /// Links of a node to nodes that have a jet.
    struct Known {
        std::array<std::uint8_t, JetLinks::kMax> link;
        std::size_t count;
    };
    struct Group {
        JetGroup jets;
        std::array<Node, Lanes::kNodes> nodes;
    };
    /// What a solve comes to.
    struct Result {
        float u;  ///< relative to the start of the batch
        Vec2f g;
        std::uint32_t label;
        bool usedFallback, frontsMeet;
    };

    std::uint32_t bucketOf(double u) const { return jets_.buckets.bucketOf(u, kLastBucket); }
    /// So many buckets after the start of a batch lies a value.
    std::uint32_t bucketsTo(float u) const {
        const float buckets = u / width_;
        return !(buckets > 0)                 ? 0
               : buckets < float(kLastBucket) ? std::uint32_t(std::int64_t(buckets))
                                              : kLastBucket;
    }
    static std::uint32_t later(std::uint32_t bucket, std::uint32_t by) {
        return by < kLastBucket - bucket ? bucket + by : kLastBucket;
    }
    /// How far beyond the start of a batch a value may lie and be final: nodes still to come lie
    /// beyond the start, and a step from one of them costs more than half a voxel at the mean of
    /// both costs. One bucket where costs are least, and many where they are large, so that these
    /// need no march bucket by bucket.
    float slackOf(NodeIndex i) const {
        return core_.costsVary ? slackOf(i, links_.leastAround(i)) : width_;
    }
    float slackOf(NodeIndex i, float leastAround) const {
        return float(options_.bucketWidth) * (float(core_.leastCostAt(i)) + leastAround) / 2;
    }

    void enqueueStartDiscs();
    void initStopNodes();
    Batch nextBatch();

    /// The three phases of a batch: BucketQueue.
    void process(const Batch& batch);
    void solve(const Batch& batch, std::size_t chunkCount);
    void accept(std::size_t chunkCount);
    void collect(std::size_t chunkCount);

    void solveChunk(const Batch& batch, std::size_t begin, std::size_t end, Chunk& chunk);
    void prefetchNode(NodeIndex i) const {
        __builtin_prefetch(&core_.nodes[i]);
        __builtin_prefetch(&jets_.state[i]);
        links_.prefetchPlace(i);
    }
    void solveGroup(const Batch& batch, Group& group, Chunk& chunk);
    void gather(NodeIndex i, const Batch& batch, Group& group);
    /// Sorts the links of a node: those to nodes that have a jet, and Node::waiting.
    Known split(std::span<const JetLink> row, const Batch& batch, Node& node) const;
    /// Whether a front may go around something beside a node: an obstacle, the end of S, or a
    /// corner at which creases within two links meet.
    bool isAtRim(NodeIndex i) const;
    void gatherJumps(const Batch& batch, Node& node) const;
    /// Accepts a node and enqueues its neighbors if its value is final, else defers it.
    void settle(const Node& node, Result s, const Batch& batch, Chunk& chunk);
    /// The jet of its start disc, unless the front of another seed was there before.
    Result exactNearSeed(NodeIndex core, const Result& s, const Batch& batch) const;
    /// Not below the straight line from the seed.
    float boundedBelow(NodeIndex i, float u, std::uint32_t label, const Batch& batch) const;
    /// Whether a value at a core node is within JetOptions::below, or next to it.
    bool withinLimit(NodeIndex i, float u, const Batch& batch) const;
    JetState stateOf(const Result& s, const Batch& batch) const;
    /// Puts the nodes that wait at the other ends of its links into the buckets of the values that
    /// an accepted jet carries to them, after the batch at the earliest.
    void enqueue(const Node& node, const Result& jet, const Batch& batch, Chunk& chunk);
    void enqueueJumps(NodeIndex from, const Result& jet, const Batch& batch, Chunk& chunk);
    /// Puts a node into the bucket of a value, after the batch at the earliest.
    void put(NodeIndex i, float u, const Batch& batch, Chunk& chunk);
    /// Whether put() may move a node out of this bucket: not where that is next to the last of the
    /// batch. The buckets of nodes in the batch, or taken out of it just now, are settled in
    /// collect(), and without tensors such nodes come back soon enough. Once false, it stays so for
    /// the batch.
    static bool mayPut(std::uint32_t bucket, std::uint32_t last, bool isotropic) {
        return isotropic ? bucket > last + 1 : bucket != last + 1;
    }

    const std::shared_ptr<const JetCore> shared_;
    const JetCore& core_;
    const JetOptions& options_;
    JetLinks ownLinks_;  ///< around the front, where the core has none
    const JetLinks& links_;
    CoreJets jets_;
    BucketQueue queue_;
    const StartDiscs discs_;
    const float width_;                   ///< of a bucket: half a voxel at the least cost
    const std::uint32_t lastDiscBucket_;  ///< nodes of a disc wait there or earlier
    double heaviest_ = 0;                 ///< the largest cost per unit length accepted so far
    bool stopped_ = false;                ///< the limit ended the march
    std::vector<Chunk> chunks_;
    std::vector<bool> stopNodes_;  ///< nodes of the core that the march has to reach; empty: all
    std::vector<NodeIndex> frontsMeet_;  ///< as Chunk::frontsMeet
    std::size_t byFallback_ = 0, stopNodesLeft_ = 0, accepted_ = 0, chunkSize_ = 0;
};

}  // namespace igeo
