#include <igeo/metric.h>

#include <igeo/error.h>
#include <igeo/parallel.h>

#include <string>

namespace igeo {

void Metric::multiply(const std::vector<float>& weights) {
    if (weight.empty()) weight.assign(weights.size(), 1);
    for (std::size_t k = 0; k < weight.size(); ++k) weight[k] *= weights[k];
}

void Metric::setObstacles(const Band& band, std::shared_ptr<const Obstacles> set) {
    // As far as a march, an extension or a trace looks from a node at once, and a voxel more.
    constexpr double kSight = 5;
    obstacles = std::move(set);
    sight.clear();
    if (!obstacles) return;
    sight.resize(band.size());
    parallelFor(band.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            const Vec3d foot = band.footPoint(i);
            if (!obstacles->mayBeNear(foot, kSight)) continue;
            sight[k] = obstacles->block(foot, foot, Vec3d(band.normal[i])) ? Inside : Beside;
        }
    });
}

double Metric::at(const BandCell& cell) const {
    if (weight.empty()) return 1;
    double sum = 0, total = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        if (cell.node[k] == kNoNode) continue;
        // A corner alone at distance 1 still counts.
        sum += (cell.weight[k] + 1e-6) * double(weight[cell.node[k]]);
        total += cell.weight[k] + 1e-6;
    }
    return total > 0 ? sum / total : 1;
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

void Metric::check(std::size_t n) const {
    using Kind = Error::Kind;
    if (obstacles && sight.size() != n)
        throw Error(Kind::InvalidArgument, "the obstacles were set for another band");
    if (weight.empty()) return;
    if (weight.size() != n)
        throw Error(Kind::InvalidArgument, std::to_string(weight.size()) +
                                               " weights for a band of " + std::to_string(n) +
                                               " nodes");
    for (const float w : weight)
        if (!(w > 0 && w < float(kInfinity)))
            throw Error(Kind::InvalidArgument,
                        "weight " + std::to_string(w) + " is not positive and finite");
}

}  // namespace igeo
