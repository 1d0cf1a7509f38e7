#include <igeo/base/point_tree.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <numeric>

namespace igeo {

namespace {

/// Compares coordinates, `axis` first: no two distinct points are equal.
bool before(const Vec3d& a, const Vec3d& b, int axis) {
    for (int k = 0; k < 3; ++k, axis = (axis + 1) % 3)
        if (a[axis] != b[axis]) return a[axis] < b[axis];
    return false;
}

}  // namespace

PointTree::PointTree(const std::vector<Vec3d>& points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), Index(0));
    while ((size() >> levels_) >= kBucket) ++levels_;
    boxes_.resize((std::size_t(2) << levels_) - 1);
    // The set of points in a box does not depend on their earlier order, and every leaf is sorted
    // at the end.
    for (unsigned level = 0; level <= levels_; ++level)
        parallelFor(std::size_t(1) << level, 1, [&](std::size_t firstBox, std::size_t endBox) {
            for (std::size_t k = firstBox; k < endBox; ++k) {
                const auto begin = order_.begin() + std::ptrdiff_t(edge(level, k)),
                           end = order_.begin() + std::ptrdiff_t(edge(level, k + 1));
                Box& box = boxes_[(std::size_t(1) << level) - 1 + k];
                box.low = {kInfinity, kInfinity, kInfinity};
                box.high = -box.low;
                for (auto i = begin; i != end; ++i)
                    for (int a = 0; a < 3; ++a) {
                        box.low[a] = std::min(box.low[a], points[*i][a]);
                        box.high[a] = std::max(box.high[a], points[*i][a]);
                    }
                const Vec3d size = box.high - box.low;
                const int axis = size.x >= size.y && size.x >= size.z ? 0
                                 : size.y >= size.z                   ? 1
                                                                      : 2;
                auto less = [&](Index a, Index b) { return before(points[a], points[b], axis); };
                if (level == levels_)
                    std::sort(begin, end, less);
                else
                    std::nth_element(begin,
                                     order_.begin() + std::ptrdiff_t(edge(level + 1, 2 * k + 1)),
                                     end, less);
            }
        });
    for (std::size_t i = 0; i < size(); ++i) points_[i] = points[order_[i]];
}

PointTree::Found PointTree::nearest(const Vec3d& p) const {
    thread_local std::vector<Found> found;
    nearest(p, 1, found);
    return found.front();
}

namespace {

/// The nearest points found so far, and the squared distance of the farthest as a bound.
class NearestSoFar {
public:
    using Found = PointTree::Found;
    NearestSoFar(std::vector<Found>& found, std::size_t count, double most)
        : found_(found), count_(count), most_(most) {}

    /// Points beyond it are ignored. Points at it are kept: their number may be lower.
    double most() const { return most_; }
    void add(const Found& here) {
        if (here.squared > most_) return;
        if (count_ <= kFew) return insert(here);
        found_.push_back(here);
        if (found_.size() == 2 * count_) drop();
    }
    void finish() {
        if (count_ <= kFew) return;
        if (found_.size() > count_) drop();
        std::sort(found_.begin(), found_.end());
    }

private:
    static constexpr std::size_t kFew = 16;

    /// Inserts in order.
    void insert(const Found& here) {
        if (found_.size() == count_) {
            if (!(here < found_.back())) return;
            found_.pop_back();
        }
        auto at = found_.end();
        while (at != found_.begin() && here < *(at - 1)) --at;
        found_.insert(at, here);
        if (found_.size() == count_) most_ = found_.back().squared;
    }
    /// Drops those beyond the first `count`.
    void drop() {
        const auto last = found_.begin() + std::ptrdiff_t(count_) - 1;
        std::nth_element(found_.begin(), last, found_.end());
        most_ = last->squared;
        found_.resize(count_);
    }

    std::vector<Found>& found_;
    std::size_t count_;
    double most_;
};

}  // namespace

void PointTree::nearest(const Vec3d& p, std::size_t count, std::vector<Found>& found,
                        double within) const {
    found.clear();
    count = std::min(count, size());
    if (count == 0) return;
    struct Waiting {
        double squared;
        unsigned level;
        std::size_t box;
    };
    auto boxAt = [&](unsigned level, std::size_t k) {
        return Waiting{boxes_[(std::size_t(1) << level) - 1 + k].squaredDistance(p), level, k};
    };
    NearestSoFar nearest(found, count, within * within);
    Waiting stack[64];
    std::size_t top = 0;
    stack[top++] = boxAt(0, 0);
    while (top > 0) {
        const Waiting w = stack[--top];
        if (w.squared > nearest.most()) continue;
        if (w.level < levels_) {
            Waiting nearer = boxAt(w.level + 1, 2 * w.box),
                    farther = boxAt(w.level + 1, 2 * w.box + 1);
            if (farther.squared < nearer.squared) std::swap(nearer, farther);
            if (farther.squared <= nearest.most()) stack[top++] = farther;
            stack[top++] = nearer;
            continue;
        }
        for (std::size_t i = edge(w.level, w.box); i < edge(w.level, w.box + 1); ++i) {
            const Vec3d r = p - points_[i];
            nearest.add({dot(r, r), Index(i)});
        }
    }
    nearest.finish();
}

void PointTree::setReach(std::vector<double> reach) {
    reach_ = std::move(reach);
    for (unsigned level = levels_ + 1; level-- > 0;)
        for (std::size_t k = 0; k < std::size_t(1) << level; ++k) {
            const std::size_t at = (std::size_t(1) << level) - 1 + k;
            double largest = 0;
            if (level == levels_)
                for (std::size_t i = edge(level, k); i < edge(level, k + 1); ++i)
                    largest = std::max(largest, reach_[i]);
            else
                largest = std::max(boxes_[2 * at + 1].reach, boxes_[2 * at + 2].reach);
            boxes_[at].reach = largest;
        }
}

}  // namespace igeo
