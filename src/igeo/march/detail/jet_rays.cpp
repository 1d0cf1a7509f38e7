#include <igeo/march/detail/jet_rays.h>

#include <igeo/march/detail/jet_ray_lanes.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

constexpr int kSteps = 3;
constexpr float kStep = 2;  // voxels
constexpr float kLength = kSteps * kStep;

Vec2f rotated(Vec2f v, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * v.x - s * v.y, s * v.x + c * v.y};
}

/// The search for the direction in which one front arrives at a point.
struct RaySearch {
    const MeetingPoint* point = nullptr;
    std::size_t number = 0;  ///< of the point
    Vec2f direction;         ///< of the next ray, in the chart of the point
    float turn = 0;          ///< from the ray before to the next one
    float off = 0;           ///< the angle at the end of the ray before
    bool done = false;
    double u = kInfinity;  ///< the least so far
    Vec2f best;            ///< direction of that ray, corrected

    RaySearch() = default;
    RaySearch(const MeetingPoint& p, std::size_t n, Vec2f front)
        : point(&p), number(n), direction(-1.0f * front) {}

    /// Takes what a ray found, and turns the next one.
    void take(double value, float angle) {
        constexpr float kGain = 3e-4f, kFlat = 0.02f, kMostTurn = 0.7f;
        const float slope = turn != 0 ? (angle - off) / turn : -1;
        const float next = std::clamp(angle / std::max(-slope, kFlat), -kMostTurn, kMostTurn);
        const Vec2f corrected = rotated(direction, next);
        if (value < u) u = value, best = slope < -kFlat ? corrected : direction;
        // Twice what the next ray will gain.
        done = kLength * angle * next < kGain;
        off = angle, turn = next, direction = corrected;
    }
};

/// Sends rays from points, up to eight side by side.
class RayGroup {
public:
    RayGroup(const CoreJets& jets, const std::vector<Vec3f>& gradients)
        : jets_(jets), core_(*jets.core), gradients_(gradients) {}

    bool full() const { return size_ == Lanes::kNodes; }
    bool empty() const { return size_ == 0; }
    void add(const RaySearch& search) { search_[size_++] = search; }
    /// Calls take(search) for each of the searches, once they are done, and takes them out.
    template <typename Take>
    void run(const Take& take) {
        constexpr int kRounds = 4;
        for (int round = 0; round < kRounds && anyLeft(); ++round) {
            begin();
            for (int k = 1; k <= kSteps; ++k) {
                lookAhead(kStep, rays_);
                findCorners();
                if (k < kSteps) {
                    gatherCornersOfS(jets_, points_, corners_);
                    makeStep(corners_, core_.band.faceted, rays_);
                } else {
                    gatherCorners(jets_, gradients_, points_, corners_);
                    makeLastStep(corners_, core_.band.faceted, rays_);
                }
            }
            for (std::size_t lane = 0; lane < size_; ++lane) takeRay(lane);
        }
        for (std::size_t lane = 0; lane < size_; ++lane) take(search_[lane]);
        size_ = 0;
    }

private:
    bool anyLeft() const {
        return std::any_of(search_.begin(), search_.begin() + size_,
                           [](const RaySearch& s) { return !s.done; });
    }
    void begin() {
        rays_.turn = rays_.length = {};
        for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
            rays_.valid[lane] = lane < size_ && !search_[lane].done ? -1 : 0;
            if (lane >= size_) continue;
            const RaySearch& s = search_[lane];
            const Vec3f& p = s.point->foot;
            const TangentFrame& frame = s.point->local.frame;
            const Vec3f v = frame.lift(s.direction), n = frame.normal();
            rays_.x[lane] = p.x, rays_.y[lane] = p.y, rays_.z[lane] = p.z;
            rays_.vx[lane] = v.x, rays_.vy[lane] = v.y, rays_.vz[lane] = v.z;
            rays_.nx[lane] = n.x, rays_.ny[lane] = n.y, rays_.nz[lane] = n.z;
            points_.weight[lane] = float(s.point->local.weight);
        }
    }
    void findCorners() {
        for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
            points_.clearNodes(lane);
            if (rays_.valid[lane]) findCorners(lane);
        }
    }
    void findCorners(std::size_t lane) {
        const Band& band = core_.band;
        const MeetingPoint& from = *search_[lane].point;
        const Vec3f p{rays_.aheadX[lane], rays_.aheadY[lane], rays_.aheadZ[lane]};
        const Ijk low{floorToInt(p.x), floorToInt(p.y), floorToInt(p.z)};
        points_.setPlace(lane, p - Vec3f(low));
        points_.setNormal(lane, {rays_.nx[lane], rays_.ny[lane], rays_.nz[lane]});
        // The band holds the whole cell, except beside an end of S.
        std::size_t inBand = 0;
        band.forCorners(&BandLeaf::band, from.leaf, from.offset, low,
                        [&](NodeIndex, unsigned) { ++inBand; });
        if (inBand < points_.node.size()) return;
        band.forCorners(&BandLeaf::core, from.leaf, from.offset, low,
                        [&](NodeIndex j, unsigned k) { points_.node[k][lane] = j; });
    }
    void takeRay(std::size_t lane) {
        RaySearch& search = search_[lane];
        if (search.done) return;
        if (!rays_.valid[lane] || !isOfSource(lane)) {
            search.done = true;
            return;
        }
        const double start = (double(corners_.bucket[lane]) - 1) * jets_.buckets.width;
        search.take(
            start / search.point->local.weight + double(rays_.u[lane]) + double(rays_.length[lane]),
            std::asin(std::clamp(rays_.off[lane], -1.0f, 1.0f)));
    }
    bool isOfSource(std::size_t lane) const {
        if (jets_.label.empty()) return true;
        bool same = true;
        for (std::size_t k = 0; k < corners_.count[lane]; ++k)
            same &= jets_.label[corners_.node[k][lane]] == search_[lane].point->label;
        return same;
    }

    const CoreJets& jets_;
    const JetCore& core_;
    const std::vector<Vec3f>& gradients_;
    std::array<RaySearch, Lanes::kNodes> search_;
    std::size_t size_ = 0;
    RayLanes rays_;
    CellPoints points_;
    JetCorners corners_;
};

}  // namespace

void MeetingPoint::findFronts(std::span<const JetNeighbor> neighbors) {
    constexpr float kApart = 0.98f;  // 11 degrees
    constexpr double kLater = 0.2;   // voxels
    constexpr double kNearSeed = 5;  // voxels that rays keep away from it
    fronts = 0;
    double first = kInfinity;
    while (fronts < kFronts) {
        double least = kInfinity;
        for (const JetNeighbor& n : neighbors) {
            if (n.u < double(kLength) + kNearSeed) {
                fronts = 0;
                return;
            }
            bool counts = dot(n.a, n.g) > 0;
            for (std::size_t k = 0; k < fronts; ++k) counts &= dot(n.g, front[k]) <= kApart;
            const double u = n.u + double(dot(n.g, n.a));
            if (counts && u < least) least = u, front[fronts] = n.g;
        }
        first = std::min(first, least);
        if (!(least <= first + kLater)) return;
        ++fronts;
    }
}

std::vector<std::optional<Solved>> solveByRays(const CoreJets& jets,
                                               const std::vector<Vec3f>& gradients,
                                               std::span<const MeetingPoint> points) {
    constexpr double kFallbackError = 0.25;  // voxels
    // A ray rounds the edges of facets, which the fits of the march do not.
    const double kept = jets.core->band.faceted ? 0.01 : 0;
    std::vector<std::optional<Solved>> found(points.size());
    auto take = [&](const RaySearch& s) {
        std::optional<Solved>& to = found[s.number];
        const double change = std::abs(s.u - s.point->before);
        if (change >= kept && change < kFallbackError && !(to && to->u <= s.u))
            to = Solved{s.u, -1.0f * s.best, s.point->label};
    };
    RayGroup group(jets, gradients);
    for (std::size_t k = 0; k < points.size(); ++k)
        for (std::size_t f = 0; f < points[k].fronts; ++f) {
            group.add({points[k], k, points[k].front[f]});
            if (group.full()) group.run(take);
        }
    if (!group.empty()) group.run(take);
    return found;
}

}  // namespace igeo
