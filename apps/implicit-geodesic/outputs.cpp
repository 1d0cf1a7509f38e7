#include "outputs.h"

#include <igeo/io/point_list.h>
#include <igeo/io/vdb_read.h>
#include <igeo/results/color_map.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/results/engrave.h>
#include <igeo/results/extend.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/log_map.h>

#include <cstdio>

#include "output_files.h"
#include "usage_error.h"

namespace {

using igeo::Vec3d;

igeo::PictureOptions pictureOptions(const PictureOptions& options) {
    igeo::PictureOptions picture;
    if (options.imageSize) {
        picture.width = options.imageSize->width;
        picture.height = options.imageSize->height;
    }
    if (options.camera) {
        picture.eye = options.camera->eye;
        picture.lookAt = options.camera->lookAt;
    }
    if (options.up == UpAxis::Z) picture.up = {0, 0, 1};
    if (!options.colorMap.empty()) picture.colorMap = options.colorMap;
    return picture;
}

}  // namespace

Outputs::Outputs(const RunOptions& options)
    : options_(options), picture_(pictureOptions(options)) {}

const igeo::SurfaceMesh& Outputs::mesh(const Result& r, igeo::Progress& progress) {
    if (!mesh_) mesh_ = r.surface.mesh(r.band, r.field, r.report, progress);
    return *mesh_;
}

const std::vector<igeo::Isoline>& Outputs::isolines(const Result& r, igeo::Progress& progress) {
    if (isolines_) return *isolines_;
    // As asked for, else at the spacing a picture has.
    const double dx = r.band.transform.dx, largest = r.field.maxDistance;
    std::vector<double> levels;
    if (options_.levels > 0)
        levels = igeo::levelsByCount(r.field, options_.levels);
    else if (largest > 0)
        levels = igeo::levelsBySpacing(
            r.field,
            (options_.spacing > 0 ? options_.spacing : igeo::roundSpacing(largest * dx, 16)) / dx);
    isolines_ = igeo::isolines(r.band, r.field, mesh(r, progress), levels, progress);
    return *isolines_;
}

void Outputs::countCells(const Result& r, igeo::Progress& progress) {
    if (options_.asked(Grid::Label))
        r.report.cells = igeo::voronoiCells(r.band, r.field, mesh(r, progress));
}

void Outputs::writeVolume(const Result& r, igeo::Progress& progress) {
    const auto placed = r.surface.gridTransform();
    const openvdb::math::Transform& transform = *placed;
    const std::string name = r.surface.gridName(),
                      base = options_.name.empty() ? name + "_geodesic" : options_.name;
    const igeo::Band& band = r.band;
    const igeo::Field& field = r.field;

    progress.update("grids", 0);
    auto distance = igeo::distanceGrid(band, field, transform, base);
    const double dx = band.transform.dx;
    distance->insertMeta("geodesic_scheme", openvdb::StringMetadata(field.scheme));
    distance->insertMeta("geodesic_band", openvdb::FloatMetadata(float(band.h * dx)));
    distance->insertMeta("geodesic_seed_count", openvdb::Int32Metadata(int(field.sourceCount())));
    distance->insertMeta("geodesic_max", openvdb::FloatMetadata(float(field.maxDistance * dx)));
    distance->insertMeta("geodesic_unreached",
                         openvdb::Int64Metadata(std::int64_t(band.size() - field.reached)));
    std::string weight;
    for (const std::string& w : r.metric.weightNames()) weight += (weight.empty() ? "" : " * ") + w;
    distance->insertMeta("geodesic_weight", openvdb::StringMetadata(weight.empty() ? "1" : weight));
    if (options_.extend) igeo::extendDistance(*distance, r.levelSet(progress), band, field);

    openvdb::GridCPtrVec grids;
    // vdb_render shows the first float grid of a file.
    if (options_.asked(Grid::Surface)) grids.push_back(r.levelSet(progress).psi);
    grids.push_back(distance);
    if (options_.asked(Grid::Gradient))
        grids.push_back(
            igeo::gradientGrid(band, field, field.gradient, transform, base + "_gradient"));
    if (options_.asked(Grid::Label))
        grids.push_back(igeo::labelGrid(band, field, transform, name + "_label"));
    if (options_.asked(Grid::Color))
        grids.push_back(igeo::colorGrid(band, field, colorMap(), transform, base + "_color"));
    if (options_.asked(Grid::LogMap))
        grids.push_back(igeo::logMapGrid(band, igeo::logMap(band, field, {}, progress), transform,
                                         name + "_logmap"));
    if (options_.asked(Grid::Weight))
        grids.push_back(igeo::weightGrid(band, *field.metric, transform, name + "_weight"));
    if (options_.asked(Grid::Curvature))
        for (const auto& grid :
             igeo::curvatureGrids(band, r.metric.curvatureOf(band, progress), transform, name))
            grids.push_back(grid);
    if (options_.asked(Grid::Engraved))
        grids.push_back(igeo::engraved(r.levelSet(progress), isolines(r, progress), r.lines()));
    progress.throwIfCancelled();
    const std::string file = distanceFile(options_, r.surface.name());
    progress.update("write", 0);
    writeGrids(file, grids);
    r.report.outputs.emplace_back("distance", file);
}

void Outputs::writeDocuments(const Result& r, igeo::Progress& progress) {
    const igeo::Similarity& transform = r.band.transform;
    auto write = [&](const char* kind, const std::string& file, const std::string& content) {
        writeDocument(file, content);
        r.report.outputs.emplace_back(kind, file);
    };
    if (const std::string& file = options_.paths; !file.empty())
        write("paths", file,
              endingOf(file) == ".obj" ? igeo::geodesicsObj(r.lines(), r.band)
                                       : igeo::geodesicsJson(r.report, r.band, r.field));
    if (const std::string& file = options_.meshOut; !file.empty()) {
        const igeo::ColorMap colors = colorMap();
        auto color = [&](double t) { return igeo::Vec3f(igeo::srgbFromLinear(colors(t))); };
        write("mesh", file,
              endingOf(file) == ".obj" ? igeo::surfaceObj(mesh(r, progress), transform, color)
                                       : igeo::surfacePly(mesh(r, progress), transform, color));
    }
    if (const std::string& file = options_.isolines; !file.empty()) {
        const auto& lines = isolines(r, progress);
        const std::string ending = endingOf(file);
        write("isolines", file,
              ending == ".obj"   ? igeo::isolinesObj(lines, transform)
              : ending == ".ply" ? igeo::isolinesPly(lines, transform)
                                 : igeo::isolinesJson(r.report, r.band, r.field, lines));
    }
    if (const std::string& file = options_.matrix; !file.empty()) {
        const std::vector<igeo::SurfacePoint>& seeds = r.field.seeds;
        const std::size_t n = seeds.size();
        const igeo::DistanceMatrix matrix =
            !options_.matrixRows
                ? igeo::distances(r.band, r.field.metric, seeds, r.targets, progress)
                : igeo::distanceRows(r.band, r.field.metric, seeds, r.targets,
                                     options_.matrixRows->begin(n), options_.matrixRows->end(n),
                                     progress);
        const std::string ending = endingOf(file);
        write("matrix", file,
              ending == ".json"  ? igeo::matrixJson(r.report, r.band, matrix)
              : ending == ".npy" ? igeo::matrixNpy(matrix)
                                 : igeo::matrixCsv(matrix));
    }
    if (!options_.pairs.empty()) {
        const std::string file = options_.pairsOut.empty() ? "-" : options_.pairsOut;
        write("pairs", file,
              endingOf(file) == ".json" ? igeo::pairsJson(r.report, r.band)
                                        : igeo::pairsCsv(r.report.pairs, transform.dx));
    }
    if (!options_.image.empty()) {
        igeo::PictureOptions picture = picture_;
        if (options_.spacing > 0) picture.isolineSpacing = options_.spacing;
        if (options_.levels > 0)
            picture.isolineSpacing = r.field.maxDistance * transform.dx / (options_.levels + 1);
        writeDocument(options_.image, igeo::renderPng(r.levelSet(progress), r.band, r.field,
                                                      r.lines(), picture, progress));
        r.report.outputs.emplace_back("image", options_.image);
    }
}

igeo::ColorMap Outputs::colorMap() const { return igeo::ColorMap(picture_.colorMap); }
