/// A surface with its distances as one HTML page, to be turned and read in a browser.
#pragma once

#include <igeo/results/curve_files.h>
#include <igeo/results/surface_mesh.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace igeo {

/// A point with a name on a page.
struct ViewPoint {
    std::string name;
    Vec3d position;                    ///< world
    std::optional<double> distance{};  ///< of a target; +infinity: not reached
};

/// What a page shows; world units. Names may hold any bytes: they are shown as text.
struct ViewScene {
    static constexpr std::uint32_t kNoNumber = std::numeric_limits<std::uint32_t>::max();

    std::string title;    ///< of the page
    std::string creator;  ///< the program and its version
    SurfaceMesh mesh;     ///< in the world; `distance` is the number that colors show
    std::vector<std::uint8_t> blocked{};  ///< per vertex: in an obstacle; empty: none is
    /// Per vertex: its number in a file, kNoNumber: it has none; empty: there is no such file.
    std::vector<std::uint32_t> number{};
    std::vector<NamedCurve> lines{};
    std::vector<ViewPoint> seeds{}, targets{};
    std::vector<std::string> labelNames{};  ///< of SurfaceMesh::label; less than two: no cells
    std::optional<Similarity> voxels{};  ///< whose coordinates are shown beside those of the world

    std::string quantity = "distance", unit = "world units";
    std::string rest = "not reached";  ///< where the quantity is infinite
    std::optional<double> restShare;   ///< of the surface; none: that of the triangles
    bool grows = true;  ///< a front passes over the surface; else there are no isolines either
    /// Of the colors; none: those of the mesh. Values beyond it have the colors of its ends.
    std::optional<std::array<double, 2>> range{};
    std::vector<std::string> notes{};  ///< sentences below

    std::string colorMap = "viridis";   ///< ColorMap::names(), at first
    double isolineSpacing = 0;          ///< at first; 0: a round one, negative: none
    Vec3d toEye{0, 0, 1}, up{0, 1, 0};  ///< the first view, unit
    std::string still{};                ///< PNG that is shown where the browser draws nothing in 3D
};

/// Whether igeo was built with three.js, without which there are no pages.
bool hasViewer();

/// The page: HTML in UTF-8 that needs no other file and no network. Positions are rounded to
/// 1/65535 of the longest side of the surface, distances to 1/65533 of their range; both are packed
/// with zlib.
/// @throws Error  InvalidArgument where there are no triangles, for an unknown color map, and where
///         hasViewer() is false
/// Time O(triangles), mostly that of zlib. The same bytes for any number of threads.
std::string viewPage(const ViewScene& scene);

/// ViewScene::still in a page, as an address for an `<img>`; empty: there is none.
/// @param page  viewPage(), or its first bytes: the picture is before the arrays of the scene
std::string stillOfPage(std::string_view page);

/// Leaves out triangles until there are `most` at the most: of the vertices in a cube of space with
/// normals in one octant the one nearest to their mean stays, with its values.
/// @param kept  set to the numbers that the vertices left had
/// @return whether any was left out
/// Time O(triangles) per size of cube, of which there are a few.
bool thinOut(SurfaceMesh& mesh, std::size_t most, std::vector<std::uint32_t>& kept);

}  // namespace igeo
