#include <igeo/jet.h>

#include <igeo/error.h>
#include <igeo/jet_update.h>
#include <igeo/parallel.h>
#include <igeo/tangent_frame.h>

#include <algorithm>
#include <map>

namespace igeo {

namespace {

/// The march goes over the voxels whose cube S may pass, |psi| < sqrt(3)/2: they hold every foot
/// point and are connected through faces wherever S is. The other nodes of the band take the jets
/// of these.
constexpr float kCore = 0.8660254f;

/// An early stop marches this far beyond its limit, so that the nodes within it have all the
/// neighbours that a full march would give them.
constexpr double kMargin = 3;

/// Buckets are counted from the smallest start value; this one is beyond all.
constexpr std::uint32_t kNoBucket = std::numeric_limits<std::uint32_t>::max();

class JetMarch {
public:
    JetMarch(const Band& band, const std::vector<SurfacePoint>& seeds, const JetOptions& options)
        : band_(band),
          options_(options),
          seeds_(seeds),
          u_(band.size(), kInfinity),
          g_(band.size()),
          bucket_(band.size(), kNoBucket),
          limit_(options.maxDistance) {
        if (seeds.size() > 1) label_.assign(band.size(), 0);
        first_ = kInfinity;
        for (const SurfacePoint& s : seeds) first_ = std::min(first_, s.start);
        for (std::size_t k = 0; k < seeds.size(); ++k) startDisc(k);
    }

    void march(Progress& progress);
    /// Gives the nodes outside the core the jets of the core around their foot points.
    void extend();

    Field take() {
        Field field;
        for (std::size_t i = 0; i < u_.size(); ++i)
            if (u_[i] > limit_) u_[i] = kInfinity, g_[i] = Vec3f();
        field.distance = std::move(u_);
        field.gradient = std::move(g_);
        field.atFootPoints = true;
        field.label = std::move(label_);
        field.seeds = std::move(seeds_);
        field.scheme = "jet";
        field.startRadius = options_.startRadius;
        field.stoppedEarly = stopped_;
        field.guarded = guarded_;
        field.summarise();
        return field;
    }

private:
    using NodeList = std::array<NodeIndex, JetNeighbours::kMax>;
    struct Solved {
        NodeIndex node;
        std::uint32_t label = 0;
        double u = kInfinity;
        Vec3f g;
        bool guarded = false;
    };
    struct Queued {
        std::uint32_t bucket;
        NodeIndex node;
    };

    std::uint32_t bucketOf(double u) const {
        return std::uint32_t(std::max(0.0, (u - first_) / options_.bucketWidth));
    }
    bool core(NodeIndex i) const { return std::abs(band_.psi[i]) < kCore; }
    std::uint32_t labelOf(NodeIndex i) const { return label_.empty() ? 0 : label_[i]; }

    void startDisc(std::size_t seed);
    void watchTargets();
    /// The neighbours of node i with a jet, in its tangent plane; `nodes` says which they are.
    JetNeighbours gather(NodeIndex i, const TangentFrame& frame, NodeList& nodes) const;
    Solved solve(NodeIndex i) const;
    /// The jet at a node outside the core, from the core's jets at the corners around its foot
    /// point.
    Solved extendTo(NodeIndex i) const;
    /// Start discs are exact, unless the front of another seed was there before.
    const Solved& preferDisc(const Solved& s) const;
    /// Puts the neighbours of an accepted node into the bucket where its jet says they belong.
    void key(NodeIndex j, std::uint32_t current, std::vector<Queued>& out);
    void process(std::uint32_t bucket, const std::vector<NodeIndex>& nodes);
    /// Nodes that touch what is accepted at an edge or a corner only: keyed through faces, the
    /// march passed them by. Puts them into `bucket` and says whether there are any.
    bool queueStragglers(std::uint32_t bucket);

    const Band& band_;
    const JetOptions& options_;
    std::vector<SurfacePoint> seeds_;
    double first_;
    std::vector<double> u_;  ///< +inf until accepted
    std::vector<Vec3f> g_;
    std::vector<std::uint32_t> label_;
    std::vector<std::uint32_t> bucket_;  ///< the bucket a node waits in; 0 once it is accepted
    std::map<std::uint32_t, std::vector<NodeIndex>> queue_;
    std::vector<Solved> solved_;               ///< of the current bucket, one per node
    std::vector<std::vector<Queued>> queued_;  ///< by the current bucket, one list per chunk
    std::map<NodeIndex, Solved> discs_;        ///< jets around the seeds
    double discEnd_ = 0;                       ///< the largest value among them
    double limit_;                             ///< distances beyond it are not wanted
    bool stopped_ = false;                     ///< the limit ended the march
    std::vector<bool> awaited_;
    std::size_t awaitedCount_ = 0, accepted_ = 0, guarded_ = 0;
};

void JetMarch::startDisc(std::size_t k) {
    const SurfacePoint& seed = seeds_[k];
    const PsiSample psi = samplePsi(band_, seed.pIndex);
    const Vec3f n = psi.valid ? Vec3f(normalized(psi.gradient)) : band_.normal[seed.node];
    constexpr float kInPlane = 0.05f;
    for (const NodeIndex i : nodesAround(band_, seed, options_.startRadius + band_.h)) {
        const TangentFrame frame(band_.normal[i]);
        const Vec3f chord(band_.footPoint(i) - seed.pIndex);
        const float cosine = igeo::dot(frame.normal(), n), c = igeo::length(chord);
        if (c > float(options_.startRadius)) continue;
        // Across a crease chords say nothing, and the march begins next to the seed; but a seed on
        // the crease itself lies in the planes of all its faces.
        const bool inPlane = std::abs(igeo::dot(frame.normal(), chord)) < kInPlane * c;
        if (cosine < 0.8f && !inPlane) continue;
        const Vec2f way = cosine < 0.8f ? frame.flat(chord) : frame.way(chord, n, cosine);
        const float u = length(way);
        Solved s{i, std::uint32_t(k), seed.start + double(u), Vec3f(), false};
        if (u > 1e-6f) s.g = frame.lift((1 / u) * way);
        discEnd_ = std::max(discEnd_, s.u);
        const auto [at, isNew] = discs_.try_emplace(i, s);
        if (!isNew && s.u < at->second.u) at->second = s;
        const std::uint32_t b = bucketOf(s.u);
        if (core(i) && b < bucket_[i]) bucket_[i] = b, queue_[b].push_back(i);
    }
}

JetNeighbours JetMarch::gather(NodeIndex i, const TangentFrame& frame, NodeList& nodes) const {
    JetNeighbours all;
    const Vec3f fi = band_.foot[i];
    band_.forNeighbours(i, [&](NodeIndex j, int dx, int dy, int dz) {
        if (!(u_[j] < kInfinity)) return;
        const Vec3f nj = band_.normal[j];
        const float cosine = igeo::dot(frame.normal(), nj);
        if (cosine < Band::kOtherSheet) return;
        if (cosine < 0.9f) all.smooth = false;
        const Vec3f chord = fi - band_.foot[j] - Vec3f{float(dx), float(dy), float(dz)};
        nodes[std::size_t(all.count())] = j;
        // Relative to the start: near a source the solve takes u for the distance to it.
        all.add(frame.neighbour(chord, nj, cosine, g_[j], u_[j] - first_));
    });
    return all;
}

JetMarch::Solved JetMarch::solve(NodeIndex i) const {
    Solved s;
    s.node = i;
    const TangentFrame frame(band_.normal[i]);
    NodeList nodes;
    const JetNeighbours all = gather(i, frame, nodes);
    const Jet jet = jetUpdate(all);
    if (jet.from >= 0) {
        s.u = first_ + jet.u;
        s.g = frame.lift(jet.g);
        s.guarded = jet.guarded;
        s.label = labelOf(nodes[std::size_t(jet.from)]);
    }
    // Nodes of a disc wait in its buckets or earlier.
    return bucket_[i] > bucketOf(discEnd_) ? s : preferDisc(s);
}

const JetMarch::Solved& JetMarch::preferDisc(const Solved& s) const {
    const auto disc = discs_.find(s.node);
    if (disc == discs_.end() || (s.u < disc->second.u && s.label != disc->second.label)) return s;
    return disc->second;
}

void JetMarch::key(NodeIndex j, std::uint32_t current, std::vector<Queued>& out) {
    const Vec3f fj = band_.foot[j], g = g_[j];
    for (int side = 0; side < 6; ++side) {
        const Ijk step = Band::faceStep(side);
        const NodeIndex i = band_.neighbour(j, step);
        if (i == kNoNode || !core(i)) continue;
        // Several threads may key one node: the least bucket wins, whoever comes first.
        std::uint32_t seen = __atomic_load_n(&bucket_[i], __ATOMIC_RELAXED);
        if (seen <= current + 1 || !band_.linked(i, j)) continue;
        // As jet::carry, by chords: good enough to know the bucket.
        const Vec3f chord = band_.foot[i] - fj + Vec3f(step);
        const double along = igeo::dot(g, chord), c2 = igeo::dot(chord, chord);
        const double r = u_[j] - first_ + std::max(along, 0.0);
        const double carried =
            along > 0 ? std::sqrt(r * r + std::max(c2 - along * along, 0.0)) : r + std::sqrt(c2);
        const std::uint32_t b =
            std::max(current + 1, std::uint32_t(carried / options_.bucketWidth));
        while (b < seen && !__atomic_compare_exchange_n(&bucket_[i], &seen, b, /*weak=*/true,
                                                        __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
        }
        if (b < seen) out.push_back({b, i});
    }
}

void JetMarch::process(std::uint32_t bucket, const std::vector<NodeIndex>& nodes) {
    constexpr std::size_t kChunk = 128;
    const std::size_t chunks = (nodes.size() + kChunk - 1) / kChunk;
    solved_.resize(nodes.size());
    if (queued_.size() < chunks) queued_.resize(chunks);
    parallelFor(chunks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin * kChunk; k < std::min(nodes.size(), end * kChunk); ++k)
            if (bucket_[nodes[k]] == bucket)
                solved_[k] = solve(nodes[k]);
            else
                solved_[k].node = kNoNode;
    });
    // Accepted together: what is solved beyond its bucket waits for the one it belongs to.
    for (Solved& s : solved_) {
        if (s.node == kNoNode) continue;
        if (!(s.u < kInfinity)) {  // all its neighbours face it: somebody else may reach it
            bucket_[s.node] = kNoBucket;
            s.node = kNoNode;
            continue;
        }
        const std::uint32_t b = bucketOf(s.u);
        if (bucket_[s.node] != bucket || b > bucket) {  // the former: queued twice
            if (bucket_[s.node] == bucket) {
                bucket_[s.node] = b;
                queue_[b].push_back(s.node);
            }
            s.node = kNoNode;
            continue;
        }
        u_[s.node] = s.u;
        g_[s.node] = s.g;
        if (!label_.empty()) label_[s.node] = s.label;
        bucket_[s.node] = 0;
        guarded_ += s.guarded;
        ++accepted_;
        if (!awaited_.empty() && awaited_[s.node]) --awaitedCount_;
    }
    parallelFor(chunks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            queued_[c].clear();
            for (std::size_t k = c * kChunk; k < std::min(nodes.size(), (c + 1) * kChunk); ++k)
                if (solved_[k].node != kNoNode) key(solved_[k].node, bucket, queued_[c]);
        }
    });
    for (std::size_t c = 0; c < chunks; ++c)
        for (const Queued& q : queued_[c]) queue_[q.bucket].push_back(q.node);
}

JetMarch::Solved JetMarch::extendTo(NodeIndex i) const {
    const Vec3f fi = band_.foot[i];
    const TangentFrame frame(band_.normal[i]);
    const Ijk base = floorToIjk(Vec3d(fi));
    const Vec3f t = fi - Vec3f(base);
    JetNeighbours all;
    std::array<float, JetNeighbours::kMax> weight{};
    Solved s;
    s.node = i;
    constexpr float kLight = 0.01f;
    for (int k = 0; k < 8; ++k) {
        const Ijk corner{k >> 2, k >> 1 & 1, k & 1}, step = base + corner;
        const float w =
            (corner.x ? t.x : 1 - t.x) * (corner.y ? t.y : 1 - t.y) * (corner.z ? t.z : 1 - t.z) +
            1e-6f;
        // The lightest corners change nothing, but one of the eight always counts.
        if (w < kLight) continue;
        const NodeIndex j = band_.neighbour(i, step);
        if (j == kNoNode || !core(j) || !(u_[j] < kInfinity)) continue;
        const Vec3f nj = band_.normal[j];
        const float cosine = igeo::dot(frame.normal(), nj);
        if (cosine < Band::kOtherSheet) continue;
        const Vec3f chord = fi - band_.foot[j] - Vec3f(step);
        weight[std::size_t(all.count())] = w;
        all.add(frame.neighbour(chord, nj, cosine, g_[j], u_[j]));
        s.label = labelOf(j);
    }
    if (all.count() == 0)
        // A foot point that is off: take what lies next to the voxel.
        band_.forNeighbours(i, [&](NodeIndex j, int dx, int dy, int dz) {
            const float cosine = igeo::dot(frame.normal(), band_.normal[j]);
            if (!core(j) || !(u_[j] < kInfinity) || cosine < Band::kOtherSheet) return;
            const Vec3f chord = fi - band_.foot[j] - Vec3f{float(dx), float(dy), float(dz)};
            weight[std::size_t(all.count())] = 1;
            all.add(frame.neighbour(chord, band_.normal[j], cosine, g_[j], u_[j]));
            s.label = labelOf(j);
        });
    const Jet jet = blendJets(all, weight);
    s.u = jet.u;
    s.g = frame.lift(jet.g);
    return s.u > discEnd_ + kMargin && s.u < kInfinity ? s : preferDisc(s);
}

void JetMarch::extend() {
    parallelFor(band_.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (core(NodeIndex(k))) continue;
            const Solved s = extendTo(NodeIndex(k));
            u_[k] = s.u;
            g_[k] = s.g;
            if (!label_.empty()) label_[k] = s.label;
        }
    });
}

void JetMarch::watchTargets() {
    if (options_.stopAt.empty()) return;
    awaited_.assign(band_.size(), false);
    for (const SurfacePoint& p : options_.stopAt)
        for (const NodeIndex i : nodesAround(band_, p, 3.0))
            if (core(i) && !awaited_[i]) awaited_[i] = true, ++awaitedCount_;
}

bool JetMarch::queueStragglers(std::uint32_t bucket) {
    constexpr std::size_t kChunk = 1 << 14;
    std::vector<std::vector<NodeIndex>> found((band_.size() + kChunk - 1) / kChunk);
    parallelFor(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::size_t k = c * kChunk; k < std::min(band_.size(), (c + 1) * kChunk); ++k) {
                const auto i = NodeIndex(k);
                if (!core(i) || u_[i] < kInfinity) continue;
                bool reachable = false;
                band_.forNeighbours(i, [&](NodeIndex j, int, int, int) {
                    reachable |= u_[j] < kInfinity &&
                                 igeo::dot(band_.normal[i], band_.normal[j]) >= Band::kOtherSheet;
                });
                if (reachable) found[c].push_back(i);
            }
    });
    for (const auto& part : found)
        for (const NodeIndex i : part) {
            bucket_[i] = bucket;
            queue_[bucket].push_back(i);
        }
    return !queue_.empty();
}

void JetMarch::march(Progress& progress) {
    watchTargets();
    bool waits = awaitedCount_ > 0;
    std::uint32_t last = 0;
    while (!queue_.empty() || queueStragglers(last + 1)) {
        const auto first = queue_.begin();
        const std::uint32_t bucket = first->first;
        if (first_ + bucket * options_.bucketWidth > limit_ + kMargin) {
            stopped_ = true;
            return;
        }
        const std::vector<NodeIndex> nodes = std::move(first->second);
        queue_.erase(first);
        process(bucket, nodes);
        last = bucket;
        if (waits && awaitedCount_ == 0) {
            limit_ = std::min(limit_, first_ + (bucket + 1) * options_.bucketWidth);
            waits = false;
        }
        progress.throwIfCancelled();
        progress.update("march", double(accepted_) / double(band_.size()));
    }
}

}  // namespace

Field marchJet(const Band& band, const std::vector<SurfacePoint>& seeds, const JetOptions& options,
               Progress& progress) {
    using Kind = Error::Kind;
    if (seeds.empty()) throw Error(Kind::InvalidArgument, "a march needs at least one seed");
    if (!(options.maxDistance > 0))
        throw Error(Kind::InvalidArgument, "the largest distance must be positive");
    if (!(band.h >= double(kCore)))
        throw Error(Kind::InvalidArgument, "a band of " + std::to_string(band.h) +
                                               " voxels is too narrow: jet needs sqrt(3)/2");
    const auto [first, last] = std::minmax_element(
        seeds.begin(), seeds.end(), [](auto& a, auto& b) { return a.start < b.start; });
    // Buckets are numbered in 32 bits.
    if (!(last->start - first->start < 1e9))
        throw Error(Kind::InvalidArgument, "start values of seeds differ by more than 1e9 voxels",
                    "give seeds that no front comes near to a run of their own");
    JetMarch march(band, seeds, options);
    march.march(progress);
    march.extend();
    return march.take();
}

}  // namespace igeo
