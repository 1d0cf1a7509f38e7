/// The march of scheme `jet` over the core of a band. Internal.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_march_lanes.h>
#include <igeo/march/detail/jet_meeting.h>
#include <igeo/march/detail/jet_queue.h>
#include <igeo/march/detail/jet_start.h>
#include <igeo/march/detail/jet_update.h>
#include <igeo/march/detail/mesh_read.h>
#include <igeo/march/field.h>
#include <igeo/march/jet_options.h>

#include <algorithm>
#include <utility>

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
    /// What one thread finds out about a part of a batch, to be written once all are solved.
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
    /// The first arrival over the jumps to a node; on a mesh by walks.
    struct Jump {
        float u = float(kInfinity);
        Vec2f g;  ///< direction of travel in the chart of the node; 0 where it is unknown
        std::uint32_t label = 0;
    };
    /// Nodes taken out of the queue, and their links.
    struct Taken {
        static constexpr std::size_t kMost = 8 * Lanes::kNodes;
        std::size_t size = 0;
        std::array<NodeIndex, kMost> node;
        std::array<JetRows::Row, kMost> row;
        std::array<bool, kMost> creased;  ///< JetLinks::Row::creased
    };
    /// Up to eight nodes that are solved side by side.
    struct Group {
        std::size_t size = 0;
        std::array<NodeIndex, Lanes::kNodes> node;
        std::array<float, Lanes::kNodes> line2;
        /// Whether a neighbor that has a jet is over a crease; with tensors, any neighbor.
        std::array<bool, Lanes::kNodes> overCrease;
        JetRows rows;
        Lanes weight;
        JetGroup jets;
        JetsOnLinks accepted;  ///< isotropic: those that go on to their neighbors

        Group() { std::fill_n(weight.of, Lanes::kNodes, 1.0f); }
        void add(const Taken& taken, std::size_t k) {
            node[size] = taken.node[k], overCrease[size] = taken.creased[k];
            rows.of[size++] = &taken.row[k];
        }
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

    /// A value relative to the start of the batch.
    float fromStart(double u) const { return float(u - batchStart_); }
    /// The distance of a jet from the least start.
    float radiusOf(const Result& jet) const { return float(batchRadius_ + double(jet.u)); }

    void enqueueStartDiscs();
    void initStopNodes();
    Batch nextBatch();

    /// The three phases of a batch: BucketQueue.
    void process(const Batch& batch);
    void solve(const Batch& batch, std::size_t chunkCount);
    void accept(std::size_t chunkCount);
    void collect(std::size_t chunkCount);

    /// @param chunk  empty
    void solvePart(const Batch& batch, std::size_t begin, std::size_t end, Chunk& chunk);
    void prefetchNode(NodeIndex i) const {
        __builtin_prefetch(&core_.nodes[i]);
        __builtin_prefetch(&jets_.state[i]);
        links_.prefetchPlace(i);
    }
    /// Solves nodes in groups that have about as many known neighbors.
    void solveTaken(const Batch& batch, Taken& taken, Group& group, Chunk& chunk);
    void solveGroup(const Batch& batch, Group& group, Chunk& chunk);
    /// Begins the nodes in Group::jets.
    void gather(const Batch& batch, Group& group);
    /// Whether a detour (JetGroup::Solution) may come from neighbors beside its ray alone, as
    /// beside creases no other node of the core is next to it. On a mesh also two links from a
    /// crease: a front that fans out around a corner there turns too much from neighbor to
    /// neighbor.
    bool mayGoRound(NodeIndex i, const JetRows::Row& row) const;
    /// The least of a solution and of what nodes up to two links away carry: along straight lines
    /// on S, and on a mesh over walks.
    JetGroup::Solution overTwoLinks(NodeIndex i, const JetRows::Row& row, const Batch& batch,
                                    JetGroup::Solution s) const;
    JetGroup::Solution walkTwoLinks(NodeIndex i, const JetRows::Row& row,
                                    JetGroup::Solution s) const;
    /// Whether the chart of a node of a mesh misplaces the neighbors from which its value comes: a
    /// link or the segment between them is not as long in the chart as over the planes of its ends.
    /// No plane holds all faces that meet beside the node, nor does one a fold within a voxel. A
    /// fit may agree with a fallback that is as wrong as itself.
    bool isMisplaced(NodeIndex i, const JetRows::Row& row, const JetGroup::Solution& s,
                     bool overCrease) const;
    /// The neighbors on the two sides of a ray to a node that are nearest to it; equal: on one side
    /// there is none behind the node.
    static std::array<std::uint8_t, 2> nextToRay(const JetRows::Row& row, Vec2f g);
    /// The first arrival from nodes up to two links away, over walks.
    JetGroup::Solution solveByWalks(NodeIndex i, const JetRows::Row& row,
                                    JetGroup::Solution s) const;
    /// Adds the neighbors of a node in the coordinates of its tensor.
    void addStretched(NodeIndex i, const JetRows::Row& row, const Batch& batch,
                      JetGroup& jets) const;
    /// The value of an accepted node, relative to the start of a batch.
    float valueIn(const Batch& batch, NodeIndex i) const;
    /// Whether a neighbor that has a jet is over a crease.
    static bool knowsCrease(const JetRows::Row& row);
    /// The square of the straight line from the only seed to a node, at the least cost, and a
    /// little more for rounding; +inf where there are other seeds.
    float line2(const JetNode& node) const;
    /// Whether a front may go around something beside a node: an obstacle, the end of S, a
    /// corner at which creases within two links meet, or a jump of the costs.
    bool isAtRim(NodeIndex i) const;
    /// Whether a front that spreads around the corner of a rim has reached a neighbor: what comes
    /// straight past the corner, and has neighbors on one side only, does not reach the node.
    bool isInShadow(const JetRows::Row& row, const JetGroup::Solution& s) const;
    /// Whether a fit of a front with tensors lets it reach a node from the side: no neighbor is
    /// straight behind the node, or the node is at a rim, and no node further back confirms the
    /// fit. Behind a corner, where the front is not, a fit would carry it on: across the cheap axis
    /// neighbors are far apart. The same, without that node further back, where sheets of a mesh
    /// share voxels: there neighbors straight behind may be missing.
    bool comesSideways(NodeIndex i, const JetRows::Row& row, const JetGroup::Solution& s) const;
    /// Whether a neighbor of the front is straight behind a node.
    bool hasNeighborBehind(NodeIndex i, const JetRows::Row& row, const JetGroup::Solution& s) const;
    /// Whether a node of a mesh lacks links to voxels beside it, which lie on other sheets.
    bool sharesVoxels(NodeIndex i) const;
    /// Whether S goes on straight behind a node, to a node that belongs to the front and does not
    /// carry a later value.
    /// @param sameWay  cosine of the largest angle between the directions of both
    bool isConfirmedBehind(NodeIndex i, const JetGroup::Solution& s, float sameWay) const;
    /// The node over links from another, about so far along a direction of its tangent plane;
    /// kNoNode where S ends before.
    NodeIndex nodeAlong(NodeIndex i, Vec3f direction, float far) const;
    /// A neighbor of a node in the coordinates of its tensor, without a value.
    JetNeighbor inStretchedChart(NodeIndex i, const JetLink& link) const;
    /// Whether S folds or crosses within a voxel, so that no chart holds the links of a node.
    bool isFolded(NodeIndex i) const;
    Jump jumpTo(NodeIndex i) const;
    /// Whether an obstacle blocks a jump from j, or the walk that it stands for.
    /// @param walk  its length
    bool isJumpBlocked(NodeIndex i, NodeIndex j, double walk) const;
    /// A node from which a front may come to another.
    struct From {
        double least;  ///< of the other, if it does
        double most;   ///< longest walk, voxels
        NodeIndex node;
        const WalkEnds* line = nullptr;  ///< a straight line to the other
        bool operator<(const From& o) const {
            return std::pair(least, node) < std::pair(o.least, o.node);
        }
    };
    /// Calls visit(j) for the accepted nodes that are linked to node i.
    template <typename Visit>
    void forAccepted(NodeIndex i, const Visit& visit) const;
    /// The nodes up to two links away from which a front may come to a node with a value of at most
    /// `most`, over walks that are so much longer, in voxels, at most.
    std::vector<From> fromTwoLinks(NodeIndex i, const JetRows::Row& row, double most,
                                   double around) const;
    /// Whether the value of a node may be final if a front comes from one of some nodes: else it is
    /// found again.
    bool mayBeFinal(NodeIndex i, const std::vector<From>& from) const;
    /// The first arrival at a node from accepted nodes, carried over the triangles.
    /// @param around  voxels: from so much later nodes it is not sought
    Jump firstByWalks(NodeIndex i, std::vector<From> from, double around) const;
    /// Accepts a node and enqueues its neighbors if its value is final, else defers it.
    void settle(std::size_t lane, Group& group, Result s, const Batch& batch, Chunk& chunk);
    /// The jet of its start disc, unless the front of another seed was there before.
    Result exactNearSeed(NodeIndex core, const Result& s) const;
    /// The jet along the line over an edge from a seed, where the march finds a longer path.
    Result overEdgeNearSeed(NodeIndex i, const Result& s) const;
    /// Not below the straight line from the seed.
    float boundedBelow(NodeIndex i, float u, std::uint32_t label) const;
    /// Whether a value at a core node is within JetOptions::below, or next to it.
    bool withinLimit(NodeIndex i, float u, const Batch& batch) const;
    /// Whether the core has distances beyond the limit, or so near it that the band may.
    bool endsAtLimit() const;
    /// @return  bucket kLastBucket for values beyond
    JetState stateOf(const Result& s, const Batch& batch) const;
    /// Puts the nodes that wait at the other ends of their links into the buckets of the values
    /// that accepted jets carry to them, after the batch at the earliest.
    void enqueue(const Batch& batch, JetsOnLinks& accepted, Chunk& chunk);
    void enqueueStretched(NodeIndex i, const JetRows::Row& row, const Result& jet,
                          const Batch& batch, Chunk& chunk);
    void enqueueJumps(NodeIndex from, const Result& jet, const Batch& batch, Chunk& chunk);
    /// Puts a node into the bucket of a value, after the batch at the earliest.
    void put(NodeIndex i, float u, const Batch& batch, Chunk& chunk);
    void lower(NodeIndex i, std::uint32_t to, std::uint32_t current, Chunk& chunk) {
        if (queue_.lower(i, to, current)) chunk.queued.push_back({to, i});
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
    const bool isotropic_, weighted_, onMesh_;
    const bool ofOnePoint_;  ///< the only source is one
    /// Its voxel, and where it is from there.
    Registers<4>::Integers seedVoxel_{};
    Registers<4>::Vector seedFoot_{};
    const float leastCost2_;  ///< square of the least cost
    double batchStart_ = 0;   ///< where the batch in work begins
    double batchRadius_ = 0;  ///< the same, from the least start
    BucketScale scale_;       ///< from there on
    double heaviest_;         ///< the largest cost per unit length accepted so far
    bool stopped_ = false;    ///< the limit ended the march
    std::vector<Chunk> chunks_;
    std::vector<bool> stopNodes_;  ///< nodes of the core that the march has to reach; empty: all
    std::vector<NodeIndex> frontsMeet_;  ///< as Chunk::frontsMeet
    std::size_t byFallback_ = 0, stopNodesLeft_ = 0, accepted_ = 0, chunkSize_ = 0;
};

}  // namespace igeo
