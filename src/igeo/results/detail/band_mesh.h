/// psi = 0 of a band as triangles. Internal to the pictures.
#pragma once

#include <igeo/band/band.h>
#include <igeo/results/surface_mesh.h>

namespace igeo {

/// Dual contouring: a vertex in each cell with an edge that psi crosses between two nodes,
/// projected to psi = 0, and a quadrilateral around each such edge, cut along its shorter diagonal.
/// Normals are the means of the triangles around. Where psi changes by more than a distance can,
/// between two sheets, there is no surface. Time O(nodes), in parallel except for the numbering;
/// without OpenVDB.
SurfaceMesh bandMesh(const Band& band);

}  // namespace igeo
