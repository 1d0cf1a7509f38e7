/// The triangles of S, where its band was made from a mesh.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace igeo {

/// Triangles in index space, with their neighbors and a tree of boxes over them.
class SurfaceTriangles {
public:
    using Triangle = std::array<std::uint32_t, 3>;
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max(),
                                   kMany = kNone - 1;
    /// An edge of a triangle: from a corner to the next.
    struct Side {
        std::uint32_t triangle = kNone;
        unsigned corner = 0;
    };
    /// A point of a triangle.
    struct Place {
        std::uint32_t triangle = kNone;  ///< kNone: there is none
        Vec3d point;
        double squared = kInfinity;  ///< squared distance to the given point, voxels
    };

    /// @param neighbor  per triangle, the neighbor across the edge from corner k to k + 1: kNone at
    ///                  a boundary, kMany where three or more triangles meet
    /// @param run       so many triangles after one another are close, and stay together in the
    ///                  tree
    SurfaceTriangles(std::vector<Vec3d> points, std::vector<Triangle> triangles,
                     std::vector<std::array<std::uint32_t, 3>> neighbor, std::size_t run = 1);

    std::size_t size() const { return triangles_.size(); }
    /// Whether every edge has two triangles, so that there is an inside.
    bool closed() const;
    const std::vector<Vec3d>& points() const { return points_; }
    const Triangle& operator[](std::size_t t) const { return triangles_[t]; }
    const Vec3d& corner(std::size_t t, unsigned k) const { return points_[triangles_[t][k % 3]]; }
    /// Unit normal of a triangle, counter-clockwise; zero for one without area.
    Vec3d normal(std::size_t t) const {
        const Vec3d a = corner(t, 0);
        return normalized(cross(corner(t, 1) - a, corner(t, 2) - a));
    }

    /// The angle of a triangle at its corner k.
    double angle(std::size_t t, unsigned k) const {
        const Vec3d& p = corner(t, k);
        return angleBetween(corner(t, k + 1) - p, corner(t, k + 2) - p);
    }

    /// The nearest point at most `within` from p; on ties that of the triangle with the lowest
    /// number.
    /// @param sheetNormal  a unit normal: triangles with opposite normals are used only where there
    ///                     are no others
    /// Time O(log n). The first call builds the tree, in O(n log n).
    Place nearest(const Vec3d& p, double within = kInfinity, const Vec3d& sheetNormal = {}) const;

    /// The point of a triangle nearest to p.
    Place placeOn(std::uint32_t t, const Vec3d& p) const;

    /// Whether `is` holds of a triangle's point nearest to p, at most `within` from it.
    bool any(const Vec3d& p, double within, const std::function<bool(const Place&)>& is) const;

    /// Whether a path on the triangles joins two points of them through edges within the ball of
    /// this radius around their middle. Time O(triangles within).
    bool joins(const Place& from, const Place& to, double radius) const;

    /// Whether a ray from `from` in the unit direction `dir` meets a triangle.
    bool meets(const Vec3d& from, const Vec3d& dir) const;

    /// Calls visit(side) for the other triangles at an edge; `side` is the edge as a side of that
    /// triangle.
    template <typename Visit>
    void forBeyond(const Side& side, const Visit& visit) const {
        const std::uint32_t beside = neighbor_[side.triangle][side.corner];
        if (beside == kNone) return;
        if (beside != kMany) return visit(Side{beside, cornerAt(beside, side)});
        for (const Side& other : sidesAtManyEdge(side))
            if (other.triangle != side.triangle) visit(other);
    }
    /// As ShortWalk asks for them: visit(triangle), and whether a walk may join two triangles.
    template <typename Visit>
    void forBeyond(std::uint32_t t, std::uint32_t k, const Visit& visit) const {
        forBeyond(Side{t, k}, [&](const Side& side) { visit(side.triangle); });
    }
    bool mayJoin(std::uint32_t, std::uint32_t) const { return true; }
    /// The one triangle across an edge; none at a boundary and where three or more meet.
    std::optional<Side> beyond(const Side& side) const {
        const std::uint32_t beside = neighbor_[side.triangle][side.corner];
        if (beside >= kMany) return std::nullopt;
        return Side{beside, cornerAt(beside, side)};
    }

private:
    struct Box {
        Vec3d low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
        void add(const Vec3d& p);
        void add(const Box& box);
        double squaredDistance(const Vec3d& p) const;
        /// The distance at which a ray enters; +infinity where it misses.
        double entry(const Vec3d& from, const Vec3d& inverse) const;
    };
    /// Boxes level by level: 2^level - 1 boxes come before a level.
    struct Tree {
        std::vector<std::uint32_t> order;  ///< of runs
        std::vector<Box> boxes;
        unsigned levels = 0;   ///< below the root
        std::vector<Box> few;  ///< of each kFew triangles after one another, in long runs
    };
    static constexpr double kOpposed = -0.2;  ///< cosine of normals; as Band::kOtherSheet
    static constexpr std::size_t kFew = 4;    ///< triangles with a box of their own

    const Tree& tree() const;
    void makeTree() const;
    Box boxOf(std::size_t first, std::size_t last) const;
    std::size_t runs() const { return (size() + run_ - 1) / run_; }
    std::size_t edge(unsigned level, std::size_t k) const { return k * runs() >> level; }
    std::size_t endOf(std::size_t run) const { return std::min((run + 1) * run_, size()); }
    /// Runs in a leaf of the tree: at most so many, and at least half of it.
    std::size_t bucket() const { return run_ > kFew ? 2 : 4; }
    /// Visits leaves in the order of their boxes' `key`, least first: visit(triangle), while key <
    /// limit().
    template <typename Key, typename Limit, typename Visit>
    void forLeaves(const Key& key, const Limit& limit, const Visit& visit) const;

    unsigned cornerAt(std::uint32_t t, const Side& edge) const;
    std::vector<Side> sidesAtManyEdge(const Side& side) const;

    std::vector<Vec3d> points_;
    std::vector<Triangle> triangles_;
    std::vector<std::array<std::uint32_t, 3>> neighbor_;
    std::size_t run_;
    /// Sides at edges of three or more triangles, sorted by edge.
    std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, Side>> many_;
    mutable std::once_flag treeMade_;
    mutable Tree tree_;
};

}  // namespace igeo
