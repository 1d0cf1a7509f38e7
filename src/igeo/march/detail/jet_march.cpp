#include <igeo/march/detail/jet_march.h>

#include <igeo/base/detail/registers.h>
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
    resizeByAll(jets.state, core->nodes.size());
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
      lastDiscBucket_(bucketOf(jets_.seeds.largestInDisc)),
      isotropic_(core_.stretch.empty()),
      weighted_(core_.metric.weighted()),
      onMesh_(core_.band.triangles != nullptr),
      ofOnePoint_(jets_.seeds.lines.ofOnePoint()),
      leastCost2_(float(jets_.seeds.lines.leastCost() * jets_.seeds.lines.leastCost())),
      heaviest_(core_.leastCost) {
    const auto last = std::max_element(seeds.begin(), seeds.end(),
                                       [](auto& a, auto& b) { return a.start < b.start; });
    // Buckets are numbered in 32 bits.
    if (!(last->start - jets_.seeds.leastStart < 1e9 * core_.leastCost))
        throw Error(Error::Kind::InvalidArgument,
                    "start values of seeds differ by more than 1e9 voxels",
                    "give seeds that no front comes near to a run of their own");
    if (ofOnePoint_) {
        const Vec3d seed = jets_.seeds.lines.only().from;
        const Ijk voxel = roundToIjk(seed);
        const auto foot = Vec3f(seed - Vec3d(voxel));
        seedVoxel_ = Registers<4>::Integers{voxel.x, voxel.y, voxel.z};
        seedFoot_ = Registers<4>::Vector{foot.x, foot.y, foot.z};
    }
    enqueueStartDiscs();
    initStopNodes();
}

void JetMarch::enqueueStartDiscs() {
    const auto put = [&](NodeIndex i, double u) {
        jets_.state[i].bucket = bucketOf(u);
        queue_.add(i, jets_.state[i].bucket);
    };
    for (const auto& [i, s] : discs_.jets) put(i, s.u);
    for (const auto& [i, s] : discs_.overEdges)
        if (!discs_.jets.contains(i)) put(i, s.u);
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
    batchStart_ = jets_.buckets.startOf(batch.first);
    batchRadius_ = batchStart_ - jets_.seeds.leastStart;
    scale_ = {batch.first, width_};
    // As many chunks as keep the threads busy to the end, of whole groups.
    constexpr std::size_t kLargest = 8 * Lanes::kNodes;
    const auto threads = std::size_t(ThreadLimit::current());
    const std::size_t groups = batch.nodes.size() / (4 * threads) / Lanes::kNodes;
    chunkSize_ =
        threads == 1 ? kLargest : std::clamp(groups * Lanes::kNodes, Lanes::kNodes, kLargest);
    const std::size_t chunkCount = (batch.nodes.size() + chunkSize_ - 1) / chunkSize_;
    if (chunks_.size() < chunkCount) chunks_.resize(chunkCount);
    solve(batch, chunkCount);
    accept(chunkCount);
    collect(chunkCount);
}

void JetMarch::solve(const Batch& batch, std::size_t chunkCount) {
    parallelFor(chunkCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) chunks_[c].clear();
        solvePart(batch, begin * chunkSize_, std::min(batch.nodes.size(), end * chunkSize_),
                  chunks_[begin]);
    });
}

void JetMarch::solvePart(const Batch& batch, std::size_t begin, std::size_t end, Chunk& chunk) {
    Group group;
    Taken taken;
    // Nodes of a bucket lie all over the surface: what they need is fetched before it is used.
    constexpr std::size_t kNode = 16, kLinks = 8;
    const NodeIndex* const nodes = batch.nodes.data();
    const std::size_t size = batch.nodes.size();
    for (std::size_t k = begin; k < end; ++k) {
        if (k + kNode < size) prefetchNode(nodes[k + kNode]);
        if (k + kLinks < size) links_.prefetch(nodes[k + kLinks]);
        if (queue_.take(nodes[k], batch.first, batch.last)) taken.node[taken.size++] = nodes[k];
        if (taken.size == Taken::kMost) solveTaken(batch, taken, group, chunk);
    }
    solveTaken(batch, taken, group, chunk);
}

void JetMarch::solveTaken(const Batch& batch, Taken& taken, Group& group, Chunk& chunk) {
    for (std::size_t k = 0; k < taken.size; ++k) {
        const NodeIndex i = taken.node[k];
        if (!ownLinks_.empty()) ownLinks_.make(core_, i);
        const JetLinks::Row row = links_.rowAt(i);
        taken.row[k].links = row.links, taken.creased[k] = row.creased;
        for (const JetLink& link : row.links) __builtin_prefetch(&jets_.state[link.node()]);
    }
    split({taken.row.data(), taken.size}, jets_.state.data(), batch.last + 1, isotropic_);
    std::array<std::uint8_t, JetLinks::kMax + 2> begin{};  // of the nodes with so many neighbors
    for (std::size_t k = 0; k < taken.size; ++k) ++begin[taken.row[k].knownCount + 1];
    for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
    std::array<std::uint8_t, Taken::kMost> order;
    for (std::size_t k = 0; k < taken.size; ++k)
        order[begin[taken.row[k].knownCount]++] = std::uint8_t(k);
    for (std::size_t k = 0; k < taken.size; ++k) {
        group.add(taken, order[k]);
        if (group.size == Lanes::kNodes || k + 1 == taken.size) solveGroup(batch, group, chunk);
    }
    taken.size = 0;
}

void JetMarch::gather(const Batch& batch, Group& group) {
    // Relative to the least start: near a source the solve takes u for the distance to it. Divided,
    // as a product with 1 / weight would be off to the same side in each step.
    const auto start = float(batchRadius_);
    group.jets.clear(core_.pull());
    // Lanes without a node are laid out as well.
    for (std::size_t lane = group.size; lane < Lanes::kNodes; ++lane)
        group.rows.of[lane] = group.rows.of[0];
    for (std::size_t lane = 0; lane < group.size; ++lane) {
        const NodeIndex i = group.node[lane];
        const JetNode& here = core_.nodes[i];
        const JetRows::Row& row = *group.rows.of[lane];
        group.weight[lane] = here.weight;
        group.line2[lane] = line2(here);
        group.jets.begin(weighted_ ? start / here.weight : start,
                         isotropic_ ? JetNeighbors::kLongest2 : core_.longest2(core_.stretch[i]));
        if (!isotropic_) {
            addStretched(i, row, batch, group.jets);
            continue;
        }
        group.overCrease[lane] = group.overCrease[lane] && knowsCrease(row);
        group.jets.expect(row.knownCount, !group.overCrease[lane]);
        for (std::size_t k = 0; k < row.knownCount && !jets_.label.empty(); ++k)
            group.jets.setSource(k, jets_.label[row.knownLink(k).node()]);
    }
}

void JetMarch::addStretched(NodeIndex i, const JetRows::Row& row, const Batch& batch,
                            JetGroup& jets) const {
    const float weight = core_.nodes[i].weight;
    for (std::size_t k = 0; k < row.knownCount; ++k) {
        const JetLink& link = row.knownLink(k);
        const NodeIndex j = link.node();
        const JetNeighbor n = inStretchedChart(i, link);
        jets.add(n.a, n.g, valueIn(batch, j) / weight, jets_.labelOf(j), link.overCrease());
    }
}

JetNeighbor JetMarch::inStretchedChart(NodeIndex i, const JetLink& link) const {
    const NodeIndex j = link.node();
    JetNeighbor n{link.a(), link.turned(jets_.state[j].g)};
    n.g = (core_.nodes[j].weight / core_.nodes[i].weight) * n.g;
    return stretched(core_.stretch[i], n);
}

bool JetMarch::mayGoRound(NodeIndex i, const JetRows::Row& row) const {
    if (!isotropic_ || core_.costsVary || core_.nodes[i].obstacleState != Metric::Clear)
        return false;
    if (onMesh_) return knowsCrease(row) || isAtRim(i) || sharesVoxels(i);
    return core_.band.foot.empty() && knowsCrease(row);
}

bool JetMarch::isMisplaced(NodeIndex i, const JetRows::Row& row, const JetGroup::Solution& s,
                           bool overCrease) const {
    constexpr float kOff = 0.05f, kOffFacets = 0.002f, kOffStretched = 0.25f;  // voxels
    if (!core_.isEven()) return false;
    // The fallback takes stretched links for what they are, as long as a walk.
    if (!overCrease && (s.usedFallback || !(core_.nodes[i].facing & Band::kStretched)))
        return false;
    const float most = !overCrease ? kOffStretched : core_.band.faceted ? kOffFacets : kOff;
    const std::array<std::uint8_t, 2> ends = s.usedFallback ? s.ends : nextToRay(row, s.g);
    if (!s.usedFallback && ends[0] == ends[1]) return false;
    const JetLink &p = row.knownLink(ends[0]), &q = row.knownLink(ends[1]);
    // Over the planes at both ends.
    const auto isOff = [&](NodeIndex from, NodeIndex to, float laid) {
        const JetNode &a = core_.nodes[from], &b = core_.nodes[to];
        const Vec3f chord = a.foot - b.foot - Vec3f(core_.voxelOf(b) - core_.voxelOf(a));
        const Vec2f along = TangentFrame(a.normal, core_.band.faceted)
                                .unfold(chord, b.normal, dot(a.normal, b.normal));
        return std::abs(laid - length(along)) > most;
    };
    return isOff(i, p.node(), length(p.a())) ||
           (ends[0] != ends[1] && (isOff(i, q.node(), length(q.a())) ||
                                   isOff(p.node(), q.node(), length(p.a() - q.a()))));
}

std::array<std::uint8_t, 2> JetMarch::nextToRay(const JetRows::Row& row, Vec2f g) {
    std::array<std::uint8_t, 2> ends{};
    std::array<float, 2> least{float(kInfinity), float(kInfinity)};
    for (std::size_t k = 0; k < row.knownCount; ++k) {
        const Vec2f a = row.knownLink(k).a();
        const float across = cross(g, a), along = dot(g, a);
        if (!(along > 0)) continue;
        const std::size_t side = across > 0;
        const float slope = std::abs(across) / along;
        if (slope < least[side]) least[side] = slope, ends[side] = std::uint8_t(k);
    }
    if (!(least[0] < float(kInfinity)) || !(least[1] < float(kInfinity))) return {};
    return ends;
}

bool JetMarch::knowsCrease(const JetRows::Row& row) {
    for (std::size_t k = 0; k < row.knownCount; ++k)
        if (row.knownLink(k).overCrease()) return true;
    return false;
}

float JetMarch::line2(const JetNode& node) const {
    using Four = Registers<4>::Vector;
    using Integers = Registers<4>::Integers;
    constexpr float kRounding = 1.0001f;
    if (!ofOnePoint_) return float(kInfinity);
    // The fourth number is not used.
    static_assert(offsetof(BandLeaf, origin) == 0 && sizeof(BandLeaf) >= sizeof(Integers) &&
                  offsetof(JetNode, foot) + sizeof(Four) <= sizeof(JetNode));
    const Integers leaf = loadAs<Integers>(&core_.band.leaves[node.leaf]) - seedVoxel_,
                   inLeaf = (Integers{} + std::int32_t(node.offset)) & Integers{7 << 6, 7 << 3, 7};
    const Four off = __builtin_convertvector(leaf, Four) +
                     __builtin_convertvector(inLeaf, Four) * Four{0x1p-6f, 0x1p-3f, 1} +
                     (loadAs<Four>(&node.foot) - seedFoot_),
               square = off * off;
    return kRounding * leastCost2_ * (square[0] + square[1] + square[2]);
}

float JetMarch::valueIn(const Batch& batch, NodeIndex i) const {
    const JetState& state = jets_.state[i];
    return float(std::int64_t(state.bucket) - batch.first) * width_ + state.rest;
}

bool JetMarch::isAtRim(NodeIndex i) const {
    if (core_.nodes[i].obstacleState != Metric::Clear) return true;
    // Tensors squeeze the chart, and at a straight rim the fallback would err by more than it
    // saves: comesSideways.
    if (!isotropic_) return false;
    // Beside the corner of a rim a front arrives before the node on the rim has its value.
    return core_.costsVary || links_.row(i).size() < kAllAround ||
           core_.rims.isBesideOpen(core_, i) || core_.rims.isCreasedBeside(core_, i);
}

bool JetMarch::isInShadow(const JetRows::Row& row, const JetGroup::Solution& s) const {
    if (!isotropic_) return false;
    for (std::size_t k = 0; k < row.knownCount; ++k) {
        const JetLink& link = row.knownLink(k);
        const Vec2f g = link.turned(jets_.state[link.node()].g);
        if (dot(g, s.g) < jet::kSameFront && dot(g - s.g, link.a()) < 0 &&
            jets_.labelOf(link.node()) == s.source && core_.rims.isBesideOpen(core_, link.node()))
            return true;
    }
    return false;
}

bool JetMarch::comesSideways(NodeIndex i, const JetRows::Row& row,
                             const JetGroup::Solution& s) const {
    constexpr float kSameWay = 0.9f, kStraight = 0.9998f;  // cosines: 26 degrees, one degree
    if (isotropic_) return sharesVoxels(i) && !hasNeighborBehind(i, row, s);
    // Along a rim that bends a fit would cut the bend a little with every step.
    const bool atRim = core_.rims.isBesideOpen(core_, i);
    return (atRim || !hasNeighborBehind(i, row, s)) &&
           !isConfirmedBehind(i, s, atRim ? kStraight : kSameWay);
}

bool JetMarch::hasNeighborBehind(NodeIndex i, const JetRows::Row& row,
                                 const JetGroup::Solution& s) const {
    constexpr float kBehind = 0.9f;  // cosine: within 26 degrees
    for (std::size_t k = 0; k < row.knownCount; ++k) {
        const JetLink& link = row.knownLink(k);
        const JetNeighbor n = isotropic_
                                  ? JetNeighbor{link.a(), link.turned(jets_.state[link.node()].g)}
                                  : inStretchedChart(i, link);
        if (dot(n.g, s.g) >= jet::kSameFront && dot(n.a, s.g) > kBehind * length(n.a)) return true;
    }
    return false;
}

bool JetMarch::sharesVoxels(NodeIndex i) const {
    return onMesh_ && isotropic_ && core_.nodes[i].facing & Band::kSevered;
}

bool JetMarch::isFolded(NodeIndex i) const {
    constexpr auto kBeside = Band::kStretched | Band::kBesideSevered;
    return core_.nodes[i].facing & Band::kHasWays && core_.nodes[i].facing & kBeside;
}

void JetMarch::enqueue(const Batch& batch, JetsOnLinks& accepted, Chunk& chunk) {
    carry(scale_, accepted);
    const std::uint32_t next = batch.last + 1;
    for (std::size_t n = 0; n < accepted.size; ++n) {
        const JetRows::Row& row = *accepted.row[n];
        for (std::size_t k = 0; k < row.waitingCount; ++k) {
            const NodeIndex j = row.waitingLink(k).node();
            const std::uint32_t current = queue_.bucketOf(j),
                                to = std::max(next, accepted.bucket[k][n]);
            if (to < current) lower(j, to, current, chunk);
        }
    }
    accepted.size = 0;
}

void JetMarch::enqueueStretched(NodeIndex i, const JetRows::Row& row, const Result& jet,
                                const Batch& batch, Chunk& chunk) {
    const float here = core_.nodes[i].weight, radius = radiusOf(jet);
    for (std::size_t k = 0; k < row.waitingCount; ++k) {
        const JetLink& link = row.waitingLink(k);
        const float weight = meanWeight(core_.nodes[link.node()].weight, here) * here;
        const Vec2f step = -weight * link.a(), flat = core_.stretch[i].vector(step);
        const float along = dot(jet.g, step), square = dot(flat, flat);
        const float r = radius + std::max(along, 0.0f),
                    across = std::max(square - along * along, 0.0f);
        const float further =
            along > 0 ? along + across / (std::sqrt(r * r + across) + r) : std::sqrt(square);
        put(link.node(), jet.u + further, batch, chunk);
    }
}

void JetMarch::put(NodeIndex i, float u, const Batch& batch, Chunk& chunk) {
    const std::uint32_t current = queue_.bucketOf(i), next = batch.last + 1;
    if (!mayPut(current, next, isotropic_)) return;
    const std::uint32_t to = std::max(next, later(batch.first, bucketsTo(u)));
    if (current < next)
        chunk.requeueLater.push_back({to, i});
    else
        lower(i, to, current, chunk);
}

IGEO_INLINE void JetMarch::settle(std::size_t lane, Group& group, Result s, const Batch& batch,
                                  Chunk& chunk) {
    const NodeIndex i = group.node[lane];
    const JetNode& node = core_.nodes[i];
    const bool bridged = node.facing & (Band::kBridged | Band::kHasWays);
    if (bridged)
        if (const Jump jump = jumpTo(i); jump.u < s.u)
            s = {jump.u, jump.g, jump.label, false, false};
    // Nodes of a disc wait in its buckets or earlier.
    if (batch.first <= lastDiscBucket_) s = exactNearSeed(i, s);
    if (!(s.u < float(kInfinity))) return;
    const float radius = radiusOf(s);
    if (!(radius > 0 && radius * radius > group.line2[lane])) s.u = boundedBelow(i, s.u, s.label);
    if (options_.below && !withinLimit(i, s.u, batch)) return;
    // What the fallback has from one or two neighbors is final when no node before it waits: the
    // neighbors that it lacks may be in its own bucket.
    const bool few = s.usedFallback && group.rows.of[lane]->knownCount <= 2;
    if (!(s.u < (few ? 0.0f : slackOf(i)))) {
        // Half as far as its bucket: soon, with what is known then, but not in every bucket in
        // between, of which there are many where weights differ by much.
        const std::uint32_t half = later(batch.first, (bucketsTo(s.u) + 1) / 2);
        chunk.deferred.push_back({std::max(batch.last + 1, half), i});
        return;
    }
    const JetState state = stateOf(s, batch);
    if (state.bucket >= kLastBucket) {
        chunk.tooFar = true;
        return;
    }
    chunk.accepted.push_back({i, s.label, state});
    chunk.byFallback += s.usedFallback;
    if (s.frontsMeet) chunk.frontsMeet.push_back(i);
    if (core_.costsVary || !isotropic_)
        chunk.heaviest = std::max(chunk.heaviest, core_.largestCostAt(i));
    if (stopNodesLeft_ > 0 && stopNodes_[i]) ++chunk.stopNodes;
    const JetRows::Row& row = *group.rows.of[lane];
    if (isotropic_)
        group.accepted.add(s.u, s.g, radiusOf(s), node.weight, row);
    else
        enqueueStretched(i, row, s, batch, chunk);
    if (bridged) enqueueJumps(i, s, batch, chunk);
}

JetMarch::Result JetMarch::exactNearSeed(NodeIndex i, const Result& s) const {
    const auto disc = discs_.jets.find(i);
    if (disc == discs_.jets.end()) return overEdgeNearSeed(i, s);
    const float u = fromStart(disc->second.u);
    if (s.u < u && s.label != disc->second.label) return s;
    const JetNode& node = core_.nodes[i];
    if (overtakesDisc(core_, jets_.seeds, batchStart_ + double(s.u), disc->second.u,
                      double(node.weight), core_.footOf(node)))
        return s;
    return {u, disc->second.g, disc->second.label, false, false};
}

JetMarch::Result JetMarch::overEdgeNearSeed(NodeIndex i, const Result& s) const {
    constexpr float kLonger = 0.1f;  // voxels
    const auto over = discs_.overEdges.find(i);
    if (over == discs_.overEdges.end()) return s;
    const float u = fromStart(over->second.u);
    if (!(u < s.u - kLonger * core_.nodes[i].weight)) return s;
    return {u, over->second.g, over->second.label, false, false};
}

float JetMarch::boundedBelow(NodeIndex i, float u, std::uint32_t label) const {
    return std::max(u, fromStart(jets_.seeds.lines.from(label, core_.footOf(core_.nodes[i]))));
}

bool JetMarch::withinLimit(NodeIndex i, float u, const Batch& batch) const {
    const NodeIndex inBand = core_.inBand(core_.nodes[i]);
    return jets_.buckets.startOf(batch.first) + double(u) <
           (*options_.below)[inBand] + kMarginBelow * core_.largestCostAt(i);
}

IGEO_INLINE JetState JetMarch::stateOf(const Result& s, const Batch& batch) const {
    if (s.u >= 0 && s.u < width_) return {batch.first, s.u, s.g};
    // Fits may lie before the batch, by a few buckets.
    const float at = std::clamp(s.u / width_, 1 - float(batch.first), 2.0f * float(kLastBucket));
    const auto whole = std::int64_t(at), by = whole - (float(whole) > at ? 1 : 0);
    const std::int64_t bucket = std::min(batch.first + by, std::int64_t(kLastBucket));
    return {std::uint32_t(bucket), s.u - float(by) * width_, s.g};
}

void JetMarch::solveGroup(const Batch& batch, Group& group, Chunk& chunk) {
    constexpr float kDetour = 0.1f, kLongest2 = 3;  // voxels; of a link, squared
    const auto isLess = [](const auto& a, const auto& b) { return a.u < b.u; };
    gather(batch, group);
    if (isotropic_)
        group.jets.fill([&](JetLanes& lanes) {
            layOut(group.rows, jets_.state.data(), batch.first, width_,
                   weighted_ ? &group.weight : nullptr, lanes);
        });
    JetGroup::Solutions solutions = group.jets.solve();
    for (std::size_t lane = 0; lane < group.size; ++lane) {
        const NodeIndex i = group.node[lane];
        JetGroup::Solution& s = solutions[lane];
        if (isFolded(i))
            s = group.jets.solveAtFold(lane);
        else if (s.oneSided && (isInShadow(*group.rows.of[lane], s) || isAtRim(i) ||
                                comesSideways(i, *group.rows.of[lane], s)))
            s = group.jets.solveAtRim(lane);
        const JetRows::Row& row = *group.rows.of[lane];
        if (s.detour > kDetour && mayGoRound(i, row)) {
            if (!onMesh_) s = std::min(s, group.jets.solveOverSegments(lane, kLongest2), isLess);
            s = overTwoLinks(i, row, batch, s);
        }
        if (onMesh_ && isMisplaced(i, row, s, group.overCrease[lane])) s = solveByWalks(i, row, s);
        if (!isotropic_) s.g = core_.stretch[i].covectorBack(s.g);
        settle(lane, group, {s.u * group.weight[lane], s.g, s.source, s.usedFallback, s.frontsMeet},
               batch, chunk);
    }
    if (!group.accepted.empty()) enqueue(batch, group.accepted, chunk);
    group.size = 0;
}

void JetMarch::accept(std::size_t chunkCount) {
    constexpr std::size_t kNodes = 256;  // fewer take less time than to wake a thread
    parallelFor(chunkCount, kNodes / chunkSize_, [&](std::size_t begin, std::size_t end) {
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

bool JetMarch::endsAtLimit() const {
    constexpr double kBeside = 2;  // voxels: nodes of the band are so close to the core
    if (!(jets_.limit < kInfinity)) return false;
    const double last = jets_.limit - kBeside * heaviest_;
    for (NodeIndex i = 0; i < jets_.state.size(); ++i)
        if (const double d = jets_.marchedValueOf(i); d > last && d < kInfinity) return true;
    return false;
}

Field JetMarch::take() {
    Field field;
    field.band = &core_.band;
    field.atFootPoints = true;
    field.metric = core_.metricPtr;
    field.seeds = jets_.seeds.points;
    field.scheme = "jet";
    field.evenCosts = core_.isEven();
    field.startRadius = options_.startRadius;
    field.stoppedEarly = stopped_ || options_.below || endsAtLimit();
    field.limit = jets_.limit;
    field.lines = jets_.seeds.lines;
    field.solved = accepted_;
    field.fallbackCount = byFallback_;
    jets_.meetings = findMeetings(jets_, ownLinks_, frontsMeet_);
    field.core = field.jets = std::make_shared<const CoreJets>(std::move(jets_));
    return field;
}

}  // namespace igeo
