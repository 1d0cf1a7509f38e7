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
                        const std::vector<std::uint8_t>& atEdge, std::size_t neighbors) {
    constexpr double kOneSheet = 0.95, kOverEdge = 0.6;
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
                const double cosine = dot(normals[a], normals[b]);
                if (!atEdge.empty() && (atEdge[a] || atEdge[b]) && std::abs(cosine) < kOneSheet) {
                    const double trust = kOverEdge * std::min(std::abs(alongA), std::abs(alongB));
                    all[at++] = {float(1 - trust), alongA * alongB > 0, a, b};
                    continue;
                }
                const double agree = cosine - 2 * alongA * alongB;
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

/// What the edges between two parts say together.
struct Vote {
    Index a, b;    ///< a < b
    double votes;  ///< negative: the parts point to different sides
    bool operator<(const Vote& o) const { return std::tie(a, b) < std::tie(o.a, o.b); }
};

std::vector<Vote> votesOf(const std::vector<Edge>& edges, SidedSets& sides) {
    std::vector<Vote> votes;
    for (const Edge& e : edges) {
        const SidedSets::Member a = sides.find(e.a), b = sides.find(e.b);
        const bool turned = e.turned != (a.turned != b.turned);
        const double trust = 1 - double(e.doubt);
        votes.push_back(
            {std::min(a.first, b.first), std::max(a.first, b.first), turned ? -trust : trust});
    }
    std::stable_sort(votes.begin(), votes.end());
    std::size_t count = 0;
    for (const Vote& v : votes)
        if (count > 0 && votes[count - 1].a == v.a && votes[count - 1].b == v.b)
            votes[count - 1].votes += v.votes;
        else
            votes[count++] = v;
    votes.resize(count);
    std::stable_sort(votes.begin(), votes.end(), [](const Vote& v, const Vote& w) {
        return std::abs(v.votes) > std::abs(w.votes);
    });
    return votes;
}

/// Joins all points that edges connect.
/// @param edges  sorted
void joinByEdges(std::vector<Edge> edges, SidedSets& sides) {
    constexpr float kCertain = 0.15f;
    for (const Edge& e : edges)
        if (e.doubt < kCertain) sides.join(e.a, e.b, e.turned);
    while (true) {
        edges.erase(std::remove_if(edges.begin(), edges.end(),
                                   [&](const Edge& e) {
                                       return sides.find(e.a).first == sides.find(e.b).first;
                                   }),
                    edges.end());
        if (edges.empty()) return;
        // The clearer half. Each join changes what is between the others.
        const std::vector<Vote> votes = votesOf(edges, sides);
        for (std::size_t k = 0; k < (votes.size() + 1) / 2; ++k)
            sides.join(votes[k].a, votes[k].b, votes[k].votes < 0);
    }
}

}  // namespace

Orientation orientNormals(const PointTree& points, const std::vector<Vec3d>& normals,
                          const std::vector<std::uint8_t>& atEdge, std::size_t neighbors) {
    constexpr float kSure = 0.5f;
    const Vec3d outward = normalized(Vec3d{0.31, 0.17, 0.94});  // along no axis
    const std::size_t n = points.size();
    SidedSets sides(n);
    const std::vector<Edge> all = edges(points, normals, atEdge, neighbors);
    joinByEdges(all, sides);
    std::size_t sure = 0, wrong = 0;
    for (const Edge& e : all)
        if (e.doubt < kSure)
            ++sure, wrong += e.turned != (sides.find(e.a).turned != sides.find(e.b).turned);

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
