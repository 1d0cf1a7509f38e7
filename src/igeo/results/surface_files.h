/// Surfaces with distances as mesh files for other programs.
#pragma once

#include <igeo/results/surface_mesh.h>

#include <string>

namespace igeo {

/// The mesh as a binary PLY file: x y z, nx ny nz (float), red green blue (uchar); distance and
/// quality, the same number (float); label (int); s t and texture_u texture_v (float), (distance /
/// largest, 0) or (0, 1) where unreached; triangles. World units. Unreached vertices are gray and
/// have distance -1 and label -1, because MeshLab does not support NaN.
std::string surfacePly(const SurfaceMesh& mesh, const Similarity& transform, const Color& color);

/// The mesh as Wavefront OBJ, `v x y z r g b` (colors as Blender and MeshLab read them) and `f`.
std::string surfaceObj(const SurfaceMesh& mesh, const Similarity& transform, const Color& color);

/// The mesh for VTK (vtp_file.h), with data at the points: distance (float64), label (int32),
/// gradient of the distance and Normals (three float32). Unreached: distance NaN, label -1,
/// gradient 0.
std::string surfaceVtp(const SurfaceMesh& mesh, const Similarity& transform);

/// The mesh as binary glTF 2.0: POSITION, NORMAL, COLOR_0 (linear, as glTF requires), TEXCOORD_0,
/// (distance / largest, 0) or (0, 1) where unreached, _DISTANCE and _LABEL (-1: unreached), all
/// float32. Coordinates stay those of the world. In glTF y points up.
/// @param color  in linear light
/// @param up     the world's up direction; the node of the mesh rotates it to that of glTF
/// @throws Error  InvalidArgument for 4 GiB and more, the limit of glTF
std::string surfaceGlb(const SurfaceMesh& mesh, const Similarity& transform, const Color& color,
                       const Vec3d& up = {0, 1, 0});

}  // namespace igeo
