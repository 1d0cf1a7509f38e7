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
    /// It may come back to a triangle, as a curve that goes around the surface more than once does.
    bool winds = false;

    std::uint32_t triangle(std::size_t k) const {
        return k < exits.size() ? exits[k].triangle : last;
    }
    std::size_t size() const { return exits.size() + 1; }
};

/// The strips that join each point of a curve on the triangles to the next, a voxel or so apart: by
/// a search (A*) over neighbors. One strip per pair of points.
/// @return a strip's `last` is kNone where the triangles do not join its ends nearby
std::vector<TriangleStrip> stripsAlong(const SurfaceTriangles& triangles,
                                       const std::vector<Vec3d>& curve);

/// Strips that follow each other as one, without loops.
TriangleStrip joined(const std::vector<TriangleStrip>& strips, std::size_t begin, std::size_t end);
/// The same with the loops by which a curve goes around the surface: only turns around one vertex
/// are left out.
TriangleStrip joinedWinding(const SurfaceTriangles& triangles,
                            const std::vector<TriangleStrip>& strips, std::size_t begin,
                            std::size_t end);

/// The locally shortest curve over the triangles near a strip: exact to rounding.
///
/// The strip is laid out flat, and a funnel (D. T. Lee and F. P. Preparata, 1984) finds the
/// shortest curve in it. Where that bends around a vertex with less than 180 degrees on the other
/// side, the strip goes on around that side instead (S.-Q. Xin and G.-J. Wang, 2007), for as long
/// as the curve gets shorter.
/// @return where it crosses edges and passes vertices, with both ends
/// @throws Error  Cancelled, looked at before each round
std::vector<Vec3d> shortestCurve(const SurfaceTriangles& triangles, TriangleStrip strip,
                                 const Progress& progress = Progress::none());

}  // namespace igeo
