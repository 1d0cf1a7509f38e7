// Geodesic distances known in closed form; torus_geodesics.h has those of the torus.
#pragma once

#include <openvdb/openvdb.h>

namespace igeo::test {

/// Great-circle distance between the directions of p and q from `center`; accurate to rounding
/// for all angles, 0 and pi included.
double geodesicOnSphere(const openvdb::Vec3d& center, double radius, const openvdb::Vec3d& p,
                        const openvdb::Vec3d& q);

/// Distance on the side of an endless cylinder about the z axis through `center` (unrolled). On a
/// capped one this is the distance while no path over an end is shorter.
double geodesicOnCylinder(const openvdb::Vec3d& center, double radius, const openvdb::Vec3d& p,
                          const openvdb::Vec3d& q);

/// Distance on the side of a cone with flat ends (frustum() of shapes.h; `wide` at the lower end):
/// straight in the unrolled sector. NaN where a path over an end might be shorter.
///
/// Let s be the distance from the apex. It grows by at most the length of a path, so a path that
/// touches the rim at s = s_end takes |s_end - s_p| + |s_end - s_q| at least. Where the straight
/// segment is shorter than that for both rims, it stays on the side, and nothing is shorter.
double geodesicOnConeSide(const openvdb::Vec3d& center, double wide, double narrow,
                          double halfHeight, const openvdb::Vec3d& p, const openvdb::Vec3d& q);

/// Distance around the z axis of a rounded box (roundedBox() of shapes.h). NaN where a path over an
/// end might be shorter, and at the ends.
///
/// The belt |z| <= c of four faces and four quarter cylinders, c = halfSize.z - radius, unrolls
/// into a strip, in which the straight segment is the shortest path. One that leaves the belt at
/// z = +-c takes 2 c -+ (p.z + q.z) at least.
double geodesicAroundRoundedBox(const openvdb::Vec3d& center, const openvdb::Vec3d& halfSize,
                                double radius, const openvdb::Vec3d& p, const openvdb::Vec3d& q);

/// Distance between two points on the surface of a sharp box; exact for all pairs.
///
/// A shortest path on a convex polyhedron crosses no face twice and is straight once the faces it
/// crosses are laid into one plane. The result is the minimum over all sequences of distinct faces
/// from p's face to q's whose unfolded straight segment stays inside them.
/// @param p, q  on the surface within 1e-9 of the box's size
double geodesicOnBox(const openvdb::Vec3d& center, const openvdb::Vec3d& halfSize,
                     const openvdb::Vec3d& p, const openvdb::Vec3d& q);

}  // namespace igeo::test
