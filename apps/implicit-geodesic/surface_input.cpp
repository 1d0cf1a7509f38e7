#include "surface_input.h"

#include <igeo/band_width.h>
#include <igeo/vdb_io.h>

#include <cmath>
#include <utility>

#include "text.h"

void SurfaceInput::read(const Options& options) {
    loaded_ = igeo::readLevelSetGrid(igeo::parseGridSource(options.sdf));
}

void SurfaceInput::check(const Console& console, igeo::Progress& progress,
                         igeo::RunReport& report) {
    levelSet_ = igeo::checkLevelSet(std::move(loaded_), progress);
    const igeo::LevelSetStats& stats = levelSet_.stats;
    report.file = levelSet_.file;
    report.grid = levelSet_.name;
    report.activeVoxels = stats.activeVoxels;
    report.halfWidth = stats.halfWidth;
    report.largestCurvature = stats.largestCurvature;
    console.detail("surface: " + levelSet_.name + text(", dx %.6g", transform().dx) +
                   text(", half-width %.4g voxels, radius of curvature at least %.4g voxels",
                        stats.halfWidth, 1 / stats.largestCurvature));
}

void SurfaceInput::chooseBandWidth(const Options& options, igeo::RunReport& report) {
    const igeo::LevelSetStats& stats = levelSet_.stats;
    const double dx = transform().dx;
    const igeo::BandBounds bounds =
        igeo::bandBounds(stats.largestCurvature, stats.reach, stats.halfWidth);
    report.bandLower = bounds.lower;
    report.bandUpper = bounds.upper;
    // jet works on foot points, for which the narrowest band is enough.
    h_ = options.scheme == "jet"
             ? bounds.lower
             : igeo::defaultBandWidth(options.order, stats.largestCurvature, bounds);
    if (options.band > 0) h_ = igeo::requireBandWidth(options.band / dx, bounds, dx);
    if (options.bandVoxels > 0) h_ = igeo::requireBandWidth(options.bandVoxels, bounds, dx);
    if (!bounds.resolved)
        levelSet_.warnings.push_back(
            "in places the surface bends or folds within " + text("%.2g voxels", bounds.lower) +
            ", less than the grid resolves: distances are less accurate there than elsewhere");
    igeo::widen(levelSet_, h_);
}

double SurfaceInput::diagonal() const {
    return std::sqrt(levelSet_.psi->evalActiveVoxelBoundingBox().dim().asVec3d().lengthSqr());
}
