/// Curves on a surface as files: text, meshes of edges, scenes.
#pragma once

#include <igeo/base/types.h>
#include <igeo/io/poly_data.h>
#include <igeo/results/isolines.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// A curve in world units, with values at its vertices.
struct NamedCurve {
    std::string name;        ///< "target_3"; consecutive curves of one name are one object
    std::size_t number = 0;  ///< in tables
    bool closed = false;     ///< the last vertex repeats the first
    std::vector<Vec3d> points, normals;
    std::vector<double> arcLength, distance;
};

/// The kind of curves, for the words in files.
enum class CurveKind { Path, Isoline };

/// Isolines in world units, named by their level: "isoline_0.25".
std::vector<NamedCurve> namedCurves(const std::vector<Isoline>& lines, const Similarity& transform);

/// The endings that curveFile accepts.
constexpr const char* kCurveEndings = ".csv .obj .ply .usda .vtp";

/// The file for an ending, one of kCurveEndings. Curves of fewer than two vertices have no edges.
///
/// - .csv: a line per vertex, `path,vertex,x,y,z,arcLength,distance,nx,ny,nz`, or
///   `line,level,vertex,x,y,z,arcLength,nx,ny,nz`; numbers that read as the same doubles.
/// - .obj: an object per name, `v` and `vn` per vertex, `l a b` per segment.
/// - .ply: binary, vertices `x y z` (double), `nx ny nz distance arcLength` (float), `path` or
///   `line` (int); edges `vertex1 vertex2`.
/// - .usda: per name BasisCurves, linear, with normals and primvars distance and arcLength.
/// - .vtp: polylines.
///
/// In .obj and .ply, edges of closed curves return to the first vertex; other formats repeat it.
std::string curveFile(const std::string& ending, CurveKind kind,
                      const std::vector<NamedCurve>& curves);

}  // namespace igeo
