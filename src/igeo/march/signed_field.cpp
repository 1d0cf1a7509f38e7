#include <igeo/march/signed_field.h>

#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

namespace igeo {

namespace {

/// The side of the nearest curve that a node is on: -1, +1, or 0 far from curves.
class CurveSigns {
public:
    explicit CurveSigns(const Field& field) : band_(*field.band), field_(field) {}

    std::int8_t of(NodeIndex i) const {
        const Vec3d p = band_.footPoint(i), normal(band_.normal[i]);
        double least = field_.startRadius;
        std::size_t nearest = field_.seeds.size();
        field_.seedsNear.forNear(p, [&](std::size_t k) {
            const SurfacePoint& s = field_.seeds[k];
            if (s.segment == Vec3d{} || dot(band_.normal[i], band_.normal[s.node]) < 0) return;
            if (const double r = length(p - s.nearestTo(p)); r < least) least = r, nearest = k;
        });
        if (nearest == field_.seeds.size()) return 0;
        const Vec3d from = field_.seeds[nearest].nearestTo(p);
        return dot(cross(tangentAt(nearest, from), p - from), normal) < 0 ? -1 : 1;
    }

private:
    /// The tangent of the curve at a point of segment k; where two segments meet the mean of both,
    /// which gives the right side on both sides of the corner.
    Vec3d tangentAt(std::size_t k, const Vec3d& p) const {
        const std::vector<SurfacePoint>& s = field_.seeds;
        constexpr double kSame = 1e-6;
        const Vec3d own = normalized(s[k].segment);
        auto with = [&](std::size_t other, const Vec3d& joint) {
            const Vec3d& segment = s[other].segment;
            return field_.source[other] == field_.source[k] && segment != Vec3d{} &&
                           length(joint - p) < kSame
                       ? own + normalized(segment)
                       : own;
        };
        const Vec3d begin = s[k].pIndex, end = begin + s[k].segment;
        auto firstOf = [&](std::size_t j) {
            while (s[j].joined) --j;
            return j;
        };
        if (length(p - begin) < kSame) return with(s[k].joined ? k - 1 : lastOf(k), begin);
        if (length(p - end) < kSame) {
            const bool more = k + 1 < s.size() && s[k + 1].joined;
            return with(more ? k + 1 : firstOf(k), end);
        }
        return own;
    }
    std::size_t lastOf(std::size_t k) const {
        while (k + 1 < field_.seeds.size() && field_.seeds[k + 1].joined) ++k;
        return k;
    }

    const Band& band_;
    const Field& field_;
};

}  // namespace

void clearInside(const std::vector<std::uint8_t>& inside, std::uint32_t source, Field& field) {
    // A region of lines alone holds none.
    if (std::find(inside.begin(), inside.end(), 1) == inside.end()) return;
    for (std::size_t i = 0; i < inside.size(); ++i)
        if (inside[i] && !field.metric->inside(NodeIndex(i))) {
            field.distance[i] = 0;
            if (!field.gradient.empty()) field.gradient[i] = {};
            if (!field.label.empty()) field.label[i] = source;
        }
    field.jets = nullptr;
    field.summarize();
}

void signInside(const std::vector<std::uint8_t>& inside, Field& field) {
    field.sign.clear();
    for (const std::uint8_t in : inside) field.sign.push_back(in ? -1 : 1);
    for (SurfacePoint& s : field.seeds) s.rim = false;
}

namespace {

/// Nodes joined between two tests of cancellation, some milliseconds.
constexpr NodeIndex kLookEvery = 1 << 14;

bool isKnown(const Field& field, NodeIndex i) { return field.distance[i] < kInfinity; }

/// The parts of S between curves: nodes joined without crossing one.
struct CurveParts {
    SidedSets sets;
    std::vector<std::pair<NodeIndex, NodeIndex>> crossings;  ///< neighbors across a curve
};

CurveParts partsBetweenCurves(const Field& field, const Progress& progress) {
    const Band& band = *field.band;
    const std::size_t n = band.size();
    std::vector<std::int8_t> signOf(n, 0);
    const CurveSigns curves(field);
    parallelFor(n, 4096, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) signOf[i] = curves.of(NodeIndex(i));
    });
    CurveParts parts{SidedSets(n), {}};
    for (NodeIndex i = 0; i < n; ++i) {
        if (i % kLookEvery == 0) progress.throwIfCancelled();
        if (!isKnown(field, i)) continue;
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (j < i || !isKnown(field, j) || !band.linked(i, j)) return;
            if (signOf[i] * signOf[j] < 0)
                parts.crossings.emplace_back(i, j);
            else
                parts.sets.join(i, j, false);
        });
    }
    return parts;
}

/// Makes parts across a curve opposite to each other. A majority of crossings decides which parts:
/// next to a corner of a curve, single nodes may be on the wrong side.
/// @return the number of crossings in the minority
std::size_t joinAcrossCurves(CurveParts& parts) {
    std::map<std::pair<NodeIndex, NodeIndex>, std::size_t> votes;
    for (const auto& [i, j] : parts.crossings) {
        const NodeIndex a = parts.sets.find(i).first, b = parts.sets.find(j).first;
        ++votes[std::minmax(a, b)];
    }
    std::vector<std::pair<std::size_t, std::pair<NodeIndex, NodeIndex>>> order;
    for (const auto& [pair, count] : votes) order.emplace_back(count, pair);
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::size_t against = 0;
    for (const auto& [count, pair] : order)
        if (!parts.sets.join(pair.first, pair.second, true)) against += count;
    return against;
}

}  // namespace

std::vector<std::int8_t> signsOfCurves(const Field& field, Progress& progress) {
    constexpr std::size_t kStray = 20;  // one in so many crossings may be wrong
    CurveParts parts = partsBetweenCurves(field, progress);
    if (const std::size_t against = joinAcrossCurves(parts);
        parts.crossings.empty() || against * kStray > parts.crossings.size())
        throw Error(Error::Kind::InvalidArgument,
                    "the seeds do not part the surface into an inside and an outside",
                    "close the curve without crossing it, or leave out isSigned");

    const std::size_t n = field.distance.size();
    std::vector<std::int8_t> sign(n, 0);
    std::map<NodeIndex, std::ptrdiff_t> balance;
    for (NodeIndex i = 0; i < n; ++i) {
        if (i % kLookEvery == 0) progress.throwIfCancelled();
        if (!isKnown(field, i)) continue;
        const SidedSets::Member at = parts.sets.find(i);
        sign[i] = at.turned ? -1 : 1;
        balance[at.first] += sign[i];
    }
    for (NodeIndex i = 0; i < n; ++i)
        if (sign[i] && balance[parts.sets.find(i).first] < 0) sign[i] = std::int8_t(-sign[i]);
    return sign;
}

void finishInside(const std::vector<std::shared_ptr<const Obstacles>>& regions, std::size_t first,
                  bool isSigned, Field& field, Progress& progress) {
    std::vector<std::uint8_t> any(regions.empty() ? 0 : field.band->size());
    for (std::size_t k = regions.size(); k-- > 0;) {
        const std::vector<std::uint8_t> inside = nodesInside(*field.band, *regions[k], progress);
        for (std::size_t i = 0; i < any.size(); ++i) any[i] |= inside[i];
        // Where regions overlap the first one wins, so it is applied last.
        if (!isSigned) clearInside(inside, std::uint32_t(first + k), field);
    }
    if (!isSigned) {
        for (std::size_t k = 0; k < regions.size(); ++k)
            field.regions.push_back({regions[k], std::uint32_t(first + k)});
        return;
    }
    if (regions.empty())
        field.sign = signsOfCurves(field, progress);
    else
        signInside(any, field);
}

double signAt(const Field& field, const Vec3d& pIndex) {
    if (field.sign.empty()) return 1;
    const Band& band = *field.band;
    BandCell cell = cellAt(band, pIndex);
    dropFacingCorners(band, cell);
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k)
        if (const NodeIndex i = cell.node[k]; i != kNoNode && field.distance[i] < kInfinity)
            sum += cell.weight[k] * field.sign[i] * field.distance[i];
    return sum < 0 ? -1 : 1;
}

}  // namespace igeo
