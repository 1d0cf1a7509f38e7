#include <igeo/jet.h>

#include <igeo/error.h>
#include <igeo/jet_update.h>
#include <igeo/parallel.h>
#include <igeo/tangent_frame.h>

#include <algorithm>
#include <map>
#include <set>

namespace igeo {

namespace {

/// An early stop marches this far beyond its limit, so that the nodes within it have all the
/// neighbours that a full march would give them.
constexpr double kMargin = 3;

/// Buckets are counted from the smallest start value; this one is beyond all.
constexpr std::uint32_t kNoBucket = std::numeric_limits<std::uint32_t>::max();
/// Values beyond this bucket do not fit: 2e9 voxels of the least weight.
constexpr std::uint32_t kLastBucket = kNoBucket - 2;

/// By how much a chord counts in units of the weight at its end `to`: trapezoid rule.
float meanWeight(float from, float to) { return from == to ? 1 : (1 + from / to) / 2; }

/// Whether two foot points, `chord` apart, lie on either side of a gap or a plate rather than of a
/// crease: both normals along the chord, and the chord longer than between neighbours on one sheet
/// (sqrt(3), and a bit). In gaps of about two voxels psi bends normals away from each other, and
/// Band::kOtherSheet alone does not tell.
bool acrossGap(const Vec3f& chord, const Vec3f& a, const Vec3f& b) {
    constexpr float kFar2 = 3.2f, kAlong2 = 0.25f;
    const float c2 = dot(chord, chord), alongA = dot(a, chord), alongB = dot(b, chord);
    return c2 > kFar2 && alongA * alongB < 0 &&
           std::min(alongA * alongA, alongB * alongB) > kAlong2 * c2;
}

/// What a solve found out about a node.
struct Solved {
    double u = kInfinity;
    Vec3f g;
    std::uint32_t label = 0;  ///< the seed whose front it is
    bool guarded = false;
    bool stands = false;  ///< no node still to come can change it
};

/// Nodes around a foot point that have a jet, as the local solve sees them, and whose fronts they
/// belong to.
struct Surroundings {
    JetNeighbours all;
    std::array<std::uint32_t, JetNeighbours::kMax> label;
    bool oneLabel = true;

    void add(const JetNeighbour& n, std::uint32_t from) {
        const auto k = std::size_t(all.count());
        label[k] = from;
        oneLabel &= from == label[0];
        all.add(n);
    }
    /// jetUpdate; fronts of different seeds are never fitted together, the lesser value counts, and
    /// the earlier seed where they are equal. In the picture's coordinates.
    Jet update(std::uint32_t& from) const;
};

Jet Surroundings::update(std::uint32_t& from) const {
    if (all.count() == 0) return {};
    from = label[0];
    if (oneLabel) return jetUpdate(all);
    Jet best;
    std::uint32_t next = *std::min_element(label.begin(), label.begin() + all.count());
    while (next != kNoBucket) {
        const std::uint32_t current = next;
        next = kNoBucket;
        JetNeighbours part;
        part.smooth = all.smooth, part.rim = all.rim;
        for (int k = 0; k < all.count(); ++k) {
            const std::uint32_t l = label[std::size_t(k)];
            if (l == current) part.add({all.a(k), all.g(k), all.base() + double(all.u(k))});
            if (l > current) next = std::min(next, l);
        }
        const Jet jet = jetUpdate(part);
        if (jet.u < best.u) best = jet, from = current;
    }
    return best;
}

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
    /// All that a march touches of a core node, side by side.
    struct Node {
        double u = kInfinity;  ///< +inf until accepted
        Vec3f g, foot, normal;
        LeafIndex leaf;
        std::uint32_t bucket = kNoBucket;  ///< the bucket it waits in; 0 once it is taken out
        std::uint16_t offset;
        Metric::Sight sight;
        float weight;
    };
    struct Queued {
        std::uint32_t bucket;
        NodeIndex node;
    };
    /// Part of a bucket, for one thread: what is accepted, and who waits for what bucket now.
    struct Chunk {
        std::vector<std::pair<NodeIndex, Solved>> accepted;
        std::vector<Queued> queued, tooEarly;
    };

    std::uint32_t bucketOf(double u) const {
        return std::uint32_t(
            std::min(std::max(0.0, (u - first_) / bucketWidth_), double(kLastBucket)));
    }
    /// How far beyond a bucket's start a value may lie to stand, found from all that was accepted
    /// before: nodes still to come lie beyond the start, and a step from one of them costs more
    /// than half a voxel at the mean of both weights. One bucket where the weight is least, and
    /// many where it is large, which need not be gone through one by one.
    double slackOf(float weight, float leastAround) const {
        return options_.bucketWidth * double(weight + leastAround) / 2;
    }
    std::uint32_t labelOf(NodeIndex core) const { return label_.empty() ? 0 : label_[core]; }
    Vec3d footOf(const Node& node) const {
        return Vec3d(band_.leaves[node.leaf].origin +
                     Ijk{node.offset >> 6, node.offset >> 3 & 7, node.offset & 7}) +
               Vec3d(node.foot);
    }
    /// Nodes inside an obstacle, but next to one outside, stand on its rim, so that fronts go along
    /// the rim and not along the voxels outside of it.
    void placeRimNodes();
    /// Calls visit(i, step) for the core nodes up to `reach` steps from the voxel at middle.
    template <typename Visit>
    void forBox(LeafIndex l, unsigned at, const Ijk& middle, int reach, const Visit& visit) const;

    /// The exact jet of seed k at a foot point, if that lies within its start disc.
    bool discJet(std::uint32_t k, const Vec3f& normal, const Vec3d& foot, double weight,
                 Solved& s) const;
    void startDisc(std::uint32_t seed);
    /// Whether an obstacle hides core node j from a point of S.
    bool hidden(const Node& j, const Vec3d& p, const Vec3f& normal) const {
        return j.sight == Metric::Inside ||
               (j.sight == Metric::Beside &&
                metric_.blocked(p, footOf(j), Vec3d(normalized(normal))));
    }
    void watchTargets();
    /// The nodes of the first bucket, and of those behind it that need not wait for its values.
    /// @param last  the last of these buckets
    std::vector<NodeIndex> nextNodes(std::uint32_t& last);
    /// Adds an accepted node to what a node of the given frame and weight sees.
    /// @param chord, cosine  from its foot point to that node's; between their normals
    void see(NodeIndex j, const Vec3f& chord, float cosine, const TangentFrame& frame, float weight,
             Surroundings& from) const;
    /// Solves a node from its accepted neighbours; if it belongs into this bucket, puts the others
    /// into the buckets where its jet says they belong.
    /// @param last  no node goes into a bucket up to this one
    Solved visit(NodeIndex i, std::uint32_t bucket, std::uint32_t last, std::vector<Queued>& out);
    /// @param chord from a node with jet (u, g) to node i, times the weight there
    void key(NodeIndex i, const Vec3f& chord, const Solved& from, std::uint32_t bucket,
             std::vector<Queued>& out);
    void process(std::uint32_t bucket, std::uint32_t last, const std::vector<NodeIndex>& nodes);

    /// A jet for a band node outside the core.
    /// @param l, at  its leaf and offset
    Solved extendTo(NodeIndex i, LeafIndex l, unsigned at) const;
    /// The same where the core around the foot point is not of one smooth front: as the march
    /// would.
    Solved solveOutside(NodeIndex i, LeafIndex l, unsigned at) const;
    /// The core around a node, as far as it is reached.
    /// @return whether any of it is on the node's sheet, reached or not
    bool gatherAround(NodeIndex i, LeafIndex l, unsigned at, const Ijk& middle, int reach,
                      const TangentFrame& frame, Surroundings& found) const;

    /// Start discs are exact, unless the front of another seed was there before.
    Solved preferDisc(NodeIndex core, const Solved& s) const;
    Solved preferDiscOutside(NodeIndex i, const Solved& s) const;

    const Band& band_;
    const MetricPtr held_;
    const Metric& metric_;
    const JetOptions& options_;
    const double least_;  ///< weight
    const bool varied_;   ///< not one weight everywhere
    double bucketWidth_;  ///< half a voxel at the least weight
    float heaviest_ = 0;  ///< the largest weight accepted so far
    std::vector<SurfacePoint> seeds_;
    double first_ = kInfinity;  ///< the least start value
    std::vector<Node> core_;
    std::vector<std::uint32_t> label_;  ///< per core node; empty for one seed
    std::map<std::uint32_t, std::vector<NodeIndex>> queue_;
    std::vector<Chunk> chunks_;
    std::vector<Vec3f> seedNormal_;
    std::map<NodeIndex, Solved> discs_;  ///< jets around the seeds, by core node
    double discEnd_ = 0;                 ///< the largest value among them
    double limit_;                       ///< distances beyond it are not wanted
    bool stopped_ = false;               ///< the limit ended the march
    std::vector<bool> awaited_;
    std::size_t awaitedCount_ = 0, accepted_ = 0, guarded_ = 0;
};

JetMarch::JetMarch(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
                   const JetOptions& options)
    : band_(band),
      held_(std::move(metric)),
      metric_(*held_),
      options_(options),
      least_(metric_.least()),
      varied_(metric_.largest() > least_),
      bucketWidth_(options.bucketWidth * least_),
      seeds_(seeds),
      core_(band.coreSize()),
      limit_(options.maxDistance) {
    parallelFor(band.leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& leaf = band.leaves[l];
            NodeIndex k = leaf.core.first;
            for (NodeIndex i = leaf.band.first; i < leaf.band.first + leaf.band.count; ++i) {
                const std::uint16_t o = band.offset[i];
                if (leaf.core.mask[o >> 6] >> (o & 63) & 1)
                    core_[k++] = {kInfinity,
                                  {},
                                  band.foot[i],
                                  band.normal[i],
                                  LeafIndex(l),
                                  kNoBucket,
                                  o,
                                  metric_.sight.empty() ? Metric::Clear : metric_.sight[i],
                                  float(metric_.at(i))};
            }
        }
    });
    if (metric_.obstacles) placeRimNodes();
    if (seeds.size() > 1) label_.assign(core_.size(), 0);
    for (SurfacePoint& s : seeds_) {
        s.weight = metric_.at(s.node);
        first_ = std::min(first_, s.start);
    }
    for (std::size_t k = 0; k < seeds.size(); ++k) startDisc(std::uint32_t(k));
}

void JetMarch::placeRimNodes() {
    // So far outside that steps of 1.5 voxels along a rim with a radius of 6 voxels stay outside.
    constexpr float kOff = 0.05f;
    std::vector<std::pair<NodeIndex, Vec3f>> rim;
    for (std::size_t k = 0; k < core_.size(); ++k) {
        const auto i = NodeIndex(k);
        const Node& node = core_[i];
        if (node.sight != Metric::Inside) continue;
        float nearest = float(kInfinity);
        Vec3f place;
        band_.forNeighbours(
            &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
                const Node& outside = core_[j];
                if (outside.sight == Metric::Inside ||
                    igeo::dot(node.normal, outside.normal) < Band::kOtherSheet)
                    return;
                const Vec3f step = node.foot - outside.foot - Vec3f(Ijk{dx, dy, dz});
                const Vec3d from = footOf(outside), normal(node.normal);
                // To a thousandth of a voxel.
                float free = 0, blocked = 1;
                for (int round = 0; round < 10; ++round) {
                    const float t = (free + blocked) / 2;
                    const Vec3d p = from + Vec3d(t * step);
                    (metric_.blocked(p, p, normal) ? blocked : free) = t;
                }
                const float len = igeo::length(step), back = (1 - free) * len + kOff;
                if (back > len || back >= nearest) return;
                nearest = back;
                place = node.foot - (back / len) * step;
            });
        if (nearest < float(kInfinity)) rim.emplace_back(i, place);
    }
    for (const auto& [i, place] : rim) core_[i].foot = place, core_[i].sight = Metric::Beside;
}

bool JetMarch::discJet(std::uint32_t k, const Vec3f& normal, const Vec3d& foot, double weight,
                       Solved& s) const {
    const SurfacePoint& seed = seeds_[k];
    const TangentFrame frame(normal);
    const Vec3f chord(foot - seed.pIndex);
    const float cosine = igeo::dot(normal, seedNormal_[k]), c = igeo::length(chord);
    if (c > float(options_.startRadius)) return false;
    // Across a crease chords say nothing, and the march begins next to the seed; but a seed on the
    // crease itself lies in the planes of all its faces.
    constexpr float kSmooth = 0.8f, kInPlane = 0.05f;
    if (cosine < kSmooth && std::abs(igeo::dot(normal, chord)) >= kInPlane * c) return false;
    const Vec2f way =
        cosine < kSmooth ? frame.flat(chord) : frame.way(chord, seedNormal_[k], cosine);
    const float u = length(way);
    s = {seed.start + (seed.weight + weight) / 2 * double(u), {}, k, false};
    if (u > 1e-6f) s.g = frame.lift((1 / u) * way);
    return true;
}

void JetMarch::startDisc(std::uint32_t k) {
    const SurfacePoint& seed = seeds_[k];
    const PsiSample psi = samplePsi(band_, seed.pIndex);
    // Where two faces share a cell their gradients cancel.
    const bool clear = psi.valid && length(psi.gradient) > 0.5;
    seedNormal_.push_back(clear ? Vec3f(normalized(psi.gradient)) : band_.normal[seed.node]);
    auto put = [&](NodeIndex i, const Solved& s) {
        discEnd_ = std::max(discEnd_, s.u);
        const auto [at, isNew] = discs_.try_emplace(i, s);
        if (!isNew && s.u < at->second.u) at->second = s;
        const std::uint32_t b = bucketOf(s.u);
        if (b < core_[i].bucket) core_[i].bucket = b, queue_[b].push_back(i);
    };
    // Outward from the seed over the core, so that no disc reaches a surface close by.
    std::vector<NodeIndex> found;
    std::set<NodeIndex> seen;
    NodeIndex nearest = kNoNode;
    double least = kInfinity;
    auto visit = [&](NodeIndex i) {
        if (!seen.insert(i).second) return;
        if (hidden(core_[i], seed.pIndex, seedNormal_[k])) return;
        const Vec3d foot = footOf(core_[i]);
        if (const double r = length(foot - seed.pIndex); r < least) least = r, nearest = i;
        if (Solved s; discJet(k, core_[i].normal, foot, core_[i].weight, s))
            put(i, s), found.push_back(i);
    };
    const Vec3f side = band_.normal[seed.node];
    forBox(band_.leaf[seed.node], band_.offset[seed.node], {}, 2, [&](NodeIndex i, const Ijk&) {
        if (igeo::dot(core_[i].normal, side) >= Band::kOtherSheet) visit(i);
    });
    for (std::size_t at = 0; at < found.size(); ++at) {
        const Node& node = core_[found[at]];
        band_.forNeighbours(&BandLeaf::core, node.leaf, node.offset,
                            [&](NodeIndex j, int, int, int) {
                                if (igeo::dot(node.normal, core_[j].normal) >= Band::kOtherSheet)
                                    visit(j);
                            });
    }
    // A seed in a corner that no node near it can see: straight to the nearest.
    if (found.empty() && nearest != kNoNode)
        put(nearest, {seed.start + seed.weight * least, {}, k, false});
}

Solved JetMarch::preferDisc(NodeIndex i, const Solved& s) const {
    const auto disc = discs_.find(i);
    if (disc == discs_.end() || (s.u < disc->second.u && s.label != disc->second.label)) return s;
    return disc->second;
}

void JetMarch::see(NodeIndex j, const Vec3f& chord, float cosine, const TangentFrame& frame,
                   float weight, Surroundings& from) const {
    const Node& other = core_[j];
    if (cosine < 0.9f) from.all.smooth = false;
    // Relative to the start: near a source the solve takes u for the distance to it.
    from.add(frame.neighbour(meanWeight(other.weight, weight) * chord, other.normal, cosine,
                             other.g, (other.u - first_) / double(weight)),
             labelOf(j));
}

Solved JetMarch::visit(NodeIndex i, std::uint32_t bucket, std::uint32_t last,
                       std::vector<Queued>& out) {
    const Node& node = core_[i];
    const TangentFrame frame(node.normal);
    Surroundings known;
    struct Waiting {
        NodeIndex node;
        Vec3f chord;  ///< from its foot point to this one
    };
    std::array<Waiting, 26> waiting;
    std::size_t waitingCount = 0;
    float leastAround = node.weight;
    band_.forNeighbours(
        &BandLeaf::core, node.leaf, node.offset, [&](NodeIndex j, int dx, int dy, int dz) {
            const Node& other = core_[j];
            const float cosine = igeo::dot(frame.normal(), other.normal);
            if (cosine < Band::kOtherSheet) return;
            leastAround = std::min(leastAround, other.weight);
            const Vec3f chord = node.foot - other.foot - Vec3f{float(dx), float(dy), float(dz)};
            if (cosine < 0.5f && acrossGap(chord, frame.normal(), other.normal)) return;
            if (node.sight != Metric::Clear &&
                hidden(other, footOf(node), node.normal + other.normal))
                return;
            if (!(other.u < kInfinity)) {
                waiting[waitingCount++] = {j, chord};
                return;
            }
            see(j, chord, cosine, frame, node.weight, known);
        });
    // One per lattice column: on a surface that goes on all around these are eight, or nearly so.
    constexpr std::size_t kAllAround = 7;
    known.all.rim =
        node.sight != Metric::Clear || std::size_t(known.all.count()) + waitingCount < kAllAround;
    Solved s;
    const Jet jet = known.update(s.label);
    s.u = first_ + double(node.weight) * jet.u;
    s.g = frame.lift(jet.g);
    s.guarded = jet.guarded;
    // Nodes of a disc wait in its buckets or earlier.
    if (bucket <= bucketOf(discEnd_)) s = preferDisc(i, s);
    s.stands = s.u < kInfinity &&
               bucketOf(s.u - (slackOf(node.weight, leastAround) - bucketWidth_)) <= bucket;
    if (s.stands)
        for (std::size_t k = 0; k < waitingCount; ++k)
            key(waiting[k].node, node.weight * -waiting[k].chord, s, last, out);
    return s;
}

void JetMarch::key(NodeIndex i, const Vec3f& chord, const Solved& from, std::uint32_t bucket,
                   std::vector<Queued>& out) {
    // Several threads may key one node: the least bucket wins, whoever comes first.
    std::uint32_t& waitsIn = core_[i].bucket;
    std::uint32_t seen = __atomic_load_n(&waitsIn, __ATOMIC_RELAXED);
    if (seen <= bucket + 1) return;
    // As jet::carry, by chords: good enough to know the bucket.
    const double along = igeo::dot(from.g, chord), c2 = igeo::dot(chord, chord);
    const double r = from.u - first_ + std::max(along, 0.0);
    const double carried =
        along > 0 ? std::sqrt(r * r + std::max(c2 - along * along, 0.0)) : r + std::sqrt(c2);
    const std::uint32_t b = std::max(bucket + 1, bucketOf(first_ + carried));
    while (b < seen && !__atomic_compare_exchange_n(&waitsIn, &seen, b, /*weak=*/true,
                                                    __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
    if (b < seen) out.push_back({b, i});
}

std::vector<NodeIndex> JetMarch::nextNodes(std::uint32_t& last) {
    const std::uint32_t first = queue_.begin()->first;
    std::vector<NodeIndex> nodes = std::move(queue_.begin()->second);
    queue_.erase(queue_.begin());
    last = first;
    if (!varied_) return nodes;
    // Together with the next buckets, up to the slack that every node has.
    double slack = kInfinity;
    const auto fits = [&](const std::vector<NodeIndex>& more, std::uint32_t bucket) {
        for (const NodeIndex i : more)
            if (slack = std::min(slack, slackOf(core_[i].weight, 0));
                (bucket - first + 1) * bucketWidth_ > slack)
                return false;
        return true;
    };
    if (!fits(nodes, first)) return nodes;
    while (!queue_.empty() && fits(queue_.begin()->second, queue_.begin()->first)) {
        const auto next = queue_.begin();
        last = next->first;
        nodes.insert(nodes.end(), next->second.begin(), next->second.end());
        queue_.erase(next);
    }
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
            chunk.accepted.clear(), chunk.queued.clear(), chunk.tooEarly.clear();
            for (std::size_t k = c * kChunk; k < std::min(nodes.size(), (c + 1) * kChunk); ++k) {
                // Taken out of its bucket by whoever is first: it may be queued twice. Or it was
                // queued here before a front came to it from elsewhere, and earlier.
                std::uint32_t& waitsIn = core_[nodes[k]].bucket;
                std::uint32_t seen = __atomic_load_n(&waitsIn, __ATOMIC_RELAXED);
                if (seen < bucket || seen > last ||
                    !__atomic_compare_exchange_n(&waitsIn, &seen, 0, /*weak=*/false,
                                                 __ATOMIC_RELAXED, __ATOMIC_RELAXED))
                    continue;
                const Solved s = visit(nodes[k], bucket, last, chunk.queued);
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
            for (const Queued& q : chunks_[c].tooEarly) core_[q.node].bucket = q.bucket;
            for (const auto& [i, s] : chunks_[c].accepted) {
                core_[i].u = s.u;
                core_[i].g = s.g;
                if (!label_.empty()) label_[i] = s.label;
            }
        }
    });
    for (std::size_t c = 0; c < count; ++c) {
        accepted_ += chunks_[c].accepted.size();
        for (const auto& [i, s] : chunks_[c].accepted) {
            guarded_ += s.guarded;
            heaviest_ = std::max(heaviest_, core_[i].weight);
            if (!awaited_.empty() && awaited_[i]) --awaitedCount_;
        }
        for (const auto* list : {&chunks_[c].queued, &chunks_[c].tooEarly})
            for (const Queued& q : *list) queue_[q.bucket].push_back(q.node);
    }
}

void JetMarch::watchTargets() {
    if (options_.stopAt.empty()) return;
    awaited_.assign(core_.size(), false);
    for (const SurfacePoint& p : options_.stopAt)
        for (const NodeIndex i : nodesAround(band_, p, 3.0)) {
            const NodeIndex core = band_.coreNode(i);
            if (core != kNoNode && !awaited_[core] && !metric_.inside(i))
                awaited_[core] = true, ++awaitedCount_;
        }
}

void JetMarch::march(Progress& progress) {
    watchTargets();
    bool waits = awaitedCount_ > 0;
    while (!queue_.empty()) {
        const std::uint32_t bucket = queue_.begin()->first;
        if (bucket >= kLastBucket)
            throw Error(Error::Kind::InvalidArgument,
                        "a distance is more than 2e9 times the least weight, in voxels",
                        "raise the least weights: they make no difference beside the largest");
        if (first_ + bucket * bucketWidth_ > limit_ + kMargin * double(heaviest_)) {
            stopped_ = true;
            return;
        }
        std::uint32_t last = bucket;
        const std::vector<NodeIndex> nodes = nextNodes(last);
        process(bucket, last, nodes);
        if (waits && awaitedCount_ == 0) {
            limit_ = std::min(limit_, first_ + (last + 1) * bucketWidth_);
            waits = false;
        }
        progress.throwIfCancelled();
        progress.update("march", double(accepted_) / double(core_.size()));
    }
}

Solved JetMarch::extendTo(NodeIndex i, LeafIndex l, unsigned at) const {
    constexpr float kLight = 0.01f, kFlat = 0.8f;
    const Vec3f fi = band_.foot[i], n = band_.normal[i];
    const Ijk low{floorToInt(fi.x), floorToInt(fi.y), floorToInt(fi.z)};
    const Vec3f up = fi - Vec3f(low);
    // The corners around the foot point that are in the core, and what they say together.
    struct Corner {
        const Node* node;
        float weight;
        Vec3f chord;
    };
    std::array<Corner, 8> corners;
    std::size_t count = 0;
    Solved s;
    Vec3f sum;
    bool simple = true;
    band_.forCorners(&BandLeaf::core, l, at, low, [&](NodeIndex j, unsigned k) {
        const Vec3f from = up - Vec3f{float(k >> 2), float(k >> 1 & 1), float(k & 1)};
        const float w = (1 - std::abs(from.x)) * (1 - std::abs(from.y)) * (1 - std::abs(from.z));
        if (w < kLight) return;
        const Node& node = core_[j];
        if (count == 0) s.label = labelOf(j);
        simple &= node.u < kInfinity && labelOf(j) == s.label && dot(n, node.normal) >= kFlat;
        corners[count++] = {&node, w, from - node.foot};
        sum += w * node.g;
    });
    if (count == 0 || !metric_.clear(i)) simple = false;
    if (!simple) return solveOutside(i, l, at);
    s.g = normalized(tangential(sum, n));
    // Every corner carries its jet to the foot point as along a circle (jet::circularStep); that
    // these directions are in space, not in one plane, changes it by (k c)^2 / 12 at curvature k.
    const double origin = corners[0].node->u, weight = metric_.at(i);
    float value = 0, total = 0;
    for (std::size_t c = 0; c < count; ++c) {
        const auto& [node, w, chord] = corners[c];
        const float cosine = dot(s.g, node->g);
        if (!(cosine >= jet::kSameFront)) return solveOutside(i, l, at);
        value +=
            w * (float((node->u - origin) / weight) + meanWeight(node->weight, float(weight)) *
                                                          dot(s.g + node->g, chord) / (1 + cosine));
        total += w;
    }
    s.u = origin + weight * double(value / total);
    return s.u > discEnd_ + kMargin * weight ? s : preferDiscOutside(i, s);
}

/// The core around such a node has been reached from its seed, so that it is on the same sheet.
Solved JetMarch::preferDiscOutside(NodeIndex i, const Solved& s) const {
    Solved disc;
    const SurfacePoint& seed = seeds_[s.label];
    if (metric_.blocked(band_, seed.pIndex, Vec3d(seedNormal_[s.label]), i) ||
        !discJet(s.label, band_.normal[i], band_.footPoint(i), metric_.at(i), disc)) {
        disc = s;
        disc.u = std::max(s.u, seed.start);
    }
    return disc;
}

template <typename Visit>
void JetMarch::forBox(LeafIndex l, unsigned at, const Ijk& middle, int reach,
                      const Visit& visit) const {
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach; z <= reach; ++z) {
                const Ijk step = middle + Ijk{x, y, z};
                const NodeIndex i = band_.neighbour(&BandLeaf::core, l, at, step);
                if (i != kNoNode) visit(i, step);
            }
}

bool JetMarch::gatherAround(NodeIndex i, LeafIndex l, unsigned at, const Ijk& middle, int reach,
                            const TangentFrame& frame, Surroundings& found) const {
    // Further off than a cell's diagonal it may be another surface.
    constexpr float kNear2 = 3;
    const auto weight = float(metric_.at(i));
    bool anybody = false;
    forBox(l, at, middle, reach, [&](NodeIndex j, const Ijk& step) {
        const Node& other = core_[j];
        const float cosine = igeo::dot(frame.normal(), other.normal);
        const Vec3f chord = band_.foot[i] - other.foot - Vec3f(step);
        if (cosine < Band::kOtherSheet || igeo::dot(chord, chord) > kNear2) return;
        if (!metric_.clear(i) && hidden(other, band_.footPoint(i), frame.normal() + other.normal))
            return;
        anybody = true;
        if (!(other.u < kInfinity) || found.all.count() == JetNeighbours::kMax) return;
        see(j, chord, cosine, frame, weight, found);
    });
    return anybody;
}

Solved JetMarch::solveOutside(NodeIndex i, LeafIndex l, unsigned at) const {
    const TangentFrame frame(band_.normal[i]);
    Surroundings around;
    // Where the foot point is off, the core passes within two voxels all the same.
    if (!gatherAround(i, l, at, roundToIjk(Vec3d(band_.foot[i])), 1, frame, around))
        gatherAround(i, l, at, {}, 2, frame, around);
    Solved s;
    const Jet jet = around.update(s.label);
    s.u = first_ + metric_.at(i) * jet.u;
    s.g = frame.lift(jet.g);
    return s.u > discEnd_ + kMargin * metric_.at(i) ? s : preferDiscOutside(i, s);
}

Field JetMarch::take() {
    Field field;
    // Side by side: the first touch of fresh memory costs more than what is written there.
    parallelFor(3, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (k == 0) field.distance.resize(band_.size());
            if (k == 1) field.gradient.resize(band_.size());
            if (k == 2 && !label_.empty()) field.label.resize(band_.size());
        }
    });
    parallelFor(band_.leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& leaf = band_.leaves[l];
            for (NodeIndex i = leaf.band.first; i < leaf.band.first + leaf.band.count; ++i) {
                const unsigned at = band_.offset[i];
                const NodeIndex k = leaf.core.node(at);
                const Solved s = metric_.inside(i) ? Solved{}
                                 : k == kNoNode    ? extendTo(i, LeafIndex(l), at)
                                                : Solved{core_[k].u, core_[k].g, labelOf(k), false};
                const bool wanted = s.u <= limit_;
                field.distance[i] = wanted ? s.u : kInfinity;
                field.gradient[i] = wanted ? float(metric_.at(i)) * s.g : Vec3f();
                if (!label_.empty()) field.label[i] = s.label;
            }
        }
    });
    field.atFootPoints = true;
    field.metric = held_;
    field.seeds = std::move(seeds_);
    field.scheme = "jet";
    field.startRadius = options_.startRadius;
    field.stoppedEarly = stopped_;
    field.solved = accepted_;
    field.guarded = guarded_;
    field.summarise();
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
    const auto [first, last] = std::minmax_element(
        seeds.begin(), seeds.end(), [](auto& a, auto& b) { return a.start < b.start; });
    // Buckets are numbered in 32 bits.
    if (!(last->start - first->start < 1e9 * metric->least()))
        throw Error(Kind::InvalidArgument, "start values of seeds differ by more than 1e9 voxels",
                    "give seeds that no front comes near to a run of their own");
    metric->check(band.size());
    JetMarch march(band, std::move(metric), seeds, options);
    march.march(progress);
    return march.take();
}

}  // namespace igeo
