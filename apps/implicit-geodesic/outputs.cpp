#include "outputs.h"

#include <igeo/colour_map.h>
#include <igeo/engrave.h>
#include <igeo/field_grids.h>
#include <igeo/isolines.h>
#include <igeo/log_map.h>
#include <igeo/matrix.h>
#include <igeo/picture.h>
#include <igeo/point_file.h>
#include <igeo/surface_mesh.h>

#include <algorithm>
#include <cstdio>

#include "usage_error.h"

namespace {

using igeo::Vec3d;

std::string endingOf(const std::string& file) {
    const auto dot = file.rfind('.');
    return dot == std::string::npos ? "" : file.substr(dot);
}

void checkEnding(const char* option, const std::string& file, const std::string& allowed) {
    if (file.empty() || file == "-") return;
    const std::string ending = endingOf(file);
    if (ending.empty() || (" " + allowed + " ").find(" " + ending + " ") == std::string::npos)
        usageError(std::string(option) + " " + file + ": the ending is none of " + allowed,
                   "name the file with one of them");
}

bool asked(const Options& options, const char* grid) {
    return std::count(options.with.begin(), options.with.end(), grid) > 0;
}

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
    if (!options.colourMap.empty()) picture.colourMap = options.colourMap;
    igeo::ColourMap{picture.colourMap};
    return picture;
}

igeo::ColourMap colourMap(const Options& options) {
    return igeo::ColourMap(options.colourMap.empty() ? igeo::ColourMap::names().front()
                                                     : options.colourMap);
}

/// As asked for, else at the spacing a picture has.
std::vector<double> levels(const Options& options, const Result& r) {
    const double dx = r.band.transform.dx;
    if (options.levels > 0) return igeo::levelsByCount(r.field, options.levels);
    if (!(r.field.maxDistance > 0)) return {};
    const double spacing =
        options.spacing > 0 ? options.spacing : igeo::roundSpacing(r.field.maxDistance * dx, 16);
    return igeo::levelsBySpacing(r.field, spacing / dx);
}

}  // namespace

void checkOutputOptions(const Options& options) {
    checkEnding("--paths", options.paths, ".json .obj");
    checkEnding("--mesh-out", options.meshOut, ".ply .obj");
    checkEnding("--isolines", options.isolines, ".json .obj .ply");
    checkEnding("--matrix", options.matrix, ".csv .json .npy");
    checkEnding("--image", options.image, ".png");
    for (const char* grid : {"label", "logmap"})
        if (asked(options, grid) && options.scheme != "jet")
            usageError(std::string("--with ") + grid + " needs --scheme jet",
                       "godunov does not know where a front came from");
    if (asked(options, "logmap") && !(options.metric.empty() && options.metricCurvature.empty()))
        usageError("--with logmap does not go with tensors (--metric, --metric-curvature)",
                   "the logarithmic map is known for weights only");
    pictureOptions(options);
}

openvdb::GridCPtrVec extraGrids(const Options& options, const Result& r, const std::string& base,
                                igeo::Progress& progress) {
    const auto& transform = r.levelSet.psi->transform();
    const std::string psi = r.levelSet.psi->getName();
    openvdb::GridCPtrVec grids;
    if (asked(options, "gradient"))
        grids.push_back(
            igeo::gradientGrid(r.band, r.field, r.field.gradient, transform, base + "_gradient"));
    if (asked(options, "label"))
        grids.push_back(igeo::labelGrid(r.band, r.field, transform, psi + "_label"));
    if (asked(options, "color"))
        grids.push_back(
            igeo::colorGrid(r.band, r.field, colourMap(options), transform, base + "_color"));
    if (asked(options, "logmap"))
        grids.push_back(
            igeo::logMapGrid(r.band, igeo::logMap(r.band, r.field), transform, psi + "_logmap"));
    if (asked(options, "weight"))
        grids.push_back(igeo::weightGrid(r.band, *r.field.metric, transform, psi + "_weight"));
    if (asked(options, "curvature"))
        for (const auto& grid :
             igeo::curvatureGrids(r.band, r.metric.curvatureOf(r.band, progress), transform, psi))
            grids.push_back(grid);
    if (asked(options, "engraved")) {
        const igeo::SurfaceMesh mesh = igeo::surfaceMesh(r.levelSet, r.band, r.field, progress);
        grids.push_back(igeo::engraved(
            r.levelSet, igeo::isolines(r.band, r.field, mesh, levels(options, r), progress),
            r.report.paths));
    }
    return grids;
}

std::vector<Document> documents(const Options& options, const Result& r, igeo::Progress& progress) {
    std::vector<Document> all;
    const igeo::Similarity& transform = r.band.transform;
    if (!options.meshOut.empty() || !options.isolines.empty()) {
        const igeo::SurfaceMesh mesh = igeo::surfaceMesh(r.levelSet, r.band, r.field, progress);
        if (!options.meshOut.empty()) {
            const igeo::ColourMap colours = colourMap(options);
            auto colour = [&](double t) { return igeo::Vec3f(igeo::srgbFromLinear(colours(t))); };
            all.push_back({"mesh", options.meshOut,
                           endingOf(options.meshOut) == ".obj"
                               ? igeo::surfaceObj(mesh, transform, colour)
                               : igeo::surfacePly(mesh, transform, colour)});
        }
        if (!options.isolines.empty()) {
            const auto lines = igeo::isolines(r.band, r.field, mesh, levels(options, r), progress);
            const std::string ending = endingOf(options.isolines);
            all.push_back({"isolines", options.isolines,
                           ending == ".obj" ? igeo::isolinesObj(lines, transform)
                           : ending == ".ply"
                               ? igeo::isolinesPly(lines, transform)
                               : igeo::isolinesJson(r.report, r.band, r.field, lines)});
        }
    }
    if (!options.matrix.empty()) {
        const igeo::DistanceMatrix matrix =
            igeo::distances(r.band, r.field.metric, r.field.seeds, r.targets, progress);
        const std::string ending = endingOf(options.matrix);
        all.push_back({"matrix", options.matrix,
                       ending == ".json"  ? igeo::matrixJson(r.report, r.band, matrix)
                       : ending == ".npy" ? igeo::matrixNpy(matrix, transform.dx)
                                          : igeo::matrixCsv(matrix, transform.dx)});
    }
    return all;
}

void writeImage(const Options& options, const Result& r, igeo::Progress& progress) {
    if (options.image.empty()) return;
    igeo::PictureOptions picture = pictureOptions(options);
    if (options.spacing > 0) picture.isolineSpacing = options.spacing;
    if (options.levels > 0)
        picture.isolineSpacing = r.field.maxDistance * r.band.transform.dx / (options.levels + 1);
    igeo::writePicture(options.image, r.levelSet, r.band, r.field, r.report.paths, picture,
                       progress);
}
