/// psi = 0 of a band as triangles. Internal to the pictures.
#pragma once

#include <igeo/band/band.h>
#include <igeo/results/surface_mesh.h>

namespace igeo {

/// Dual contouring: a vertex in each cell with an edge that psi crosses between two nodes, moved
/// onto psi = 0, and a quadrilateral around each such edge, cut along its shorter diagonal. Normals
/// are the means of the triangles around. Where psi changes its sign by more than a distance may,
/// between two sheets, there is nothing. Time O(nodes), in parallel but for the numbering; without
/// OpenVDB.
SurfaceMesh bandMesh(const Band& band);

}  // namespace igeo
