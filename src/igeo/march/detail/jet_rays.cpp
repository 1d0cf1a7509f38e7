#include <igeo/march/detail/jet_rays.h>

#include <igeo/march/detail/jet_ray_lanes.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

constexpr float kLength = MeetingPoint::kLength;

Vec2f rotated(Vec2f v, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * v.x - s * v.y, s * v.x + c * v.y};
}

/// The search for the direction in which one front arrives at a point.
struct RaySearch {
    const MeetingPoint* point = nullptr;
    std::size_t number = 0;  ///< of the point
    int rays = 0;            ///< sent so far
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
    /// @param curvature  of the front at its end
    void take(double value, float angle, float curvature) {
        constexpr int kMostRays = 4;
        constexpr float kGain = 3e-4f, kSureGain = 4e-3f, kFlat = 0.02f, kMostTurn = 0.7f;
        const bool isFirst = ++rays == 1;
        const float slope = isFirst ? -1 - kLength * curvature : (angle - off) / turn,
                    least = isFirst ? 1 : kFlat;
        const float next = std::clamp(angle / std::max(-slope, least), -kMostTurn, kMostTurn);
        const Vec2f corrected = rotated(direction, next);
        // Twice what the next ray will gain, which is known where the front spreads.
        const float gain = kLength * angle * next;
        const bool isSure = slope < -1 && gain < kSureGain;
        done = isSure || gain < kGain || rays == kMostRays;
        if (isSure) value -= double(gain / 2);
        if (value < u) u = value, best = slope < -kFlat ? corrected : direction;
        off = angle, turn = next, direction = corrected;
    }
};

/// Sends rays from points, up to eight side by side.
class RayGroup {
public:
    explicit RayGroup(const CoreJets& jets) : jets_(jets), core_(*jets.core) {}

    /// Ends the searches. A lane takes the next one as soon as one has ended.
    void run(std::span<RaySearch> searches) {
        while (begin(searches)) {
            constexpr int kSteps = 3;
            for (int k = 1; k <= kSteps; ++k) {
                lookAhead(kLength / kSteps, rays_, points_);
                findCorners(rays_.valid, rays_.cell, points_);
                if (k < kSteps)
                    gatherCornersOfS(jets_, points_, corners_);
                else
                    gatherMarched(jets_, points_, corners_);
                makeStep(corners_, core_.band.faceted, rays_);
            }
            lookBeside(corners_, rays_, beside_);
            findCorners(beside_.wanted, beside_.cell, beside_.points);
            gatherMarched(jets_, beside_.points, beside_.corners);
            for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane)
                if (beside_.wanted[lane] && !isOfSource(beside_.corners, lane))
                    beside_.wanted[lane] = 0;
            readFronts(corners_, beside_, rays_);
            for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane)
                if (search_[lane]) takeRay(lane);
        }
    }

private:
    /// Begins the next rays.
    /// @return whether there are any
    bool begin(std::span<RaySearch>& searches) {
        rays_.turn = rays_.length = {};
        bool any = false;
        for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
            RaySearch*& search = search_[lane];
            if (!search || search->done) {
                search = searches.empty() ? nullptr : searches.data();
                searches = searches.subspan(search ? 1 : 0);
            }
            rays_.valid[lane] = search ? -1 : 0;
            if (search) begin(lane, *search), any = true;
        }
        return any;
    }
    void begin(std::size_t lane, const RaySearch& search) {
        const MeetingPoint& from = *search.point;
        const TangentFrame& frame = from.local.frame;
        const Vec3f v = frame.lift(search.direction), n = frame.normal();
        rays_.x[lane] = from.foot.x, rays_.y[lane] = from.foot.y, rays_.z[lane] = from.foot.z;
        rays_.vx[lane] = v.x, rays_.vy[lane] = v.y, rays_.vz[lane] = v.z;
        rays_.nx[lane] = n.x, rays_.ny[lane] = n.y, rays_.nz[lane] = n.z;
        CellPlaces& start = rays_.start;
        start.leaf[lane] = from.leaf;
        start.x[lane] = int(from.offset >> 6), start.y[lane] = int(from.offset >> 3 & 7);
        start.z[lane] = int(from.offset & 7);
        points_.weight[lane] = beside_.points.weight[lane] = float(from.local.weight);
    }
    void findCorners(const RayLanes::PerLane<std::int32_t>& wanted, const CellPlaces& cells,
                     CellPoints& points) const {
        unsigned bits = 0;
        for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane)
            bits |= unsigned(wanted[lane] & 1) << lane;
        igeo::findCorners(core_.band, cells, bits, points);
    }
    void takeRay(std::size_t lane) {
        RaySearch& search = *search_[lane];
        if (!rays_.valid[lane] || !isOfSource(corners_, lane)) {
            search.done = true;
            return;
        }
        const double start = jets_.buckets.beyondLeast(corners_.bucket[lane]);
        search.take(
            start / search.point->local.weight + double(rays_.u[lane]) + double(rays_.length[lane]),
            std::asin(std::clamp(rays_.off[lane], -1.0f, 1.0f)), rays_.curvature[lane]);
    }
    bool isOfSource(const JetCorners& corners, std::size_t lane) const {
        if (jets_.label.empty()) return true;
        bool same = true;
        for (std::size_t k = 0; k < corners.count[lane]; ++k)
            same &= jets_.label[corners.node[k][lane]] == search_[lane]->point->label;
        return same;
    }

    const CoreJets& jets_;
    const JetCore& core_;
    std::array<RaySearch*, Lanes::kNodes> search_{};  ///< null: the lane is empty
    RayLanes rays_;
    CellPoints points_;
    JetCorners corners_;
    BesideRays beside_;
};

}  // namespace

void FrontsAtPoints::add(std::size_t point, std::span<const JetNeighbor> neighbors) {
    if (std::any_of(neighbors.begin(), neighbors.end(),
                    [](const JetNeighbor& n) { return n.u < MeetingPoint::kNearSeed; }))
        return;
    const std::size_t lane = size_++;
    point_[lane] = point;
    for (std::size_t k = 0; k < neighbors.size(); ++k) {
        const JetNeighbor& n = neighbors[k];
        Arrivals::Neighbor& to = arrivals_.neighbor[k];
        if (k == arrivals_.count) {
            ++arrivals_.count;
            to.gx = to.gy = {};
            std::fill_n(to.u.of, Lanes::kNodes, JetFronts::kNoValue);
        }
        const float along = dot(n.g, n.a);
        to.gx[lane] = n.g.x, to.gy[lane] = n.g.y;
        if (along > 0) to.u[lane] = float(n.u - neighbors[0].u) + along;
    }
}

void FrontsAtPoints::finish(std::span<MeetingPoint> points) {
    if (size_ == 0) return;
    ArrivingFronts found;
    findFronts(arrivals_, found);
    for (std::size_t lane = 0; lane < size_; ++lane) points[point_[lane]].fronts = found.at(lane);
    size_ = arrivals_.count = 0;
}

std::vector<std::optional<Solved>> solveByRays(const CoreJets& jets,
                                               std::span<const MeetingPoint> points) {
    constexpr double kFallbackError = 0.25;  // voxels
    // A ray rounds the edges of facets, which the fits of the march do not.
    const double kept = jets.core->band.faceted ? 0.01 : 0;
    std::vector<std::optional<Solved>> found(points.size());
    std::vector<RaySearch> searches;
    for (std::size_t k = 0; k < points.size(); ++k)
        for (std::size_t f = 0; f < points[k].fronts.count; ++f)
            searches.push_back({points[k], k, points[k].fronts.g[f]});
    RayGroup(jets).run(searches);
    for (const RaySearch& s : searches) {
        std::optional<Solved>& to = found[s.number];
        const double change = std::abs(s.u - s.point->before);
        if (change >= kept && change < kFallbackError && !(to && to->u <= s.u))
            to = Solved{s.u, -1.0f * s.best, s.point->label};
    }
    return found;
}

}  // namespace igeo
