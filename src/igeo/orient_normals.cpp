#include <igeo/orient_normals.h>

#include <igeo/parallel.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace igeo {

namespace {

using Index = PointTree::Index;

struct Edge {
    float doubt;  ///< 0: none, 1: says nothing
    bool turned;  ///< the normals look to different sides
    Index a, b;   ///< a < b
    bool operator<(const Edge& o) const {
        return std::tie(doubt, a, b) < std::tie(o.doubt, o.a, o.b);
    }
};

std::vector<Edge> edges(const PointTree& points, const std::vector<Vec3d>& normals,
                        std::size_t neighbours) {
    const std::size_t k = std::min(neighbours, points.size() - 1);
    std::vector<Edge> all(points.size() * k);
    parallelFor(points.size(), 512, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> near;
        for (std::size_t i = begin; i < end; ++i) {
            points.nearest(points[i], k + 1, near);
            std::size_t at = i * k;
            for (const PointTree::Found& f : near) {
                if (f.point == i || at == (i + 1) * k) continue;
                const auto a = std::min(Index(i), f.point), b = std::max(Index(i), f.point);
                const Vec3d way = normalized(points[b] - points[a]);
                const double alongA = dot(normals[a], way), alongB = dot(normals[b], way);
                const double agree = dot(normals[a], normals[b]) - 2 * alongA * alongB;
                // Two points one above the other may also be the scatter of one sheet: there the
                // edges along it come first.
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

/// Union-find that knows of each member whether it is turned against its root.
class Sides {
public:
    explicit Sides(std::size_t n) : parent_(n), turned_(n, 0) {
        std::iota(parent_.begin(), parent_.end(), Index(0));
    }
    struct Side {
        Index root;
        bool turned;
    };
    Side find(Index i) {
        Index root = i;
        bool turned = false;
        while (parent_[root] != root) turned ^= turned_[root] != 0, root = parent_[root];
        const Side found{root, turned};
        while (parent_[i] != root) {
            const Index next = parent_[i];
            const bool here = turned;
            turned ^= turned_[i] != 0;
            parent_[i] = root;
            turned_[i] = here;
            i = next;
        }
        return found;
    }
    void join(Side a, Side b, bool turned) {
        // The higher number below the lower one: the roots do not depend on the sizes.
        if (a.root > b.root) std::swap(a, b);
        parent_[b.root] = a.root;
        turned_[b.root] = turned ^ a.turned ^ b.turned;
    }

private:
    std::vector<Index> parent_;
    std::vector<std::uint8_t> turned_;
};

}  // namespace

Orientation orientNormals(const PointTree& points, const std::vector<Vec3d>& normals,
                          std::size_t neighbours) {
    constexpr float kSure = 0.5f;
    const Vec3d outward = normalized(Vec3d{0.31, 0.17, 0.94});  // along no axis
    const std::size_t n = points.size();
    Sides sides(n);
    std::size_t sure = 0, wrong = 0;
    for (const Edge& e : edges(points, normals, neighbours)) {
        const Sides::Side a = sides.find(e.a), b = sides.find(e.b);
        if (a.root != b.root)
            sides.join(a, b, e.turned);
        else if (e.doubt < kSure)
            ++sure, wrong += (a.turned != b.turned) != e.turned;
    }

    Orientation result;
    result.sign.resize(n);
    result.conflicts = sure ? double(wrong) / double(sure) : 0;
    std::vector<Index> outermost(n);
    std::iota(outermost.begin(), outermost.end(), Index(0));
    for (std::size_t i = 0; i < n; ++i) {
        Index& best = outermost[sides.find(Index(i)).root];
        if (dot(outward, points[i] - points[best]) > 0) best = Index(i);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const Sides::Side side = sides.find(Index(i));
        const Index top = outermost[side.root];
        const bool inward = dot(outward, normals[top]) < 0;
        result.sign[i] = (side.turned != sides.find(top).turned) != inward ? -1 : 1;
        result.pieces += side.root == i;
    }
    return result;
}

}  // namespace igeo
