/// The logarithmic map: the surface in polar coordinates around a seed.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/base/types.h>
#include <igeo/march/field.h>

#include <vector>

namespace igeo {

/// The logarithmic map: the position of a point relative to its nearest seed, as a vector in the
/// seed's tangent plane. Its length is the distance; its direction is that of the shortest path at
/// the seed, also where the path bends later: around a corner, or over a jump of the weight.
struct LogMap {
    /// The plane's axes, index space: orthonormal, with u x v the normal of S in world
    /// space, which may mirror.
    struct Frame {
        Vec3d u, v;
    };
    std::vector<Frame> frames;  ///< per seed
    /// Per band node, of its foot point: d (cos, sin) of the angle from u toward v, voxels times
    /// weight; NaN: unreached, or no neighbor with a direction
    std::vector<Vec2f> position;
};

/// The logarithmic map of a field of marchJet, around the nearest seed of each node.
///
/// The direction at the seed is constant along geodesics. Where these run straight it is found by a
/// frame, transported from the seed outward, parallel along every geodesic: a node's angle is that
/// of its gradient in its frame. The gradient's error does not accumulate, and the frame is smooth,
/// even at the seed, where angles are not. In order of distance each node of the core takes the
/// frame e and its change w along the front from lower neighbors, by least squares over the
/// equations
///     angle(e_i) - w_i (t_i . a_ij) / 2 = angle(P e_j) + w_j (t_j . a_ij) / 2,
/// the trapezoid rule along the chord a_ij, with P the least rotation of one tangent plane into the
/// other and t across the geodesics; a weight g adds a_ij x (grad ln g_i + grad ln g_j) / 2 on the
/// right (the connection of a conformal metric). Beside a rim, an obstacle, a crease, a seam or a
/// jump of the weight geodesics may bend, and no frame passes. There, and at all nodes behind, the
/// direction itself is carried: that of node i is that of neighbor j, turned by
///     2 asin(b_ij (s_i + s_j) / 4),
/// with b_ij how far the geodesic through j passes beside i, and s the change of the direction
/// along the front, 0 in the shadow of a corner. A geodesic bends where the plane fronts of i and j
/// agree: Snell's law, and the corner. The angles are then fitted by a line along the front over
/// the neighbors of each node, in which outliers get small weights. The other nodes take theirs
/// from the lines of the core around. Second order where geodesics run straight, first order behind
/// bends.
/// @param reference index space; u is its part along S at each seed. If it is zero or normal to S,
///                  the coordinate axis farthest from the normal is used
/// @throws Error  InvalidArgument for a field that is not of marchJet, of a tensor, or of seeds
///         that are more than points; Cancelled through `progress`
/// At the cut locus a node has the direction of one of its shortest geodesics. Time O(n log n),
/// about twice the work of the march, a good part of it on one thread.
/// Error: some 0.01 degrees on average at radii of 40 voxels (tests/accuracy/test_log_map.cpp);
/// behind corners and jumps of the weight about the angle at which the seed sees a voxel there, 1
/// to 3 degrees at 30 to 40 voxels (test_log_map_bends.cpp).
LogMap logMap(const Field& field, const Vec3d& reference = {},
              Progress& progress = Progress::none());

/// The same at a point of S: the direction is blended from the nodes around it that one front
/// reached; the length is the distance there. NaN where that is unknown. Time O(1).
/// @param map  of the field
Vec2f positionAt(const Field& field, const LogMap& map, const SurfacePoint& p);

}  // namespace igeo
