/// The clearance beside a surface.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// Radii of medial balls: a ball that touches S in a point and has no point of S inside. The
/// smaller of the two at a point, one on each side, is the local bound of M&S (14), min(1 / M_S,
/// W): at most the radius of curvature where S bends, and at most half the distance to a sheet that
/// faces S.
struct MedialRadii {
    /// Per sample, sorted; kInfinity where the ball is unbounded.
    std::vector<double> radius;
    /// The same, only of balls that end at a sheet facing the point, by the normals: half the
    /// distance to it.
    std::vector<double> facing;

    /// The value below which a share of the samples lies; kInfinity if there are none.
    static double quantile(const std::vector<double>& sorted, double share);
    /// The share of the samples below a value; 0 if there are none.
    static double shareBelow(const std::vector<double>& sorted, double value);
};

/// Finds the balls by shrinking them around the nearest point found inside (Ma, Bae and Choi, 3D
/// medial axis point approximation using nearest neighbors and the normal field, 2012).
///
/// Turns of the surface by less than 40 degrees within a ball are ignored, so that facets of a mesh
/// and scatter of points are no bends. Sharper edges are bends: the ball of a nearby point is as
/// small as its distance from the edge.
/// @param points   of S, evenly spread
/// @param normals  of length 1, one per point, of one side of each sheet
/// @param samples  most points to be sampled, evenly spread over their order
/// @return in the points' unit, accurate to a twentieth and to the spacing of the points
/// Time O((n + samples) log n), in parallel; about 60 bytes of working memory per point.
MedialRadii medialRadii(const std::vector<Vec3d>& points, const std::vector<Vec3d>& normals,
                        std::size_t samples = 4000);

}  // namespace igeo
