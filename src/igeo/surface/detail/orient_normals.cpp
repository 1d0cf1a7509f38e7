#include <igeo/surface/detail/orient_normals.h>

#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace igeo {

namespace {

using Index = PointTree::Index;

struct Edge {
    float doubt;  ///< 0: certain, 1: no information
    bool turned;  ///< the normals point to different sides
    Index a, b;   ///< a < b
    bool operator<(const Edge& o) const {
        return std::tie(doubt, a, b) < std::tie(o.doubt, o.a, o.b);
    }
};

std::vector<Edge> edges(const PointTree& points, const std::vector<Vec3d>& normals,
                        std::size_t neighbors) {
    const std::size_t k = std::min(neighbors, points.size() - 1);
    std::vector<Edge> all(points.size() * k);
    parallelFor(points.size(), 512, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> found;
        for (std::size_t i = begin; i < end; ++i) {
            points.nearest(points[i], k + 1, found);
            std::size_t at = i * k;
            for (const PointTree::Found& f : found) {
                if (f.point == i || at == (i + 1) * k) continue;
                const auto a = std::min(Index(i), f.point), b = std::max(Index(i), f.point);
                const Vec3d way = normalized(points[b] - points[a]);
                const double alongA = dot(normals[a], way), alongB = dot(normals[b], way);
                const double agree = dot(normals[a], normals[b]) - 2 * alongA * alongB;
                // Two points one above the other may also be scatter of one sheet: there the edges
                // along the sheet come first.
                const double steep = std::max(std::abs(alongA), std::abs(alongB));
                const double trust = std::abs(agree) * (1 - 0.7 * steep);
                all[at++] = {float(1 - trust), agree < 0, a, b};
            }
        }
    });
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end(),
                          [](const Edge& x, const Edge& y) { return x.a == y.a && x.b == y.b; }),
              all.end());
    return all;
}

}  // namespace

Orientation orientNormals(const PointTree& points, const std::vector<Vec3d>& normals,
                          std::size_t neighbors) {
    constexpr float kSure = 0.5f;
    const Vec3d outward = normalized(Vec3d{0.31, 0.17, 0.94});  // along no axis
    const std::size_t n = points.size();
    SidedSets sides(n);
    std::size_t sure = 0, wrong = 0;
    for (const Edge& e : edges(points, normals, neighbors)) {
        const bool known = sides.find(e.a).first == sides.find(e.b).first;
        const bool agrees = sides.join(e.a, e.b, e.turned);
        if (known && e.doubt < kSure) ++sure, wrong += !agrees;
    }

    Orientation result;
    result.sign.resize(n);
    result.conflicts = sure ? double(wrong) / double(sure) : 0;
    std::vector<Index> outermost(n);
    std::iota(outermost.begin(), outermost.end(), Index(0));
    for (std::size_t i = 0; i < n; ++i) {
        Index& best = outermost[sides.find(Index(i)).first];
        if (dot(outward, points[i] - points[best]) > 0) best = Index(i);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const SidedSets::Member side = sides.find(Index(i));
        const Index top = outermost[side.first];
        const bool inward = dot(outward, normals[top]) < 0;
        result.sign[i] = (side.turned != sides.find(top).turned) != inward ? -1 : 1;
        result.pieces += side.first == i;
    }
    return result;
}

}  // namespace igeo
