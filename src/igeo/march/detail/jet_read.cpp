#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_corners.h>
#include <igeo/march/detail/jet_extend.h>
#include <igeo/march/detail/known_jets.h>
#include <igeo/march/field.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace igeo {

namespace {

/// Reads jets at points of S from the core around them, side by side, where it is of one smooth
/// front of constant cost, far from seeds.
class CoreReader {
public:
    /// @param met  null, or gets the arrivals of points where fronts meet: then they are not left
    CoreReader(const CoreJets& jets, const LiftedJets& lifted, std::vector<Arrival*>* met)
        : jets_(jets), core_(*jets.core), band_(core_.band), lifted_(lifted), met_(met) {}

    /// Begins with a point: its arrival is in `to` after the next finish(), or `to` is in `left`.
    void add(const Vec3d& p, const Vec3f& normal, Arrival& to) {
        const std::size_t lane = size_++;
        asked_[lane] = {&p, &to};
        const Ijk low = findCorners(p, lane);
        points_.setPlace(lane, Vec3f(p - Vec3d(low)));
        points_.setNormal(lane, normal);
        if (size_ == Lanes::kNodes) finish();
    }
    /// Finds the jets around points ahead where fronts meet.
    void lookAhead(std::span<const Vec3d> points) {
        if (!jets_.meetings || !lifted_.empty()) return;
        std::vector<NodeIndex> meetings;
        for (const Vec3d& p : points) {
            findCorners(p, 0);
            for (const auto& corner : points_.node)
                if (const NodeIndex k = corner[0]; k != kNoNode && jets_.meetings->at(k))
                    meetings.push_back(k);
        }
        jets_.meetings->findAhead(jets_, meetings);
    }
    void finish() {
        if (size_ == 0) return;
        for (std::size_t lane = size_; lane < Lanes::kNodes; ++lane) points_.clearNodes(lane);
        gatherCorners(jets_, lifted_, points_, corners_);
        takeNormals();
        CarriedJets carried;
        carryFromCorners(corners_, band_.faceted, carried);
        for (std::size_t lane = 0; lane < size_; ++lane)
            if (!settle(lane, carried)) left.push_back(asked_[lane].to);
        size_ = 0;
    }

    std::vector<Arrival*> left;  ///< of points that want more care

private:
    struct Asked {
        const Vec3d* p = nullptr;
        Arrival* to = nullptr;
    };

    /// @return the low corner of the cell around a point
    Ijk findCorners(const Vec3d& p, std::size_t lane) {
        const Ijk low = floorToIjk(p);
        if (leaf_ == kNoLeaf || low.x >> 3 != at_.x || low.y >> 3 != at_.y || low.z >> 3 != at_.z)
            leaf_ = band_.leafAt(low), at_ = {low.x >> 3, low.y >> 3, low.z >> 3};
        points_.clearNodes(lane);
        if (leaf_ != kNoLeaf) findCornersInLeaf(low, lane);
        return low;
    }
    void findCornersInLeaf(const Ijk& low, std::size_t lane) {
        const unsigned at = Band::offsetOf(low.x, low.y, low.z);
        if (std::max({low.x & 7, low.y & 7, low.z & 7}) == 7)
            return band_.forCorners(&BandLeaf::core, leaf_, at, {},
                                    [&](NodeIndex j, unsigned k) { points_.node[k][lane] = j; });
        std::array<NodeIndex, 8> node;
        for (unsigned a = 0; a < 2; ++a) band_.leaves[leaf_].core.square(at + 64 * a, &node[4 * a]);
        for (std::size_t k = 0; k < 8; ++k) points_.node[k][lane] = node[k];
    }

    /// Those of the corners, blended: the normal that was asked for selects the sheet only.
    void takeNormals() {
        for (std::size_t lane = 0; lane < size_; ++lane) {
            Vec3f sum;
            for (std::size_t c = 0; c < corners_.count[lane]; ++c) {
                const JetCorners::Corner& k = corners_.corner[c];
                sum += k.weight[lane] * Vec3f(k.mx[lane], k.my[lane], k.mz[lane]);
            }
            const Vec3f n = normalized(sum);
            corners_.nx[lane] = n.x, corners_.ny[lane] = n.y, corners_.nz[lane] = n.z;
        }
    }

    /// Whether the corners of a point tell its distance.
    bool settle(std::size_t lane, const CarriedJets& carried) {
        // One or two corners do not show that fronts meet around them. Near a seed the distance is
        // that to the seed, or the front bends too much for corners a voxel away.
        constexpr std::uint32_t kLeast = 3;
        constexpr double kNearSeed = 12;
        if (!corners_.count[lane] || !corners_.smooth[lane] || corners_.hindered[lane])
            return false;
        const std::uint32_t label = jets_.labelOf(corners_.node[0][lane]);
        bool oneLabel = true, meet = false, thin = false, beyond = false;
        for (std::size_t c = 0; c < corners_.count[lane]; ++c) {
            const NodeIndex k = corners_.node[c][lane];
            oneLabel &= jets_.labelOf(k) == label;
            meet |= jets_.frontsMeetNear(k);
            thin |= (core_.nodes[k].facing & Band::kFacing) != 0;
            beyond |= !(jets_.valueOf(k) <= jets_.limit);
        }
        if (!oneLabel || beyond || (thin && !band_.triangles) ||
            (corners_.count[lane] < kLeast && meet))
            return false;
        const bool meeting = !(carried.spreads[lane] || (carried.oneFront[lane] && !meet));
        if (meeting && !met_) return false;
        const double d =
            jets_.buckets.startOf(corners_.bucket[lane]) +
            double(meeting ? firstAt(lane) : carried.u[lane] + besideMean(lane, carried));
        if (!(d > jets_.seeds.largestInDisc + kNearSeed)) return false;
        const Asked& asked = asked_[lane];
        *asked.to = {std::max(d, jets_.seeds.lines.from(label, *asked.p)), label, nullptr};
        if (meeting) met_->push_back(asked.to);
        return true;
    }

    /// What the carried value lacks, as corners of the core may all lie to one side: it takes their
    /// mean direction of travel for that at the point. Along a front of curvature k whose corners
    /// are m to the side in the mean that is k m^2 / 2.
    float besideMean(std::size_t lane, const CarriedJets& carried) const {
        constexpr float kStiff = 0.01f;  // voxels^2: corners side by side show no curvature
        constexpr float kBent = 0.1f;    // 1 / voxels: more is not known from one cell
        const Vec3f n{corners_.nx[lane], corners_.ny[lane], corners_.nz[lane]},
            side = cross(n, Vec3f{carried.gx[lane], carried.gy[lane], carried.gz[lane]});
        float total = 0, l = 0, t = 0, ll = 0, lt = 0;
        for (std::size_t c = 0; c < corners_.count[lane]; ++c) {
            const float w = corners_.corner[c].weight[lane],
                        across = -dot(side, corners_.chord(lane, c)),
                        turned = dot(side, corners_.g(lane, c));
            total += w, l += w * across, t += w * turned;
            ll += w * across * across, lt += w * across * turned;
        }
        const float mean = l / total,
                    curvature = (lt - mean * t) / (ll - mean * l + kStiff * total);
        return std::clamp(curvature, -kBent, kBent) * mean * mean / 2;
    }

    /// The value by the corners of the first front alone, each a plane front.
    float firstAt(std::size_t lane) const {
        constexpr float kOneFront = 0.1f;  // voxels
        std::array<float, JetCorners::kMax> u;
        float least = float(kInfinity), sum = 0, weights = 0;
        for (std::size_t c = 0; c < corners_.count[lane]; ++c) {
            u[c] = corners_.corner[c].u[lane] + dot(corners_.g(lane, c), corners_.chord(lane, c));
            least = std::min(least, u[c]);
        }
        for (std::size_t c = 0; c < corners_.count[lane]; ++c)
            if (const float weight = corners_.corner[c].weight[lane]; u[c] < least + kOneFront)
                sum += weight * u[c], weights += weight;
        return sum / weights;
    }

    const CoreJets& jets_;
    const JetCore& core_;
    const Band& band_;
    const LiftedJets& lifted_;
    std::vector<Arrival*>* const met_;
    std::array<Asked, Lanes::kNodes> asked_;
    CellPoints points_;
    JetCorners corners_;
    std::size_t size_ = 0;
    LeafIndex leaf_ = kNoLeaf;  ///< of the last point
    Ijk at_;                    ///< its place, in leaves
};

bool isReadFromCore(const Field& field) { return field.jets && !field.metric->weighted(); }

/// The arrivals at points that the core leaves.
/// @param at  place of each of them
void readAt(const Field& field, std::span<const Vec3d> points, std::span<const std::size_t> left,
            std::span<const ReadPlace* const> at, Arrival* to) {
    const KnownJets known(field, at);
    for (std::size_t k = 0; k < left.size(); ++k)
        to[left[k]] = arrivalAt(field, known, points[left[k]], *at[k]);
}

}  // namespace

std::optional<Arrival> arrivalFromCore(const Field& field, const Vec3d& pIndex,
                                       const Vec3d& sheetNormal) {
    if (!isReadFromCore(field) || field.band->triangles) return {};
    const Vec3d normal = sheetNormal == Vec3d{}
                             ? SurfaceCell(*field.band, *field.metric, pIndex, {}).normal
                             : sheetNormal;
    const LiftedJets none;
    Arrival first;
    CoreReader reader(*field.jets, none, nullptr);
    reader.add(pIndex, Vec3f(normal), first);
    reader.finish();
    return reader.left.empty() ? std::optional(first) : std::nullopt;
}

ArrivalReader::ArrivalReader(const Field& field, std::size_t points)
    : field_(field), fromCore_(isReadFromCore(field)) {
    constexpr std::size_t kCorners = 4;  // of a point
    const bool many = fromCore_ && points > field.jets->state.size() / kCorners;
    lifted_ = std::make_shared<const LiftedJets>(many ? liftedOf(*field.jets) : LiftedJets{});
}

void ArrivalReader::read(std::span<const Vec3d> points, std::span<const Vec3f> sheetNormals,
                         Arrival* to, double tolerance, std::uint8_t* isSmooth) const {
    const std::vector<std::size_t> left =
        readFromCore(points, sheetNormals, to, tolerance, isSmooth);
    std::vector<ReadPlace> places;
    places.reserve(left.size());
    std::vector<const ReadPlace*> at;
    for (const std::size_t i : left)
        at.push_back(&places.emplace_back(field_, points[i], Vec3d(sheetNormals[i])));
    readAt(field_, points, left, at, to);
}

std::vector<std::size_t> ArrivalReader::readFromCore(std::span<const Vec3d> points,
                                                     std::span<const Vec3f> sheetNormals,
                                                     Arrival* to, double tolerance,
                                                     std::uint8_t* isSmooth) const {
    constexpr double kOnMesh = 0.01, kAtMeeting = 0.1;  // voxels
    const bool fromCore = fromCore_ && (!field_.band->triangles || tolerance >= kOnMesh);
    if (isSmooth) std::fill_n(isSmooth, points.size(), std::uint8_t(fromCore));
    std::vector<std::size_t> left;
    if (!fromCore) {
        left.resize(points.size());
        std::iota(left.begin(), left.end(), std::size_t(0));
        return left;
    }
    std::vector<Arrival*> met;
    CoreReader reader(*field_.jets, *lifted_, tolerance >= kAtMeeting ? &met : nullptr);
    reader.lookAhead(points);
    for (std::size_t i = 0; i < points.size(); ++i) reader.add(points[i], sheetNormals[i], to[i]);
    reader.finish();
    for (const Arrival* at : reader.left) left.push_back(std::size_t(at - to));
    if (isSmooth)
        for (const auto* list : {&met, &reader.left})
            for (const Arrival* at : *list) isSmooth[at - to] = 0;
    return left;
}

struct SharedPoints::Places {
    std::vector<std::atomic<const ReadPlace*>> of;
    explicit Places(std::size_t count) : of(count) {}
    ~Places() {
        for (const auto& place : of) delete place.load(std::memory_order_relaxed);
    }
};

SharedPoints::SharedPoints(const Band& band, const std::vector<SurfacePoint>& points)
    : places_(std::make_unique<Places>(points.size())) {
    for (const SurfacePoint& p : points)
        point_.push_back(p.pIndex), normal_.push_back(band.normal[p.node]);
}
SharedPoints::~SharedPoints() = default;

const ReadPlace& SharedPoints::placeOf(const Field& field, std::size_t k) const {
    std::atomic<const ReadPlace*>& place = places_->of[k];
    const ReadPlace* known = place.load(std::memory_order_acquire);
    if (known) return *known;
    auto found = std::make_unique<const ReadPlace>(field, point_[k], Vec3d(normal_[k]));
    // Another thread may have found it at the same time.
    if (!place.compare_exchange_strong(known, found.get(), std::memory_order_acq_rel))
        return *known;
    return *found.release();
}

std::vector<Arrival> SharedPoints::read(const Field& field) const {
    std::vector<Arrival> arrivals(point_.size());
    const std::vector<std::size_t> left =
        ArrivalReader(field, point_.size()).readFromCore(point_, normal_, arrivals.data());
    std::vector<const ReadPlace*> at;
    for (const std::size_t i : left) at.push_back(&placeOf(field, i));
    readAt(field, point_, left, at, arrivals.data());
    return arrivals;
}

std::vector<Arrival> arrivalsAt(const Field& field, const std::vector<Vec3d>& points,
                                const std::vector<Vec3f>& sheetNormals, double tolerance,
                                const Progress& progress) {
    std::vector<Arrival> arrivals(points.size());
    const ArrivalReader reader(field, points.size());
    parallelFor(points.size(), 1024, progress, [&](std::size_t begin, std::size_t end) {
        reader.read({&points[begin], end - begin}, {&sheetNormals[begin], end - begin},
                    &arrivals[begin], tolerance);
    });
    return arrivals;
}

}  // namespace igeo
