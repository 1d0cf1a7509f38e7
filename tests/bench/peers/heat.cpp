#include <CGAL/Heat_method_3/Surface_mesh_geodesic_distances_3.h>
#include <CGAL/Simple_cartesian.h>

#include "cgal_mesh.h"
#include "peer.h"

namespace igeo::test {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

template <typename Mode>
class Heat : public Peer {
public:
    explicit Heat(const TriangleMesh& mesh) : mesh_(cgalMesh<Kernel::Point_3>(mesh)), heat_(mesh_) {
        distance_ = mesh_.add_property_map<Mesh::Vertex_index, double>("v:distance", 0).first;
    }

    std::vector<double> distances(std::size_t seed) override {
        heat_.clear_sources();
        heat_.add_source(Mesh::Vertex_index(Mesh::size_type(seed)));
        heat_.estimate_geodesic_distances(distance_);
        std::vector<double> result;
        for (const auto v : mesh_.vertices()) result.push_back(distance_[v]);
        return result;
    }

private:
    Mesh mesh_;
    CGAL::Heat_method_3::Surface_mesh_geodesic_distances_3<Mesh, Mode> heat_;
    Mesh::Property_map<Mesh::Vertex_index, double> distance_;
};

}  // namespace

std::unique_ptr<Peer> heatMethod(const TriangleMesh& mesh) {
    return std::make_unique<Heat<CGAL::Heat_method_3::Direct>>(mesh);
}

std::unique_ptr<Peer> heatMethodIntrinsicDelaunay(const TriangleMesh& mesh) {
    return std::make_unique<Heat<CGAL::Heat_method_3::Intrinsic_Delaunay>>(mesh);
}

}  // namespace igeo::test
