#include <igeo/godunov.h>

#include <igeo/eikonal.h>
#include <igeo/error.h>
#include <igeo/heap.h>

namespace igeo {

namespace {

/// States of a voxel (M&S section 3: Far Away, NarrowBand, Alive).
enum class State : std::uint8_t { Far, Trial, Accepted };

class Godunov {
public:
    Godunov(const Band& band, const Metric& metric, const GodunovOptions& options)
        : band_(band), metric_(metric), options_(options) {
        distance_.assign(band.size(), kInfinity);
        state_.assign(band.size(), State::Far);
    }

    void start(SurfacePoint seed) {
        seed.weight = metric_.at(seed.node);
        for (const NodeIndex i : nodesAround(band_, seed, options_.startRadius))
            lower(i, seed.start + seed.weight * length(Vec3d(band_.ijk(i)) - seed.pIndex));
        seeds_.push_back(seed);
    }

    void march(Progress& progress);

    Field take() {
        Field field;
        field.distance = std::move(distance_);
        // Trial values are upper bounds, not distances.
        for (std::size_t i = 0; i < field.distance.size(); ++i)
            if (state_[i] != State::Accepted) field.distance[i] = kInfinity;
        field.stoppedEarly = !heap_.empty();
        field.seeds = std::move(seeds_);
        field.startRadius = options_.startRadius;
        field.scheme = options_.order == 1 ? "godunov, order 1" : "godunov, order 2";
        field.summarise();
        return field;
    }

private:
    void lower(NodeIndex i, double value) {
        if (!(value < distance_[i])) return;
        distance_[i] = value;
        state_[i] = State::Trial;
        heap_.push(value, i);
    }

    /// Whether the value at j may be used at its neighbour i.
    bool upwind(NodeIndex j, NodeIndex i) const {
        return j != kNoNode && state_[j] == State::Accepted && band_.linked(i, j);
    }

    /// Solves M&S (13) at node i from its Accepted neighbours.
    double solve(NodeIndex i) const;

    /// How far the march must go on after the last target's cell is known, so that gradients there
    /// see both sides.
    void watchTargets();

    const Band& band_;
    const Metric& metric_;
    const GodunovOptions& options_;
    std::vector<SurfacePoint> seeds_;
    std::vector<double> distance_;
    std::vector<State> state_;
    std::vector<bool> awaited_;
    std::size_t awaitedCount_ = 0;
    MarchHeap heap_;
};

double Godunov::solve(NodeIndex i) const {
    std::array<UpwindTerm, 3> terms;
    int n = 0;
    for (int axis = 0; axis < 3; ++axis) {
        int sx = axis == 0, sy = axis == 1, sz = axis == 2;
        const NodeIndex lo = band_.neighbour(i, -sx, -sy, -sz);
        const NodeIndex hi = band_.neighbour(i, sx, sy, sz);
        const double dLo = upwind(lo, i) ? distance_[lo] : kInfinity;
        const double dHi = upwind(hi, i) ? distance_[hi] : kInfinity;
        const double m = std::min(dLo, dHi);
        if (m == kInfinity) continue;
        auto& term = terms[std::size_t(n++)];
        term = firstOrderTerm(m);
        if (options_.order == 1) continue;
        // Equal sides give equal terms at order 1 only: take the smaller second difference base.
        double mm = kInfinity;
        if (dLo == m) {
            const NodeIndex far = band_.neighbour(i, -2 * sx, -2 * sy, -2 * sz);
            if (upwind(far, lo)) mm = distance_[far];
        }
        if (dHi == m) {
            const NodeIndex far = band_.neighbour(i, 2 * sx, 2 * sy, 2 * sz);
            if (upwind(far, hi)) mm = std::min(mm, distance_[far]);
        }
        if (mm <= m) term = secondOrderTerm(m, mm);
    }
    return godunovSolve(terms, n, metric_.at(i));
}

void Godunov::watchTargets() {
    if (options_.stopAt.empty()) return;
    awaited_.assign(band_.size(), false);
    for (const SurfacePoint& p : options_.stopAt) {
        // The cells around the target's: what the gradient at the target reads.
        for (const NodeIndex i : nodesAround(band_, p, 3.0))
            if (!awaited_[i]) awaited_[i] = true, ++awaitedCount_;
    }
}

void Godunov::march(Progress& progress) {
    watchTargets();
    const bool waits = awaitedCount_ > 0;
    std::size_t done = 0;
    while (!heap_.empty()) {
        const MarchHeap::Entry next = heap_.top();
        if (next.value > options_.maxDistance) return;
        heap_.pop();
        const NodeIndex i = next.node;
        if (state_[i] == State::Accepted) continue;
        state_[i] = State::Accepted;
        if (waits && awaited_[i] && --awaitedCount_ == 0) return;
        if ((++done & 0x3fff) == 0) {
            progress.throwIfCancelled();
            progress.update("march", double(done) / double(band_.size()));
        }
        for (int side = -1; side <= 1; side += 2)
            for (int axis = 0; axis < 3; ++axis) {
                const NodeIndex j =
                    band_.neighbour(i, side * (axis == 0), side * (axis == 1), side * (axis == 2));
                if (j != kNoNode && state_[j] != State::Accepted && band_.linked(i, j))
                    lower(j, solve(j));
            }
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
    if (metric.weight.empty()) return;
    if (metric.weight.size() != band.size())
        throw Error(Kind::InvalidArgument, std::to_string(metric.weight.size()) +
                                               " weights for a band of " +
                                               std::to_string(band.size()) + " nodes");
    for (const float w : metric.weight)
        if (!(w > 0 && w < float(kInfinity)))
            throw Error(Kind::InvalidArgument,
                        "weight " + std::to_string(w) + " is not positive and finite");
}

}  // namespace

Field marchGodunov(const Band& band, const Metric& metric, const std::vector<SurfacePoint>& seeds,
                   const GodunovOptions& options, Progress& progress) {
    check(band, metric, seeds, options);
    Godunov march(band, metric, options);
    for (const SurfacePoint& seed : seeds) march.start(seed);
    march.march(progress);
    return march.take();
}

}  // namespace igeo
