/// The clearance beside a surface.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// Radii of medial balls: a ball that touches S in a point and holds nothing of S. The smaller of
/// the two that a point has, one on each side, is the local bound of M&S (14), min(1 / M_S, W): it
/// is at most the radius of curvature where S bends and half the distance to a sheet that faces S.
struct MedialRadii {
    /// Per sample, sorted; kInfinity where nothing stops the ball.
    std::vector<double> radius;
    /// The same, of balls only that end at a sheet that faces the point, by the normals: half the
    /// distance to it.
    std::vector<double> facing;

    /// What a share of the samples falls below; kInfinity if there are none.
    static double quantile(const std::vector<double>& sorted, double share);
};

/// Finds the balls by shrinking them about the nearest point found inside (Ma, Bae and Choi, 3D
/// medial axis point approximation using nearest neighbors and the normal field, 2012).
///
/// Turns of the surface by less than 40 degrees within a ball do not count, so that facets of a
/// mesh and scatter of points are no bends; sharper edges are, with balls that get as small as the
/// point is near.
/// @param points   of S, evenly spread
/// @param normals  of length 1, one per point, of one side of each sheet
/// @param samples  how many points are asked at most, evenly spread over their order
/// @return in the points' unit, good to a twentieth and to the spacing of the points
/// Time O((n + samples) log n), in parallel; about 60 bytes per point while it works.
MedialRadii medialRadii(const std::vector<Vec3d>& points, const std::vector<Vec3d>& normals,
                        std::size_t samples = 4000);

}  // namespace igeo
