#pragma once

#include <CGAL/Surface_mesh.h>
#include <igeo/io/triangle_mesh.h>

#include <stdexcept>
#include <string>

namespace igeo::test {

/// A mesh as CGAL has it, vertices in the same order.
/// @throws std::runtime_error  for a mesh that is no manifold, which CGAL's methods need
template <typename Point>
CGAL::Surface_mesh<Point> cgalMesh(const TriangleMesh& mesh) {
    using Mesh = CGAL::Surface_mesh<Point>;
    using Vertex = typename Mesh::Vertex_index;
    Mesh result;
    for (const Vec3d& p : mesh.points) result.add_vertex(Point(p.x, p.y, p.z));
    std::size_t refused = 0;
    for (const auto& t : mesh.triangles)
        if (result.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])) == Mesh::null_face())
            ++refused;
    if (refused > 0)
        throw std::runtime_error("the mesh is no manifold: CGAL refuses " +
                                 std::to_string(refused) + " triangles");
    return result;
}

}  // namespace igeo::test
