// Level sets of shapes whose signed distance is known exactly.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <string>
#include <vector>

namespace igeo::test {

/// Where tests put shapes: in the middle of the unit cube, or away from every plane of symmetry of
/// the lattice.
inline const openvdb::Vec3d kCenter(0.5, 0.5, 0.5), kOffLattice(0.137, -0.291, 0.413);

/// Distance in world units as a function of the world position; changes by at most the distance
/// between two points (Lipschitz constant 1), which makeLevelSet relies on to skip empty space.
using SignedDistance = std::function<double(const openvdb::Vec3d& pWorld)>;

/// A surface given by its exact signed distance.
struct Shape {
    std::string name;
    SignedDistance sdf;     ///< negative inside
    openvdb::BBoxd bounds;  ///< contains the surface, world units
    bool closed = true;     ///< the surface separates an inside from an outside
    SignedDistance domain;  ///< if set, voxels are active only where this is negative
};

Shape sphere(const openvdb::Vec3d& center, double radius);

/// Torus about the z axis through `center`: circle of radius `majorRadius`, tube `minorRadius`.
Shape torus(const openvdb::Vec3d& center, double majorRadius, double minorRadius);

/// Ellipsoid with half axes along x, y, z.
Shape ellipsoid(const openvdb::Vec3d& center, const openvdb::Vec3d& halfAxes);

/// The point of its surface nearest to p, which is not on a plane of symmetry inside.
openvdb::Vec3d nearestOnEllipsoid(const openvdb::Vec3d& center, const openvdb::Vec3d& halfAxes,
                                  const openvdb::Vec3d& p);

/// Tube around the trefoil knot scale (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t).
///
/// The knot's smallest radius of curvature is 1.28 scale and its strands keep 1.21 scale apart, so
/// the tube is embedded for tubeRadius < 0.60 scale. The distance is exact to 1e-12 scale.
Shape trefoilTube(const openvdb::Vec3d& center, double scale, double tubeRadius);

/// Box with sharp edges; `halfSize` is half of each side.
Shape box(const openvdb::Vec3d& center, const openvdb::Vec3d& halfSize);

/// Box of half sides `halfSize` whose edges and corners are rounded with `radius`.
Shape roundedBox(const openvdb::Vec3d& center, const openvdb::Vec3d& halfSize, double radius);

/// Two spheres apart from each other: a surface of two pieces.
Shape twoSpheres(const openvdb::Vec3d& center0, double radius0, const openvdb::Vec3d& center1,
                 double radius1);

/// Closed slab of the given thickness about the plane z = center.z, with a half-round rim.
/// @param halfX, halfY  half of the outer sides, rim included
Shape thinSheet(const openvdb::Vec3d& center, double halfX, double halfY, double thickness);

/// The plane through `center`, in a square of side `size`: a surface cut by the volume's edge.
Shape planePatch(const openvdb::Vec3d& center, const openvdb::Vec3d& normal, double size);

/// Cylinder about the z axis with flat ends and sharp rims.
Shape cylinder(const openvdb::Vec3d& center, double radius, double halfHeight);

/// A block with sides along the axes, added to those before it or cut out of them.
struct Block {
    openvdb::Vec3d low, high;
    bool isCut = false;
};

/// What blocks make together: a part with plane faces, all at right angles.
Shape partOf(const std::vector<Block>& blocks);

/// Cone about the z axis with flat ends: radius `wide` at the lower one, `narrow` at the upper.
Shape frustum(const openvdb::Vec3d& center, double wide, double narrow, double halfHeight);

/// worldFromIndex: scale by `dx`, turn by `angleDegrees` about `axis` (right-handed), translate.
openvdb::math::Transform::Ptr rotatedTransform(double dx, const openvdb::Vec3d& axis,
                                               double angleDegrees,
                                               const openvdb::Vec3d& translation);

/// Samples the signed distance at the voxel centers worldFromIndex(ijk).
///
/// Active where |psi| < halfWidthVoxels dx; inactive values are +-background = +-halfWidthVoxels
/// dx with the sign of psi (outside the leaves of an open shape: +background). The class is
/// GRID_LEVEL_SET. The transform may be any affine one; dx is the length of its first voxel side.
/// The result does not depend on the number of threads.
openvdb::FloatGrid::Ptr makeLevelSet(const Shape& shape, const openvdb::math::Transform& transform,
                                     double halfWidthVoxels, const std::string& name = "psi");

/// The same with the voxel centers at dx ijk.
openvdb::FloatGrid::Ptr makeLevelSet(const Shape& shape, double dx, double halfWidthVoxels,
                                     const std::string& name = "psi");

/// The same in double precision.
openvdb::DoubleGrid::Ptr makeDoubleLevelSet(const Shape& shape,
                                            const openvdb::math::Transform& transform,
                                            double halfWidthVoxels,
                                            const std::string& name = "psi");

}  // namespace igeo::test
