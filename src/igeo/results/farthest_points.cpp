#include <igeo/results/farthest_points.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace igeo {

namespace {

/// Candidate nodes, and their distances from the points chosen so far.
class Farthest {
public:
    Farthest(const Band& band, const MetricPtr& metric)
        : core_(jetCore(band, metric)), nearest_(band.size(), kInfinity) {
        for (std::size_t k = 0; k < band.size(); ++k)
            if (band.inCore(NodeIndex(k)) && !(metric && metric->inside(NodeIndex(k))))
                candidates_.push_back({NodeIndex(k), kInfinity});
    }
    std::size_t candidates() const { return candidates_.size(); }

    void add(const std::vector<SurfacePoint>& seeds, Progress& progress);
    /// Removes the farthest candidate.
    NodeIndex take();

private:
    struct Candidate {
        NodeIndex node;
        double distance;  ///< negative: chosen
    };

    const JetCorePtr core_;
    std::vector<double> nearest_;  ///< per band node; set for candidates
    std::vector<Candidate> candidates_;
};

void Farthest::add(const std::vector<SurfacePoint>& seeds, Progress& progress) {
    JetOptions options;
    options.below = &nearest_;
    options.extend = false;
    const Field field = marchJet(core_, seeds, options, progress);
    parallelFor(candidates_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            Candidate& c = candidates_[k];
            double& nearest = nearest_[c.node];
            nearest = std::min(nearest, field.at(c.node).distance);
            c.distance = std::min(c.distance, nearest);
        }
    });
}

NodeIndex Farthest::take() {
    constexpr std::size_t kChunk = 1 << 14;
    auto farther = [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; };
    // std::max_element finds the first of equals, which has the lowest node number.
    std::vector<Candidate*> best((candidates_.size() + kChunk - 1) / kChunk);
    parallelFor(best.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Candidate* const first = candidates_.data() + c * kChunk;
            best[c] = std::max_element(
                first, first + std::min(kChunk, candidates_.size() - c * kChunk), farther);
        }
    });
    Candidate* const chosen =
        *std::max_element(best.begin(), best.end(),
                          [&](const Candidate* a, const Candidate* b) { return farther(*a, *b); });
    chosen->distance = -1;
    return chosen->node;
}

SurfacePoint pointAt(const Band& band, NodeIndex i) {
    SurfacePoint p;
    p.node = i;
    p.pIndex = p.askedIndex = band.footPoint(i);
    projectToSurface(band, p.pIndex);
    p.snapDistance = length(p.pIndex - p.askedIndex);
    return p;
}

/// For progress: the work of n - 1 marches, in units of a march of the whole surface. The k-th
/// visits about 1 / k of it, plus a measured constant.
double workOf(std::size_t n) { return std::log(double(n)) + 0.05 * double(n - 1); }

}  // namespace

std::vector<SurfacePoint> farthestPoints(const Band& band, const MetricPtr& metric,
                                         const std::vector<SurfacePoint>& start, std::size_t count,
                                         Progress& progress) {
    Farthest farthest(band, metric);
    if (count == 0 || count > farthest.candidates())
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("{} points are to be spread over the surface; at least 1 and at "
                                "most {} are allowed, one per voxel next to it",
                                count, farthest.candidates()),
                    "ask for fewer points, or take smaller voxels");
    CancelOnly quiet(progress);
    const std::size_t given = !start.empty();  // a march from the given points
    progress.update("points", 0);
    if (given) farthest.add(start, quiet);
    std::vector<SurfacePoint> points;
    while (true) {
        points.push_back(pointAt(band, farthest.take()));
        if (points.size() == count) return points;
        progress.update("points", workOf(points.size() + given) / workOf(count + given));
        farthest.add({points.back()}, quiet);
    }
}

}  // namespace igeo
