/// Straight on over triangles. Internal to the paths.
#pragma once

#include <igeo/band/surface_triangles.h>

#include <optional>

namespace igeo {

/// A point that moves straight on over triangles: over an edge as if both sides were laid out flat,
/// and past a vertex with the same angle on both sides (K. Polthier and M. Schmies, Straightest
/// geodesics on polyhedral surfaces, 1998). At a vertex of the boundary it goes on with 180 degrees
/// on one side, where there are so many. At an edge of three triangles or more it takes the one
/// that turns least. Exact to rounding.
class TriangleWalk {
public:
    /// @param direction  its part along the triangle counts
    /// @param p          on the triangles
    TriangleWalk(const SurfaceTriangles& triangles, const Vec3d& p, const Vec3d& direction);

    /// Whether the direction has a part along the triangles.
    bool leads() const { return velocity_ != Vec3d{}; }
    const Vec3d& position() const { return p_; }

    /// Moves on within one triangle, by `most` or as far as its edge.
    /// @return how far; nothing where the triangles end
    std::optional<double> advance(double most);

private:
    /// The triangles around a vertex, from one on.
    struct Turn {
        double angle = 0;     ///< from there to the end of the last
        bool closed = false;  ///< it comes back
    };

    /// Unit vectors of an edge of a triangle: along it, and into the triangle.
    struct EdgeFrame {
        Vec3d along, inward;
    };
    EdgeFrame frame(const SurfaceTriangles::Side& side) const;
    bool leadsInto(std::uint32_t t, const Vec3d& along) const;
    void chooseTriangle(const Vec3d& direction);
    bool crossEdge(unsigned corner);
    bool passVertex(unsigned corner);
    /// Turns around a corner, over its edge `first`, until `wanted` is reached or the triangles
    /// end.
    /// @param move  goes on in that direction where it is reached
    Turn turnAround(unsigned corner, unsigned first, double wanted, bool move);

    const SurfaceTriangles& triangles_;
    std::uint32_t t_;
    Vec3d p_, velocity_;
};

}  // namespace igeo
