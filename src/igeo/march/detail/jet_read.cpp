#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_corners.h>
#include <igeo/march/detail/jet_extend.h>
#include <igeo/march/field.h>

#include <algorithm>

namespace igeo {

namespace {

/// Reads jets at points of S from the core around them, side by side, where it is of one smooth
/// front of constant cost, far from seeds.
class CoreReader {
public:
    CoreReader(const CoreJets& jets, const std::vector<Vec3f>& gradients)
        : jets_(jets), core_(*jets.core), band_(core_.band), gradients_(gradients) {}

    /// Begins with a point: its arrival is in `to` after the next finish(), or `to` is in `left`.
    void add(const Vec3d& p, const Vec3f& normal, Arrival& to) {
        const std::size_t lane = size_++;
        Point& point = points_[lane];
        point = {&p, &to};
        corners_.count[lane] = 0;
        corners_.setNormal(lane, normal);
        const Ijk low = floorToIjk(p);
        if (leaf_ == kNoLeaf || low.x >> 3 != at_.x || low.y >> 3 != at_.y || low.z >> 3 != at_.z)
            leaf_ = band_.leafAt(low), at_ = {low.x >> 3, low.y >> 3, low.z >> 3};
        if (leaf_ == kNoLeaf) {
            point.simple = false;
        } else {
            const Vec3f t(p - Vec3d(low));
            band_.forCorners(&BandLeaf::core, leaf_, Band::offsetOf(low.x, low.y, low.z), {},
                             [&](NodeIndex j, unsigned k) { addCorner(j, k, t, normal, lane); });
        }
        if (size_ == Lanes::kNodes) finish();
    }
    void finish() {
        if (size_ == 0) return;
        for (std::size_t lane = size_; lane < Lanes::kNodes; ++lane) corners_.count[lane] = 0;
        corners_.pad();
        CarriedJets carried;
        carryFromCorners(corners_, band_.faceted, carried);
        for (std::size_t lane = 0; lane < size_; ++lane)
            if (!settle(lane, carried)) left.push_back(points_[lane].to);
        size_ = 0;
    }

    std::vector<Arrival*> left;  ///< of points that want more care

private:
    struct Point {
        const Vec3d* p = nullptr;
        Arrival* to = nullptr;
        bool simple = true, meet = false;  ///< meet: CoreJets::meetNear at a corner
        std::uint32_t bucket = 0, label = 0;
    };

    /// @param t  the place in the cell
    void addCorner(NodeIndex j, unsigned k, const Vec3f& t, const Vec3f& normal, std::size_t lane) {
        constexpr float kLight = 0.01f, kFlat = 0.8f;  // as in Extension
        const Vec3f from = t - Vec3f{float(k >> 2), float(k >> 1 & 1), float(k & 1)};
        const float weight =
            (1 - std::abs(from.x)) * (1 - std::abs(from.y)) * (1 - std::abs(from.z));
        if (weight < kLight) return;
        Point& point = points_[lane];
        const JetNode& node = core_.nodes[j];
        const JetState& state = jets_.state[j];
        const bool isFirst = corners_.count[lane] == 0;
        if (!state.accepted() || dot(normal, node.normal) < kFlat ||
            node.facing & Band::kBesideSevered || node.obstacleState != Metric::Clear ||
            (!isFirst && jets_.labelOf(j) != point.label)) {
            point.simple = false;
            return;
        }
        if (isFirst) point.bucket = state.bucket, point.label = jets_.labelOf(j);
        point.meet = point.meet || jets_.meetNear(j);
        const float u =
            float(std::int64_t(state.bucket) - point.bucket) * float(jets_.buckets.width) +
            state.rest;
        corners_.set(lane, corners_.count[lane]++, weight, from - node.foot, node.normal,
                     gradients_[j], u, 1);
    }

    /// Whether the corners of a point tell its distance.
    bool settle(std::size_t lane, const CarriedJets& carried) const {
        // One or two corners do not show that fronts meet around them. Near a seed the distance is
        // that to the seed, and near a limit it depends on the corners left.
        constexpr std::uint32_t kLeast = 3;
        constexpr double kNearSeed = 3, kNearLimit = 4;
        const Point& point = points_[lane];
        const std::uint32_t count = corners_.count[lane];
        if (!point.simple || count == 0 || (count < kLeast && point.meet) ||
            !(carried.spreads[lane] || (carried.oneFront[lane] && !point.meet)))
            return false;
        const double d = jets_.buckets.startOf(point.bucket) + double(carried.u[lane]);
        if (!(d > jets_.seeds.largestInDisc + kNearSeed) || !(d < jets_.limit - kNearLimit))
            return false;
        *point.to = {std::max(d, jets_.seeds.lines.from(point.label, *point.p)), point.label,
                     nullptr};
        return true;
    }

    const CoreJets& jets_;
    const JetCore& core_;
    const Band& band_;
    const std::vector<Vec3f>& gradients_;
    std::array<Point, Lanes::kNodes> points_;
    JetCorners corners_;
    std::size_t size_ = 0;
    LeafIndex leaf_ = kNoLeaf;  ///< of the last point
    Ijk at_;                    ///< its place, in leaves
};

}  // namespace

std::vector<Arrival> arrivalsAt(const Field& field, const std::vector<Vec3d>& points,
                                const std::vector<Vec3f>& sheetNormals, const Progress& progress) {
    std::vector<Arrival> arrivals(points.size());
    auto read = [&](std::size_t i) {
        arrivals[i] = arrivalAt(field, points[i], Vec3d(sheetNormals[i]));
    };
    const bool fromCore = field.core && !field.metric->weighted();
    const std::vector<Vec3f> gradients =
        fromCore ? jet::gradientsOf(*field.core) : std::vector<Vec3f>{};
    parallelFor(points.size(), 1024, progress, [&](std::size_t begin, std::size_t end) {
        if (!fromCore) {
            for (std::size_t i = begin; i < end; ++i) read(i);
            return;
        }
        CoreReader reader(*field.core, gradients);
        for (std::size_t i = begin; i < end; ++i)
            reader.add(points[i], sheetNormals[i], arrivals[i]);
        reader.finish();
        for (const Arrival* left : reader.left) read(std::size_t(left - arrivals.data()));
    });
    return arrivals;
}

}  // namespace igeo
