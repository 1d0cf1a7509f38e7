#include <igeo/march/detail/jet_march.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_meeting.h>

namespace igeo {

namespace {

/// An early stop marches this far beyond its limit, so that the nodes within it have all the
/// neighbors that a full march would give them: where fronts meet, those three links off.
constexpr double kMargin = 8;
/// The same beyond JetOptions::below, where a thousandth of a voxel makes no difference.
constexpr double kMarginBelow = 3;

/// Links of a node on a surface that goes on all around: one per lattice column, so eight, or
/// nearly so.
constexpr std::size_t kAllAround = 7;

[[noreturn]] void refuseTooFar() {
    throw Error(Error::Kind::InvalidArgument,
                "a distance is more than 2e9 times the least weight, in voxels",
                "raise the least weights: they make no difference beside the largest");
}

CoreJets unmarched(const std::shared_ptr<const JetCore>& core,
                   const std::vector<SurfacePoint>& seeds, const JetOptions& options) {
    CoreJets jets{core, JetSeeds(*core, seeds, options.startRadius), {}, {}, {}, {}, 0};
    // In single precision, as the march takes it.
    jets.buckets = {jets.seeds.leastStart, double(float(options.bucketWidth * core->leastCost))};
    jets.state.resize(core->nodes.size());
    if (jets.seeds.source.back() > 0) jets.label.assign(core->nodes.size(), 0);
    jets.limit = options.maxDistance;
    return jets;
}

}  // namespace

JetMarch::JetMarch(std::shared_ptr<const JetCore> core, const std::vector<SurfacePoint>& seeds,
                   const JetOptions& options)
    : shared_(std::move(core)),
      core_(*shared_),
      options_(options),
      ownLinks_(core_.links.empty() ? core_.nodes.size() : 0),
      links_(core_.links.empty() ? ownLinks_ : core_.links),
      jets_(unmarched(shared_, seeds, options)),
      queue_(jets_.state),
      discs_(startDiscs(core_, jets_.seeds)),
      width_(float(jets_.buckets.width)),
      lastDiscBucket_(bucketOf(jets_.seeds.largestInDisc)) {
    const auto last = std::max_element(seeds.begin(), seeds.end(),
                                       [](auto& a, auto& b) { return a.start < b.start; });
    // Buckets are numbered in 32 bits.
    if (!(last->start - jets_.seeds.leastStart < 1e9 * core_.leastCost))
        throw Error(Error::Kind::InvalidArgument,
                    "start values of seeds differ by more than 1e9 voxels",
                    "give seeds that no front comes near to a run of their own");
    enqueueStartDiscs();
    initStopNodes();
}

void JetMarch::enqueueStartDiscs() {
    for (const auto& [i, s] : discs_) {
        jets_.state[i].bucket = bucketOf(s.u);
        queue_.add(i, jets_.state[i].bucket);
    }
}

void JetMarch::initStopNodes() {
    if (options_.stopAt.empty()) return;
    stopNodes_.assign(core_.nodes.size(), false);
    for (const NodeIndex i : options_.stopAt)
        if (!core_.metric.inside(core_.inBand(core_.nodes[i])))
            stopNodes_[i] = true, ++stopNodesLeft_;
}

void JetMarch::march(Progress& progress) {
    bool mayStop = stopNodesLeft_ > 0;
    while (queue_.anyWaits()) {
        const std::uint32_t bucket = queue_.firstBucket();
        if (bucket >= kLastBucket) refuseTooFar();
        if (jets_.buckets.startOf(bucket) > jets_.limit + kMargin * heaviest_) {
            stopped_ = true;
            return;
        }
        const Batch batch = nextBatch();
        process(batch);
        if (mayStop && stopNodesLeft_ == 0) {
            jets_.limit = std::min(jets_.limit, jets_.buckets.startOf(batch.last + 1));
            mayStop = false;
        }
        progress.throwIfCancelled();
        progress.update("march", double(accepted_) / double(core_.nodes.size()));
    }
}

Batch JetMarch::nextBatch() {
    if (!core_.costsVary) return queue_.popFirst();
    return queue_.popTogether(double(width_), [&](NodeIndex i) { return double(slackOf(i, 0)); });
}

void JetMarch::process(const Batch& batch) {
    // As many chunks as keep the threads busy to the end, of whole groups.
    const auto threads = std::size_t(ThreadLimit::current());
    chunkSize_ = std::clamp(batch.nodes.size() / (2 * threads) / Lanes::kNodes * Lanes::kNodes,
                            Lanes::kNodes, 8 * Lanes::kNodes);
    const std::size_t chunkCount = (batch.nodes.size() + chunkSize_ - 1) / chunkSize_;
    if (chunks_.size() < chunkCount) chunks_.resize(chunkCount);
    solve(batch, chunkCount);
    accept(chunkCount);
    collect(chunkCount);
}

void JetMarch::solve(const Batch& batch, std::size_t chunkCount) {
    parallelFor(chunkCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            solveChunk(batch, c * chunkSize_, std::min(batch.nodes.size(), (c + 1) * chunkSize_),
                       chunks_[c]);
    });
}

void JetMarch::solveChunk(const Batch& batch, std::size_t begin, std::size_t end, Chunk& chunk) {
    chunk.clear();
    Group group;
    group.jets.clear(core_.pull());
    // Nodes of a bucket lie all over the surface: what they need is fetched before it is used.
    constexpr std::size_t kNode = 16, kLinks = 8;
    for (std::size_t k = begin; k < end; ++k) {
        if (k + kNode < batch.nodes.size()) prefetchNode(batch.nodes[k + kNode]);
        if (k + kLinks < batch.nodes.size()) links_.prefetch(batch.nodes[k + kLinks]);
        const NodeIndex i = batch.nodes[k];
        if (queue_.take(i, batch.first, batch.last)) gather(i, batch, group);
        if (group.jets.full()) solveGroup(batch, group, chunk);
    }
    if (group.jets.size() > 0) solveGroup(batch, group, chunk);
}

void JetMarch::solveGroup(const Batch& batch, Group& group, Chunk& chunk) {
    const JetGroup::Solutions solutions = group.jets.solve();
    for (std::size_t k = 0; k < group.jets.size(); ++k) {
        const Node& node = group.nodes[k];
        JetGroup::Solution s = solutions[k];
        if (s.oneSided && isAtRim(node.core)) s = group.jets.solveAtRim(k);
        const JetNode& at = core_.nodes[node.core];
        Result result{s.u * at.weight, s.g, s.source, s.usedFallback, s.frontsMeet};
        if (!core_.stretch.empty()) result.g = core_.stretch[node.core].covectorBack(s.g);
        settle(node, result, batch, chunk);
    }
    group.jets.clear(core_.pull());
}

JetMarch::Known JetMarch::split(std::span<const JetLink> row, const Batch& batch,
                                Node& node) const {
    // Which neighbors have a jet changes from node to node: no branches.
    const JetState* const state = jets_.state.data();
    const std::uint32_t last = batch.last;
    const bool isotropic = core_.stretch.empty();
    Known known;
    std::size_t knownCount = 0, waitingCount = 0;
    for (std::size_t k = 0; k < row.size(); ++k) {
        const JetState& other = state[row[k].node()];
        const bool accepted = other.accepted();
        known.link[knownCount] = node.waiting[waitingCount] = std::uint8_t(k);
        knownCount += accepted;
        waitingCount += !accepted & mayPut(BucketQueue::bucketOf(other), last, isotropic);
    }
    known.count = knownCount, node.waitingCount = waitingCount;
    return known;
}

void JetMarch::gather(NodeIndex i, const Batch& batch, Group& group) {
    if (!ownLinks_.empty()) ownLinks_.make(core_, i);
    Node& node = group.nodes[group.jets.size()];
    node.core = i;
    const JetNode& here = core_.nodes[i];
    const bool isotropic = core_.stretch.empty();
    // Divided, as a product with 1 / weight would be off to the same side in each step.
    const bool weighted = core_.metric.weighted();
    auto perWeight = [&](float u) { return weighted ? u / here.weight : u; };
    const auto start = float(jets_.buckets.startOf(batch.first) - jets_.seeds.leastStart);
    // Relative to the least start: near a source the solve takes u for the distance to it.
    group.jets.begin(perWeight(start),
                     isotropic ? JetNeighbors::kLongest2 : core_.longest2(core_.stretch[i]));
    const auto row = links_.row(i);
    const Known known = split(row, batch, node);
    for (std::size_t k = 0; k < known.count; ++k) {
        const JetLink& link = row[known.link[k]];
        const NodeIndex j = link.node();
        const JetState& state = jets_.state[j];
        const float u = float(std::int64_t(state.bucket) - batch.first) * width_ + state.rest;
        JetNeighbor n{link.a(), link.turned(state.g)};
        if (!isotropic) {
            n.g = perWeight(core_.nodes[j].weight) * n.g;
            n = stretched(core_.stretch[i], n);
        }
        group.jets.add(n.a, n.g, perWeight(u), jets_.labelOf(j), link.overCrease());
    }
    node.jump = float(kInfinity);
    if (here.facing & Band::kBridged) gatherJumps(batch, node);
}

bool JetMarch::isAtRim(NodeIndex i) const {
    if (core_.nodes[i].obstacleState != Metric::Clear) return true;
    // Tensors squeeze the chart, and at a straight rim the fallback would err by more than it
    // saves.
    if (!core_.stretch.empty()) return false;
    const auto row = links_.row(i);
    return row.size() < kAllAround || std::any_of(row.begin(), row.end(), [&](const JetLink& l) {
               bool crease = false;
               forLinks(core_, l.node(), [&](NodeIndex, const Ijk&, const Vec3f&, float cosine) {
                   crease |= cosine < JetLink::kSmooth;
               });
               return crease;
           });
}

void JetMarch::gatherJumps(const Batch& batch, Node& node) const {
    forJumps(core_, node.core, [&](NodeIndex j, const Vec3f& chord) {
        if (!jets_.accepted(j)) return;
        const double cost = (core_.largestCostAt(node.core) + core_.largestCostAt(j)) / 2;
        const auto u = float(jets_.valueOf(j) - jets_.buckets.startOf(batch.first) +
                             cost * double(length(chord)));
        if (u < node.jump) node.jump = u, node.jumpLabel = jets_.labelOf(j);
    });
}

void JetMarch::settle(const Node& node, Result s, const Batch& batch, Chunk& chunk) {
    const NodeIndex i = node.core;
    if (node.jump < s.u) s = {node.jump, {}, node.jumpLabel, false, false};
    // Nodes of a disc wait in its buckets or earlier.
    if (batch.first <= lastDiscBucket_) s = exactNearSeed(i, s, batch);
    if (!(s.u < float(kInfinity))) return;
    s.u = boundedBelow(i, s.u, s.label, batch);
    if (options_.below && !withinLimit(i, s.u, batch)) return;
    if (!(s.u < slackOf(i))) {
        // Half as far as its bucket: soon, with what is known then, but not in every bucket in
        // between, of which there are many where weights differ by much.
        const std::uint32_t half = later(batch.first, (bucketsTo(s.u) + 1) / 2);
        chunk.deferred.push_back({std::max(batch.last + 1, half), i});
        return;
    }
    if (later(batch.first, bucketsTo(s.u)) >= kLastBucket) {
        chunk.tooFar = true;
        return;
    }
    chunk.accepted.push_back({i, s.label, stateOf(s, batch)});
    chunk.byFallback += s.usedFallback;
    if (s.frontsMeet) chunk.frontsMeet.push_back(i);
    chunk.heaviest = std::max(chunk.heaviest, core_.largestCostAt(i));
    if (!stopNodes_.empty() && stopNodes_[i]) ++chunk.stopNodes;
    enqueue(node, s, batch, chunk);
    if (core_.nodes[i].facing & Band::kBridged) enqueueJumps(i, s, batch, chunk);
}

JetMarch::Result JetMarch::exactNearSeed(NodeIndex i, const Result& s, const Batch& batch) const {
    const auto disc = discs_.find(i);
    if (disc == discs_.end()) return s;
    const auto u = float(disc->second.u - jets_.buckets.startOf(batch.first));
    if (s.u < u && s.label != disc->second.label) return s;
    return {u, disc->second.g, disc->second.label, false, false};
}

float JetMarch::boundedBelow(NodeIndex i, float u, std::uint32_t label, const Batch& batch) const {
    const double bound = jets_.seeds.lines.from(label, core_.footOf(core_.nodes[i]));
    return std::max(u, float(bound - jets_.buckets.startOf(batch.first)));
}

bool JetMarch::withinLimit(NodeIndex i, float u, const Batch& batch) const {
    const NodeIndex inBand = core_.inBand(core_.nodes[i]);
    return jets_.buckets.startOf(batch.first) + double(u) <
           (*options_.below)[inBand] + kMarginBelow * core_.largestCostAt(i);
}

JetState JetMarch::stateOf(const Result& s, const Batch& batch) const {
    // Fits may lie before the batch, by a few buckets.
    const float at = std::max(s.u / width_, 1 - float(batch.first));
    const auto whole = std::int64_t(at), by = whole - (float(whole) > at ? 1 : 0);
    return {std::uint32_t(std::int64_t(batch.first) + by), s.u - float(by) * width_, s.g};
}

void JetMarch::enqueue(const Node& node, const Result& jet, const Batch& batch, Chunk& chunk) {
    // Along a circle about the source, at the mean cost of both ends.
    const bool isotropic = core_.stretch.empty();
    const float here = core_.nodes[node.core].weight;
    const auto radius =
        float(jets_.buckets.startOf(batch.first) - jets_.seeds.leastStart + double(jet.u));
    const auto row = links_.row(node.core);
    for (std::size_t k = 0; k < node.waitingCount; ++k) {
        const JetLink& link = row[node.waiting[k]];
        const float weight =
            isotropic ? here : meanWeight(core_.nodes[link.node()].weight, here) * here;
        const Vec2f step = -weight * link.a();
        const Vec2f flat = isotropic ? step : core_.stretch[node.core].vector(step);
        const float along = dot(jet.g, step), square = dot(flat, flat);
        const float r = radius + std::max(along, 0.0f),
                    across = std::max(square - along * along, 0.0f);
        const float further =
            along > 0 ? along + across / (std::sqrt(r * r + across) + r) : std::sqrt(square);
        put(link.node(), jet.u + further, batch, chunk);
    }
}

void JetMarch::enqueueJumps(NodeIndex from, const Result& jet, const Batch& batch, Chunk& chunk) {
    forJumps(core_, from, [&](NodeIndex j, const Vec3f& chord) {
        if (jets_.accepted(j)) return;
        const double cost = (core_.largestCostAt(from) + core_.largestCostAt(j)) / 2;
        put(j, jet.u + float(cost) * length(chord), batch, chunk);
    });
}

void JetMarch::put(NodeIndex i, float u, const Batch& batch, Chunk& chunk) {
    const std::uint32_t current = queue_.bucketOf(i), next = batch.last + 1;
    if (!mayPut(current, batch.last, core_.stretch.empty())) return;
    const std::uint32_t to = std::max(next, later(batch.first, bucketsTo(u)));
    if (current < next)
        chunk.requeueLater.push_back({to, i});
    else if (queue_.lower(i, to, current))
        chunk.queued.push_back({to, i});
}

void JetMarch::accept(std::size_t chunkCount) {
    parallelFor(chunkCount, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            for (const Queued& q : chunks_[c].deferred) jets_.state[q.node].bucket = q.bucket;
            for (const Accepted& a : chunks_[c].accepted) {
                jets_.state[a.node] = a.state;
                if (!jets_.label.empty()) jets_.label[a.node] = a.label;
            }
        }
    });
}

void JetMarch::collect(std::size_t chunkCount) {
    for (std::size_t c = 0; c < chunkCount; ++c) {
        const Chunk& chunk = chunks_[c];
        if (chunk.tooFar) refuseTooFar();
        accepted_ += chunk.accepted.size();
        byFallback_ += chunk.byFallback;
        frontsMeet_.insert(frontsMeet_.end(), chunk.frontsMeet.begin(), chunk.frontsMeet.end());
        heaviest_ = std::max(heaviest_, chunk.heaviest);
        stopNodesLeft_ -= chunk.stopNodes;
        for (const auto* list : {&chunk.queued, &chunk.deferred})
            for (const Queued& q : *list) queue_.add(q.node, q.bucket);
        for (const Queued& q : chunk.requeueLater) queue_.requeue(q.node, q.bucket);
        if (ownLinks_.empty()) continue;
        for (const Accepted& a : chunk.accepted) ownLinks_.dropAccepted(a.node);
    }
}

Field JetMarch::take() {
    Field field;
    field.band = &core_.band;
    field.atFootPoints = true;
    field.metric = core_.metricPtr;
    field.seeds = jets_.seeds.points;
    field.scheme = "jet";
    field.startRadius = options_.startRadius;
    field.stoppedEarly = stopped_ || options_.below;
    field.limit = jets_.limit;
    field.lines = jets_.seeds.lines;
    field.solved = accepted_;
    field.fallbackCount = byFallback_;
    solveMeetings(jets_, frontsMeet_);
    field.core = std::make_shared<const CoreJets>(std::move(jets_));
    return field;
}

}  // namespace igeo
