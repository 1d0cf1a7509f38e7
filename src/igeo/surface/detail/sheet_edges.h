/// Sharp edges of a cloud, in which two sheets meet. Internal.
#pragma once

#include <igeo/base/point_tree.h>
#include <igeo/surface/detail/orient_normals.h>
#include <igeo/surface/quadric_fit.h>

#include <cstdint>
#include <vector>

namespace igeo {

/// The fits at the points of a cloud.
struct SheetFits {
    const PointTree& points;
    const std::vector<double>& spacing;  ///< per point
    /// Per point: by how much its fit misses the points around, and the point itself; spacings
    const std::vector<double>& misfit;
    std::vector<Quadric>& quadric;
    std::vector<Vec3d>& normal;
};

/// Bits of a point: its sheet ends at a sharp edge within two spacings, or one does that is within
/// three.
constexpr std::uint8_t kAtEdge = 1, kBesideEdge = 2;
/// Cosine of the normals of two sheets that meet in a sharp edge: S turns by 78 degrees there.
constexpr double kSheetsMeet = 0.2;

/// Separates the sheets that meet in sharp edges.
///
/// A quadric cannot follow both faces of an edge, and one that was fitted to points of both lies
/// between them. Where the fit at a point misses the points around, the one beside it counts that
/// misses none and passes nearest, if the planes of two sheets meet nearby and every normal around
/// is close to that of one of them. So a bend that the points resolve stays one.
/// @param noise        scatter of the points, spacings
/// @param orientation  takes the signs that edges tell; null: they are known
/// @return per point, bits: kAtEdge, kBesideEdge
/// Time O(n log n), in parallel but for the signs.
std::vector<std::uint8_t> separateSheets(const SheetFits& fits, double noise,
                                         Orientation* orientation);

}  // namespace igeo
