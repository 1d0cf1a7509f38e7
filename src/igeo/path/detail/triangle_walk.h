/// Straightest geodesics over triangles. Internal to the paths.
#pragma once

#include <igeo/band/surface_triangles.h>

#include <optional>

namespace igeo {

/// A point that moves straight over triangles: over an edge with both sides laid flat, and past a
/// vertex with equal angles on both sides (K. Polthier and M. Schmies, Straightest geodesics on
/// polyhedral surfaces, 1998). At a boundary vertex it leaves 180 degrees on one side, if there are
/// so many. At an edge of three triangles or more it takes the one that turns it least. Exact to
/// rounding.
class TriangleWalk {
public:
    /// @param direction  only its part along the triangle is used
    /// @param p          on the triangles
    TriangleWalk(const SurfaceTriangles& triangles, const Vec3d& p, const Vec3d& direction);

    /// Whether the direction has a part along the triangles.
    bool leads() const { return velocity_ != Vec3d{}; }
    const Vec3d& position() const { return p_; }

    /// Moves within one triangle, by `most` or to its edge.
    /// @return the length moved; empty where the triangles end
    std::optional<double> advance(double most);

private:
    /// The triangles around a vertex, starting from one.
    struct Turn {
        double angle = 0;     ///< from there to the far side of the last
        bool closed = false;  ///< the turn comes back to its start
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
    /// @param move  continue in the direction where it is reached
    Turn turnAround(unsigned corner, unsigned first, double wanted, bool move);

    const SurfaceTriangles& triangles_;
    std::uint32_t t_;
    Vec3d p_, velocity_;
};

}  // namespace igeo
