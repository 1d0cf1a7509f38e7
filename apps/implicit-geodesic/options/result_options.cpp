#include "options/result_options.h"

#include <igeo/io/point_list.h>
#include <igeo/results/color_map.h>

#include <cstdio>
#include <sstream>

#include "options/command.h"
#include "printable.h"

namespace {

std::string gridNameOf(const std::string& word) {
    if (word.empty()) usageError("the name is empty", "give one, or leave --name out");
    if (hasControls(word))
        usageError("'" + word + "' holds a control character", "remove it from the name");
    return word;
}

const Names<Grid> kGrids{{"surface", Grid::Surface},     {"gradient", Grid::Gradient},
                         {"label", Grid::Label},         {"color", Grid::Color},
                         {"logmap", Grid::LogMap},       {"weight", Grid::Weight},
                         {"curvature", Grid::Curvature}, {"engraved", Grid::Engraved}};
const Names<igeo::Vec3d> kUpAxes{{"x", {1, 0, 0}},   {"y", {0, 1, 0}},   {"z", {0, 0, 1}},
                                 {"-x", {-1, 0, 0}}, {"-y", {0, -1, 0}}, {"-z", {0, 0, -1}}};
const Names<igeo::Background> kBackgrounds{{"white", igeo::Background::White},
                                           {"black", igeo::Background::Black},
                                           {"transparent", igeo::Background::Transparent}};

/// A plus before an axis has no effect.
Reader upAxis(std::optional<igeo::Vec3d>& field) {
    auto read = [&field](const std::string& word) {
        field = valueNamed(word.substr(word[0] == '+' ? 1 : 0), kUpAxes);
    };
    return {.read = read, .choices = namesIn(kUpAxes)};
}

Reader gridList(std::set<Grid>& field) {
    auto read = [&field](const std::string& word) {
        std::istringstream in(word);
        for (std::string name; std::getline(in, name, ',');) field.insert(valueNamed(name, kGrids));
    };
    return {.read = read, .choices = namesIn(kGrids), .repeatable = true, .separator = ','};
}

ImageSize imageSizeOf(const std::string& word) {
    constexpr int kMost = 16384;
    ImageSize size;
    char rest = 0;
    if (std::sscanf(word.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 ||
        size.width < 1 || size.height < 1 || size.width > kMost || size.height > kMost)
        usageError("'" + word + "' is not WIDTHxHEIGHT, each 1 to 16384 pixels",
                   "write for instance 1280x960");
    return size;
}

Camera cameraOf(const std::string& word) {
    const std::vector<double> v = igeo::parseNumbers(word);
    if (v.size() != 3 && v.size() != 6)
        usageError("'" + word + "' is not x,y,z or x,y,z,x,y,z",
                   "give the position of the camera, and optionally what it looks at");
    Camera camera{{v[0], v[1], v[2]}, {}};
    if (v.size() == 6) camera.lookAt = igeo::Vec3d{v[3], v[4], v[5]};
    return camera;
}

/// The characters of the pictures' font: Latin-1 and the Greek mu, in UTF-8.
std::string unitOf(const std::string& word) {
    constexpr std::size_t kMost = 16;
    std::size_t count = 0;
    bool drawn = !word.empty() && !hasControls(word);
    for (std::size_t i = 0; i < word.size() && drawn; ++i, ++count) {
        const auto c = static_cast<unsigned char>(word[i]);
        if (c < 0x80) continue;
        const auto next = static_cast<unsigned char>(++i < word.size() ? word[i] : 0);
        const bool latin = (c == 0xc2 && next >= 0xa0 && next <= 0xbf) ||
                           (c == 0xc3 && next >= 0x80 && next <= 0xbf);
        drawn = latin || (c == 0xce && next == 0xbc);
    }
    if (!drawn || count > kMost)
        usageError("'" + word + "' is not 1 to 16 characters of Latin-1",
                   "write for instance --unit mm");
    return word;
}

Reader colorMap(std::string& field) {
    Names<std::string> names;
    for (const std::string& name : igeo::ColorMap::names()) names.emplace_back(name, name);
    return choice(field, names);
}

std::vector<Option> volumeOptions(ResultOptions& o) {
    return {
        {.names = {"-o", "--output"},
         .value = "FILE.vdb",
         .text = "Distances as a VDB file; - writes to stdout [<sdf>_geodesic.vdb here, where no "
                 "other result is asked for]",
         .reads = text(o.output)},
        {.names = {"--grids"},
         .value = "LIST",
         .text = "More grids in the output: surface (psi, first), gradient (of the distance), "
                 "label (nearest seed), color, logmap, weight, curvature, engraved (isolines "
                 "and paths cut into psi)",
         .reads = gridList(o.grids)},
        {.names = {"--extend"},
         .text = "Cover the whole narrow band of the level set, not only the band marched",
         .reads = flag(o.extend)},
        {.names = {"--name"},
         .value = "GRID",
         .text = "Name of the distance grid [<psi>_geodesic]",
         .reads = parsed(o.name, gridNameOf)}};
}

std::vector<Option> curveOptions(ResultOptions& o) {
    return {{.names = {"--paths"},
             .value = "FILE",
             .text = "Geodesics from all targets, of --pairs and --via, and walks of --shoot, as "
                     "polylines with normals: .json (docs/geodesics.schema.json), .csv, .obj, "
                     ".ply, .vtp or .usda; - writes JSON to stdout",
             .reads = text(o.paths)},
            {.names = {"--straighten"},
             .text = "Relax the geodesics to locally shortest curves, free of the march's error, "
                     "as those on a mesh without weights and obstacles always are; with --via "
                     "the curve as a whole, whose points then only guide it",
             .reads = flag(o.straighten)},
            {.names = {"--path-step"},
             .value = "D",
             .text = "Vertices of --paths D apart along the path, world units [as traced]",
             .reads = numberAboveZero(o.pathStep)},
            {.names = {"--path-offset"},
             .value = "D",
             .text = "Vertices of --paths moved by D along the normal of the surface, world units; "
                     "may be negative",
             .reads = number(o.pathOffset)},
            {.names = {"--isolines"},
             .value = "FILE",
             .text = "Lines of equal distance on the surface: .json (docs/isolines.schema.json), "
                     ".csv, .obj, .ply, .vtp or .usda; - writes JSON to stdout",
             .reads = text(o.isolines)},
            {.names = {"--levels"},
             .value = "N",
             .text = "Number of levels of isolines",
             .reads = wholeNumber(o.levels, 1, 100000)},
            {.names = {"--spacing"},
             .value = "D",
             .text = "Distance between isolines, world units times weight [a round one, about 16 "
                     "lines]",
             .reads = numberAboveZero(o.spacing),
             .excludes = {"--levels"}}};
}

std::vector<Option> meshAndTableOptions(ResultOptions& o) {
    return {
        {.names = {"--mesh-out"},
         .value = "FILE",
         .text = "The surface as triangles with distance, label and color: .ply, .vtp, .glb or "
                 ".obj; - writes PLY to stdout",
         .reads = text(o.meshOut)},
        {.names = {"--per-vertex"},
         .value = "FILE",
         .text = "Distances at the vertices of --mesh, under the file's own numbers: .csv, "
                 ".npy, .npz, .func.gii, or .ply, .vtp or .obj with its own vertices and faces; "
                 "- writes CSV to stdout",
         .reads = text(o.perVertex)},
        {.names = {"--per-seed"},
         .text = "In --per-vertex, a column for each seed, group of seeds, curve or mask by itself",
         .reads = flag(o.perSeed)},
        {.names = {"--samples"},
         .value = "FILE",
         .text = "What jet found at its foot points: position, normal, distance, gradient, "
                 "label; .npz, .csv or .ply; - writes CSV to stdout",
         .reads = text(o.samples)},
        {.names = {"--matrix"},
         .value = "FILE",
         .text = "All distances from seeds to targets, or between the seeds if there is no "
                 "target: .csv (a line per target), .json or .npy; - writes CSV to stdout",
         .reads = text(o.matrix)},
        {.names = {"--matrix-rows"},
         .value = "K/N",
         .text = "Only the K-th of N parts of the rows, as .json; batch merge --matrix joins "
                 "them",
         .reads = parsed(o.matrixRows, Part::parse)},
        {.names = {"--pairs-out"},
         .value = "FILE",
         .text = "Distances of --pairs: .csv or .json (docs/pairs.schema.json); - writes CSV "
                 "to stdout [-]",
         .reads = text(o.pairsOut)}};
}

}  // namespace

void addResultOptions(Command& command, ResultOptions& o) {
    command.add("Results", volumeOptions(o));
    command.add("Results", curveOptions(o));
    command.add("Results", meshAndTableOptions(o));
}

void addReportOption(Command& command, ResultOptions& o) {
    command.add("Results",
                {{.names = {"--report"},
                  .value = "FILE",
                  .text = "Report: parameters, counts, snap distances, timings; - writes to stdout",
                  .reads = text(o.report)}});
}

void addPictureOptions(Command& command, PictureOptions& o) {
    command.add(
        "Picture",
        {{.names = {"--image"},
          .value = "FILE.png",
          .text = "The surface as a picture: distances, isolines, paths",
          .reads = text(o.image)},
         {.names = {"--view"},
          .value = "FILE.html",
          .text = "The same as a page to turn, zoom and read in a browser; it needs no network",
          .reads = text(o.view)},
         {.names = {"--image-size"},
          .value = "WxH",
          .text = "In pixels [1280x960]",
          .reads = parsed(o.imageSize, imageSizeOf)},
         {.names = {"--camera"},
          .value = "X,Y,Z[,X,Y,Z]",
          .text = "Where the camera is and what it looks at, world units [chosen; the middle]",
          .reads = parsed(o.camera, cameraOf)},
         {.names = {"--up"},
          .value = "AXIS",
          .text = "The direction that points up: x, y, z, -x, -y or -z [y]",
          .reads = upAxis(o.up)},
         {.names = {"--background"},
          .value = "COLOR",
          .text = "white, black or transparent [white]",
          .reads = choice(o.background, kBackgrounds)},
         {.names = {"--unit"},
          .value = "NAME",
          .text = "Unit of the world, for the legend, such as mm",
          .reads = parsed(o.unit, unitOf)},
         {.names = {"--color-map"},
          .value = "NAME",
          .text =
              "Colors of picture, page, mesh and color grid: viridis, magma, cividis, turbo, gray "
              "[viridis]",
          .reads = colorMap(o.colorMap)}});
}
