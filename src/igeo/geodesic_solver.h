/// Geodesic distances on a surface: one solver, many seeds.
#pragma once

#include <igeo/base/seed.h>
#include <igeo/base/space.h>
#include <igeo/distance.h>
#include <igeo/metric/metric_definition.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/pair_distances.h>
#include <igeo/results/vertex_values.h>
#include <igeo/surface.h>

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace igeo {

/// The space and the snap limit of points, and the memory limit of a march.
struct QueryRules {
    /// How far points may be from the surface, world units; negative: SurfaceFacts::snap
    double maxSnap = -1;
    Space space = Space::World;
    double memoryLimit = kInfinity;  ///< most bytes of a march of the whole surface
    /// Targets and pairs with a point beyond maxSnap get no distance (NaN,
    /// SnappedPoint::offSurface) instead of an error.
    bool skipOffSurface = false;
};

struct SolverOptions {
    Scheme scheme = Scheme::Jet;
    int order = 2;            ///< of godunov's differences, 1 or 2
    double band = 0;          ///< h, world units; 0: the one of least error
    double bandVoxels = 0;    ///< the same in voxels
    MetricDefinition metric;  ///< Euclidean unless filled
    QueryRules rules;
};

/// Points that form one seed: the distance from a group is that from its nearest point.
struct SeedGroup {
    std::string name;  ///< for messages and results; may be empty
    std::vector<Seed> points;
};

/// Where the distance is 0. The sources are its points, groups, curves, regions and samples; labels
/// number them in this order.
struct Seeds {
    std::vector<Seed> points;
    std::vector<SeedGroup> groups;
    std::vector<Curve> curves;  ///< `start` in world units
    /// Each is the part of the surface inside
    std::vector<std::shared_ptr<const Obstacles>> regions;
    /// Names of the curves and then of the regions in messages; may be empty.
    std::vector<std::string> names = {};
    std::size_t samples = 0;  ///< number of further seeds, each as far as possible from all others
    /// Negative distances inside regions, or on the smaller side of closed curves.
    bool isSigned = false;

    Seeds() = default;
    Seeds(std::vector<Seed> p) : points(std::move(p)) {}
    Seeds(std::initializer_list<Seed> p) : points(p) {}

    /// Whether there are curves or regions.
    bool extended() const { return !curves.empty() || !regions.empty(); }
    bool empty() const { return points.empty() && groups.empty() && !extended() && samples == 0; }
    /// @param dx  voxel size
    /// @throws Error  InvalidArgument without seeds, for start values below 0 or beyond 1e12
    ///         voxels, and for `isSigned` with seeds other than only curves or only regions
    void requireUsable(double dx) const;
    /// Each source by itself, without the samples, which the march finds.
    std::vector<Seeds> sources() const;
};

/// The limit of a march, and its targets.
struct MarchLimits {
    double maxDistance = kInfinity;  ///< world units times weight
    std::vector<Vec3d> targets = {};
    bool stopAtTargets = false;  ///< stop once all targets are reached
};

/// The distance between two points, in world units.
struct PairDistance {
    SnappedPoint source, target;
    /// World units times weight; +infinity: no path joins the points; NaN: one of them is off the
    /// surface.
    double distance = kInfinity;
    /// From source to target, by pairPaths; `distance` at each vertex is the distance from the
    /// source.
    Polyline path = {};

    bool isSkipped() const { return source.offSurface || target.offSurface; }
    /// "the source is off the surface", or the target; empty if neither is.
    std::string reason() const;
};

/// The width of the band that a solver would use.
/// @throws Error  as Surface::bandWidth
BandWidth bandWidth(const Surface& surface, const SolverOptions& options,
                    Progress& progress = Progress::none());

/// Everything that does not depend on the seeds: the band, the metric on it, their bounds. Cheap to
/// copy; several threads may use it at once.
class GeodesicSolver {
public:
    /// @throws Error  as Surface::bandWidth; InvalidArgument for an order or a metric out of range
    explicit GeodesicSolver(Surface surface, SolverOptions options = {},
                            Progress& progress = Progress::none());

    /// The same solver, band and metric included, with other rules.
    GeodesicSolver with(const QueryRules& rules) const;

    /// The distance from seeds: second order in the voxel size with `jet`.
    ///
    /// Where a limit keeps the march near the seeds, only the band near them is made. With a
    /// maximal distance this takes one march. With targets to stop at, the reach doubles until all
    /// are found, which costs at most twice the last march. No path is shorter than the straight
    /// line at the least weight, so the result equals that of a march of the whole surface.
    /// @throws Error  InvalidArgument without seeds, for a point farther from the surface than
    ///         maxSnap or inside an obstacle, for `isSigned` with other seeds; signsOfCurves,
    ///         marchJet, marchGodunov; Cancelled
    /// Time O(n) with jet, O(n log n) with godunov; n: nodes of the band visited. The same bits for
    /// any number of threads.
    Distance distance(const Seeds& seeds, const MarchLimits& limits = {},
                      Progress& progress = Progress::none()) const;

    /// Distances from several seeds, each by itself, at the vertices of the mesh. Column k has the
    /// values of distance(seeds[k], limits).atVertices() and the name of its group, or its number
    /// k. The marches run side by side, with at most one field per thread in memory.
    /// @throws Error  as distance; InvalidArgument for a surface that is no mesh
    std::vector<VertexColumn> atVertices(const std::vector<Seeds>& seeds,
                                         const MarchLimits& limits = {},
                                         Progress& progress = Progress::none()) const;

    /// Distances between pairs of points by `jet`, each on the part of the surface around it
    /// (pair_distances.h).
    /// @throws Error  InvalidArgument for a point farther from the surface than maxSnap; as
    ///         marchJet
    std::vector<PairDistance> pairs(const std::vector<Vec3d>& sources,
                                    const std::vector<Vec3d>& targets,
                                    Progress& progress = Progress::none()) const;
    /// The same with the geodesics (tracePath).
    /// @param straighten  relax them to locally shortest curves, free of the march's error
    std::vector<PairDistance> pairPaths(const std::vector<Vec3d>& sources,
                                        const std::vector<Vec3d>& targets, bool straighten = false,
                                        Progress& progress = Progress::none()) const;

    /// The curve through points in their order. Each leg is the straightened geodesic between two
    /// of them (pairPaths), so the curve turns at the points in between.
    /// @param closed  a leg leads from the last point to the first; the last vertex repeats the
    ///                first
    /// @param whole   relax the curve as a whole (straightenWhole): the points in between then only
    ///                select how the curve winds around the surface, and a closed curve passes none
    ///                of them
    /// @return `distance` at each vertex is the cost from the start. Without vertices: Unreachable
    ///         where no path joins two consecutive points; Stalled where a closed curve contracts
    ///         to a point, so that there is no closed geodesic
    /// @throws Error  InvalidArgument for fewer than two points, three for a closed curve; as pairs
    Polyline through(const std::vector<Vec3d>& points, bool closed = false, bool whole = false,
                     Progress& progress = Progress::none()) const;

    /// A polyline of this solver with its vertices at equal lengths along it, counted from its
    /// start and again from each corner; the last segment before a corner and before the end is
    /// shorter. The vertices lie on the given polyline, so the new one cuts across the edges of a
    /// mesh. `length` stays that of the given one.
    /// @param step  world units
    /// @throws Error  InvalidArgument for a step not above 0, or more than 1e7 vertices
    Polyline resampled(const Polyline& line, double step) const;

    /// The geodesic that starts at a point in a direction (shoot), on the band around it, or on
    /// that of the whole surface if it exists.
    /// @param length  world units; voxels with Space::Index
    /// @throws Error  as shoot; InvalidArgument for a point farther from the surface than maxSnap
    Polyline shoot(const Vec3d& from, const Vec3d& direction, double length,
                   Progress& progress = Progress::none()) const;

    /// A result without a march: all is unreached.
    /// @param whole  with the band of the whole surface, else without nodes
    Distance unreached(bool whole, Progress& progress = Progress::none()) const;

    const Surface& surface() const;
    const SolverOptions& options() const;
    const BandWidth& bandWidth() const;
    double maxSnap() const;  ///< world units
    /// The band of the whole surface.
    /// @throws Error  InvalidArgument where it would take more memory than allowed
    std::shared_ptr<const Band> wholeBand(Progress& progress = Progress::none()) const;
    /// The metric on it; null where it is Euclidean.
    MetricPtr wholeMetric(Progress& progress = Progress::none()) const;
    /// igeo::costWarnings on it, found once.
    std::vector<std::string> costWarnings(Progress& progress = Progress::none()) const;
    Vec3d indexOf(const Vec3d& position) const;
    /// @param what  names the point in the message
    /// @throws Error  InvalidArgument for a point farther from the surface than maxSnap, with the
    ///         nearest point, the box of the surface and the likely mistake; as wholeBand
    void requireNear(const Vec3d& position, const std::string& what) const;

    struct Setup;

private:
    std::shared_ptr<const Setup> setup_;
};

}  // namespace igeo
