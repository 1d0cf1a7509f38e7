/// Fills a Band from a point cloud.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/point_surface.h>

namespace igeo {

enum class PointBandKind {
    Fits,  ///< voxels with |psi| < h, psi the distance to the fitted surface: for `jet`
    Balls  ///< voxels nearer than h to a point, as in M&S 5.2: for `godunov`
};

/// The default in world units. Fits: half the median spacing, which resolves the surface where it
/// bends within two or three points. Balls: the median spacing; finer voxels gain little, because
/// balls must not shrink with them.
double defaultVoxelSize(const CloudDensity& density, PointBandKind kind);

/// Half the thickness of the band, voxels. Fits: sqrt(3), M&S (14). Balls: sqrt(3 + (s / dx)^2)
/// with s the 99th percentile of the spacing, so that a ball extends sqrt(3) voxels off the surface
/// where points are s apart.
double defaultBandWidth(const CloudDensity& density, PointBandKind kind, double dx);

/// M&S (14) for such a band: from defaultBandWidth() to below the radius of curvature (95th
/// percentile) and half the distance between sheets that face each other (1st percentile,
/// MedialRadii). Time O(n log n).
BandBounds bandBounds(const PointSurface& surface, PointBandKind kind, double dx);

/// Numbers the voxels of the band on the lattice dx Z^3 and computes their foot points and normals.
///
/// Fits: foot point and normal are those of PointSurface::project, psi the signed distance; nodes
/// exist only where there are points on all sides of the foot point. `jet` and all readers of psi
/// work as on a level set.
///
/// Balls: the union of the balls of radius h around the points. The foot point is the nearest
/// point, the normal that of its fit, and psi the height over its tangent plane, which |x - y|
/// bounds: the paper's unsigned distance would have no zeros to put seeds and paths on. The voxels
/// of the band are exactly those of the paper, with the round ends of rims.
/// @param dx  voxel size, world units: from an eighth of the median spacing to an eighth of the
///            cloud's longest side
/// @param h   voxels; Fits: at least sqrt(3)/2; Balls: at least s / dx, s as above
/// @throws Error  InvalidArgument for dx or h out of range, BadInput for too many voxels, or
///         coordinates beyond 2^30 voxels; Cancelled
/// Time O(voxels within 3 spacings of the surface), in parallel; some 5 microseconds per node
/// measured. 35 bytes per node, twice that while it works.
Band bandFromPoints(const PointSurface& surface, PointBandKind kind, double dx, double h,
                    Progress& progress = Progress::none());

}  // namespace igeo
