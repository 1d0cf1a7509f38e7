#include <igeo/surface/detail/orient_normals.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <atomic>
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

/// What the normals of two points say of their sides.
Edge edgeBetween(const PointTree& points, const std::vector<Vec3d>& normals,
                 const std::vector<std::uint8_t>& atEdge, Index i, Index j) {
    constexpr double kOneSheet = 0.95, kOverEdge = 0.6;
    const Index a = std::min(i, j), b = std::max(i, j);
    const Vec3d way = normalized(points[b] - points[a]);
    const double alongA = dot(normals[a], way), alongB = dot(normals[b], way);
    const double cosine = dot(normals[a], normals[b]);
    if (!atEdge.empty() && (atEdge[a] || atEdge[b]) && std::abs(cosine) < kOneSheet) {
        const double trust = kOverEdge * std::min(std::abs(alongA), std::abs(alongB));
        return {float(1 - trust), alongA * alongB > 0, a, b};
    }
    const double agree = cosine - 2 * alongA * alongB;
    // Two points one above the other may also be scatter of one sheet: there the edges along the
    // sheet come first.
    const double steep = std::max(std::abs(alongA), std::abs(alongB));
    const double trust = std::abs(agree) * (1 - 0.7 * steep);
    return {float(1 - trust), agree < 0, a, b};
}

std::vector<Edge> edges(const PointTree& points, const std::vector<Vec3d>& normals,
                        const std::vector<std::uint8_t>& atEdge, std::size_t neighbors) {
    const std::size_t k = std::min(neighbors, points.size() - 1);
    std::vector<Edge> all(points.size() * k);
    parallelFor(points.size(), 512, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> found;
        for (std::size_t i = begin; i < end; ++i) {
            points.nearest(points[i], k + 1, found);
            std::size_t at = i * k;
            for (const PointTree::Found& f : found)
                if (f.point != i && at < (i + 1) * k)
                    all[at++] = edgeBetween(points, normals, atEdge, Index(i), f.point);
        }
    });
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end(),
                          [](const Edge& x, const Edge& y) { return x.a == y.a && x.b == y.b; }),
              all.end());
    return all;
}

/// Edges with less doubt lead along a sheet.
constexpr float kSure = 0.5f;

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
    const Vec3d outward = normalized(Vec3d{0.31, 0.17, 0.94});  // along no axis
    const std::size_t n = points.size();
    SidedSets sides(n);
    joinByEdges(edges(points, normals, atEdge, neighbors), sides);
    Orientation result;
    result.sign.resize(n);
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

Seams seamsOf(const PointTree& points, const std::vector<Vec3d>& normals,
              const std::vector<std::uint8_t>& atEdge, std::size_t neighbors) {
    constexpr double kOpposite = -0.9;  // of neighbors across a sharp edge: less
    const std::size_t n = points.size(), k = std::min(neighbors, n - 1);
    std::vector<std::uint8_t> beside(n);
    const auto forSure = [&](std::size_t i, std::vector<PointTree::Found>& found,
                             const auto& visit) {
        points.nearest(points[i], k + 1, found);
        for (const PointTree::Found& f : found) {
            if (f.point == i) continue;
            const Edge e = edgeBetween(points, normals, atEdge, Index(i), f.point);
            if (e.doubt < kSure) visit(f.point, e.turned);
        }
    };
    parallelFor(n, 512, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> found;
        for (std::size_t i = begin; i < end; ++i)
            forSure(i, found, [&](Index j, bool turned) {
                if (!turned || dot(normals[i], normals[j]) > kOpposite) return;
                for (const std::size_t p : {i, std::size_t(j)})
                    std::atomic_ref(beside[p]).store(1, std::memory_order_relaxed);
            });
    });
    DisjointSets seams(n);
    std::vector<PointTree::Found> found;
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!beside[i]) continue;
        ++count;
        forSure(i, found, [&](Index j, bool) {
            if (beside[j]) seams.join(Index(i), j);
        });
    }
    Seams result;
    result.share = double(count) / double(n);
    if (count == 0) return result;
    std::vector<Box> boxes(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (!beside[i]) continue;
        Box& box = boxes[seams.first(Index(i))];
        box.include(points[i]);
        result.longest = std::max(result.longest, length(box.size()));
    }
    return result;
}

}  // namespace igeo
