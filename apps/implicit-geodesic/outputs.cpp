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

igeo::PictureOptions pictureOptions(const Options& options) {
    igeo::PictureOptions picture;
    if (!options.imageSize.empty()) {
        char rest = 0;
        if (std::sscanf(options.imageSize.c_str(), "%dx%d%c", &picture.width, &picture.height,
                        &rest) != 2 ||
            picture.width < 1 || picture.height < 1 || picture.width > 16384 ||
            picture.height > 16384)
            usageError("--image-size: '" + options.imageSize +
                           "' is not WIDTHxHEIGHT, each 1 to 16384 pixels",
                       "write for instance 1280x960");
    }
    if (!options.camera.empty()) {
        const std::vector<double> v = igeo::parseNumbers(options.camera);
        if (v.size() != 3 && v.size() != 6)
            usageError("--camera: '" + options.camera + "' is not x,y,z or x,y,z,x,y,z",
                       "give where the camera is and, if you like, what it looks at");
        picture.eye = Vec3d{v[0], v[1], v[2]};
        if (v.size() == 6) picture.lookAt = Vec3d{v[3], v[4], v[5]};
    }
    if (options.upZ) picture.up = {0, 0, 1};
    if (!options.colorMap.empty()) picture.colorMap = options.colorMap;
    igeo::ColorMap{picture.colorMap};
    return picture;
}

}  // namespace

Outputs::Outputs(const Options& options)
    : options_(options),
      picture_(pictureOptions(options)),
      rows_(Part::parse("--matrix-rows", options.matrixRows)) {
    if (!options.matrixRows.empty() && endingOf(options.matrix) != ".json")
        usageError("--matrix-rows without --matrix FILE.json",
                   "parts are written as JSON; batch merge --matrix makes any format of them");
    for (const char* grid : {"label", "logmap"})
        if (options.asked(grid) && options.scheme != "jet")
            usageError(std::string("--grids ") + grid + " needs --scheme jet",
                       "godunov does not know where a front came from");
    const bool extended = !(options.seedCurves.empty() && options.seedMasks.empty());
    if (!options.matrix.empty() && extended)
        usageError("--matrix does not go with --seed-curve and --seed-mask",
                   "a matrix is made of distances between points");
    if (!options.pairsOut.empty() && options.pairs.empty())
        usageError("--pairs-out without --pairs", "add --pairs FILE");
    if (!options.asked("logmap")) return;
    if (!(options.metric.empty() && options.metricCurvature.empty()))
        usageError("--grids logmap does not go with tensors (--metric, --metric-curvature)",
                   "the logarithmic map is known for weights only");
    if (extended)
        usageError("--grids logmap does not go with --seed-curve and --seed-mask",
                   "polar coordinates are those about a point");
}

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
    if (options_.asked("label"))
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
    if (options_.asked("surface")) grids.push_back(r.levelSet(progress).psi);
    grids.push_back(distance);
    if (options_.asked("gradient"))
        grids.push_back(
            igeo::gradientGrid(band, field, field.gradient, transform, base + "_gradient"));
    if (options_.asked("label"))
        grids.push_back(igeo::labelGrid(band, field, transform, name + "_label"));
    if (options_.asked("color"))
        grids.push_back(igeo::colorGrid(band, field, colorMap(), transform, base + "_color"));
    if (options_.asked("logmap"))
        grids.push_back(igeo::logMapGrid(band, igeo::logMap(band, field, {}, progress), transform,
                                         name + "_logmap"));
    if (options_.asked("weight"))
        grids.push_back(igeo::weightGrid(band, *field.metric, transform, name + "_weight"));
    if (options_.asked("curvature"))
        for (const auto& grid :
             igeo::curvatureGrids(band, r.metric.curvatureOf(band, progress), transform, name))
            grids.push_back(grid);
    if (options_.asked("engraved"))
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
            options_.matrixRows.empty()
                ? igeo::distances(r.band, r.field.metric, seeds, r.targets, progress)
                : igeo::distanceRows(r.band, r.field.metric, seeds, r.targets, rows_.begin(n),
                                     rows_.end(n), progress);
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
