#include "input/vertex_input.h"

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/error.h>
#include <igeo/io/annotation_file.h>
#include <igeo/io/vdb_read.h>
#include <igeo/io/vertex_data_file.h>
#include <igeo/metric/vertex_weights.h>

#include <algorithm>
#include <cmath>

#include "input/guarded_read.h"
#include "options/reader.h"

namespace {

using Kind = igeo::Error::Kind;

const igeo::TriangleMesh& meshOf(const igeo::Surface& surface, const std::string& file) {
    if (const igeo::TriangleMesh* mesh = surface.triangles()) return *mesh;
    throw igeo::Error(Kind::InvalidArgument,
                      "'" + file + "' holds values per vertex, and the surface is no mesh",
                      "give the surface by --mesh, or the values as a grid in a .vdb file");
}

std::size_t verticesOf(const igeo::TriangleMesh& mesh) {
    return mesh.source ? mesh.source->vertices.size() : mesh.points.size();
}

std::vector<double> valuesOf(const std::string& file, const igeo::TriangleMesh& mesh) {
    return guardedRead(file, [&] { return igeo::readVertexData(file, verticesOf(mesh)); });
}

std::vector<bool> blockedVertices(const igeo::GridSource& source,
                                  const std::vector<double>& values) {
    std::vector<bool> blocked(values.size());
    const auto wanted =
        source.grid.empty() ? std::optional<double>(0) : igeo::parseDouble(source.grid);
    if (!wanted)
        throw igeo::Error(Kind::InvalidArgument,
                          "'" + source.grid + "' is no value of a vertex ('" + source.file + "')",
                          "write FILE, or FILE:V with the value of the vertices that are meant");
    for (std::size_t v = 0; v < values.size(); ++v) {
        if (std::isnan(values[v]) && !std::isnan(*wanted))
            throw igeo::Error(Kind::BadInput,
                              fmt::format("the value of vertex {} in '{}' is NaN", v, source.file),
                              "write " + source.file + ":nan if the vertices with NaN are meant");
        const bool same = std::isnan(*wanted) ? std::isnan(values[v]) : values[v] == *wanted;
        blocked[v] = source.grid.empty() ? !same : same;
    }
    return blocked;
}

/// The vertices of the named region.
std::vector<bool> regionVertices(const igeo::GridSource& source, const igeo::TriangleMesh& mesh) {
    const igeo::Annotation annotation =
        guardedRead(source.file, [&] { return igeo::readAnnotation(source.file); });
    requireVertices(source.file, annotation.vertices, verticesOf(mesh));
    std::vector<bool> inside(annotation.vertices);
    std::vector<std::string> names;
    for (const igeo::VertexRegion& region : annotation.regions) {
        names.push_back(region.name);
        if (region.name == source.grid)
            for (const std::size_t v : region.vertices) inside[v] = true;
    }
    if (std::find(names.begin(), names.end(), source.grid) == names.end())
        throw igeo::Error(Kind::InvalidArgument,
                          source.grid.empty()
                              ? "'" + source.file + "' holds regions, and none is named"
                              : "'" + source.file + "' has no region '" + source.grid + "'" +
                                    didYouMean(source.grid, names),
                          "write FILE.annot:REGION; it has " + commaList(names));
    return inside;
}

using AddVertices = void (igeo::ObstacleSet::*)(const igeo::TriangleMesh&,
                                                const std::vector<bool>&);

std::vector<std::string> addBody(const igeo::GridSource& source, const igeo::Surface& surface,
                                 AddVertices addVertices, igeo::ObstacleSet& set) {
    if (igeo::isAnnotationFile(source.file)) {
        const igeo::TriangleMesh& mesh = meshOf(surface, source.file);
        (set.*addVertices)(mesh, regionVertices(source, mesh));
        return {};
    }
    if (igeo::isVertexDataFile(source.file)) {
        const igeo::TriangleMesh& mesh = meshOf(surface, source.file);
        (set.*addVertices)(mesh, blockedVertices(source, valuesOf(source.file, mesh)));
        return {};
    }
    const igeo::ObstacleGrid grid =
        guardedRead(source.file, [&] { return igeo::readObstacleGrid(source); });
    set.addGrid(grid);
    return grid.warnings;
}

}  // namespace

void requireVertices(const std::string& file, std::size_t count, std::size_t ofMesh) {
    if (count == ofMesh) return;
    throw igeo::Error(
        Kind::BadInput,
        fmt::format("'{}' is for {} vertices, and the mesh has {}", file, count, ofMesh),
        "give a file that belongs to this mesh");
}

std::vector<std::string> addObstacle(const igeo::GridSource& source, const igeo::Surface& surface,
                                     igeo::ObstacleSet& obstacles) {
    return addBody(source, surface, &igeo::ObstacleSet::addVertices, obstacles);
}

std::vector<std::string> addRegion(const igeo::GridSource& source, const igeo::Surface& surface,
                                   igeo::ObstacleSet& region) {
    return addBody(source, surface, &igeo::ObstacleSet::addVertexRegion, region);
}

std::vector<double> vertexWeights(const std::string& file, const igeo::Surface& surface) {
    const igeo::TriangleMesh& mesh = meshOf(surface, file);
    const std::vector<double> values = valuesOf(file, mesh);
    const auto bad = std::find_if(values.begin(), values.end(), [](double value) {
        return !(value > 0 && std::isfinite(value));
    });
    if (bad != values.end())
        throw igeo::Error(Kind::BadInput,
                          fmt::format("the weight of vertex {} in '{}' is {}; allowed are finite "
                                      "numbers above 0",
                                      bad - values.begin(), file, *bad),
                          "block those vertices by --obstacle, and give them any weight above 0");
    return igeo::valuesAtPoints(mesh, values);
}
