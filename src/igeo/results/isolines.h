/// Lines of equal distance on S (M&S, Fig. 8).
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/results/surface_mesh.h>

#include <vector>

namespace igeo {

/// A line on which the distance is `level`. Points nearer to the seeds lie to its left, seen from
/// outside in world space.
struct Isoline {
    double level = 0;            ///< voxels times weight; negative where the seeds enclose it
    double length = 0;           ///< of the polyline, voxels
    bool closed = false;         ///< the last point is joined to the first
    std::vector<Vec3d> points;   ///< on psi = 0, index space; no repeats
    std::vector<Vec3d> normals;  ///< unit, of S at each (normalAt), index space
};

/// The isolines of `field` at some levels, in ascending order of level.
///
/// A line passes from triangle to triangle over the edges whose ends are on two sides of the level
/// (a value equal to it is above), so it neither breaks nor branches: on a closed surface that is
/// reached everywhere all lines are closed. Lines end at the rim of an open surface, at unknown
/// distances and at obstacles. The point on an edge is where sampleDistance() equals the level
/// along the edge's projection to psi = 0, to 1e-6 voxels (along the edge itself where a corner of
/// the cell is not in the band).
/// @param mesh   surfaceMesh() of the same field
/// @param levels voxels times weight, finite; negative ones only where the field has signs. Levels
///               beyond the distances give no lines, nor does 0, where the seeds are
/// @throws Error  InvalidArgument for other levels; Cancelled through `progress`
/// Time O(triangles log triangles + points), in parallel over points. Points are as accurate as the
/// distance; a polyline with edges of length s on a line of curvature k is short by (k s)^2/24.
std::vector<Isoline> isolines(const Field& field, const SurfaceMesh& mesh,
                              const std::vector<double>& levels,
                              Progress& progress = Progress::none());

/// Multiples of `spacing`, from the least positive one above the least start value of a seed up to
/// the largest distance. Voxels times weight.
/// @throws Error  InvalidArgument unless spacing is finite, > 0 and gives 100000 levels at most
std::vector<double> levelsBySpacing(const Field& field, double spacing);

/// `count` levels that divide the range of the distance into count + 1 equal parts.
/// @throws Error  InvalidArgument unless 1 <= count <= 100000
std::vector<double> levelsByCount(const Field& field, int count);

/// Levels >= 0 and, of a field with signs, their negatives too, for isolines on both sides of the
/// seeds.
std::vector<double> onBothSides(const Field& field, const std::vector<double>& levels);

/// The levels of isolines in files, pictures and legends, without signs: by count if it is above 0,
/// else by spacing (world units times weight), or by a round spacing that gives about 16 if it is
/// 0. Empty where all distances are equal.
/// @throws Error  as the two above
std::vector<double> chosenLevels(const Field& field, int count, double spacing);

/// The one of 1, 2 and 5 times the powers of ten that divides `range` > 0 into about so many parts
/// (nearest by ratio).
double roundSpacing(double range, double lines);

}  // namespace igeo
