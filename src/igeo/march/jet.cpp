#include <igeo/march/jet.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_extend.h>
#include <igeo/march/detail/jet_neighborhood.h>
#include <igeo/march/detail/jet_queue.h>
#include <igeo/march/detail/jet_start.h>

#include <algorithm>

namespace igeo {

namespace {

/// An early stop marches this far beyond its limit, so that the nodes within it have all the
/// neighbors that a full march would give them.
constexpr double kMargin = 3;
/// Nodes per chunk of a batch.
constexpr std::size_t kChunk = 64;

/// The march over the core of a band, batch by batch: the nodes of the first buckets are solved
/// from nodes accepted before, accepted together, and put their neighbors into later buckets.
class JetMarch {
public:
    JetMarch(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
             const JetOptions& options);
    void march(Progress& progress);
    /// The field on the whole band; the march is over then.
    Field take();

private:
    struct Queued {
        std::uint32_t bucket;
        NodeIndex node;
    };
    /// A node without a jet next to one that is solved. Bare numbers, which cost nothing until they
    /// are set.
    struct Waiting {
        NodeIndex node;
        float x, y, z;  ///< the chord from its foot point to the other
    };
    /// The neighbors of a node that is solved.
    struct Gathered {
        Neighborhood known;
        std::array<Waiting, JetStencil::kMax> waiting;
        std::size_t waitingCount = 0;
        Solved jump;         ///< the least value over jumps
        double leastAround;  ///< the least cost per unit length of the node and its neighbors
    };
    /// Part of a batch, for one thread: what it found out, to be written once all are solved.
    struct Chunk {
        std::vector<std::pair<NodeIndex, Solved>> accepted;
        std::vector<Queued> queued;        ///< neighbors, into an earlier bucket than before
        std::vector<Queued> deferred;      ///< nodes of the batch that are not final
        std::vector<Queued> requeueLater;  ///< neighbors that are in the batch themselves

        void clear() { accepted.clear(), queued.clear(), deferred.clear(), requeueLater.clear(); }
    };

    std::uint32_t bucketOf(double u) const {
        return std::uint32_t(std::min(std::max(0.0, (u - core_.seeds.leastStart) / bucketWidth_),
                                      double(kLastBucket)));
    }
    double startOf(std::uint32_t bucket) const {
        return core_.seeds.leastStart + bucket * bucketWidth_;
    }
    /// How far beyond the start of a batch a value may lie and be final: nodes still to come lie
    /// beyond the start, and a step from one of them costs more than half a voxel at the mean of
    /// both costs. One bucket where costs are least, and many where they are large, so that these
    /// need no march bucket by bucket.
    double slackOf(double cost, double leastAround) const {
        return options_.bucketWidth * (cost + leastAround) / 2;
    }
    /// Whether a value at a core node is within JetOptions::below, or next to it.
    bool withinLimit(NodeIndex core, double u) const {
        if (!options_.below) return true;
        return u < (*options_.below)[core_.inBand(core_.nodes[core])] +
                       kMargin * core_.largestCostAt(core);
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
    /// Solves a node from its accepted neighbors; if the result is final, enqueues the others.
    Solved solveNode(NodeIndex i, const Batch& batch, Chunk& chunk);
    void gather(NodeIndex i, const LocalFrame& local, double cost, Gathered& around) const;
    void gatherJumps(NodeIndex i, Gathered& around) const;
    /// The jet of its start disc, unless the front of another seed was there before.
    Solved exactNearSeed(NodeIndex core, const Solved& s) const;
    /// Puts node i into the bucket of the value that a jet nearby carries to it, after the batch at
    /// the earliest.
    /// @param from, chord  the foot point with that jet, and the chord from there to node i
    void enqueue(NodeIndex i, const LocalFrame& from, const Vec3f& chord, const Solved& jet,
                 const Batch& batch, Chunk& chunk);

    const MetricPtr metric_;
    const JetOptions& options_;
    JetCore core_;
    BucketQueue queue_;
    const StartDiscs discs_;
    const double bucketWidth_;  ///< half a voxel at the least cost
    double heaviest_ = 0;       ///< the largest cost per unit length accepted so far
    double limit_;              ///< larger distances are left out
    bool stopped_ = false;      ///< the limit ended the march
    std::vector<Chunk> chunks_;
    std::vector<bool> stopNodes_;  ///< nodes of the core that the march has to reach; empty: all
    std::size_t stopNodesLeft_ = 0, accepted_ = 0, fallbackCount_ = 0;
};

JetMarch::JetMarch(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
                   const JetOptions& options)
    : metric_(std::move(metric)),
      options_(options),
      core_(buildJetCore(band, *metric_, seeds, options.startRadius)),
      queue_(core_.nodes),
      discs_(startDiscs(core_)),
      bucketWidth_(options.bucketWidth * core_.leastCost),
      limit_(options.maxDistance) {
    const auto last = std::max_element(seeds.begin(), seeds.end(),
                                       [](auto& a, auto& b) { return a.start < b.start; });
    // Buckets are numbered in 32 bits.
    if (!(last->start - core_.seeds.leastStart < 1e9 * core_.leastCost))
        throw Error(Error::Kind::InvalidArgument,
                    "start values of seeds differ by more than 1e9 voxels",
                    "give seeds that no front comes near to a run of their own");
    enqueueStartDiscs();
    initStopNodes();
}

void JetMarch::enqueueStartDiscs() {
    for (const auto& [i, s] : discs_) {
        core_.nodes[i].bucket = bucketOf(s.u);
        queue_.add(i, core_.nodes[i].bucket);
    }
}

void JetMarch::initStopNodes() {
    if (options_.stopAt.empty()) return;
    stopNodes_.assign(core_.nodes.size(), false);
    for (const SurfacePoint& p : options_.stopAt)
        for (const NodeIndex i : nodesAround(core_.band, p, 3.0)) {
            const NodeIndex core = core_.band.coreNode(i);
            if (core != kNoNode && !stopNodes_[core] && !metric_->inside(i))
                stopNodes_[core] = true, ++stopNodesLeft_;
        }
}

void JetMarch::march(Progress& progress) {
    bool mayStop = stopNodesLeft_ > 0;
    while (queue_.anyWaits()) {
        const std::uint32_t bucket = queue_.firstBucket();
        if (bucket >= kLastBucket)
            throw Error(Error::Kind::InvalidArgument,
                        "a distance is more than 2e9 times the least weight, in voxels",
                        "raise the least weights: they make no difference beside the largest");
        if (startOf(bucket) > limit_ + kMargin * heaviest_) {
            stopped_ = true;
            return;
        }
        const Batch batch = nextBatch();
        process(batch);
        if (mayStop && stopNodesLeft_ == 0) {
            limit_ = std::min(limit_, startOf(batch.last + 1));
            mayStop = false;
        }
        progress.throwIfCancelled();
        progress.update("march", double(accepted_) / double(core_.nodes.size()));
    }
}

Batch JetMarch::nextBatch() {
    if (!core_.variableCost) return queue_.popFirst();
    return queue_.popTogether(bucketWidth_,
                              [&](NodeIndex i) { return slackOf(core_.leastCostAt(i), 0); });
}

void JetMarch::process(const Batch& batch) {
    const std::size_t chunkCount = (batch.nodes.size() + kChunk - 1) / kChunk;
    if (chunks_.size() < chunkCount) chunks_.resize(chunkCount);
    solve(batch, chunkCount);
    accept(chunkCount);
    collect(chunkCount);
}

void JetMarch::solve(const Batch& batch, std::size_t chunkCount) {
    parallelFor(chunkCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            solveChunk(batch, c * kChunk, std::min(batch.nodes.size(), (c + 1) * kChunk),
                       chunks_[c]);
    });
}

void JetMarch::solveChunk(const Batch& batch, std::size_t begin, std::size_t end, Chunk& chunk) {
    chunk.clear();
    for (std::size_t k = begin; k < end; ++k) {
        const NodeIndex i = batch.nodes[k];
        if (!queue_.take(i, batch.first, batch.last)) continue;
        const Solved s = solveNode(i, batch, chunk);
        if (s.isFinal) {
            chunk.accepted.emplace_back(i, s);
        } else if (s.u < kInfinity) {
            // Half as far as its bucket: soon, with what is known then, but not in every bucket in
            // between, of which there are many where weights differ by much.
            const std::uint32_t half = batch.first + (bucketOf(s.u) - batch.first + 1) / 2;
            chunk.deferred.push_back({std::max(batch.last + 1, half), i});
        }
    }
}

Solved JetMarch::solveNode(NodeIndex i, const Batch& batch, Chunk& chunk) {
    const LocalFrame local = core_.localFrame(i);
    const double cost = core_.leastCostAt(i);
    Gathered around;
    gather(i, local, cost, around);
    Solved s = solveJet(core_, local, around.known);
    if (around.jump.u < s.u) s = around.jump;
    // Nodes of a disc wait in its buckets or earlier.
    if (batch.first <= bucketOf(core_.seeds.largestInDisc)) s = exactNearSeed(i, s);
    s.u = std::max(s.u, core_.seeds.lines.from(s.label, core_.footOf(core_.nodes[i])));
    if (!withinLimit(i, s.u)) s.u = kInfinity;
    const double slack = slackOf(cost, around.leastAround);
    s.isFinal = s.u < kInfinity && bucketOf(s.u - (slack - bucketWidth_)) <= batch.first;
    if (s.isFinal)
        for (std::size_t k = 0; k < around.waitingCount; ++k) {
            const Waiting& w = around.waiting[k];
            enqueue(w.node, local, -Vec3f(w.x, w.y, w.z), s, batch, chunk);
        }
    return s;
}

void JetMarch::gather(NodeIndex i, const LocalFrame& local, double cost, Gathered& around) const {
    around.leastAround = cost;
    forStencil(core_, i, [&](NodeIndex j, const Ijk&, const Vec3f& chord, float cosine) {
        if (core_.variableCost)
            around.leastAround = std::min(around.leastAround, core_.leastCostAt(j));
        if (!(core_.nodes[j].u < kInfinity))
            around.waiting[around.waitingCount++] = {j, chord.x, chord.y, chord.z};
        else if (!around.known.full())
            addNeighbor(core_, j, chord, cosine, local, around.known);
    });
    gatherJumps(i, around);
    // One per lattice column: on a surface that goes on all around these are eight, or nearly so.
    // Tensors squeeze the chart, and at a straight rim the fallback would err by more than it
    // saves.
    constexpr std::size_t kAllAround = 7;
    JetNeighbors& all = around.known.all;
    all.rim =
        core_.nodes[i].obstacleState != Metric::Clear ||
        (core_.stretch.empty() && std::size_t(all.count()) + around.waitingCount < kAllAround);
}

void JetMarch::gatherJumps(NodeIndex i, Gathered& around) const {
    forJumps(core_, i, [&](NodeIndex j, const Vec3f& chord) {
        const JetNode& other = core_.nodes[j];
        if (!(other.u < kInfinity)) {
            around.waiting[around.waitingCount++] = {j, chord.x, chord.y, chord.z};
            return;
        }
        const double cost = (core_.largestCostAt(i) + core_.largestCostAt(j)) / 2;
        const double u = other.u + cost * double(length(chord));
        if (u < around.jump.u) around.jump = {u, {}, core_.labelOf(j), false};
    });
}

Solved JetMarch::exactNearSeed(NodeIndex i, const Solved& s) const {
    const auto disc = discs_.find(i);
    if (disc == discs_.end() || (s.u < disc->second.u && s.label != disc->second.label)) return s;
    return disc->second;
}

void JetMarch::enqueue(NodeIndex i, const LocalFrame& from, const Vec3f& chord, const Solved& jet,
                       const Batch& batch, Chunk& chunk) {
    const std::uint32_t current = queue_.bucketOf(i), next = batch.last + 1;
    // In this batch, or taken out of it just now: its next bucket is settled in collect(). Without
    // tensors such nodes come back soon enough.
    const bool inBatch = current < next;
    if (current == next || (inBatch && core_.stretch.empty())) return;
    // The circular step by chords: good enough to know the bucket.
    const Vec3f c = float(from.weight) * chord;
    const double along = dot(jet.g, c), c2 = squaredCost(core_, from, c);
    const double r = jet.u - core_.seeds.leastStart + std::max(along, 0.0);
    const double carried =
        along > 0 ? std::sqrt(r * r + std::max(c2 - along * along, 0.0)) : r + std::sqrt(c2);
    const std::uint32_t to = std::max(next, bucketOf(core_.seeds.leastStart + carried));
    if (inBatch)
        chunk.requeueLater.push_back({to, i});
    else if (queue_.lower(i, to, current))
        chunk.queued.push_back({to, i});
}

void JetMarch::accept(std::size_t chunkCount) {
    parallelFor(chunkCount, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            for (const Queued& q : chunks_[c].deferred) core_.nodes[q.node].bucket = q.bucket;
            for (const auto& [i, s] : chunks_[c].accepted) {
                core_.nodes[i].u = s.u;
                core_.nodes[i].g = s.g;
                if (!core_.label.empty()) core_.label[i] = s.label;
            }
        }
    });
}

void JetMarch::collect(std::size_t chunkCount) {
    for (std::size_t c = 0; c < chunkCount; ++c) {
        const Chunk& chunk = chunks_[c];
        accepted_ += chunk.accepted.size();
        for (const auto& [i, s] : chunk.accepted) {
            fallbackCount_ += s.usedFallback;
            heaviest_ = std::max(heaviest_, core_.largestCostAt(i));
            if (!stopNodes_.empty() && stopNodes_[i]) --stopNodesLeft_;
        }
        for (const auto* list : {&chunk.queued, &chunk.deferred})
            for (const Queued& q : *list) queue_.add(q.node, q.bucket);
        for (const Queued& q : chunk.requeueLater) queue_.requeue(q.node, q.bucket);
    }
}

Field JetMarch::take() {
    Field field;
    field.band = &core_.band;
    extendJets(core_, limit_, /*everywhere=*/accepted_ == core_.nodes.size(), field);
    field.atFootPoints = true;
    field.metric = metric_;
    field.seeds = std::move(core_.seeds.points);
    field.scheme = "jet";
    field.startRadius = options_.startRadius;
    field.stoppedEarly = stopped_ || options_.below;
    field.limit = limit_;
    field.lines = std::move(core_.seeds.lines);
    field.solved = accepted_;
    field.fallbackCount = fallbackCount_;
    field.summarize();
    return field;
}

}  // namespace

Field marchJet(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
               const JetOptions& options, Progress& progress) {
    using Kind = Error::Kind;
    if (!metric) metric = std::make_shared<Metric>();
    if (seeds.empty()) throw Error(Kind::InvalidArgument, "a march needs at least one seed");
    if (!(options.maxDistance > 0))
        throw Error(Kind::InvalidArgument, "the largest distance must be positive");
    if (!(band.h >= std::sqrt(0.75)))
        throw Error(Kind::InvalidArgument, "a band of " + std::to_string(band.h) +
                                               " voxels is too narrow: jet needs sqrt(3)/2");
    if (options.below && options.below->size() != band.size())
        throw Error(Kind::InvalidArgument,
                    "JetOptions::below has " + std::to_string(options.below->size()) +
                        " values for " + std::to_string(band.size()) + " nodes");
    metric->check(band);
    JetMarch march(band, std::move(metric), seeds, options);
    march.march(progress);
    return march.take();
}

}  // namespace igeo
