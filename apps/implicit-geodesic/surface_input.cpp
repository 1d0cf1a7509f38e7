#include "surface_input.h"

#include <igeo/band_width.h>
#include <igeo/box.h>
#include <igeo/format.h>
#include <igeo/mesh_band.h>
#include <igeo/mesh_file.h>
#include <igeo/point_band.h>
#include <igeo/point_cloud.h>
#include <igeo/rebuild.h>
#include <igeo/refined_mesh.h>
#include <igeo/vdb_io.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "usage_error.h"

using igeo::format;
using igeo::Vec3d;

namespace {

/// The name of the grid of a surface that comes from no grid.
std::string stemOf(const std::string& file) { return std::filesystem::path(file).stem().string(); }

/// A level set, or what --rebuild makes of another volume.
class Volume : public SurfaceInput {
public:
    explicit Volume(const Options& options) : SurfaceInput(options) {}

    void read() override {
        const igeo::GridSource source = igeo::parseGridSource(options_.sdf);
        if (!options_.rebuild) {
            loaded_ = igeo::readLevelSetGrid(source);
            return;
        }
        loaded_ = igeo::readScalarGrid(source);
        const bool fog = loaded_.grid->getGridClass() == openvdb::GRID_FOG_VOLUME;
        const double iso = options_.iso ? *options_.iso : fog ? 0.5 : 0.0;
        loaded_ = igeo::rebuilt(loaded_, iso);
        warnings_.push_back("psi was rebuilt as the distance to where the volume is " +
                            format("%.6g", iso));
    }

    void prepare(igeo::Progress& progress, igeo::RunReport& report) override {
        const igeo::LevelSet& checked = levelSet(progress);
        const igeo::LevelSetStats& stats = checked.stats;
        transform_ = checked.transform;
        name_ = checked.name;
        snap_ = stats.halfWidth * transform_.dx;
        diagonal_ =
            std::sqrt(checked.psi->evalActiveVoxelBoundingBox().dim().asVec3d().lengthSqr());
        report.file = checked.file;
        report.activeVoxels = stats.activeVoxels;
        report.halfWidth = stats.halfWidth;
        report.largestCurvature = stats.largestCurvature;
        summary_ = format("half-width %.4g voxels, radius of curvature at least %.4g voxels",
                          stats.halfWidth, 1 / stats.largestCurvature);
        chooseBandWidth(stats, report);
        igeo::widen(*levelSet_, h_);
    }

    igeo::FileSurvey survey(igeo::Progress& progress) override {
        if (options_.voxelSize > 0 || options_.resolution > 0)
            usageError("--voxel-size and --resolution are for meshes and points",
                       "a volume has the voxels that it has: leave them out");
        return igeo::surveyFile(igeo::parseGridSource(options_.sdf), progress);
    }

    igeo::Band band(const std::vector<igeo::Ball>& region,
                    igeo::Progress& progress) const override {
        return igeo::bandFromLevelSet(*levelSet_, h_, region, progress);
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
    igeo::LevelSet makeLevelSet(igeo::Progress& progress) override {
        return igeo::checkLevelSet(std::move(loaded_), progress);
    }

    igeo::LoadedGrid loaded_;  ///< until it is checked
};

/// Half the thickness of the band of which a level set is made: room for differences of psi.
constexpr double kLevelSetWidth = 3;

/// Triangles: foot points are exact, which no level set of them is.
class Mesh : public SurfaceInput {
public:
    explicit Mesh(const Options& options) : SurfaceInput(options) {}

    void read() override { mesh_ = igeo::readMesh(options_.mesh); }

    void prepare(igeo::Progress& progress, igeo::RunReport& report) override {
        constexpr int kResolution = 256;
        const Vec3d size = igeo::Box(mesh_.points).size();
        transform_.dx = voxelSize(std::max({size.x, size.y, size.z}), kResolution);
        igeo::requireReasonable(mesh_, transform_.dx);
        name_ = stemOf(mesh_.file);
        snap_ = kLevelSetWidth * transform_.dx;
        diagonal_ = igeo::length(size) / transform_.dx;
        warnings_ = mesh_.warnings;
        const igeo::MeshTopology topology = igeo::meshTopology(mesh_);
        closed_ = topology.closed();
        summary_ = std::to_string(mesh_.triangles.size()) + " triangles, " +
                   (closed_ ? "closed"
                            : "open: " + std::to_string(topology.boundaryEdges) +
                                  " boundary edges, " + std::to_string(topology.nonManifoldEdges) +
                                  " of three triangles or more");
        if (topology.nonOrientable > 0)
            warnings_.push_back(
                "the mesh has one side only in places (as a Moebius strip): "
                "it is cut along a line there, which paths go around");
        report.file = mesh_.file;
        report.halfWidth = kLevelSetWidth;
        // jet needs the narrowest band, and nothing that only a level set shows.
        if (options_.scheme == "jet" && options_.band == 0 && options_.bandVoxels == 0)
            h_ = report.bandLower = report.bandUpper = std::sqrt(3.0);
        else
            chooseBandWidth(levelSet(progress).stats, report);
    }

    igeo::FileSurvey survey(igeo::Progress& progress) override {
        igeo::RunReport unused;
        read();
        prepare(progress, unused);
        requireMemory();
        return igeo::surveyMesh(mesh_, transform_.dx, progress);
    }

    igeo::Band band(const std::vector<igeo::Ball>&, igeo::Progress& progress) const override {
        return igeo::bandFromMesh(mesh_, transform_.dx, h_, progress);
    }
    double estimatedNodes() const override {
        return igeo::estimatedVoxels(mesh_, transform_.dx, h_);
    }
    igeo::SurfacePoint nearest(const igeo::Band& band, const Vec3d& p) const override {
        return igeo::nearestMeshPoint(mesh_, band, p);
    }
    igeo::SurfaceMesh mesh(const igeo::Band& band, const igeo::Field& field,
                           igeo::Progress& progress) override {
        return igeo::refinedMesh(mesh_, band, field, 1, progress);
    }

private:
    igeo::LevelSet makeLevelSet(igeo::Progress& progress) override {
        return igeo::levelSetFromBand(
            igeo::bandFromMesh(mesh_, transform_.dx, kLevelSetWidth, progress), closed_, mesh_.file,
            name_, progress);
    }

    igeo::TriangleMesh mesh_;
    bool closed_ = false;
};

/// Points: for jet a surface fitted to them, for godunov the paper's union of balls.
class Points : public SurfaceInput {
public:
    explicit Points(const Options& options)
        : SurfaceInput(options),
          kind_(options.scheme == "jet" ? igeo::PointBandKind::Fits : igeo::PointBandKind::Balls) {}

    void read() override { cloud_ = igeo::readPointCloud(options_.points); }

    void prepare(igeo::Progress& progress, igeo::RunReport& report) override {
        const Vec3d size = igeo::Box(cloud_.points).size();
        const std::string file = cloud_.file;
        surface_ = std::make_unique<igeo::PointSurface>(std::move(cloud_), progress);
        const igeo::CloudDensity& density = surface_->density();
        const bool asked = options_.voxelSize > 0 || options_.resolution > 0;
        transform_.dx = asked ? voxelSize(std::max({size.x, size.y, size.z}), 0)
                              : igeo::defaultVoxelSize(density, kind_);
        name_ = stemOf(file);
        snap_ = std::max(3 * transform_.dx, 3 * density.spacing);
        diagonal_ = igeo::length(size) / transform_.dx;
        warnings_ = igeo::densityWarnings(density, file);
        summary_ = std::to_string(density.points) + " points, " +
                   format("spacing %.4g, scatter %.2g, %.0f pieces", density.spacing, density.noise,
                          double(density.pieces));
        const igeo::BandBounds bounds = igeo::bandBounds(*surface_, kind_, transform_.dx);
        chooseBandWidth(bounds, bounds.lower, report);
        report.file = file;
        report.halfWidth = h_;
        report.largestCurvature = density.largestCurvature * transform_.dx;
    }

    igeo::FileSurvey survey(igeo::Progress& progress) override {
        igeo::RunReport unused;
        read();
        prepare(progress, unused);
        requireMemory();
        return igeo::surveyPoints(*surface_, transform_.dx, progress);
    }

    igeo::Band band(const std::vector<igeo::Ball>&, igeo::Progress& progress) const override {
        return igeo::bandFromPoints(*surface_, kind_, transform_.dx, h_, progress);
    }

    double estimatedNodes() const override {
        const igeo::CloudDensity& density = surface_->density();
        const double side = density.spacing / transform_.dx;
        return double(density.points) * side * side * 2 * h_;
    }

private:
    igeo::LevelSet makeLevelSet(igeo::Progress& progress) override {
        const auto fits = igeo::PointBandKind::Fits;
        return igeo::levelSetFromBand(
            igeo::bandFromPoints(*surface_, fits, transform_.dx, kLevelSetWidth, progress),
            /*closed=*/false, surface_->file(), name_, progress);
    }

    igeo::PointCloud cloud_;  ///< until it is fitted
    std::unique_ptr<igeo::PointSurface> surface_;
    const igeo::PointBandKind kind_;
};

}  // namespace

std::unique_ptr<SurfaceInput> SurfaceInput::of(const Options& options) {
    if (!options.mesh.empty()) return std::make_unique<Mesh>(options);
    if (!options.points.empty()) return std::make_unique<Points>(options);
    if (options.sdf.empty())
        usageError(
            "no surface is given",
            "add --sdf FILE.vdb, --mesh FILE or --points FILE; see implicit-geodesic --help");
    return std::make_unique<Volume>(options);
}

void SurfaceInput::requireMemory() const {
    // Band, march and one grid of results; godunov somewhat more than jet.
    constexpr double kBytesPerNode = 110, kGiB = 1024.0 * 1024 * 1024;
    const double machine =
        double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE)) / kGiB;
    const double limit = options_.memoryLimit > 0 ? options_.memoryLimit : machine;
    const double needed = estimatedNodes() * kBytesPerNode / kGiB;
    if (needed <= limit) return;
    // The band grows with the area in voxels.
    const double factor = std::sqrt(needed / limit);
    usageError("the band of " + name_ + " has about " + format("%.3g", estimatedNodes()) +
                   " voxels and needs about " + format("%.3g GiB of memory, %.3g", needed, limit) +
                   (options_.memoryLimit > 0 ? " are allowed (--memory-limit)"
                                             : " is what the machine has"),
               "voxels of " + format("%.3g", 1.1 * factor * transform_.dx) +
                   " or more would fit; or stay near the seeds with --max-distance");
}

igeo::SurfacePoint SurfaceInput::nearest(const igeo::Band& band, const Vec3d& p) const {
    return igeo::nearestSurfacePoint(band, p);
}

igeo::SurfaceMesh SurfaceInput::mesh(const igeo::Band& band, const igeo::Field& field,
                                     igeo::Progress& progress) {
    return igeo::surfaceMesh(levelSet(progress), band, field, progress);
}

const igeo::LevelSet& SurfaceInput::levelSet(igeo::Progress& progress) {
    if (!levelSet_) levelSet_ = makeLevelSet(progress);
    return *levelSet_;
}

std::vector<std::string> SurfaceInput::warnings() const {
    std::vector<std::string> all = warnings_;
    if (levelSet_) all.insert(all.end(), levelSet_->warnings.begin(), levelSet_->warnings.end());
    return all;
}

void SurfaceInput::chooseBandWidth(const igeo::LevelSetStats& stats, igeo::RunReport& report) {
    const igeo::BandBounds bounds =
        igeo::bandBounds(stats.largestCurvature, stats.reach, stats.halfWidth);
    // jet works on foot points, for which the narrowest band is enough.
    chooseBandWidth(bounds,
                    options_.scheme == "jet"
                        ? bounds.lower
                        : igeo::defaultBandWidth(options_.order, stats.largestCurvature, bounds),
                    report);
}

void SurfaceInput::chooseBandWidth(const igeo::BandBounds& bounds, double best,
                                   igeo::RunReport& report) {
    const double dx = transform_.dx;
    report.bandLower = bounds.lower;
    report.bandUpper = bounds.upper;
    h_ = best;
    if (options_.band > 0) h_ = igeo::requireBandWidth(options_.band / dx, bounds, dx);
    if (options_.bandVoxels > 0) h_ = igeo::requireBandWidth(options_.bandVoxels, bounds, dx);
    if (!bounds.resolved)
        warnings_.push_back(
            "in places the surface bends or folds within " + format("%.2g voxels", bounds.lower) +
            ", less than the grid resolves: distances are less accurate there than elsewhere");
}

double SurfaceInput::voxelSize(double longest, int resolution) const {
    if (options_.voxelSize > 0) return options_.voxelSize;
    return longest / (options_.resolution > 0 ? options_.resolution : resolution);
}
