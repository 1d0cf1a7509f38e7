#include "extracted_mesh.h"

#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>

namespace igeo::test {

TriangleMesh extractedMesh(const openvdb::FloatGrid& psi) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(psi, points, triangles, quads);
    TriangleMesh mesh;
    for (const openvdb::Vec3s& p : points) mesh.points.emplace_back(p.x(), p.y(), p.z());
    for (const openvdb::Vec3I& t : triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
    const auto size = [&](openvdb::Index32 a, openvdb::Index32 b) {
        return length(mesh.points[a] - mesh.points[b]);
    };
    for (const openvdb::Vec4I& q : quads) {
        const int k = size(q[0], q[2]) <= size(q[1], q[3]) ? 0 : 1;
        mesh.triangles.push_back({q[k], q[k + 1], q[k + 2]});
        mesh.triangles.push_back({q[k], q[k + 2], q[(k + 3) % 4]});
    }
    return mesh;
}

double meanEdge(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            sum += length(mesh.points[t[(k + 1) % 3]] - mesh.points[t[k]]);
    return sum / (3 * double(mesh.triangles.size()));
}

std::size_t nearestVertex(const TriangleMesh& mesh, const Vec3d& p) {
    const auto nearer = [&](const Vec3d& a, const Vec3d& b) {
        return length(a - p) < length(b - p);
    };
    return std::size_t(std::min_element(mesh.points.begin(), mesh.points.end(), nearer) -
                       mesh.points.begin());
}

}  // namespace igeo::test
