#include <igeo/distance.h>

#include <igeo/band/detail/snap.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/signed_field.h>
#include <igeo/path/curve_normals.h>
#include <igeo/path/straighten.h>

#include <limits>
#include <mutex>
#include <optional>
#include <utility>

namespace igeo {

namespace {

/// Unreached beyond the limit of the march.
double withinLimit(const Field& field, double distance) {
    return distance <= field.greatest ? distance : kInfinity;
}
/// Voxels times weight.
double distanceAt(const Field& field, const SurfacePoint& p) {
    return withinLimit(field, sampleDistance(field, p.pIndex, Vec3d(field.band->normal[p.node])));
}

}  // namespace

const TriangleMesh& requireMesh(const Surface& surface) {
    if (const TriangleMesh* mesh = surface.triangles()) return *mesh;
    throw Error(Error::Kind::InvalidArgument,
                surface.facts().name + " is no mesh, and has no vertices",
                "take the surface as triangles, which has vertices with distances");
}

Polyline inWorld(const Path& path, const Similarity& t) {
    Polyline line;
    line.status = path.status;
    line.start = inWorld(path.target, t);
    for (const PathVertex& v : path.vertices) {
        line.points.push_back(t.worldFromIndex(v.pIndex));
        line.normals.push_back(t.worldFromIndexDirection(v.normal));
        line.arcLength.push_back(v.arcLength * t.dx);
        line.distance.push_back(v.distance * t.dx);
    }
    line.length = path.length * t.dx;
    line.weightedLength = path.weightedLength * t.dx;
    line.startDistance = path.distance * t.dx;
    line.roundedBends = path.roundedBends;
    line.closeCorners = path.closeCorners;
    return line;
}

void moveAlongNormals(Polyline& line, double by) {
    for (std::size_t k = 0; k < line.points.size(); ++k) line.points[k] += by * line.normals[k];
}

/// Readers at points use the field of the march, until a reader of the whole band extends it.
struct Distance::Fields {
    explicit Fields(Field f)
        : seeds(f.seeds), marched(std::make_shared<const Field>(std::move(f))) {
        if (!marched->core) whole = marched;
    }
    const std::vector<SurfacePoint> seeds;
    std::mutex mutex;
    std::shared_ptr<const Field> marched, whole;
    const std::shared_ptr<const Field>& latest() const { return whole ? whole : marched; }
    std::optional<Extent> extent;   ///< of the whole band, if `grid` has found it
    std::optional<double> largest;  ///< on the whole band
};

Distance::Distance(Surface surface, BandWidth width, std::shared_ptr<const Band> band,
                   bool wholeBand, Field field, std::vector<SurfacePoint> targets, double maxSnap,
                   std::shared_ptr<CostWarnings> costs)
    : surface_(std::move(surface)),
      width_(std::move(width)),
      band_(std::move(band)),
      wholeBand_(wholeBand),
      fields_(std::make_shared<Fields>(std::move(field))),
      targets_(std::move(targets)),
      maxSnap_(maxSnap),
      costs_(std::move(costs)) {}

const Field& Distance::field() const {
    const std::lock_guard<std::mutex> lock(fields_->mutex);
    if (!fields_->whole) {
        Field whole = *fields_->marched;
        extendToBand(whole);
        fields_->whole = std::make_shared<const Field>(std::move(whole));
    }
    return *fields_->whole;
}
std::shared_ptr<const Field> Distance::forPoints(std::size_t count) const {
    constexpr std::size_t kCorners = 8;
    if (count * kCorners > band_->size()) field();
    const std::lock_guard<std::mutex> lock(fields_->mutex);
    return fields_->latest();
}
std::shared_ptr<const Field> Distance::marched() const { return fields_->marched; }
const std::vector<SurfacePoint>& Distance::seeds() const { return fields_->seeds; }

SurfacePoint Distance::nearest(const Vec3d& pWorld, const std::string& what) const {
    const SurfacePoint p = surface_.nearest(*band_, band_->transform.indexFromWorld(pWorld));
    if (!isNear(p, band_->transform, maxSnap_))
        requireNear(p, band_->transform, maxSnap_, what + " " + textOf(pWorld));
    return p;
}

double Distance::at(const Vec3d& pWorld) const {
    const SurfacePoint p = nearest(pWorld);
    const std::shared_ptr<const Field> field = forPoints(1);
    return distanceAt(*field, p) * signAt(*field, p.pIndex) * band_->transform.dx;
}

PointValue Distance::valueAt(const Field& field, const SurfacePoint& p) const {
    const Vec3d normal(band_->normal[p.node]);
    const Arrival arrival = arrivalAt(field, p.pIndex, normal);
    if (!(arrival.distance < kInfinity) || arrival.distance > field.greatest) return {};
    const SurfaceCell cell(*band_, *field.metric, p.pIndex, normal);
    const double sign = signAt(field, p.pIndex);
    const Vec3d gradient = gradientAt(field, arrival, p.pIndex, cell);
    return {arrival.distance * sign * band_->transform.dx, arrival.source,
            sign * band_->transform.worldFromIndexDirection(gradient)};
}

std::vector<PointValue> Distance::valuesAt(const std::vector<Vec3d>& pWorld,
                                           Progress& progress) const {
    std::vector<PointValue> values(pWorld.size());
    const std::shared_ptr<const Field> field = forPoints(pWorld.size());
    parallelFor(values.size(), 64, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            values[k] = valueAt(*field, nearest(pWorld[k], "point " + std::to_string(k) + " at"));
    });
    return values;
}

std::shared_ptr<const Field> Distance::forPaths(std::size_t count) const {
    constexpr double kReadsPerVoxel = 15;  // cells that the tracer reads
    const double voxels = marched()->maxDistance / marched()->metric->least();
    return forPoints(std::size_t(double(count) * std::min(kReadsPerVoxel * voxels, 1e9)));
}

Polyline Distance::polylineOf(const Field& field, const Path& path) const {
    Polyline line = inWorld(path, band_->transform);
    if (path.status != PathStatus::Reached) return line;
    const SurfacePoint& seed = seeds()[path.seed];
    const bool several = path.seed + 1 < seeds().size() && seeds()[path.seed + 1].joined;
    line.seed = field.source[path.seed];
    line.end = inWorld(seed, band_->transform);
    if (seed.joined || several) line.end = {line.points.back(), line.points.back()};
    line.endDistance = seed.start * band_->transform.dx;
    return line;
}

Polyline Distance::path(const Vec3d& pWorld, bool straightened) const {
    const std::shared_ptr<const Field> field = forPaths(1);
    Path path = tracePath(*field, nearest(pWorld));
    if (straightened) straighten(*field, path);
    addNormals(*band_, path);
    return polylineOf(*field, path);
}

std::vector<Polyline> Distance::paths(bool straightened, Progress& progress) const {
    if (targets_.empty()) return {};
    const std::shared_ptr<const Field> field = forPaths(targets_.size());
    std::vector<Path> paths = tracePaths(*field, targets_, {}, progress);
    for (std::size_t k = 0; straightened && k < paths.size(); ++k) {
        straighten(*field, paths[k], progress);
        progress.update("straighten", double(k + 1) / double(paths.size()));
    }
    std::vector<Polyline> lines(paths.size());
    parallelFor(paths.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            addNormals(*band_, paths[k]);
            lines[k] = polylineOf(*field, paths[k]);
        }
    });
    return lines;
}

std::vector<double> Distance::atTargets() const {
    std::vector<double> distances(targets_.size(), std::numeric_limits<double>::quiet_NaN());
    std::vector<std::size_t> onSurface;
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;
    for (std::size_t k = 0; k < targets_.size(); ++k) {
        if (targets_[k].offSurface) continue;
        onSurface.push_back(k), points.push_back(targets_[k].pIndex);
        normals.push_back(band_->normal[targets_[k].node]);
    }
    const std::vector<Arrival> first = arrivalsAt(*marched(), points, normals);
    for (std::size_t k = 0; k < first.size(); ++k)
        distances[onSurface[k]] = band_->transform.dx * withinLimit(*marched(), first[k].distance);
    return distances;
}
VertexValues Distance::atVertices(Progress& progress) const {
    const TriangleMesh& mesh = requireMesh(surface_);
    return vertexValues(mesh, *forPoints(mesh.points.size()), progress);
}
std::vector<std::string> Distance::costWarnings() const {
    const Field& field = *marched();
    return costs_->of(*band_, *field.metric, field.atFootPoints);
}
Samples Distance::samples() const { return samplesOf(*forPoints(0)); }
DistanceMatrix Distance::matrix(Progress& progress) const {
    return distances(*band_, forPoints(0)->metric, seeds(), targets_, progress);
}

openvdb::FloatGrid::Ptr Distance::grid(const std::string& name) const {
    Extent extent;
    const openvdb::FloatGrid::Ptr grid =
        distanceGrid(*marched(), *surface_.gridTransform(),
                     name.empty() ? surface_.gridName() + "_geodesic" : name, &extent);
    const std::lock_guard<std::mutex> lock(fields_->mutex);
    fields_->extent = extent;
    return grid;
}
SurfaceMesh Distance::mesh(Progress& progress) const {
    SurfaceMesh mesh = indexMesh(progress);
    finish(mesh, *marched());
    return inWorld(std::move(mesh), band_->transform);
}
SurfaceMesh Distance::indexMesh(Progress& progress) const {
    return surface_.mesh(width_, field(), progress);
}
const LevelSet& Distance::levelSet(Progress& progress) const {
    return surface_.levelSet(width_, progress);
}
double Distance::largest() const { return extent().maxDistance * band_->transform.dx; }
std::size_t Distance::reached() const {
    if (const Extent known = extent(); known.nodes == band_->size()) return known.reached;
    return field().reached;
}

Extent Distance::extent() const {
    {
        const std::lock_guard<std::mutex> lock(fields_->mutex);
        if (fields_->extent) return *fields_->extent;
        const Field& f = *fields_->latest();
        // The core's share of what obstacles hide is not the band's.
        if (!f.core || f.stoppedEarly || f.reached == f.size() || !f.metric->obstacles) {
            if (!fields_->largest) fields_->largest = largestOnBand(f);
            return {f.core ? band_->coreSize() : band_->size(), f.reached, *fields_->largest};
        }
    }
    const Field& whole = field();
    return {band_->size(), whole.reached, whole.maxDistance};
}

}  // namespace igeo
