#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include "cgal_mesh.h"
#include "peer.h"

namespace igeo::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Paths =
    CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>>;
using TreeTraits = CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>;

/// CGAL says -1 where there is no path.
double orInfinity(double distance) { return distance < 0 ? kInfinity : distance; }

class Exact : public Peer {
public:
    explicit Exact(const TriangleMesh& mesh)
        : mesh_(cgalMesh<Kernel::Point_3>(mesh)), paths_(mesh_) {}

    std::vector<double> distances(std::size_t seed) override {
        paths_.remove_all_source_points();
        paths_.add_source_point(Mesh::Vertex_index(Mesh::size_type(seed)));
        paths_.build_sequence_tree();
        std::vector<double> result;
        for (const auto v : mesh_.vertices())
            result.push_back(orInfinity(paths_.shortest_distance_to_source_points(v).first));
        return result;
    }

private:
    Mesh mesh_;
    Paths paths_;
};

}  // namespace

std::unique_ptr<Peer> exactOnMesh(const TriangleMesh& mesh) {
    return std::make_unique<Exact>(mesh);
}

void exactAtPoints(const TriangleMesh& mesh, const Vec3d& seed,
                   const std::vector<PointsCsv*>& points) {
    const Mesh surface = cgalMesh<Kernel::Point_3>(mesh);
    Paths paths(surface);
    CGAL::AABB_tree<TreeTraits> tree;
    paths.build_aabb_tree(tree);
    // A vertex whose coordinates were rounded lies in a face. From there CGAL misses shorter paths:
    // on a machined part 5.68 for 3.80.
    constexpr double kVertex = 1 - 1e-6;
    const auto locate = [&](const Vec3d& p) {
        const auto at = paths.locate<TreeTraits>(Kernel::Point_3(p.x, p.y, p.z), tree);
        auto corner = surface.halfedge(at.first);
        corner = surface.prev(corner);  // its target is the first vertex of the face
        for (std::size_t k = 0; k < 3; ++k, corner = surface.next(corner))
            if (at.second[k] > kVertex) return paths.face_location(surface.target(corner));
        return at;
    };
    paths.add_source_point(locate(seed));
    for (PointsCsv* csv : points)
        for (std::size_t k = 0; k < csv->points.size(); ++k) {
            const auto at = locate(csv->points[k]);
            csv->distance[k] =
                orInfinity(paths.shortest_distance_to_source_points(at.first, at.second).first);
        }
}

}  // namespace igeo::test
