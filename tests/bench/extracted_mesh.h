/// The mesh that one would work on without a band.
#pragma once

#include <igeo/io/triangle_mesh.h>
#include <openvdb/openvdb.h>

namespace igeo::test {

/// psi = 0 as OpenVDB's volumeToMesh extracts it, world units; quadrilaterals are cut along the
/// shorter diagonal.
TriangleMesh extractedMesh(const openvdb::FloatGrid& psi);

/// The mean length of its edges, those between two triangles counted twice.
double meanEdge(const TriangleMesh& mesh);

/// The vertex nearest to p.
std::size_t nearestVertex(const TriangleMesh& mesh, const Vec3d& p);

}  // namespace igeo::test
