#include <igeo/surface/detail/points_around.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {
constexpr double kAboveRounding = 1 + 1e-9;
}  // namespace

void PointsAround::moveTo(const Vec3d& middle, double radius, double beside) {
    middle_ = middle;
    radius_ = radius * kAboveRounding;
    reach_ = (radius + beside) * kAboveRounding;
    hasReaching_ = false;
    points_.nearest(middle, kNearest, found_);
    const double within = std::sqrt(found_.back().squared) + 2 * radius_;
    points_.nearest(middle, points_.size(), found_, within * kAboveRounding);
    near_.clear();
    for (const PointTree::Found& f : found_)
        near_.push_back({std::sqrt(f.squared), points_[f.point], f.point});
}

const std::vector<PointTree::Found>& PointsAround::nearest(const Vec3d& p) {
    const std::size_t count = std::min(kNearest, points_.size());
    const double off = length(p - middle_) * kAboveRounding;
    found_.clear();
    double farthest = kInfinity;  // of those found, if there are enough
    for (const Near& n : near_) {
        if (n.distance - off > farthest) break;
        const Vec3d r = p - n.at;
        const PointTree::Found here{dot(r, r), n.index};
        if (found_.size() == count) {
            if (!(here < found_.back())) continue;
            found_.pop_back();
        }
        auto at = found_.end();
        while (at != found_.begin() && here < *(at - 1)) --at;
        found_.insert(at, here);
        if (found_.size() == count) farthest = std::sqrt(found_.back().squared) * kAboveRounding;
    }
    return found_;
}

void PointsAround::findReaching() {
    reaching_.clear();
    points_.forReaching(middle_, reach_, [&](Index i) {
        reaching_.push_back({points_[i], points_.reach(i), i});
    });
    hasReaching_ = true;
}

}  // namespace igeo
