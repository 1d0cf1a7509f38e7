/// Shortest curves over triangles. Internal to the paths.
#pragma once

#include <igeo/band/surface_triangles.h>
#include <igeo/base/progress.h>

#include <vector>

namespace igeo {

/// Triangles from one point to another, each joined to the next by an edge.
struct TriangleStrip {
    Vec3d from, to;
    std::vector<SurfaceTriangles::Side> exits;  ///< the edge by which each but the last is left
    std::uint32_t last = SurfaceTriangles::kNone;
    /// It may return to a triangle, as a curve with several turns around the surface does.
    bool winds = false;

    std::uint32_t triangle(std::size_t k) const {
        return k < exits.size() ? exits[k].triangle : last;
    }
    std::size_t size() const { return exits.size() + 1; }
};

/// The strips from each point of a curve on the triangles to the next, about a voxel apart, by a
/// search (A*) over neighbors. One strip per pair of points.
/// @return a strip's `last` is kNone where the triangles do not join its ends nearby
std::vector<TriangleStrip> stripsAlong(const SurfaceTriangles& triangles,
                                       const std::vector<Vec3d>& curve);

/// Consecutive strips as one, without loops.
TriangleStrip joined(const std::vector<TriangleStrip>& strips, std::size_t begin, std::size_t end);
/// The same with the loops of the curve around the surface: only turns around a single vertex are
/// removed.
TriangleStrip joinedWinding(const SurfaceTriangles& triangles,
                            const std::vector<TriangleStrip>& strips, std::size_t begin,
                            std::size_t end);

/// The locally shortest curve over the triangles near a strip: exact to rounding.
///
/// The strip is laid flat, and a funnel (D. T. Lee and F. P. Preparata, 1984) finds the shortest
/// curve in it. Where the curve bends around a vertex with less than 180 degrees on the other side,
/// the strip passes on that side instead (S.-Q. Xin and G.-J. Wang, 2007), as long as the curve
/// gets shorter.
/// @return the points where it crosses edges and passes vertices, with both ends
/// @throws Error  Cancelled, tested before each round
std::vector<Vec3d> shortestCurve(const SurfaceTriangles& triangles, TriangleStrip strip,
                                 const Progress& progress = Progress::none());

}  // namespace igeo
