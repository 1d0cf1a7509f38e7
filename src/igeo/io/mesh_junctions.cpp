#include <igeo/base/detail/box.h>
#include <igeo/base/nearest_on_triangle.h>
#include <igeo/base/point_tree.h>
#include <igeo/io/detail/mesh_edges.h>
#include <igeo/io/triangle_mesh.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace igeo {

namespace {

using PointNumber = std::uint32_t;

/// A point in the edge from corner `edge` of a triangle to the next.
struct Junction {
    std::uint32_t triangle, edge;
    double along;  ///< grows from corner to corner
    PointNumber point;

    bool operator<(const Junction& o) const {
        return std::tie(triangle, edge, along, point) <
               std::tie(o.triangle, o.edge, o.along, o.point);
    }
    bool operator==(const Junction& o) const {
        return triangle == o.triangle && edge == o.edge && point == o.point;
    }
};

/// The points in boundary edges at which other boundary edges end that run along them.
class Junctions {
public:
    explicit Junctions(const TriangleMesh& mesh)
        : mesh_(mesh), tolerance_(TriangleMesh::kSame * length(Box(mesh.points).size())) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;  // triangle, corner
        forEdges(mesh.points.size(), mesh.triangles,
                 [&](const HalfEdge* first, const HalfEdge* last) {
                     if (last - first != 1) return;
                     sides.emplace_back(first->triangle, first->corner);
                     along_.emplace_back(first->low, first->high);
                     along_.emplace_back(first->high, first->low);
                 });
        std::sort(along_.begin(), along_.end());
        std::vector<Vec3d> ends;
        for (std::size_t k = 0; k < along_.size(); ++k) {
            if (k > 0 && along_[k].first == along_[k - 1].first) continue;
            number_.push_back(along_[k].first);
            ends.push_back(at(along_[k].first));
        }
        tree_ = PointTree(ends);
        for (const auto& [t, k] : sides) {
            const Triangle& of = mesh.triangles[t];
            find(t, k, at(of[k]), at(of[(k + 1) % 3]));
        }
        std::sort(found_.begin(), found_.end());
        found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    }
    /// By triangle, edge and place; each once.
    const std::vector<Junction>& found() const { return found_; }

private:
    using Triangle = TriangleMesh::Triangle;

    const Vec3d& at(PointNumber p) const { return mesh_.points[p]; }

    /// Finds those in a part of an edge: in halves, until few points are near.
    void find(std::uint32_t t, std::uint32_t k, const Vec3d& from, const Vec3d& to) {
        constexpr std::size_t kFew = 16;
        const Vec3d middle = 0.5 * (from + to);
        const double half = length(to - from) / 2;
        tree_.nearest(middle, kFew, near_, half + tolerance_);
        if (near_.size() == kFew && half > tolerance_) {
            find(t, k, from, middle);
            find(t, k, middle, to);
            return;
        }
        const Triangle& of = mesh_.triangles[t];
        const PointNumber a = of[k], b = of[(k + 1) % 3];
        for (const PointTree::Found& end : near_) {
            const PointNumber p = number_[tree_.inputIndex(end.point)];
            if (std::count(of.begin(), of.end(), p) == 0 && isIn(p, a, b) && runsAlong(p, a, b))
                found_.push_back({t, k, dot(at(p) - at(a), at(b) - at(a)), p});
        }
    }
    bool isIn(PointNumber p, PointNumber a, PointNumber b) const {
        return distanceToSegment(at(p), at(a), at(b)) <= tolerance_;
    }
    /// Whether a boundary edge that ends in p, a point in the edge from a to b, runs along this.
    bool runsAlong(PointNumber p, PointNumber a, PointNumber b) const {
        auto edge = std::lower_bound(along_.begin(), along_.end(), std::pair(p, PointNumber(0)));
        for (; edge != along_.end() && edge->first == p; ++edge)
            if (const PointNumber q = edge->second; isIn(q, a, b) || isIn(a, p, q) || isIn(b, p, q))
                return true;
        return false;
    }

    const TriangleMesh& mesh_;
    double tolerance_;
    std::vector<std::pair<PointNumber, PointNumber>> along_;  ///< boundary edges, from both ends
    std::vector<PointNumber> number_;                         ///< of their ends, once each
    PointTree tree_;                                          ///< over these
    std::vector<PointTree::Found> near_;
    std::vector<Junction> found_;
};

/// Cuts a triangle into triangles that have all points on its edges as corners: a strip between two
/// edges, and a fan to the points of the third, which has the fewest.
/// @param sides  per edge its first corner and the points in it, in their order
void cut(std::array<std::vector<PointNumber>, 3> sides, const std::vector<Vec3d>& points,
         std::vector<TriangleMesh::Triangle>& pieces) {
    const auto fewest =
        std::min_element(sides.begin(), sides.end(),
                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
    std::rotate(sides.begin(), sides.begin() + (fewest - sides.begin() + 2) % 3, sides.end());
    auto& [left, opposite, right] = sides;
    left.push_back(opposite.front());
    opposite.push_back(right.front());
    right.push_back(left.front());
    std::reverse(right.begin(), right.end());

    const auto apart = [&](PointNumber a, PointNumber b) { return length(points[a] - points[b]); };
    std::size_t i = 1, j = 1;
    TriangleMesh::Triangle last{left[0], left[1], right[1]};
    PointNumber third = left[0];
    while (i + 1 < left.size() || j + 1 < right.size()) {
        pieces.push_back(last);
        const bool onLeft =
            j + 1 == right.size() ||
            (i + 1 < left.size() && apart(left[i + 1], right[j]) <= apart(left[i], right[j + 1]));
        third = onLeft ? left[i] : right[j];
        last = {left[i], onLeft ? left[i + 1] : right[j + 1], right[j]};
        ++(onLeft ? i : j);
    }
    for (std::size_t k = 1; k < opposite.size(); ++k)
        pieces.push_back({third, opposite[k - 1], opposite[k]});
}

/// The triangles without area that join others along an edge, whose middle corner becomes a
/// junction. Not at edges of three triangles, nor at a corner that no other triangle has.
std::vector<bool> triangleSeams(const TriangleMesh& mesh) {
    std::vector<bool> isSeam(mesh.triangles.size()), hasArea(mesh.points.size());
    bool any = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        isSeam[t] = TriangleCorners(mesh.points[a], mesh.points[b], mesh.points[c]).flat;
        any |= isSeam[t];
        if (!isSeam[t]) hasArea[a] = hasArea[b] = hasArea[c] = true;
    }
    if (!any) return isSeam;
    forEdges(mesh.points.size(), mesh.triangles, [&](const HalfEdge* first, const HalfEdge* last) {
        for (const HalfEdge* e = first; e < last; ++e)
            if (last - first > 2 || !hasArea[e->low] || !hasArea[e->high])
                isSeam[e->triangle] = false;
    });
    return isSeam;
}

/// Leaves triangles out.
void remove(const std::vector<bool>& which, std::vector<TriangleMesh::Triangle>& triangles) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < which.size(); ++t)
        if (!which[t]) triangles[kept++] = triangles[t];
    triangles.resize(kept);
}

}  // namespace

void splitAtJunctions(TriangleMesh& mesh) {
    mesh.unsplit.clear();
    remove(triangleSeams(mesh), mesh.triangles);
    const std::vector<Junction> junctions = Junctions(mesh).found();
    if (junctions.empty()) return;
    std::vector<TriangleMesh::Triangle> pieces;
    std::vector<bool> isJunction(mesh.points.size());
    auto next = junctions.begin();
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        if (next == junctions.end() || next->triangle != t) {
            pieces.push_back({a, b, c});
            continue;
        }
        std::array<std::vector<PointNumber>, 3> sides{{{a}, {b}, {c}}};
        for (; next != junctions.end() && next->triangle == t; ++next) {
            sides[next->edge].push_back(next->point);
            isJunction[next->point] = true;
        }
        cut(std::move(sides), mesh.points, pieces);
    }
    mesh.unsplit = std::exchange(mesh.triangles, std::move(pieces));
    mesh.junctions = std::size_t(std::count(isJunction.begin(), isJunction.end(), true));
}

}  // namespace igeo
