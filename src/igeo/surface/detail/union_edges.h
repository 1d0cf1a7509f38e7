/// psi beside the edges of unions and intersections, made a distance again. Internal.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

namespace igeo {

/// A voxel and its distance to the edge, in world units, with the sign of psi.
struct EdgeDistance {
    openvdb::Coord at;
    float distance;
};

/// Distances to the edges in which the surfaces of two level sets meet, where psi is the lesser of
/// both.
///
/// min(a, b) is no distance inside of the edge of a union: the foot point on the nearer surface
/// lies inside of the other body, and the nearest point of the union is on the edge. Where the
/// faces meet at a small angle such foot points make a sheet between the bodies that is no part of
/// S, and no node joins the faces. The same holds for max(a, b) on the other side of S. A voxel
/// counts if it or one beside it has a kink or counts, and
/// - the plane that is as far from it as psi has it has its foot point y deeper than 0.05 voxels
///   inside of another plane, whose normal opposes (Band::kOtherSheet); each plane lies above psi
///   at the voxel of the other one, as in a union;
/// - y, and foot points on all other planes as far, lie in balls around voxels, as large as |psi|
///   there: in these a distance has no S;
/// - the line in which both planes meet is the nearest part of both, and farther than |psi|. Where
///   faces are curved, planes beside the line are taken in its stead, in four rounds.
/// @param kinks      voxels where |psi| may have a sharp convex kink
/// @param halfWidth  world units: no distance is larger
/// Time O(kinks and voxels found), in parallel. The order of kinks has no effect.
std::vector<EdgeDistance> distancesToUnionEdges(const openvdb::FloatGrid& psi,
                                                const std::vector<openvdb::Coord>& kinks,
                                                double halfWidth);

}  // namespace igeo
