/// Other geodesics on a mesh, one file per library or method, all behind one interface.
#pragma once

#include <igeo/io/triangle_mesh.h>

#include <memory>
#include <vector>

#include "bench/points_csv.h"

namespace igeo::test {

/// A method on one mesh. What does not depend on the seed is done when it is made.
class Peer {
public:
    virtual ~Peer() = default;
    /// Distances at all vertices from one of them.
    virtual std::vector<double> distances(std::size_t seed) = 0;
};

/// CGAL's Heat_method_3 (Crane, Weischedel and Wardetzky 2013), Eigen's sparse LDL^T.
std::unique_ptr<Peer> heatMethod(const TriangleMesh& mesh);
/// The same on the intrinsic Delaunay triangulation.
std::unique_ptr<Peer> heatMethodIntrinsicDelaunay(const TriangleMesh& mesh);
/// The heat method with a time of ten mean edges squared, written here, Eigen's sparse LDL^T.
std::unique_ptr<Peer> heatMethodTuned(const TriangleMesh& mesh);
/// Fast marching (Kimmel and Sethian 1998), written here.
std::unique_ptr<Peer> fastMarching(const TriangleMesh& mesh);
/// CGAL's Surface_mesh_shortest_path (Xin and Wang 2009): exact on the facets.
std::unique_ptr<Peer> exactOnMesh(const TriangleMesh& mesh);
/// VTK's vtkDijkstraGraphGeodesicPath: along edges.
std::unique_ptr<Peer> dijkstraOnEdges(const TriangleMesh& mesh);

/// Sets the distances of points to those on the mesh, from the point of the mesh nearest to `seed`
/// to those nearest to them, exact on the facets; +inf: not connected.
void exactAtPoints(const TriangleMesh& mesh, const Vec3d& seed,
                   const std::vector<PointsCsv*>& points);

}  // namespace igeo::test
