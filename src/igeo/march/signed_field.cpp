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

/// The side of the nearest curve next to a node: -1, +1, or 0 where none is near.
class CurveSides {
public:
    CurveSides(const Band& band, const Field& field) : band_(band), field_(field) {}

    std::int8_t of(NodeIndex i) const {
        const Vec3d p = band_.footPoint(i), normal(band_.normal[i]);
        double least = field_.startRadius;
        std::size_t nearest = field_.seeds.size();
        field_.seedsNear.forNear(p, [&](std::size_t k) {
            const SurfacePoint& s = field_.seeds[k];
            if (s.piece == Vec3d{} || dot(band_.normal[i], band_.normal[s.node]) < 0) return;
            if (const double r = length(p - s.nearestTo(p)); r < least) least = r, nearest = k;
        });
        if (nearest == field_.seeds.size()) return 0;
        const Vec3d from = field_.seeds[nearest].nearestTo(p);
        return dot(cross(tangentAt(nearest, from), p - from), normal) < 0 ? -1 : 1;
    }

private:
    /// Along the curve at a point of piece k; where two pieces meet, the mean of both, as then the
    /// side is right on either side of the corner.
    Vec3d tangentAt(std::size_t k, const Vec3d& p) const {
        const std::vector<SurfacePoint>& s = field_.seeds;
        constexpr double kSame = 1e-6;
        const Vec3d own = normalized(s[k].piece);
        auto with = [&](std::size_t other, const Vec3d& joint) {
            const Vec3d& piece = s[other].piece;
            return field_.source[other] == field_.source[k] && piece != Vec3d{} &&
                           length(joint - p) < kSame
                       ? own + normalized(piece)
                       : own;
        };
        const Vec3d begin = s[k].pIndex, end = begin + s[k].piece;
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

void clearInside(const std::vector<std::uint8_t>& inside, Field& field) {
    for (std::size_t i = 0; i < inside.size(); ++i)
        if (inside[i] && field.distance[i] < kInfinity) {
            field.distance[i] = 0;
            if (!field.gradient.empty()) field.gradient[i] = {};
        }
    field.summarize();
}

void signInside(const std::vector<std::uint8_t>& inside, Field& field) {
    field.side.clear();
    for (const std::uint8_t in : inside) field.side.push_back(in ? -1 : 1);
    for (SurfacePoint& s : field.seeds) s.rim = false;
}

std::vector<std::int8_t> sidesOfCurves(const Band& band, const Field& field) {
    const std::size_t n = band.size();
    std::vector<std::int8_t> sideOf(n, 0);
    const CurveSides curves(band, field);
    parallelFor(n, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) sideOf[i] = curves.of(NodeIndex(i));
    });

    // What is joined without crossing a curve is one part. Votes, and not single crossings, decide
    // which parts are opposite: next to a corner of a curve a node may be taken for the other side.
    SidedSets parts(n);
    std::vector<std::pair<NodeIndex, NodeIndex>> crossings;
    auto known = [&](NodeIndex i) { return field.distance[i] < kInfinity; };
    for (NodeIndex i = 0; i < n; ++i) {
        if (!known(i)) continue;
        band.forNeighbors(&BandLeaf::band, band.leaf[i], band.offset[i],
                          [&](NodeIndex j, int, int, int) {
                              if (j < i || !known(j) || !band.linked(i, j)) return;
                              if (sideOf[i] * sideOf[j] < 0)
                                  crossings.emplace_back(i, j);
                              else
                                  parts.join(i, j, false);
                          });
    }
    std::map<std::pair<NodeIndex, NodeIndex>, std::size_t> votes;
    for (const auto& [i, j] : crossings) {
        const NodeIndex a = parts.find(i).first, b = parts.find(j).first;
        ++votes[std::minmax(a, b)];
    }
    std::vector<std::pair<std::size_t, std::pair<NodeIndex, NodeIndex>>> order;
    for (const auto& [pair, count] : votes) order.emplace_back(count, pair);
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::size_t against = 0;
    for (const auto& [count, pair] : order)
        if (!parts.join(pair.first, pair.second, true)) against += count;
    constexpr std::size_t kStray = 20;  // one crossing in so many may be wrong
    if (crossings.empty() || against * kStray > crossings.size())
        throw Error(Error::Kind::InvalidArgument,
                    "the seeds do not part the surface into an inside and an outside",
                    "close the curve, or leave out --signed");

    std::vector<std::int8_t> side(n, 0);
    std::map<NodeIndex, std::ptrdiff_t> balance;
    for (NodeIndex i = 0; i < n; ++i) {
        if (!known(i)) continue;
        const SidedSets::Member at = parts.find(i);
        side[i] = at.turned ? -1 : 1;
        balance[at.first] += side[i];
    }
    for (NodeIndex i = 0; i < n; ++i)
        if (side[i] && balance[parts.find(i).first] < 0) side[i] = std::int8_t(-side[i]);
    return side;
}

double sideAt(const Band& band, const Field& field, const Vec3d& pIndex) {
    if (field.side.empty()) return 1;
    NodeIndex i = band.nodeAt(roundToIjk(pIndex));
    if (i == kNoNode) {
        const BandCell cell = cellAt(band, pIndex);
        for (std::size_t k = 0; k < 8 && i == kNoNode; ++k) i = cell.node[k];
    }
    return i == kNoNode || field.side[i] == 0 ? 1 : field.side[i];
}

}  // namespace igeo
