#include <igeo/march/godunov.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/godunov_update.h>
#include <igeo/march/detail/march_heap.h>

namespace igeo {

namespace {

/// The face neighbors of every node at faces -x, +x, -y, +y, -z, +z. Where there is none, or one on
/// a facing sheet (Band::linked) or behind an obstacle, the entry is n, a node that never gets a
/// distance: so the solve needs no tests.
class FaceNeighbors {
public:
    using Six = std::array<NodeIndex, 6>;

    FaceNeighbors(const Band& band, const Metric& metric) : table_(band.size() + 1) {
        const auto none = NodeIndex(band.size());
        table_.back().fill(none);
        parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                for (int face = 0; face < 6; ++face) {
                    const auto i = NodeIndex(k);
                    const NodeIndex j = band.neighbor(i, Band::faceStep(face));
                    const bool open =
                        j != kNoNode && band.linked(i, j) && !metric.blocked(band, i, j);
                    table_[k][std::size_t(face)] = open ? j : none;
                }
        });
    }
    const Six& operator[](NodeIndex i) const { return table_[i]; }

private:
    std::vector<Six> table_;
};

/// Cost per unit length along an axis, of a diagonal tensor.
double axisCost(const Tensor& g, std::size_t axis) {
    return std::sqrt(double(axis == 0 ? g.xx : axis == 1 ? g.yy : g.zz));
}

/// Far, Trial and Accepted (M&S section 3: Far Away, NarrowBand, Alive) follow from the values: a
/// node is Accepted where `accepted_` is finite, else Trial where `trial_` is finite, else Far.
class Godunov {
public:
    /// @param leastStart of all seeds: heap keys are relative to it, because they are floats
    Godunov(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
            const GodunovOptions& options, double leastStart)
        : band_(band),
          metric_(std::move(metric)),
          anisotropic_(metric_->anisotropic()),
          options_(options),
          leastStart_(leastStart),
          lines_(seeds, metric_->least()),
          neighbors_(band, *metric_),
          accepted_(band.size() + 1, kInfinity),
          trial_(band.size() + 1, kInfinity),
          started_(band.size()) {}

    void start(SurfacePoint seed) {
        seed.weight = metric_->at(seed.node);
        const Vec3d normal(band_.normal[seed.node]);
        for (const NodeIndex i : nodesAround(band_, seed, options_.startRadius)) {
            const Vec3d p(band_.ijk(i)), from = seed.nearestTo(p);
            if (metric_->blocked(band_, from, normal, i)) continue;
            lower(i, seed.start + metric_->stepCost(seed.node, p - from));
            started_[i] = true;
        }
        seeds_.push_back(seed);
    }

    template <int Order>
    void march(Progress& progress);

    Field take() {
        Field field;
        field.band = &band_;
        accepted_.resize(band_.size());
        field.distance = std::move(accepted_);
        field.stoppedEarly = !heap_.empty();
        field.limit = options_.maxDistance;
        field.metric = std::move(metric_);
        field.seeds = std::move(seeds_);
        field.startRadius = options_.startRadius;
        field.scheme = options_.order == 1 ? "godunov, order 1" : "godunov, order 2";
        field.summarize();
        field.gradient = surfaceGradient(field);
        return field;
    }

private:
    void lower(NodeIndex i, double value) {
        if (!(value < trial_[i])) return;
        trial_[i] = value;
        heap_.push(value - leastStart_, i);
    }

    /// Whether node j keeps its start value. A difference over two voxels across the seed would
    /// lower it; one over one voxel does not, because distances from a point are convex. If a
    /// difference over one voxel does lower it, the front of another seed has arrived, and j
    /// becomes an ordinary node.
    bool keepsStart(NodeIndex j) {
        constexpr double kRounding = 1e-6;  // voxels
        if (!started_[j]) return false;
        started_[j] = solve<1>(j) >= trial_[j] - kRounding * metric_->at(j);
        return started_[j];
    }

    /// Solves M&S (13) at node i from its Accepted neighbors.
    template <int Order>
    double solve(NodeIndex i) const;

    /// The straight line at the least cost is a lower solution of order 1, which is monotone; order
    /// 2 is not, and goes below it by parts of a voxel.
    double notBelowLine(NodeIndex i, double value) const {
        return value < trial_[i] ? std::max(value, lines_.fromAny(Vec3d(band_.ijk(i)))) : value;
    }

    /// Marks the nodes that the early stop waits for.
    void initStopNodes();

    const Band& band_;
    MetricPtr metric_;
    const bool anisotropic_;
    const GodunovOptions& options_;
    const double leastStart_;
    const StraightLines lines_;
    const FaceNeighbors neighbors_;
    std::vector<SurfacePoint> seeds_;
    std::vector<double> accepted_, trial_;
    std::vector<bool> started_;  ///< in a start disc
    std::vector<bool> awaited_;
    std::size_t awaitedCount_ = 0;
    MarchHeap heap_;
};

template <int Order>
double Godunov::solve(NodeIndex i) const {
    const FaceNeighbors::Six& faces = neighbors_[i];
    std::array<UpwindTerm, 3> terms;
    int n = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const NodeIndex lo = faces[2 * axis], hi = faces[2 * axis + 1];
        const double dLo = accepted_[lo], dHi = accepted_[hi];
        const double m = std::min(dLo, dHi);
        if (m == kInfinity) continue;
        UpwindTerm& term = terms[std::size_t(n++)];
        term = firstOrderTerm(m);
        if (Order == 2) {
            // If both sides are equal the smaller second value is used, so that the result is
            // symmetric.
            double mm = kInfinity;
            if (dLo == m) mm = accepted_[neighbors_[lo][2 * axis]];
            if (dHi == m) mm = std::min(mm, accepted_[neighbors_[hi][2 * axis + 1]]);
            if (mm <= m) term = secondOrderTerm(m, mm);
        }
        // M&S (22) for a diagonal tensor: sum_j (T - m_j)^2 / G_jj = 1.
        if (anisotropic_) term.coefficient /= axisCost(metric_->tensor[i], axis);
    }
    return godunovSolve(terms, n, anisotropic_ ? 1 : metric_->at(i));
}

void Godunov::initStopNodes() {
    if (options_.stopAt.empty()) return;
    awaited_.assign(band_.size(), false);
    for (const SurfacePoint& p : options_.stopAt) {
        // The cells around that of the target, which its gradient reads.
        for (const NodeIndex i : nodesAround(band_, p, 3.0))
            if (!awaited_[i] && !metric_->inside(i)) awaited_[i] = true, ++awaitedCount_;
    }
}

template <int Order>
void Godunov::march(Progress& progress) {
    initStopNodes();
    const bool waits = awaitedCount_ > 0;
    std::size_t done = 0;
    while (!heap_.empty()) {
        if (trial_[heap_.top()] > options_.maxDistance) return;
        const NodeIndex i = heap_.pop();
        if (accepted_[i] < kInfinity) continue;
        accepted_[i] = trial_[i];
        if (waits && awaited_[i] && --awaitedCount_ == 0) return;
        if ((++done & 0x3fff) == 0) {
            progress.throwIfCancelled();
            progress.update("march", double(done) / double(band_.size()));
        }
        for (const NodeIndex j : neighbors_[i])
            if (j != band_.size() && accepted_[j] == kInfinity && !keepsStart(j))
                lower(j, Order == 1 ? solve<1>(j) : notBelowLine(j, solve<Order>(j)));
    }
}

void check(const Band& band, const Metric& metric, const std::vector<SurfacePoint>& seeds,
           const GodunovOptions& options) {
    using Kind = Error::Kind;
    if (options.order != 1 && options.order != 2)
        throw Error(Kind::InvalidArgument,
                    "order " + std::to_string(options.order) + " is not 1 or 2");
    if (seeds.empty()) throw Error(Kind::InvalidArgument, "a march needs at least one seed");
    if (!(options.maxDistance > 0))
        throw Error(Kind::InvalidArgument, "the largest distance must be positive");
    metric.check(band);
    // The upwind scheme is causal along the axes only (M&S 5.1, the conditions of Osher and
    // Helmsen).
    constexpr float kRounding = 1e-6f;
    for (std::size_t k = 0; k < metric.tensor.size(); ++k) {
        const Tensor& g = metric.tensor[k];
        const float off = std::max({std::abs(g.xy), std::abs(g.xz), std::abs(g.yz)});
        if (off > kRounding * std::max({g.xx, g.yy, g.zz}))
            throw Error(Kind::InvalidArgument,
                        "the tensor at " + worldPlace(band, NodeIndex(k)) + " has " +
                            shortText(double(off)) +
                            " off its diagonal; scheme godunov takes tensors that are diagonal "
                            "along the axes of the grid",
                        "use Scheme::Jet");
    }
}

}  // namespace

Field marchGodunov(const Band& band, MetricPtr metric, const std::vector<SurfacePoint>& seeds,
                   const GodunovOptions& options, Progress& progress) {
    if (!metric) metric = std::make_shared<Metric>();
    check(band, *metric, seeds, options);
    double leastStart = kInfinity;
    for (const SurfacePoint& seed : seeds) leastStart = std::min(leastStart, seed.start);
    Godunov march(band, std::move(metric), seeds, options, leastStart);
    for (const SurfacePoint& seed : seeds) march.start(seed);
    if (options.order == 1)
        march.march<1>(progress);
    else
        march.march<2>(progress);
    return march.take();
}

}  // namespace igeo
