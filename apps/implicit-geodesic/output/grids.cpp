#include "output/grids.h"

#include <igeo/io/vdb_write.h>
#include <igeo/metric/curvature.h>
#include <igeo/results/color_map.h>
#include <igeo/results/engrave.h>
#include <igeo/results/extend.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/log_map.h>
#include <igeo/results/voronoi_cells.h>

#include <set>
#include <utility>

#include "output/output_files.h"
#include "output/run_result.h"
#include "usage_error.h"

namespace {

openvdb::FloatGrid::Ptr distanceOf(RunResult& r) {
    const igeo::Band& band = r.band();
    const double dx = band.transform.dx;
    const openvdb::FloatGrid::Ptr grid = r.distance.grid(r.options.name);
    const std::shared_ptr<const igeo::Field> field = r.distance.marched();
    std::string weight;
    for (const std::string& w : r.report.weights) weight += (weight.empty() ? "" : " * ") + w;
    grid->insertMeta("geodesic_scheme", openvdb::StringMetadata(field->scheme));
    grid->insertMeta("geodesic_band", openvdb::FloatMetadata(float(band.h * dx)));
    grid->insertMeta("geodesic_seed_count", openvdb::Int32Metadata(int(field->sourceCount())));
    grid->insertMeta("geodesic_max", openvdb::FloatMetadata(float(r.distance.largest())));
    grid->insertMeta("geodesic_unreached",
                     openvdb::Int64Metadata(std::int64_t(band.size() - r.distance.reached())));
    grid->insertMeta("geodesic_weight", openvdb::StringMetadata(weight.empty() ? "1" : weight));
    if (r.options.extend) igeo::extendDistance(*grid, r.levelSet(), r.distance.field(), r.progress);
    return grid;
}

/// The grids of --grids besides the distance and the surface, in their order.
class MoreGrids {
public:
    MoreGrids(RunResult& r, const std::string& distanceName)
        : r_(r),
          placed_(r.distance.surface().gridTransform()),
          surface_(r.distance.surface().gridName()),
          distance_(distanceName) {}

    openvdb::GridCPtrVec make() {
        const igeo::Band& band = r_.band();
        const openvdb::math::Transform& t = *placed_;
        if (asked(Grid::Gradient))
            add(igeo::gradientGrid(r_.distance.field(), t, distance_ + "_gradient"));
        if (asked(Grid::Label)) add(igeo::labelGrid(r_.distance.field(), t, surface_ + "_label"));
        if (asked(Grid::Color))
            add(igeo::colorGrid(r_.distance.field(), igeo::ColorMap(colorMapOf(r_.options)), t,
                                distance_ + "_color"));
        if (asked(Grid::LogMap))
            add(igeo::logMapGrid(band, igeo::logMap(r_.distance.field(), {}, r_.progress), t,
                                 surface_ + "_logmap"));
        if (asked(Grid::Weight))
            add(igeo::weightGrid(band, *r_.distance.marched()->metric, t, surface_ + "_weight"));
        if (asked(Grid::Curvature)) addCurvature();
        if (asked(Grid::Engraved))
            add(igeo::engraved(r_.levelSet(), r_.isolines(), r_.drawnLines(), igeo::kGrooveRadius,
                               r_.progress));
        return std::move(grids_);
    }

private:
    bool asked(Grid grid) const { return r_.options.asked(grid); }
    void add(const openvdb::GridBase::ConstPtr& grid) { grids_.push_back(grid); }
    void addCurvature() {
        const double scale = r_.solver.options().metric.curvatureScale;
        if (const igeo::TriangleMesh* mesh = r_.solver.surface().triangles())
            r_.report.warn(igeo::wideFacetWarning(*mesh, r_.band().transform.dx, scale));
        const igeo::Curvature curvature = igeo::curvature(r_.band(), scale, r_.progress);
        for (const auto& grid : igeo::curvatureGrids(r_.band(), curvature, *placed_, surface_))
            add(grid);
    }

    RunResult& r_;
    openvdb::math::Transform::ConstPtr placed_;
    std::string surface_, distance_;
    openvdb::GridCPtrVec grids_;
};

/// The names of the grids of --grids: that of the surface's or the distance's grid, followed by
/// this.
constexpr struct {
    Grid grid;
    bool ofDistance;
    const char* suffix;
} kNames[] = {{Grid::Surface, false, ""},
              {Grid::Gradient, true, "_gradient"},
              {Grid::Label, false, "_label"},
              {Grid::Color, true, "_color"},
              {Grid::LogMap, false, "_logmap"},
              {Grid::Weight, false, "_weight"},
              {Grid::Curvature, false, "_curvature_mean"},
              {Grid::Curvature, false, "_curvature_gaussian"},
              {Grid::Curvature, false, "_curvature_max"},
              {Grid::Curvature, false, "_curvature_min"},
              {Grid::Engraved, false, "_engraved"}};

}  // namespace

void checkGridNames(const RunOptions& o, const std::string& surface) {
    if (o.name.empty() || !o.hasSeeds()) return;
    std::set<std::string> names{o.name};
    for (const auto& [grid, ofDistance, suffix] : kNames)
        if (o.asked(grid))
            if (const std::string name = (ofDistance ? o.name : surface) + suffix;
                !names.insert(name).second)
                usageError(
                    "--name " + o.name + " gives two grids of the output the name '" + name + "'",
                    "choose another, or leave one of the two out of --grids");
}

void writeVolume(RunResult& r, const std::string& file) {
    // Areas and boundaries of the cells of the seeds, for the report.
    if (r.options.asked(Grid::Label))
        r.report.cells = igeo::voronoiCells(r.distance.field(), r.mesh(), r.progress);
    r.progress.update("grids", 0);
    openvdb::GridCPtrVec grids;
    const openvdb::FloatGrid::Ptr distance = distanceOf(r);
    // vdb_render draws the first float grid of a file.
    if (r.options.asked(Grid::Surface)) grids.push_back(r.levelSet().psi);
    grids.push_back(distance);
    for (const auto& grid : MoreGrids(r, distance->getName()).make()) grids.push_back(grid);
    r.progress.throwIfCancelled();
    r.progress.update("write", 0);
    if (file != "-") return igeo::writeVdb(file, grids);
    writeToStdout([&](std::ostream& out) { igeo::writeVdb(out, grids); });
}
