/// Straightest geodesics over triangles. Internal to the paths.
#pragma once

#include <igeo/band/surface_triangles.h>

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace igeo {

/// A point that moves straight over triangles: over an edge with both sides laid flat, and past a
/// vertex with equal angles on both sides (K. Polthier and M. Schmies, Straightest geodesics on
/// polyhedral surfaces, 1998). At a boundary vertex it leaves 180 degrees on one side, if there are
/// so many. At an edge of three triangles or more it takes the one that turns it least. Exact to
/// rounding, over triangles without area too: it keeps its place in a triangle laid flat, and the
/// side on which a corner lies decides where it goes on.
class TriangleWalk {
public:
    /// From an edge or a vertex, it goes on as if it came over the triangle in whose plane the
    /// direction lies. Where that is none, it starts in the triangle to which the direction is
    /// nearest, of those into which it leads.
    /// @param direction  only its part along the triangle is used
    /// @param p          on the triangles
    TriangleWalk(const SurfaceTriangles& triangles, const Vec3d& p, const Vec3d& direction);

    /// Whether the direction has a part along the triangles.
    bool leads() const { return velocity_ != Vec2d{}; }
    Vec3d position() const {
        return flat_.inSpace(at_) + triangles_.corner(side_.triangle, side_.corner);
    }

    /// Moves within one triangle, by `most` or to its edge.
    /// @return the length moved; empty where the triangles end
    std::optional<double> advance(double most);

private:
    using Side = SurfaceTriangles::Side;
    /// A triangle laid flat: the first corner of a side at the origin, the second on the x axis,
    /// and the third above it.
    struct Flat {
        std::array<Vec2d, 3> corner;
        Vec3d x, y;  ///< the axes in space; y is zero without area

        Vec3d inSpace(const Vec2d& v) const { return v.x * x + v.y * y; }
    };
    /// Part of a turn around a vertex, in one triangle.
    struct Sector {
        Side side;           ///< its first corner is the vertex
        double from, angle;  ///< where it begins, from the side, and how wide it is
        double sense;        ///< 1: it turns away from the side, -1: to it
    };
    /// A turn around a vertex, until it comes back to its start or the triangles end.
    struct Turn {
        std::vector<Sector> sectors;
        bool closed = false;
    };

    Flat laidFlat(const Side& side) const;
    /// A point of a triangle laid flat, from the corner or the edge that it lies on, if any.
    std::pair<Side, Vec2d> placeIn(std::uint32_t t, const Vec3d& p) const;
    void chooseTriangle(const Vec3d& direction, std::uint32_t first, const Vec3d& p);
    void enter(const Side& side, const Vec2d& at, const Vec2d& velocity);
    bool crossEdge(unsigned exit, double share);
    bool passVertex(unsigned corner);
    Turn turnFrom(const Sector& first) const;

    const SurfaceTriangles& triangles_;
    Side side_;
    Flat flat_;            ///< the triangle, from side_
    Vec2d at_, velocity_;  ///< in it
    bool ended_ = false;
};

}  // namespace igeo
