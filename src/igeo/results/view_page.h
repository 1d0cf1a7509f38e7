/// A surface with its distances as one interactive HTML page.
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

/// A named point on a page.
struct ViewPoint {
    std::string name;
    Vec3d position;                    ///< world
    std::optional<double> distance{};  ///< of a target; +infinity: unreached
};

/// The content of a page; world units. Names may hold any bytes: they are shown as text.
struct ViewScene {
    static constexpr std::uint32_t kNoNumber = std::numeric_limits<std::uint32_t>::max();

    std::string title;    ///< of the page
    std::string creator;  ///< the program and its version
    SurfaceMesh mesh;     ///< in world space; `distance` is the quantity shown by colors
    std::vector<std::uint8_t> blocked{};  ///< per vertex: in an obstacle; empty: no obstacles
    /// Per vertex: its number in a file, kNoNumber: none; empty: there is no file.
    std::vector<std::uint32_t> number{};
    std::vector<NamedCurve> lines{};
    std::vector<ViewPoint> seeds{}, targets{};
    std::vector<std::string> labelNames{};  ///< of SurfaceMesh::label; fewer than two: no cells
    std::optional<Similarity> voxels{};     ///< shows voxel coordinates beside world coordinates

    std::string quantity = "distance", unit = "world units";
    std::string rest = "not reached";  ///< label of the parts where the quantity is infinite
    /// Share of these parts of the surface; none: computed from the triangles
    std::optional<double> restShare;
    bool grows = true;  ///< the page animates a front; false: no isolines either
    /// The range of the colors; none: that of the mesh. Values beyond it have the colors of its
    /// ends.
    std::optional<std::array<double, 2>> range{};
    std::vector<std::string> notes{};  ///< sentences below the picture

    std::string colorMap = "viridis";   ///< initial, one of ColorMap::names()
    double isolineSpacing = 0;          ///< initial; 0: a round one, negative: none
    Vec3d toEye{0, 0, 1}, up{0, 1, 0};  ///< of the first view, unit
    std::string still{};                ///< PNG for browsers without 3D
};

/// Whether igeo was built with three.js, which pages need.
bool hasViewer();

/// The page: HTML in UTF-8, complete without other files or a network. Positions are rounded to
/// 1/65535 of the longest side of the surface, distances to 1/65533 of their range; both are packed
/// with zlib.
/// @throws Error  InvalidArgument without triangles, for an unknown color map, and where
///         hasViewer() is false
/// Time O(triangles), mostly that of zlib. The same bytes for any number of threads.
std::string viewPage(const ViewScene& scene);

/// ViewScene::still of a page, as an address for an `<img>`; empty: none.
/// @param page  viewPage(), or its start: the picture precedes the arrays of the scene
std::string stillOfPage(std::string_view page);

/// Simplifies the mesh to `most` triangles at most: of the vertices in a cube of space with normals
/// in one octant the one nearest to their mean is kept, with its values.
/// @param kept  set to the former numbers of the remaining vertices
/// @return whether any was removed
/// Time O(triangles) per size of cube, of which a few are tried.
bool thinOut(SurfaceMesh& mesh, std::size_t most, std::vector<std::uint32_t>& kept);

}  // namespace igeo
