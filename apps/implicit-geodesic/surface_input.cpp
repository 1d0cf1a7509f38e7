#include "surface_input.h"

#include <igeo/base/detail/box.h>
#include <igeo/base/detail/format.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/point_cloud_file.h>
#include <igeo/io/vdb_read.h>
#include <igeo/results/refined_mesh.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/mesh_band.h>
#include <igeo/surface/point_band.h>
#include <igeo/surface/rebuild.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "guarded_read.h"
#include "process.h"
#include "usage_error.h"

using igeo::format;
using igeo::Vec3d;

namespace {

/// The name of the grid of a surface that comes from no grid.
std::string stemOf(const std::string& file) { return std::filesystem::path(file).stem().string(); }

/// A level set, or what --rebuild makes of another volume.
class Volume : public SurfaceInput {
public:
    explicit Volume(const SurfaceOptions& options) : SurfaceInput(options) {}

    void read() override {
        const igeo::GridSource& source = options_.source;
        if (!options_.rebuild) {
            loaded_ = guardedRead(source.file, [&] { return igeo::readLevelSetGrid(source); });
            return;
        }
        loaded_ = guardedRead(source.file, [&] { return igeo::readScalarGrid(source); });
        const bool fog = loaded_.grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
        const double iso = options_.iso ? *options_.iso : fog ? 0.5 : 0.0;
        const FileGuard guard(source.file, FileGuard::kNoLimit);
        loaded_ = igeo::rebuilt(loaded_, iso);
        warn("psi was rebuilt as the distance to where the volume is " + format("%.6g", iso));
    }

    igeo::FileSurvey survey(double, igeo::Progress& progress) override {
        if (options_.voxelSize > 0 || options_.resolution > 0)
            usageError("--voxel-size and --resolution are for meshes and points",
                       "a volume has the voxels that it has: leave them out");
        const igeo::GridSource& source = options_.source;
        return guardedRead(source.file, [&] { return igeo::surveyFile(source, progress); });
    }
    double estimatedNodes() const override {
        const igeo::LevelSetStats& stats = levelSet_->stats;
        return double(stats.activeVoxels) * std::min(1.0, h_ / stats.halfWidth);
    }
    std::string gridName() const override { return levelSet_->psi->getName(); }
    // Its own, so that results line up with it bit by bit.
    openvdb::math::Transform::ConstPtr gridTransform() const override {
        return levelSet_->psi->transformPtr();
    }

private:
    void examine(igeo::Progress& progress) override {
        levelSet_ = igeo::checkLevelSet(std::exchange(loaded_, {}), progress);
        const igeo::LevelSetStats& stats = levelSet_->stats;
        transform_ = levelSet_->transform;
        snap_ = stats.halfWidth * transform_.dx;
        diagonal_ =
            std::sqrt(levelSet_->psi->evalActiveVoxelBoundingBox().dim().asVec3d().lengthSqr());
        report_.file = levelSet_->file;
        report_.grid = levelSet_->name;
        report_.activeVoxels = stats.activeVoxels;
        report_.halfWidth = stats.halfWidth;
        report_.largestCurvature = stats.largestCurvature;
        summary_ = format("half-width %.4g voxels, radius of curvature at least %.4g voxels",
                          stats.halfWidth, 1 / stats.largestCurvature);
        chooseBandWidth(stats);
        igeo::widen(*levelSet_, h_);
    }
    igeo::Band makeBand(const std::vector<igeo::Ball>& region,
                        igeo::Progress& progress) const override {
        return igeo::bandFromLevelSet(*levelSet_, h_, region, progress);
    }
    bool makesParts() const override { return true; }
    igeo::LevelSet makeLevelSet(igeo::Progress&) const override { return *levelSet_; }  // as read

    igeo::LoadedGrid loaded_;  ///< until it is checked
};

/// Half the thickness of the band of which a level set is made: room for differences of psi.
constexpr double kLevelSetWidth = 3;

/// Triangles: foot points are exact, which no level set of them is.
class Mesh : public SurfaceInput {
public:
    explicit Mesh(const SurfaceOptions& options) : SurfaceInput(options) {}

    void read() override {
        const std::string file = options_.source.text();
        mesh_ = guardedRead(file, [&] { return igeo::readMesh(file); });
    }

    igeo::FileSurvey survey(double memoryLimit, igeo::Progress& progress) override {
        read();
        prepare(progress);
        requireMemory(memoryLimit);
        return igeo::surveyMesh(mesh_, transform_.dx, progress);
    }
    std::string unreliableShare(const igeo::Band& band) const override {
        // Less is next to sharp edges.
        constexpr double kMuch = 0.02;
        const double share = igeo::facingShare(band);
        if (share < kMuch) return {};
        return format(
            "sheets face each other within two voxels on %.2g %% of the surface: distances "
            "are less accurate there; info says which voxels would tell them apart",
            100 * share);
    }
    double estimatedNodes() const override {
        return igeo::estimatedVoxels(mesh_, transform_.dx, h_);
    }
    igeo::SurfacePoint nearest(const igeo::Band& band, const Vec3d& p) const override {
        return igeo::nearestMeshPoint(mesh_, band, p);
    }
    igeo::SurfaceMesh mesh(const igeo::Band& band, const igeo::Field& field, igeo::RunReport&,
                           igeo::Progress& progress) const override {
        return igeo::refinedMesh(mesh_, band, field, 1, progress);
    }

private:
    void examine(igeo::Progress& progress) override {
        constexpr int kResolution = 256;
        const igeo::Box box(mesh_.points);
        transform_.dx = voxelSize(box.longestSide(), kResolution);
        igeo::requireReasonable(mesh_, transform_.dx);
        snap_ = kLevelSetWidth * transform_.dx;
        diagonal_ = igeo::length(box.size()) / transform_.dx;
        report_.warnings = mesh_.warnings;
        const igeo::MeshTopology topology = igeo::meshTopology(mesh_);
        closed_ = topology.closed();
        summary_ = std::to_string(mesh_.triangles.size()) + " triangles, " +
                   (closed_ ? "closed"
                            : "open: " + std::to_string(topology.boundaryEdges) +
                                  " boundary edges, " + std::to_string(topology.nonManifoldEdges) +
                                  " of three triangles or more");
        if (topology.nonOrientable > 0)
            warn(
                "the mesh has one side only in places (as a Moebius strip): "
                "it is cut along a line there, which paths go around");
        report_.file = mesh_.file;
        report_.kind = "mesh";
        report_.closed = closed_;
        report_.grid = stemOf(mesh_.file);
        report_.halfWidth = kLevelSetWidth;
        // jet needs the narrowest band, and nothing that only a level set shows.
        if (options_.scheme == Scheme::Jet && options_.band == 0 && options_.bandVoxels == 0) {
            h_ = report_.bandLower = report_.bandUpper = std::sqrt(3.0);
            return;
        }
        levelSet_ = makeLevelSet(progress);
        chooseBandWidth(levelSet_->stats);
    }
    igeo::Band makeBand(const std::vector<igeo::Ball>&, igeo::Progress& progress) const override {
        return igeo::bandFromMesh(mesh_, transform_.dx, h_, progress);
    }
    igeo::LevelSet makeLevelSet(igeo::Progress& progress) const override {
        return igeo::levelSetFromBand(
            igeo::bandFromMesh(mesh_, transform_.dx, kLevelSetWidth, progress), closed_, mesh_.file,
            name(), progress);
    }

    igeo::TriangleMesh mesh_;
    bool closed_ = false;
};

/// Points: for jet a surface fitted to them, for godunov the paper's union of balls.
class Points : public SurfaceInput {
public:
    explicit Points(const SurfaceOptions& options)
        : SurfaceInput(options),
          kind_(options.scheme == Scheme::Jet ? igeo::PointBandKind::Fits
                                              : igeo::PointBandKind::Balls) {}

    void read() override {
        const std::string file = options_.source.text();
        cloud_ = guardedRead(file, [&] { return igeo::readPointCloud(file); });
    }

    igeo::FileSurvey survey(double memoryLimit, igeo::Progress& progress) override {
        read();
        prepare(progress);
        requireMemory(memoryLimit);
        return igeo::surveyPoints(*surface_, transform_.dx, progress);
    }
    double estimatedNodes() const override {
        const igeo::CloudDensity& density = surface_->density();
        const double side = density.spacing / transform_.dx;
        return double(density.points) * side * side * 2 * h_;
    }

private:
    void examine(igeo::Progress& progress) override {
        const igeo::Box box(cloud_.points);
        const std::string file = cloud_.file;
        report_.warnings = cloud_.warnings;
        surface_ = std::make_unique<igeo::PointSurface>(std::move(cloud_), progress);
        const igeo::CloudDensity& density = surface_->density();
        const bool asked = options_.voxelSize > 0 || options_.resolution > 0;
        transform_.dx =
            asked ? voxelSize(box.longestSide(), 0) : igeo::defaultVoxelSize(density, kind_);
        snap_ = std::max(3 * transform_.dx, 3 * density.spacing);
        diagonal_ = igeo::length(box.size()) / transform_.dx;
        summary_ = std::to_string(density.points) + " points, " +
                   format("spacing %.4g, scatter %.2g, %.0f pieces", density.spacing, density.noise,
                          double(density.pieces));
        for (const std::string& w : igeo::densityWarnings(density, file)) warn(w);
        const igeo::BandBounds bounds = igeo::bandBounds(*surface_, kind_, transform_.dx);
        chooseBandWidth(bounds, bounds.lower);
        report_.file = file;
        report_.kind = "points";
        report_.grid = stemOf(file);
        report_.halfWidth = h_;
        report_.largestCurvature = density.largestCurvature * transform_.dx;
    }
    igeo::Band makeBand(const std::vector<igeo::Ball>&, igeo::Progress& progress) const override {
        return igeo::bandFromPoints(*surface_, kind_, transform_.dx, h_, progress);
    }
    igeo::LevelSet makeLevelSet(igeo::Progress& progress) const override {
        const auto fits = igeo::PointBandKind::Fits;
        return igeo::levelSetFromBand(
            igeo::bandFromPoints(*surface_, fits, transform_.dx, kLevelSetWidth, progress),
            /*closed=*/false, surface_->file(), name(), progress);
    }

    igeo::PointCloud cloud_;  ///< until it is fitted
    std::unique_ptr<igeo::PointSurface> surface_;
    const igeo::PointBandKind kind_;
};

}  // namespace

std::unique_ptr<SurfaceInput> SurfaceInput::of(const SurfaceOptions& options) {
    if (options.kind == SurfaceKind::Mesh) return std::make_unique<Mesh>(options);
    if (options.kind == SurfaceKind::Points) return std::make_unique<Points>(options);
    return std::make_unique<Volume>(options);
}

void SurfaceInput::prepare(igeo::Progress& progress) {
    {
        const FileGuard guard(options_.source.text(), FileGuard::kNoLimit);
        examine(progress);
    }
    if (levelSet_)
        for (const std::string& w : levelSet_->warnings) warn(w);
}

SurfaceInput::BandPtr SurfaceInput::band(const std::vector<igeo::Ball>& region,
                                         igeo::Progress& progress) const {
    if (!region.empty() && makesParts())
        return std::make_shared<igeo::Band>(makeBand(region, progress));
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!wholeBand_) wholeBand_ = std::make_shared<igeo::Band>(makeBand({}, progress));
    return wholeBand_;
}

double SurfaceInput::estimatedMemory() const {
    // Band, march and one grid of results; godunov somewhat more than jet.
    constexpr double kBytesPerNode = 110;
    return estimatedNodes() * kBytesPerNode / kGiB;
}

void SurfaceInput::requireMemory(double asked) const {
    const double limit = asked > 0 ? asked : machineMemory() / kGiB, needed = estimatedMemory();
    if (needed <= limit) return;
    // The band grows with the area in voxels.
    const double factor = std::sqrt(needed / limit);
    usageError("the band of " + name() + " has about " + format("%.3g", estimatedNodes()) +
                   " voxels and needs about " + format("%.3g GiB of memory, %.3g", needed, limit) +
                   (asked > 0 ? " are allowed (--memory-limit)" : " is what the machine has"),
               "voxels of " + format("%.3g", 1.1 * factor * transform_.dx) +
                   " or more would fit; or stay near the seeds with --max-distance");
}

igeo::SurfacePoint SurfaceInput::nearest(const igeo::Band& band, const Vec3d& p) const {
    return igeo::nearestSurfacePoint(band, p);
}

igeo::SurfaceMesh SurfaceInput::mesh(const igeo::Band& band, const igeo::Field& field,
                                     igeo::RunReport& report, igeo::Progress& progress) const {
    return igeo::surfaceMesh(levelSet(report, progress), band, field, progress);
}

const igeo::LevelSet& SurfaceInput::levelSet(igeo::RunReport& report,
                                             igeo::Progress& progress) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!levelSet_) levelSet_ = makeLevelSet(progress);
    for (const std::string& w : levelSet_->warnings)
        if (std::find(report.warnings.begin(), report.warnings.end(), w) == report.warnings.end())
            report.warnings.push_back(w);
    return *levelSet_;
}

void SurfaceInput::chooseBandWidth(const igeo::LevelSetStats& stats) {
    const igeo::BandBounds bounds =
        igeo::bandBounds(stats.largestCurvature, stats.reach, stats.halfWidth);
    // jet works on foot points, for which the narrowest band is enough.
    chooseBandWidth(bounds,
                    options_.scheme == Scheme::Jet
                        ? bounds.lower
                        : igeo::defaultBandWidth(options_.order, stats.largestCurvature, bounds));
}

void SurfaceInput::chooseBandWidth(const igeo::BandBounds& bounds, double best) {
    const double dx = transform_.dx;
    report_.bandLower = bounds.lower;
    report_.bandUpper = bounds.upper;
    h_ = best;
    if (options_.band > 0) h_ = igeo::requireBandWidth(options_.band / dx, bounds, dx);
    if (options_.bandVoxels > 0) h_ = igeo::requireBandWidth(options_.bandVoxels, bounds, dx);
    if (!bounds.resolved)
        warn("in places the surface bends or folds within " + format("%.2g voxels", bounds.lower) +
             ", less than the grid resolves: distances are less accurate there than elsewhere");
}

double SurfaceInput::voxelSize(double longest, int resolution) const {
    if (options_.voxelSize > 0) return options_.voxelSize;
    return longest / (options_.resolution > 0 ? options_.resolution : resolution);
}
