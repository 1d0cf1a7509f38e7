/// The distance from seeds, in world units, and the ways to read it.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/trace.h>
#include <igeo/surface.h>

#include <memory>
#include <string>
#include <vector>

namespace igeo {

/// A geodesic from a point to the seed it is nearest to, in world units.
struct Polyline {
    PathStatus status = PathStatus::Unreachable;
    std::vector<Vec3d> points;     ///< from the point on, on the surface; empty if Unreachable
    std::vector<double> distance;  ///< to the seed at each, world units times weight
    double length = 0;             ///< world units
    double weightedLength = 0;     ///< by the metric; the same where there is no weight
    std::size_t seed = 0;          ///< index of the seed reached, if Reached
};

/// What GeodesicSolver::distance found. Cheap to copy.
class Distance {
public:
    Distance(Surface surface, BandWidth width, std::shared_ptr<const Band> band, bool wholeBand,
             Field field, std::vector<SurfacePoint> targets, double maxSnap);

    /// The distance at the point of the surface nearest to a position in the world: world units
    /// times weight, +infinity where unreached, negative where the seeds enclose it (isSigned).
    /// @throws Error  InvalidArgument where the surface is farther away than the solver's maxSnap
    double at(const Vec3d& pWorld) const;
    /// The geodesic from there to the nearest seed.
    /// @param straighten  relax it to a locally shortest curve, free of the march's error
    Polyline path(const Vec3d& pWorld, bool straighten = false) const;
    /// The same for the targets that the march was given, side by side.
    std::vector<Path> paths(bool straighten = false, Progress& progress = Progress::none()) const;

    /// As a grid in world units (distanceGrid), active where the distance is known.
    /// @param name  empty: <name of the surface's grid>_geodesic
    openvdb::FloatGrid::Ptr grid(const std::string& name = {}) const;
    /// The surface as triangles that carry the distance; index space.
    SurfaceMesh mesh(Progress& progress = Progress::none()) const;
    /// The surface as a level set.
    const LevelSet& levelSet(Progress& progress = Progress::none()) const;

    double largest() const;  ///< the largest distance reached, world units times weight

    /// As the march left it: voxels, index space.
    const Field& field() const { return *field_; }
    const Band& band() const { return *band_; }
    bool ofWholeSurface() const { return wholeBand_; }  ///< or of the part around the seeds
    const std::vector<SurfacePoint>& seeds() const { return field_->seeds; }
    const std::vector<SurfacePoint>& targets() const { return targets_; }
    const Surface& surface() const { return surface_; }

private:
    SurfacePoint nearest(const Vec3d& pWorld) const;

    Surface surface_;
    BandWidth width_;
    std::shared_ptr<const Band> band_;
    bool wholeBand_;
    std::shared_ptr<const Field> field_;
    std::vector<SurfacePoint> targets_;
    double maxSnap_;
};

}  // namespace igeo
