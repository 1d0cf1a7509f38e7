#include <igeo/march/jet.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_core.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>

namespace igeo {

namespace {

/// An early stop marches this far beyond its limit, so that the nodes within it have all the
/// neighbors that a full march would give them.
constexpr double kMargin = 3;

/// Buckets are counted from the smallest start value; kNoBucket is beyond all.
/// Values beyond this bucket do not fit: 2e9 voxels of the least weight.
constexpr std::uint32_t kLastBucket = kNoBucket - 2;

/// The march goes over the core of the band; the other nodes then take the jets of the core around
/// their foot points.
class JetMarch {
public:
    JetMarch(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
             const JetOptions& options);
    void march(Progress& progress);
    /// The field on the whole band.
    Field take();

private:
    using Node = JetCore::Node;
    struct Queued {
        std::uint32_t bucket;
        NodeIndex node;
    };
    /// Part of a bucket, for one thread: what is accepted, and who waits for what bucket now.
    struct Chunk {
        std::vector<std::pair<NodeIndex, Solved>> accepted;
        std::vector<Queued> queued, tooEarly;
        std::vector<Queued> again;  ///< where jets of this bucket put nodes that are in it as well
    };

    std::uint32_t bucketOf(double u) const {
        return std::uint32_t(
            std::min(std::max(0.0, (u - core_.first) / bucketWidth_), double(kLastBucket)));
    }
    /// How far beyond a bucket's start a value may lie to stand, found from all that was accepted
    /// before: nodes still to come lie beyond the start, and a step from one of them costs more
    /// than half a voxel at the mean of both costs. One bucket where costs are least, and many
    /// where they are large, which need not be gone through one by one.
    double slackOf(double cost, double leastAround) const {
        return options_.bucketWidth * (cost + leastAround) / 2;
    }
    /// Whether a front that comes to a core node with this value is wanted (JetOptions::below).
    bool wanted(NodeIndex core, double u) const {
        if (!options_.below) return true;
        const Node& node = core_.nodes[core];
        const NodeIndex i = core_.band.leaves[node.leaf].band.numberOf(node.offset);
        return u < (*options_.below)[i] + kMargin * core_.largestCost(core);
    }
    void startDisc(std::uint32_t seed);
    void watchTargets();
    /// The queue's list of a bucket also holds nodes that an earlier front has put elsewhere since.
    /// Which ones depends on the order of the threads: nothing may be decided by them.
    bool waitsIn(std::uint32_t bucket, NodeIndex i) const {
        return core_.nodes[i].bucket == bucket;
    }
    /// Whether the queue holds a node that waits; drops first buckets that hold none.
    bool anyWaits();
    /// The nodes of the first bucket, and of those behind it that need not wait for its values.
    /// @param last  the last of these buckets
    std::vector<NodeIndex> nextNodes(std::uint32_t& last);
    /// Solves a node from its accepted neighbors; if it belongs into this bucket, puts the others
    /// into the buckets where its jet says they belong.
    /// @param last  no node goes into a bucket up to this one
    Solved visit(NodeIndex i, std::uint32_t bucket, std::uint32_t last, Chunk& out);
    /// @param from, way  a place with that jet, and the chord from there to node i
    void key(NodeIndex i, const Place& from, const Vec3f& way, const Solved& jet,
             std::uint32_t last, Chunk& out);
    void process(std::uint32_t bucket, std::uint32_t last, const std::vector<NodeIndex>& nodes);

    /// Start discs are exact, unless the front of another seed was there before.
    Solved preferDisc(NodeIndex core, const Solved& s) const;

    const MetricPtr held_;
    const JetOptions& options_;
    JetCore core_;
    double bucketWidth_;   ///< half a voxel at the least cost
    double heaviest_ = 0;  ///< the largest cost per unit length accepted so far
    std::map<std::uint32_t, std::vector<NodeIndex>> queue_;
    std::vector<Chunk> chunks_;
    std::map<NodeIndex, Solved> discs_;  ///< jets around the seeds, by core node
    double limit_;                       ///< distances beyond it are not wanted
    bool stopped_ = false;               ///< the limit ended the march
    std::vector<bool> awaited_;
    std::size_t awaitedCount_ = 0, accepted_ = 0, guarded_ = 0;
};

JetMarch::JetMarch(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
                   const JetOptions& options)
    : held_(std::move(metric)),
      options_(options),
      core_(band, *held_, seeds, options.startRadius),
      bucketWidth_(options.bucketWidth * core_.leastCost),
      limit_(options.maxDistance) {
    const auto [first, last] = std::minmax_element(
        seeds.begin(), seeds.end(), [](auto& a, auto& b) { return a.start < b.start; });
    // Buckets are numbered in 32 bits.
    if (!(last->start - first->start < 1e9 * core_.leastCost))
        throw Error(Error::Kind::InvalidArgument,
                    "start values of seeds differ by more than 1e9 voxels",
                    "give seeds that no front comes near to a run of their own");
    for (std::size_t k = 0; k < seeds.size(); ++k) startDisc(std::uint32_t(k));
}

void JetMarch::startDisc(std::uint32_t k) {
    const SurfacePoint& seed = core_.seeds[k];
    auto put = [&](NodeIndex i, const Solved& s) {
        core_.discEnd = std::max(core_.discEnd, s.u);
        const auto [at, isNew] = discs_.try_emplace(i, s);
        if (!isNew && s.u < at->second.u) at->second = s;
        const std::uint32_t b = bucketOf(s.u);
        if (b < core_.nodes[i].bucket) core_.nodes[i].bucket = b, queue_[b].push_back(i);
    };
    // Outward from the seed over the core, so that no disc reaches a surface close by.
    std::vector<NodeIndex> found;
    std::set<NodeIndex> seen;
    NodeIndex nearest = kNoNode;
    double least = kInfinity;
    auto visit = [&](NodeIndex i) {
        if (!seen.insert(i).second) return;
        const Vec3d foot = core_.footOf(core_.nodes[i]), from = seed.nearestTo(foot);
        if (core_.nodes[i].sight == Metric::Inside ||
            held_->blocked(from, foot, Vec3d(core_.seedNormal[k])))
            return;
        if (const double r = length(foot - from); r < least) least = r, nearest = i;
        if (Solved s; core_.discJet(k, core_.placeOf(i), foot, s)) put(i, s), found.push_back(i);
    };
    const Vec3f side = core_.band.normal[seed.node];
    core_.band.forBox(&BandLeaf::core, core_.band.leaf[seed.node], core_.band.offset[seed.node], {},
                      2, [&](NodeIndex i, const Ijk&) {
                          const Node& node = core_.nodes[i];
                          if (igeo::dot(node.normal, side) >= Band::kOtherSheet &&
                              !stacked(Vec3f(core_.footOf(node) - seed.pIndex), node.normal, side))
                              visit(i);
                      });
    for (std::size_t at = 0; at < found.size(); ++at) {
        const Node& node = core_.nodes[found[at]];
        core_.band.forNeighbors(
            &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
                const Node& other = core_.nodes[j];
                const Vec3f chord = node.foot - other.foot - Vec3f(Ijk{dx, dy, dz});
                if (igeo::dot(node.normal, other.normal) >= Band::kOtherSheet &&
                    !stacked(chord, node.normal, other.normal))
                    visit(j);
            });
    }
    // A seed in a corner that no node near it can see: straight to the nearest.
    if (found.empty() && nearest != kNoNode)
        put(nearest, {seed.start + seed.weight * least, {}, core_.source[k], false});
}

Solved JetMarch::preferDisc(NodeIndex i, const Solved& s) const {
    const auto disc = discs_.find(i);
    if (disc == discs_.end() || (s.u < disc->second.u && s.label != disc->second.label)) return s;
    return disc->second;
}

Solved JetMarch::visit(NodeIndex i, std::uint32_t bucket, std::uint32_t last, Chunk& out) {
    const Place place = core_.placeOf(i);
    Surroundings known;
    // Bare numbers, which cost nothing until they are set.
    struct Waiting {
        NodeIndex node;
        float x, y, z;  ///< the chord from its foot point to this one
    };
    std::array<Waiting, JetCore::kMaxStencil> waiting;
    std::size_t waitingCount = 0;
    const double cost = core_.leastCostAt(i);
    double leastAround = cost;
    auto look = [&](NodeIndex j, const Ijk&, const Vec3f& chord, float cosine) {
        if (core_.varied) leastAround = std::min(leastAround, core_.leastCostAt(j));
        if (!(core_.nodes[j].u < kInfinity))
            waiting[waitingCount++] = {j, chord.x, chord.y, chord.z};
        else if (!known.full())
            core_.see(j, chord, cosine, place, known);
    };
    if (core_.stencil.empty())
        core_.forLinks(i, look);
    else
        core_.forStencil(i, look);
    // One per lattice column: on a surface that goes on all around these are eight, or nearly so.
    // Tensors squeeze the picture, and at a straight rim the guard would err by more than it saves.
    constexpr std::size_t kAllAround = 7;
    known.all.rim =
        core_.nodes[i].sight != Metric::Clear ||
        (core_.stretch.empty() && std::size_t(known.all.count()) + waitingCount < kAllAround);
    Solved s = core_.solve(place, known);
    // Nodes of a disc wait in its buckets or earlier.
    if (bucket <= bucketOf(core_.discEnd)) s = preferDisc(i, s);
    if (!wanted(i, s.u)) s.u = kInfinity;
    s.stands =
        s.u < kInfinity && bucketOf(s.u - (slackOf(cost, leastAround) - bucketWidth_)) <= bucket;
    if (s.stands)
        for (std::size_t k = 0; k < waitingCount; ++k)
            key(waiting[k].node, place, -Vec3f(waiting[k].x, waiting[k].y, waiting[k].z), s, last,
                out);
    return s;
}

void JetMarch::key(NodeIndex i, const Place& from, const Vec3f& way, const Solved& jet,
                   std::uint32_t last, Chunk& out) {
    // Several threads may key one node: the least bucket wins, whoever comes first.
    const std::atomic_ref waitsIn(core_.nodes[i].bucket);
    std::uint32_t seen = waitsIn.load(std::memory_order_relaxed);
    // In this bucket, or taken out of it just now: where it goes next is settled afterwards.
    // Without tensors nodes come back soon enough.
    const bool inBucket = seen <= last;
    if (seen == last + 1 || (inBucket && core_.stretch.empty())) return;
    // As jet::carry, by chords: good enough to know the bucket.
    const Vec3f chord = float(from.weight) * way;
    const double along = igeo::dot(jet.g, chord), c2 = core_.squaredCost(from, chord);
    const double r = jet.u - core_.first + std::max(along, 0.0);
    const double carried =
        along > 0 ? std::sqrt(r * r + std::max(c2 - along * along, 0.0)) : r + std::sqrt(c2);
    const std::uint32_t b = std::max(last + 1, bucketOf(core_.first + carried));
    if (inBucket) {
        out.again.push_back({b, i});
        return;
    }
    while (b < seen && !waitsIn.compare_exchange_weak(seen, b, std::memory_order_relaxed)) {
    }
    if (b < seen) out.queued.push_back({b, i});
}

bool JetMarch::anyWaits() {
    for (; !queue_.empty(); queue_.erase(queue_.begin())) {
        const auto& [bucket, list] = *queue_.begin();
        for (const NodeIndex i : list)
            if (waitsIn(bucket, i)) return true;
    }
    return false;
}

std::vector<NodeIndex> JetMarch::nextNodes(std::uint32_t& last) {
    const std::uint32_t first = queue_.begin()->first;
    std::vector<NodeIndex> nodes;
    if (!core_.varied) {
        last = first;
        nodes = std::move(queue_.begin()->second);
        queue_.erase(queue_.begin());
        return nodes;
    }
    // Together with the next buckets, up to the slack that every node has.
    double slack = kInfinity;
    do {
        const auto& [bucket, list] = *queue_.begin();
        const std::size_t before = nodes.size();
        for (const NodeIndex i : list)
            if (waitsIn(bucket, i)) {
                nodes.push_back(i);
                slack = std::min(slack, slackOf(core_.leastCostAt(i), 0));
            }
        if (bucket > first && (bucket - first + 1) * bucketWidth_ > slack) {
            nodes.resize(before);
            break;
        }
        last = bucket;
        queue_.erase(queue_.begin());
    } while (anyWaits());
    return nodes;
}

void JetMarch::process(std::uint32_t bucket, std::uint32_t last,
                       const std::vector<NodeIndex>& nodes) {
    constexpr std::size_t kChunk = 64;
    const std::size_t count = (nodes.size() + kChunk - 1) / kChunk;
    if (chunks_.size() < count) chunks_.resize(count);
    parallelFor(count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Chunk& chunk = chunks_[c];
            chunk.accepted.clear(), chunk.queued.clear(), chunk.tooEarly.clear(),
                chunk.again.clear();
            for (std::size_t k = c * kChunk; k < std::min(nodes.size(), (c + 1) * kChunk); ++k) {
                // Taken out of its bucket by whoever is first: it may be queued twice. Or it was
                // queued here before a front came to it from elsewhere, and earlier.
                const std::atomic_ref waitsIn(core_.nodes[nodes[k]].bucket);
                std::uint32_t seen = waitsIn.load(std::memory_order_relaxed);
                if (seen < bucket || seen > last ||
                    !waitsIn.compare_exchange_strong(seen, 0, std::memory_order_relaxed))
                    continue;
                const Solved s = visit(nodes[k], bucket, last, chunk);
                if (s.stands) {
                    chunk.accepted.emplace_back(nodes[k], s);
                } else if (s.u < kInfinity) {
                    // Again with what is known then: soon, but not in every bucket on the way, of
                    // which there are many where weights differ by much.
                    const std::uint32_t next =
                        std::max(last + 1, bucket + (bucketOf(s.u) - bucket + 1) / 2);
                    chunk.tooEarly.push_back({next, nodes[k]});
                }
            }
        }
    });
    // Accepted together: nobody has seen a value of this bucket before, nor a node that waits
    // again.
    parallelFor(count, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            for (const Queued& q : chunks_[c].tooEarly) core_.nodes[q.node].bucket = q.bucket;
            for (const auto& [i, s] : chunks_[c].accepted) {
                core_.nodes[i].u = s.u;
                core_.nodes[i].g = s.g;
                if (!core_.label.empty()) core_.label[i] = s.label;
            }
        }
    });
    for (std::size_t c = 0; c < count; ++c) {
        accepted_ += chunks_[c].accepted.size();
        for (const auto& [i, s] : chunks_[c].accepted) {
            guarded_ += s.guarded;
            heaviest_ = std::max(heaviest_, core_.largestCost(i));
            if (!awaited_.empty() && awaited_[i]) --awaitedCount_;
        }
        for (const auto* list : {&chunks_[c].queued, &chunks_[c].tooEarly})
            for (const Queued& q : *list) queue_[q.bucket].push_back(q.node);
        for (const Queued& q : chunks_[c].again) {
            Node& node = core_.nodes[q.node];
            if (node.u < kInfinity || node.bucket <= q.bucket) continue;
            node.bucket = q.bucket;
            queue_[q.bucket].push_back(q.node);
        }
    }
}

void JetMarch::watchTargets() {
    if (options_.stopAt.empty()) return;
    awaited_.assign(core_.nodes.size(), false);
    for (const SurfacePoint& p : options_.stopAt)
        for (const NodeIndex i : nodesAround(core_.band, p, 3.0)) {
            const NodeIndex core = core_.band.coreNode(i);
            if (core != kNoNode && !awaited_[core] && !held_->inside(i))
                awaited_[core] = true, ++awaitedCount_;
        }
}

void JetMarch::march(Progress& progress) {
    watchTargets();
    bool waits = awaitedCount_ > 0;
    while (anyWaits()) {
        const std::uint32_t bucket = queue_.begin()->first;
        if (bucket >= kLastBucket)
            throw Error(Error::Kind::InvalidArgument,
                        "a distance is more than 2e9 times the least weight, in voxels",
                        "raise the least weights: they make no difference beside the largest");
        if (core_.first + bucket * bucketWidth_ > limit_ + kMargin * heaviest_) {
            stopped_ = true;
            return;
        }
        std::uint32_t last = bucket;
        const std::vector<NodeIndex> nodes = nextNodes(last);
        process(bucket, last, nodes);
        if (waits && awaitedCount_ == 0) {
            limit_ = std::min(limit_, core_.first + (last + 1) * bucketWidth_);
            waits = false;
        }
        progress.throwIfCancelled();
        progress.update("march", double(accepted_) / double(core_.nodes.size()));
    }
}

Field JetMarch::take() {
    Field field;
    extendJets(core_, limit_, /*everywhere=*/accepted_ == core_.nodes.size(), field);
    field.atFootPoints = true;
    field.metric = held_;
    field.seeds = std::move(core_.seeds);
    field.scheme = "jet";
    field.startRadius = options_.startRadius;
    field.stoppedEarly = stopped_ || options_.below;
    field.solved = accepted_;
    field.guarded = guarded_;
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
