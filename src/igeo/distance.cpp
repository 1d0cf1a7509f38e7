#include <igeo/distance.h>

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/march/signed_field.h>
#include <igeo/path/straighten.h>
#include <igeo/results/field_grids.h>

#include <utility>

namespace igeo {

Distance::Distance(Surface surface, BandWidth width, std::shared_ptr<const Band> band,
                   bool wholeBand, Field field, std::vector<SurfacePoint> targets, double maxSnap)
    : surface_(std::move(surface)),
      width_(std::move(width)),
      band_(std::move(band)),
      wholeBand_(wholeBand),
      field_(std::make_shared<const Field>(std::move(field))),
      targets_(std::move(targets)),
      maxSnap_(maxSnap) {}

SurfacePoint Distance::nearest(const Vec3d& pWorld) const {
    const SurfacePoint p = surface_.nearest(*band_, band_->transform.indexFromWorld(pWorld));
    const double snap = p.snapDistance * band_->transform.dx;
    if (!(snap <= maxSnap_ * (1 + 1e-6)))
        throw Error(Error::Kind::InvalidArgument,
                    "the point " + textOf(pWorld) + " is " +
                        fmt::format("{:.6g} from the surface, {:.6g} is allowed", snap, maxSnap_),
                    "move it to the surface or raise maxSnap");
    return p;
}

double Distance::at(const Vec3d& pWorld) const {
    const SurfacePoint p = nearest(pWorld);
    return sampleDistance(*field_, p.pIndex, Vec3d(band_->normal[p.node])) *
           signAt(*field_, p.pIndex) * band_->transform.dx;
}

Polyline Distance::path(const Vec3d& pWorld, bool straightened) const {
    const Similarity& t = band_->transform;
    Path path = tracePath(*field_, nearest(pWorld));
    if (straightened) straighten(*field_, path);
    Polyline line;
    line.status = path.status;
    for (const PathVertex& v : path.vertices) {
        line.points.push_back(t.worldFromIndex(v.pIndex));
        line.distance.push_back(v.distance * t.dx);
    }
    line.length = path.length * t.dx;
    line.weightedLength = path.weightedLength * t.dx;
    if (path.status == PathStatus::Reached) line.seed = field_->source[path.seed];
    return line;
}

std::vector<Path> Distance::paths(bool straightened, Progress& progress) const {
    std::vector<Path> paths = tracePaths(*field_, targets_, {}, progress);
    if (!straightened) return paths;
    std::size_t done = 0;
    for (Path& path : paths) {
        straighten(*field_, path, progress);
        progress.update("straighten", double(++done) / double(paths.size()));
    }
    return paths;
}

openvdb::FloatGrid::Ptr Distance::grid(const std::string& name) const {
    return distanceGrid(*field_, *surface_.gridTransform(),
                        name.empty() ? surface_.gridName() + "_geodesic" : name);
}
SurfaceMesh Distance::mesh(Progress& progress) const {
    return surface_.mesh(width_, *field_, progress);
}
const LevelSet& Distance::levelSet(Progress& progress) const {
    return surface_.levelSet(width_, progress);
}
double Distance::largest() const { return field_->maxDistance * band_->transform.dx; }

}  // namespace igeo
