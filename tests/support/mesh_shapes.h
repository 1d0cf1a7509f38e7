/// Triangle meshes of known surfaces, and files of them in every format.
#pragma once

#include <igeo/io/triangle_mesh.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace igeo::test {

/// Half-width of the bands from meshes, voxels: 26 neighbors.
inline const double kHalfWidth = std::sqrt(3.0);

/// f over [0, 1]^2 in nu by nv quadrilaterals, each cut in two.
/// @param keep  leaves quadrilaterals out, by their middle
TriangleMesh sheet(std::size_t nu, std::size_t nv, const std::function<Vec3d(double, double)>& f,
                   const std::function<bool(double, double)>& keep = nullptr);

/// Sphere about `center`: an icosahedron whose triangles are cut in four `rounds` times.
TriangleMesh sphereMesh(const Vec3d& center, double radius, int rounds);

/// The box from 0 to `size`, two triangles per face.
TriangleMesh boxMesh(const Vec3d& size);

/// A plate of 20 x 20 x 6 about the origin with a square tunnel of `width` through its middle.
TriangleMesh plateWithTunnel(double width);

/// The sides of a prism: an outline in x and z, from y = 0 to `width`.
/// @param at  places a point
TriangleMesh prismMesh(const std::vector<std::array<double, 2>>& outline, double width,
                       const std::function<Vec3d(double, double, double)>& at);

/// Moebius strip of a turn of `radius`, `width` across, in n pieces.
TriangleMesh moebius(double radius, double width, std::size_t n);

/// The two meshes in one.
TriangleMesh together(TriangleMesh a, const TriangleMesh& b);

/// Every point moved.
TriangleMesh moved(TriangleMesh mesh, const std::function<Vec3d(const Vec3d&)>& place);

/// Edges along which two triangles run the same way.
std::size_t turnedEdges(const TriangleMesh& mesh);

/// Writes a mesh by the ending of the name: .obj, .off, .ply (binary), .stl (binary), .gltf (with
/// its numbers inside; a node moves all points by (1, 2, 3) and doubles them first).
/// @param text  .ply and .stl as text
void writeMesh(const TriangleMesh& mesh, const std::string& file, bool text = false);

}  // namespace igeo::test
