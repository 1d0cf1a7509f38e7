/// The distance from seeds in world units, geodesics and grids.
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/march/field.h>
#include <igeo/metric/unresolved_costs.h>
#include <igeo/path/trace.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/samples.h>
#include <igeo/results/vertex_values.h>
#include <igeo/surface.h>

#include <memory>
#include <string>
#include <vector>

namespace igeo {

/// @throws Error  InvalidArgument for a surface that is no mesh
const TriangleMesh& requireMesh(const Surface& surface);

/// A geodesic on the surface, in world units.
struct Polyline {
    PathStatus status = PathStatus::Unreachable;
    SnappedPoint start;             ///< the point at which it starts
    std::vector<Vec3d> points;      ///< on the surface, from the start on; empty if Unreachable
    std::vector<Vec3d> normals;     ///< unit normals of the surface at the points (normalAt)
    std::vector<double> arcLength;  ///< from the start, at each point
    std::vector<double> distance;   ///< to the seed, at each point, world units times weight
    /// Of a curve through points: its vertices at these points, where it may turn.
    std::vector<std::size_t> corners;
    double length = 0;
    double weightedLength = 0;         ///< by the metric; the same where there is no weight
    double startDistance = kInfinity;  ///< distance at the start, world units times weight

    std::size_t seed = 0;  ///< index of the seed reached, if Reached
    SnappedPoint end;      ///< that seed; of a curve or region the point where the path ends
    /// Distance at which the seed's front starts, world units times weight
    double endDistance = 0;
    std::size_t roundedBends = 0;  ///< of a walk: Path::roundedBends
    std::size_t closeCorners = 0;  ///< of a walk: Path::closeCorners
};

/// A path of the engine in world units, without its `end`.
/// @param path  with normals (addNormals)
Polyline inWorld(const Path& path, const Similarity& transform);

/// Moves the points by a length along the normals of the surface, world units; a negative length
/// moves them to the other side. Lengths and distances stay those on the surface.
void moveAlongNormals(Polyline& line, double by);

/// Distance, source and gradient at a point of the surface.
struct PointValue {
    double distance = kInfinity;      ///< as Distance::at
    std::uint32_t source = kNoLabel;  ///< the nearest source; kNoLabel: not reached
    Vec3d gradient{};  ///< of the distance along the surface, world, as long as the weight there; 0
                       ///< where unreached and at a seed
};

/// The result of GeodesicSolver::distance. Cheap to copy.
class Distance {
public:
    Distance(Surface surface, BandWidth width, std::shared_ptr<const Band> band, bool wholeBand,
             Field field, std::vector<SurfacePoint> targets, double maxSnap,
             std::shared_ptr<CostWarnings> costs = std::make_shared<CostWarnings>());

    /// The distance at the point of the surface nearest to a position in the world: world units
    /// times weight, +infinity where unreached, negative where the seeds enclose it (isSigned).
    /// @throws Error  InvalidArgument where the surface is farther away than the solver's maxSnap
    double at(const Vec3d& pWorld) const;
    /// The same at many points, with the gradient and the source. In parallel.
    /// @throws Error  as `at`, with the number of the point; Cancelled
    std::vector<PointValue> valuesAt(const std::vector<Vec3d>& pWorld,
                                     Progress& progress = Progress::none()) const;
    /// The geodesic from there to the nearest seed.
    /// @param straighten  relax it to a locally shortest curve, free of the march's error
    Polyline path(const Vec3d& pWorld, bool straighten = false) const;
    /// The geodesics from the targets of the march, in parallel.
    std::vector<Polyline> paths(bool straighten = false,
                                Progress& progress = Progress::none()) const;

    /// The distances of the targets of the march, in their order: as `at`, without a sign; NaN for
    /// a skipped target (QueryRules::skipOffSurface).
    std::vector<double> atTargets() const;
    /// The distance and the nearest source at the vertices of the mesh, numbered as in its file.
    /// @throws Error  InvalidArgument for a surface that is no mesh
    VertexValues atVertices(Progress& progress = Progress::none()) const;
    /// igeo::costWarnings; of the whole surface found once per solver.
    std::vector<std::string> costWarnings() const;
    /// The distances of jet at its foot points (samplesOf).
    /// @throws Error  InvalidArgument for another scheme
    Samples samples() const;
    /// Distances from each seed or group of seeds to each target, or between the seeds if the march
    /// had no target; one march for each source (distances).
    DistanceMatrix matrix(Progress& progress = Progress::none()) const;

    /// A grid in world units (distanceGrid), active where the distance is known. Of `jet` it is
    /// made leaf by leaf without `field()`, unless that was called before: to get both, call
    /// `field()` first.
    /// @param name  empty: <name of the surface's grid>_geodesic
    openvdb::FloatGrid::Ptr grid(const std::string& name = {}) const;
    /// The surface as triangles that carry the distance.
    SurfaceMesh mesh(Progress& progress = Progress::none()) const;
    /// The same in voxels and index space: the input of isolines, cells and mesh writers.
    SurfaceMesh indexMesh(Progress& progress = Progress::none()) const;
    /// The surface as a level set.
    const LevelSet& levelSet(Progress& progress = Progress::none()) const;

    double largest() const;       ///< the largest distance reached, world units times weight
    std::size_t reached() const;  ///< voxels of the band with a distance
    /// The extent of the field, voxels. Its nodes are those of the core until `grid` or `field()`
    /// has extended the field to the band, which obstacles with nodes behind them make it do.
    Extent extent() const;

    /// The field as the march left it, to be read at points; with its seeds, scheme and metric.
    std::shared_ptr<const Field> marched() const;
    /// The field for reading along `count` paths: on the whole band where that is cheaper.
    std::shared_ptr<const Field> forPaths(std::size_t count) const;
    /// The field on the whole band: voxels, index space. Of `jet` the first call extends it from
    /// the core.
    const Field& field() const;
    const Band& band() const { return *band_; }
    bool ofWholeSurface() const { return wholeBand_; }  ///< or of the part around the seeds
    const std::vector<SurfacePoint>& seeds() const;
    const std::vector<SurfacePoint>& targets() const { return targets_; }
    const Surface& surface() const { return surface_; }

private:
    /// The field of the march, and the extended one.
    struct Fields;

    /// The field for reading at `count` points: extended where that is cheaper than reading each
    /// point from the core.
    std::shared_ptr<const Field> forPoints(std::size_t count) const;
    SurfacePoint nearest(const Vec3d& pWorld, const std::string& what = "the point") const;
    PointValue valueAt(const Field& field, const SurfacePoint& p) const;
    Polyline polylineOf(const Field& field, const Path& path) const;

    Surface surface_;
    BandWidth width_;
    std::shared_ptr<const Band> band_;
    bool wholeBand_;
    std::shared_ptr<Fields> fields_;
    std::vector<SurfacePoint> targets_;
    double maxSnap_;
    std::shared_ptr<CostWarnings> costs_;
};

}  // namespace igeo
