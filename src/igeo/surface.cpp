#include <igeo/surface.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/io/voxel_size.h>
#include <igeo/results/refined_mesh.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/detail/mesh_crossings.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/level_set_check.h>
#include <igeo/surface/mesh_band.h>
#include <igeo/surface/point_band.h>
#include <igeo/surface/vertex_name.h>

#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

namespace igeo {

namespace {

/// Half the width of the level set made from a mesh or points, voxels: enough for differences.
constexpr double kLevelSetWidth = 3;

/// The kind of an error about the voxel size: of the argument if the size was given, else of the
/// input.
Error::Kind kindOfRefusal(const VoxelOptions& voxels) {
    return voxels.size > 0 ? Error::Kind::InvalidArgument : Error::Kind::BadInput;
}

void warnUnresolved(const BandBounds& bounds, BandWidth& width) {
    if (!bounds.resolved)
        width.warnings.push_back(fmt::format(
            "the surface bends or folds within {:.2g} voxels on {} of it, less than the "
            "grid resolves: distances are less accurate there than elsewhere",
            bounds.lower, percent(bounds.unresolvedShare)));
}

/// h within the bounds of M&S (14): the given one, or the best.
BandWidth choose(Scheme scheme, const BandBounds& bounds, double best, double asked, double dx) {
    BandWidth width{scheme, best, bounds.lower, bounds.upper, bounds.unresolvedShare};
    if (asked > 0) width.h = requireBandWidth(asked, bounds, dx);
    warnUnresolved(bounds, width);
    return width;
}

BandWidth chooseByStats(Scheme scheme, int order, double asked, const LevelSetStats& stats,
                        double dx) {
    const BandBounds bounds = bandBounds(stats);
    // jet works on foot points; the narrowest band is enough.
    const double best = scheme == Scheme::Jet
                            ? bounds.lower
                            : defaultBandWidth(order, stats.largestCurvature, bounds);
    return choose(scheme, bounds, best, asked, dx);
}

}  // namespace

/// What differs between kinds of surfaces. Derived data is made once, by the first caller who needs
/// it, while others wait.
class Surface::Shape {
public:
    virtual ~Shape() = default;

    virtual BandWidth bandWidth(Scheme scheme, int order, double h, Progress& progress) const = 0;
    virtual double estimatedNodes(double h) const = 0;
    virtual const LevelSet& levelSet(double h, Progress& progress) const = 0;
    virtual SurfaceMesh mesh(double h, const Field& field, Progress& progress) const {
        return surfaceMesh(levelSet(h, progress), field, progress);
    }
    virtual std::string gridName() const { return facts.name; }
    /// In the order of the file; null for a level set.
    virtual const std::vector<Vec3d>* vertices() const { return nullptr; }
    virtual openvdb::math::Transform::ConstPtr gridTransform() const {
        return igeo::gridTransform(transform);
    }
    virtual void dropVolume() const {}
    virtual const TriangleMesh* triangles() const { return nullptr; }
    virtual const PointSurface* points() const { return nullptr; }

    std::shared_ptr<const Band> band(const BandWidth& width, const std::vector<Ball>& region,
                                     Progress& progress) const {
        if (!region.empty() && makesParts())
            return std::make_shared<Band>(makeBand(width, region, progress));
        const std::lock_guard<std::mutex> lock(bandMutex_);
        std::shared_ptr<const Band>& whole = wholeBands_[{width.scheme, width.h}];
        if (!whole) whole = std::make_shared<Band>(makeBand(width, {}, progress));
        return whole;
    }

    std::shared_ptr<const Band> madeBand(const BandWidth& width) const {
        const std::lock_guard<std::mutex> lock(bandMutex_);
        const auto at = wholeBands_.find({width.scheme, width.h});
        return at == wholeBands_.end() ? nullptr : at->second;
    }

    /// Computed once for each whole band.
    Unresolved unresolved(const Band& band) const {
        {
            const std::lock_guard<std::mutex> lock(bandMutex_);
            if (const auto at = unresolved_.find(&band); at != unresolved_.end()) return at->second;
        }
        const Unresolved found = findUnresolved(band);
        const std::lock_guard<std::mutex> lock(bandMutex_);
        for (const auto& [width, whole] : wholeBands_)
            if (whole.get() == &band) unresolved_[&band] = found;
        return found;
    }

    SurfaceFacts facts;
    Similarity transform;

protected:
    virtual Unresolved findUnresolved(const Band&) const { return {}; }
    virtual bool makesParts() const { return false; }
    virtual Band makeBand(const BandWidth& width, const std::vector<Ball>& region,
                          Progress& progress) const = 0;

    mutable std::mutex levelSetMutex_;

private:
    mutable std::mutex bandMutex_;
    mutable std::map<std::pair<Scheme, double>, std::shared_ptr<const Band>> wholeBands_;
    /// Only of wholeBands_, which live as long
    mutable std::map<const Band*, Unresolved> unresolved_;
};

namespace {

class Volume final : public Surface::Shape {
public:
    Volume(LoadedGrid loaded, Progress& progress) {
        levelSet_ = checkLevelSet(std::move(loaded), progress);
        const LevelSetStats& stats = levelSet_.stats;
        transform = levelSet_.transform;
        gridTransform_ = levelSet_.psi->transformPtr();
        gridName_ = levelSet_.psi->getName();
        facts.file = levelSet_.file;
        facts.name = levelSet_.name;
        facts.activeVoxels = stats.activeVoxels;
        facts.halfWidth = stats.halfWidth;
        facts.largestCurvature = stats.largestCurvature;
        facts.diagonal =
            std::sqrt(levelSet_.psi->evalActiveVoxelBoundingBox().dim().asVec3d().lengthSqr());
        facts.snap = stats.halfWidth * transform.dx;
        facts.summary =
            fmt::format("half-width {:.4g} voxels, radius of curvature at least {:.4g} voxels",
                        stats.halfWidth, 1 / stats.largestCurvature);
        facts.warnings = levelSet_.warnings;
    }

    BandWidth bandWidth(Scheme scheme, int order, double h, Progress& progress) const override {
        BandWidth width = chooseByStats(scheme, order, h, levelSet_.stats, transform.dx);
        const LevelSet& wide = levelSet(width.h, progress);
        width.warnings.insert(width.warnings.end(),
                              wide.warnings.begin() + std::ptrdiff_t(levelSet_.warnings.size()),
                              wide.warnings.end());
        return width;
    }
    double estimatedNodes(double h) const override {
        const LevelSetStats& stats = levelSet_.stats;
        return double(stats.activeVoxels) * std::min(1.0, h / stats.halfWidth);
    }
    /// As read, or widened.
    const LevelSet& levelSet(double h, Progress&) const override {
        const std::lock_guard<std::mutex> lock(levelSetMutex_);
        if (!levelSet_.psi)
            throw Error(Error::Kind::InvalidArgument,
                        "the volume of " + facts.name + " was dropped",
                        "call dropVolume() once nothing else is wanted of the surface");
        if (h <= levelSet_.stats.halfWidth) return levelSet_;
        const auto at = wide_.find(h);
        if (at != wide_.end()) return at->second;
        LevelSet& wide = wide_[h];
        wide = levelSet_;
        widen(wide, h);
        return wide;
    }
    std::string gridName() const override { return gridName_; }
    openvdb::math::Transform::ConstPtr gridTransform() const override { return gridTransform_; }
    void dropVolume() const override {
        const std::lock_guard<std::mutex> lock(levelSetMutex_);
        levelSet_.psi = nullptr;
        wide_.clear();
    }

private:
    bool makesParts() const override { return true; }
    Unresolved findUnresolved(const Band& band) const override {
        return unresolvedOf(levelSet(band.h, Progress::none()), band);
    }
    Band makeBand(const BandWidth& width, const std::vector<Ball>& region,
                  Progress& progress) const override {
        return bandFromLevelSet(levelSet(width.h, progress), width.h, region, progress);
    }

    openvdb::math::Transform::ConstPtr gridTransform_;
    std::string gridName_;
    mutable LevelSet levelSet_;
    mutable std::map<double, LevelSet> wide_;
};

/// Common to meshes and points: their level set is made from their band.
class MadeLevelSet : public Surface::Shape {
public:
    const LevelSet& levelSet(double, Progress& progress) const override {
        const std::lock_guard<std::mutex> lock(levelSetMutex_);
        if (!levelSet_) levelSet_ = makeLevelSet(progress);
        return *levelSet_;
    }

private:
    virtual LevelSet makeLevelSet(Progress& progress) const = 0;
    mutable std::optional<LevelSet> levelSet_;
};

/// Foot points on triangles are exact; those of a level set are not.
class Triangles final : public MadeLevelSet {
public:
    Triangles(TriangleMesh mesh, const VoxelOptions& voxels, const Progress& progress)
        : mesh_(std::move(mesh)) {
        constexpr int kResolution = 256;
        const Box box(mesh_.points);
        transform.dx =
            voxels.size > 0
                ? voxels.size
                : box.longestSide() / (voxels.resolution > 0 ? voxels.resolution : kResolution);
        requireExtent(box.longestSide(), mesh_.file);
        requireVoxelSize(transform.dx, mesh_.file, kindOfRefusal(voxels));
        requireFine(transform.dx, box.longestSide(), mesh_.file);
        requireReasonable(mesh_, transform.dx);
        requireNarrow(voxels.joinGaps);
        facts.joinGaps = voxels.joinGaps;
        facts.kind = SurfaceFacts::Kind::Mesh;
        facts.file = mesh_.file;
        facts.name = stemOf(mesh_.file);
        facts.mesh = meshFacts(mesh_, progress);
        separateContacts(length(box.size()));
        facts.halfWidth = kLevelSetWidth;
        facts.diagonal = length(box.size()) / transform.dx;
        facts.snap = kLevelSetWidth * transform.dx;
        facts.warnings = mesh_.warnings;
        for (const std::string& w : meshWarnings(*facts.mesh)) facts.warnings.push_back(w);
        const std::string open = openness(*facts.mesh);
        if (!open.empty()) facts.warnings.push_back("the mesh is " + open);
        facts.summary = std::to_string(mesh_.triangles.size()) + " triangles, " +
                        (facts.mesh->closed ? "closed"
                         : open.empty()     ? "without boundary"
                                            : open);
        if (facts.mesh->junctions > 0) facts.summary += ", " + splitsOf(*facts.mesh);
        if (facts.mesh->nonManifoldEdges > 0)
            facts.summary += ", " + std::to_string(facts.mesh->nonManifoldEdges) +
                             " edges of three triangles or more";
    }

    BandWidth bandWidth(Scheme scheme, int order, double h, Progress& progress) const override {
        // jet needs only the narrowest band, and no level set.
        const double least = std::sqrt(3.0);
        if (scheme == Scheme::Jet && h == 0) return {scheme, least, least, least};
        return chooseByStats(scheme, order, h, levelSet(h, progress).stats, transform.dx);
    }
    double estimatedNodes(double h) const override {
        return estimatedVoxels(mesh_, transform.dx, h);
    }
    SurfaceMesh mesh(double, const Field& field, Progress& progress) const override {
        return refinedMesh(mesh_, field, 1, progress);
    }
    const TriangleMesh* triangles() const override { return &mesh_; }
    const std::vector<Vec3d>* vertices() const override {
        return !separated_.empty() ? &separated_
               : mesh_.source      ? &mesh_.source->vertices
                                   : &mesh_.points;
    }

private:
    /// Points that lie on other faces move off them by 2e-8 of the diagonal, so that a vertex names
    /// a point of its own faces.
    void separateContacts(double diagonal) {
        constexpr double kApart = 2e-8;
        if (facts.mesh->contacts.empty()) return;
        separate(mesh_, facts.mesh->contacts, kApart * diagonal);
        if (!mesh_.source) return;
        std::set<std::uint32_t> moved;
        for (const MeshContact& c : facts.mesh->contacts) moved.insert(c.point);
        separated_ = mesh_.source->vertices;
        for (std::size_t v = 0; v < separated_.size(); ++v)
            if (const std::uint32_t p = mesh_.pointOfVertex[v]; moved.count(p) > 0)
                separated_[v] = mesh_.points[p];
    }
    Unresolved findUnresolved(const Band& band) const override {
        return unresolvedOf(*facts.mesh, band);
    }
    Band makeBand(const BandWidth& width, const std::vector<Ball>&,
                  Progress& progress) const override {
        return bandFromMesh(mesh_, transform.dx, width.h, progress, facts.joinGaps);
    }
    /// Refuses wide gaps: nodes search for others in balls as wide as the gaps.
    void requireNarrow(double gap) const {
        constexpr double kWidest = 64;
        if (gap <= kWidest * transform.dx) return;
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("joinGaps is {:.4g}, which is {:.3g} voxels; at most {:g} voxels "
                                "are joined ({})",
                                gap, gap / transform.dx, kWidest, mesh_.file),
                    fmt::format("take voxels of {:.3g} or more, or close the gaps in the mesh",
                                gap / kWidest));
    }
    LevelSet makeLevelSet(Progress& progress) const override {
        return levelSetFromBand(bandFromMesh(mesh_, transform.dx, kLevelSetWidth, progress),
                                facts.mesh->closed, mesh_.file, facts.name, progress);
    }

    TriangleMesh mesh_;
    std::vector<Vec3d> separated_;  ///< the vertices of the file, where points were moved
};

/// For jet a surface fitted to points, for godunov the union of balls of M&S.
class Cloud final : public MadeLevelSet {
public:
    Cloud(PointCloud cloud, const VoxelOptions& voxels, Progress& progress)
        : vertices_(cloud.points) {
        const Box box(cloud.points);
        requireExtent(box.longestSide(), cloud.file);
        facts.kind = SurfaceFacts::Kind::Points;
        facts.file = cloud.file;
        facts.name = stemOf(cloud.file);
        facts.warnings = cloud.warnings;
        surface_ = std::make_shared<const PointSurface>(std::move(cloud), progress);
        const CloudDensity& density = surface_->density();
        transform.dx = voxels.size > 0         ? voxels.size
                       : voxels.resolution > 0 ? box.longestSide() / voxels.resolution
                                               : defaultVoxelSize(density, kindFor(voxels.scheme));
        requireVoxelSize(transform.dx, facts.file, kindOfRefusal(voxels));
        if (voxels.size > 0) requireFine(transform.dx, box.longestSide(), facts.file);
        facts.diagonal = length(box.size()) / transform.dx;
        facts.snap = std::max(3 * transform.dx, 3 * density.spacing);
        facts.largestCurvature = density.largestCurvature * transform.dx;
        facts.fit = density.fitError().scaled(1 / transform.dx);
        facts.fit.points = {surface_, &surface_->points()};
        facts.summary = std::to_string(density.points) + " points, " +
                        fmt::format("spacing {:.4g}, scatter {:.2g}, {:.0f} components",
                                    density.spacing, density.noise, double(density.pieces));
        for (const std::string& w : densityWarnings(density, facts.file))
            facts.warnings.push_back(w);
    }

    BandWidth bandWidth(Scheme scheme, int, double h, Progress&) const override {
        const BandBounds bounds = bandBounds(*surface_, kindFor(scheme), transform.dx);
        return choose(scheme, bounds, bounds.lower, h, transform.dx);
    }
    double estimatedNodes(double h) const override {
        const CloudDensity& density = surface_->density();
        const double side = density.spacing / transform.dx;
        return double(density.points) * side * side * 2 * h;
    }
    const PointSurface* points() const override { return surface_.get(); }
    const std::vector<Vec3d>* vertices() const override { return &vertices_; }

private:
    static PointBandKind kindFor(Scheme scheme) {
        return scheme == Scheme::Jet ? PointBandKind::Fits : PointBandKind::Balls;
    }
    Band makeBand(const BandWidth& width, const std::vector<Ball>&,
                  Progress& progress) const override {
        return bandFromPoints(*surface_, kindFor(width.scheme), transform.dx, width.h, progress);
    }
    LevelSet makeLevelSet(Progress& progress) const override {
        return levelSetFromBand(
            bandFromPoints(*surface_, PointBandKind::Fits, transform.dx, kLevelSetWidth, progress),
            /*closed=*/false, surface_->file(), facts.name, progress);
    }

    std::vector<Vec3d> vertices_;  ///< in the order given
    std::shared_ptr<const PointSurface> surface_;
};

/// A grid that the caller owns, shared.
LoadedGrid loadedFrom(const openvdb::FloatGrid& psi) {
    openvdb::initialize();
    return {openvdb::gridConstPtrCast<openvdb::FloatGrid>(psi.copyGrid()), "memory", psi.getName(),
            psi.getGridClass() == openvdb::GRID_LEVEL_SET};
}

}  // namespace

Surface::Surface(const openvdb::FloatGrid& psi, Progress& progress)
    : Surface(loadedFrom(psi), progress) {}
Surface::Surface(LoadedGrid psi, Progress& progress)
    : shape_(std::make_shared<Volume>(std::move(psi), progress)) {}
Surface::Surface(TriangleMesh mesh, const VoxelOptions& voxels, Progress& progress)
    : shape_(std::make_shared<Triangles>(std::move(mesh), voxels, progress)) {}
Surface::Surface(PointCloud cloud, const VoxelOptions& voxels, Progress& progress)
    : shape_(std::make_shared<Cloud>(std::move(cloud), voxels, progress)) {}

const SurfaceFacts& Surface::facts() const { return shape_->facts; }
const Similarity& Surface::transform() const { return shape_->transform; }
openvdb::math::Transform::ConstPtr Surface::gridTransform() const {
    return shape_->gridTransform();
}
std::string Surface::gridName() const { return shape_->gridName(); }

Vec3d Surface::vertex(const std::string& name) const {
    const std::vector<Vec3d>* vertices = shape_->vertices();
    if (!vertices)
        throw Error(Error::Kind::InvalidArgument,
                    "'" + name + "' is a vertex, and " + facts().name + " is a level set without",
                    "give a position x,y,z");
    return (*vertices)[vertexNamed(name, *vertices, facts().name, triangles())];
}

const std::vector<Vec3d>* Surface::vertices() const { return shape_->vertices(); }

BandWidth Surface::bandWidth(Scheme scheme, int order, double h, Progress& progress) const {
    return shape_->bandWidth(scheme, order, h, progress);
}
std::shared_ptr<const Band> Surface::band(const BandWidth& width, const std::vector<Ball>& region,
                                          Progress& progress) const {
    return shape_->band(width, region, progress);
}
std::shared_ptr<const Band> Surface::madeBand(const BandWidth& width) const {
    return shape_->madeBand(width);
}
double Surface::estimatedNodes(const BandWidth& width) const {
    return shape_->estimatedNodes(width.h);
}
double Surface::estimatedMemory(const BandWidth& width) const {
    // Band, march and one grid of results; godunov takes somewhat more than jet.
    constexpr double kBytesPerNode = 110;
    return estimatedNodes(width) * kBytesPerNode;
}
void Surface::requireMemory(const BandWidth& width, double limit) const {
    constexpr double kGiB = 1 << 30;
    const double needed = estimatedMemory(width);
    if (needed <= limit) return;
    // The band grows with the area in voxels.
    const double factor = std::sqrt(needed / limit);
    throw Error(
        Error::Kind::InvalidArgument,
        "the band of " + facts().name + " has about " +
            fmt::format("{:.3g}", estimatedNodes(width)) + " voxels and needs about " +
            fmt::format("{:.3g} GiB of memory, {:.3g} are allowed", needed / kGiB, limit / kGiB),
        "voxels of " + fmt::format("{:.3g}", 1.1 * factor * transform().dx) +
            " or more would fit; or stay near the seeds with maxDistance, or raise memoryLimit");
}
void Surface::dropVolume() const { shape_->dropVolume(); }
Unresolved Surface::unresolved(const Band& band) const { return shape_->unresolved(band); }

SurfacePoint Surface::nearest(const Band& band, const Vec3d& pIndex) const {
    return nearestSurfacePoint(band, pIndex);
}
SurfaceMesh Surface::mesh(const BandWidth& width, const Field& field, Progress& progress) const {
    return shape_->mesh(width.h, field, progress);
}
const LevelSet& Surface::levelSet(const BandWidth& width, Progress& progress) const {
    return shape_->levelSet(width.h, progress);
}
const TriangleMesh* Surface::triangles() const { return shape_->triangles(); }
const PointSurface* Surface::points() const { return shape_->points(); }

}  // namespace igeo
