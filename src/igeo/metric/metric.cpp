#include <igeo/metric/metric.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/symmetric_eigen.h>

#include <string>

namespace igeo {

void Metric::setObstacles(const Band& band, std::shared_ptr<const Obstacles> set) {
    // The longest segment from a node in a march, an extension or a trace, plus a voxel.
    constexpr double kReach = 5;
    obstacles = std::move(set);
    obstacleState.clear();
    if (!obstacles) return;
    obstacleState.resize(band.size());
    parallelFor(band.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            const Vec3d foot = band.footPoint(i);
            if (!obstacles->mayBeNear(foot, kReach)) continue;
            obstacleState[k] =
                obstacles->block(foot, foot, Vec3d(band.normal[i])) ? Inside : Beside;
        }
    });
}

bool Metric::blocksAny(const Band& band) const {
    for (NodeIndex i = 0; i < obstacleState.size(); ++i) {
        if (obstacleState[i] == Inside) return true;
        if (obstacleState[i] == Clear) continue;
        for (const Ijk step : {Ijk{1, 0, 0}, Ijk{0, 1, 0}, Ijk{0, 0, 1}}) {
            const NodeIndex j = band.neighbor(i, step.x, step.y, step.z);
            if (j != kNoNode && blocked(band, i, j)) return true;
        }
        bool bridge = false;
        band.forBridges(i, [&](const Bridge& b) { bridge |= blocked(band, i, b.to); });
        if (bridge) return true;
    }
    return false;
}

std::string shortText(double x) { return fmt::format("{:.6g}", x); }

std::string worldPlace(const Band& band, NodeIndex i) {
    const Vec3d p = band.transform.worldFromIndex(band.footPoint(i));
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

namespace {

using Kind = Error::Kind;

/// Calls add(node, weight) for the remaining corners of a cell.
/// @return the sum of the weights
template <typename Add>
double blend(const BandCell& cell, const Add& add) {
    double total = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        if (cell.node[k] == kNoNode) continue;
        // A single remaining corner at distance 1 needs a positive weight.
        const double w = cell.weight[k] + 1e-6;
        add(cell.node[k], w);
        total += w;
    }
    return total;
}

/// Sylvester's criterion, by its Cholesky factors; false for NaN and infinity.
bool positiveDefinite(const Tensor& g) {
    const double xx = g.xx, xy = g.xy, xz = g.xz;
    const double yy = g.yy - xy * xy / xx, yz = g.yz - xy * xz / xx;
    const double zz = g.zz - xz * xz / xx - yz * yz / yy;
    return xx > 0 && yy > 0 && zz > 0 && xx + yy + zz < kInfinity;
}

/// Squares of costs, times those of distances in voxels, stay within single precision.
constexpr double kLeastCost = 1e-15, kLargestCost = 1e15;

bool inRange(float cost) { return cost >= kLeastCost && cost <= kLargestCost; }

[[noreturn]] void refuseCost(const Band& band, std::size_t node, const char* what, float cost) {
    throw Error(Error::Kind::InvalidArgument,
                fmt::format("the {} at {} is {:.6g}; allowed are {:.4g} to {:.4g}", what,
                            worldPlace(band, NodeIndex(node)), cost, kLeastCost, kLargestCost),
                "multiply it by one factor everywhere: distances change by that factor, or its "
                "root for a tensor, and paths do not");
}

Tensor scaled(const Tensor& g, double s) {
    return {float(s * g.xx), float(s * g.yy), float(s * g.zz),
            float(s * g.xy), float(s * g.xz), float(s * g.yz)};
}

/// The least (`sign` 1) or largest (-1) of f(k) over 0 <= k < n, in parallel.
template <typename F>
double extreme(std::size_t n, double sign, const F& f) {
    constexpr std::size_t kChunk = 1 << 14;
    std::vector<double> parts((n + kChunk - 1) / kChunk, kInfinity);
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::size_t k = c * kChunk; k < std::min(n, (c + 1) * kChunk); ++k)
                parts[c] = std::min(parts[c], sign * f(k));
    });
    return sign * *std::min_element(parts.begin(), parts.end());
}

}  // namespace

std::array<double, 3> eigenvalues(const Tensor& g) {
    return symmetricEigenvalues({g.xx, g.yy, g.zz, g.xy, g.xz, g.yz});
}

double Metric::at(const BandCell& cell) const {
    if (!tensor.empty()) return meanCost(tensorAt(cell));
    if (weight.empty()) return 1;
    double sum = 0;
    const double total = blend(cell, [&](NodeIndex i, double w) { sum += w * double(weight[i]); });
    return total > 0 ? sum / total : 1;
}

Tensor Metric::tensorAt(const BandCell& cell) const {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    const double total = blend(cell, [&](NodeIndex i, double w) {
        const Tensor& g = tensor[i];
        xx += w * g.xx, yy += w * g.yy, zz += w * g.zz;
        xy += w * g.xy, xz += w * g.xz, yz += w * g.yz;
    });
    if (!(total > 0)) return {1, 1, 1, 0, 0, 0};
    return {float(xx / total), float(yy / total), float(zz / total),
            float(xy / total), float(xz / total), float(yz / total)};
}

double Metric::meanCost(const Tensor& g) {
    const auto e = eigenvalues(g);
    return std::cbrt(std::sqrt(e[0]) * std::sqrt(e[1]) * std::sqrt(e[2]));
}

double Metric::stepCost(const BandCell& cell, const Vec3d& step) const {
    if (tensor.empty()) return at(cell) * length(step);
    return std::sqrt(product(tensorAt(cell), step, step));
}

PlaneMetric Metric::inPlane(const TangentFrame& frame, const Tensor& g) {
    const Vec3d x(frame.axis(0)), y(frame.axis(1));
    return {product(g, x, x), product(g, x, y), product(g, y, y)};
}

double Metric::least() const {
    if (!tensor.empty())
        return std::sqrt(
            extreme(tensor.size(), 1, [&](std::size_t k) { return eigenvalues(tensor[k])[0]; }));
    if (weight.empty()) return 1;
    return extreme(weight.size(), 1, [&](std::size_t k) { return double(weight[k]); });
}

double Metric::largest() const {
    if (!tensor.empty())
        return std::sqrt(
            extreme(tensor.size(), -1, [&](std::size_t k) { return eigenvalues(tensor[k])[2]; }));
    if (weight.empty()) return 1;
    return extreme(weight.size(), -1, [&](std::size_t k) { return double(weight[k]); });
}

void Metric::multiply(const std::vector<float>& factors) {
    const std::size_t n = tensor.empty() ? weight.size() : tensor.size();
    if (n != 0 && n != factors.size())
        throw Error(Error::Kind::InvalidArgument, std::to_string(factors.size()) +
                                                      " factors for a metric of " +
                                                      std::to_string(n) + " nodes");
    if (n == 0) weight.assign(factors.size(), 1);
    for (std::size_t k = 0; k < weight.size(); ++k) weight[k] *= factors[k];
    for (std::size_t k = 0; k < tensor.size(); ++k)
        tensor[k] = scaled(tensor[k], double(factors[k]) * double(factors[k]));
}

void Metric::dropHiddenCorners(const Band& band, const Vec3d& pIndex, const Vec3d& n,
                               BandCell& cell) const {
    if (!obstacles) return;
    for (NodeIndex& i : cell.node)
        if (i != kNoNode && blocked(band, pIndex, n, i)) {
            i = kNoNode;
            cell.complete = false;
        }
}

void Metric::check(const Band& band) const {
    const std::size_t n = band.size();
    auto refuse = [](const std::string& what) { throw Error(Kind::InvalidArgument, what); };
    auto count = [&](std::size_t m, const std::string& what) {
        if (m != n)
            refuse(std::to_string(m) + " " + what + " for a band of " + std::to_string(n) +
                   " nodes");
    };
    if (obstacles && obstacleState.size() != n) refuse("the obstacles were set for another band");
    if (!weight.empty() && !tensor.empty()) refuse("a metric has weights or tensors, not both");
    if (!weight.empty()) count(weight.size(), "weights");
    if (!tensor.empty()) count(tensor.size(), "tensors");
    for (std::size_t k = 0; k < weight.size(); ++k)
        if (!inRange(weight[k])) refuseCost(band, k, "weight", weight[k]);
    for (std::size_t k = 0; k < tensor.size(); ++k)
        for (const float g : {tensor[k].xx, tensor[k].yy, tensor[k].zz})
            if (g > kLargestCost) refuseCost(band, k, "diagonal of the tensor", g);
    for (std::size_t k = 0; k < tensor.size(); ++k)
        if (!positiveDefinite(tensor[k]))
            throw Error(
                Kind::InvalidArgument,
                fmt::format(
                    "the tensor at {} is not positive definite: its least eigenvalue is {:.6g}",
                    worldPlace(band, NodeIndex(k)), eigenvalues(tensor[k])[0]),
                "give a cost per unit length squared that is positive in all directions");
    for (std::size_t k = 0; k < tensor.size(); ++k)
        for (const float g : {tensor[k].xx, tensor[k].yy, tensor[k].zz})
            if (!inRange(g)) refuseCost(band, k, "diagonal of the tensor", g);
}

}  // namespace igeo
