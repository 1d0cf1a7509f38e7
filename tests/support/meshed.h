/// Shapes solved and meshed, and what holds for every mesh.
#pragma once

#include <igeo/march/jet.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/level_set.h>
#include <support/pinned.h>
#include <support/shapes.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace igeo::test {

struct Meshed : Pinned {
    LevelSet levelSet;
    Band band;
    Field field;
    SurfaceMesh mesh;

    Meshed(const openvdb::FloatGrid::Ptr& grid, const std::vector<openvdb::Vec3d>& seeds,
           const JetOptions& options);

    /// World position.
    openvdb::Vec3d world(const Vec3d& pIndex) const;
};

/// The level set of a shape, half-width 3 voxels; band of sqrt(3); jet from the seeds (world).
Meshed meshed(const Shape& shape, const openvdb::math::Transform& transform,
              const std::vector<openvdb::Vec3d>& seeds, const JetOptions& options = {});
Meshed meshed(const Shape& shape, double dx, const std::vector<openvdb::Vec3d>& seeds,
              const JetOptions& options = {});
Meshed meshed(const openvdb::FloatGrid::Ptr& grid, const std::vector<openvdb::Vec3d>& seeds,
              const JetOptions& options = {});

/// How many triangles share an edge, and the numbers that follow.
struct Topology {
    std::map<std::size_t, std::size_t> edgesByTriangles;  ///< edges with so many triangles
    std::size_t sameWay = 0;  ///< edges with two triangles that both run along it one way
    int euler = 0;            ///< vertices - edges + triangles
    std::size_t rimLoops = 0;

    bool closed() const { return edgesByTriangles.size() == 1 && edgesByTriangles.count(2) == 1; }
};
Topology topologyOf(const SurfaceMesh& mesh);

double meshArea(const SurfaceMesh& mesh);

/// A color map that values can be read from.
inline Vec3f ramp(double t) { return {float(t), 0.25f, float(1 - t)}; }

/// A binary PLY file taken apart: per element the rows, per row the numbers; of a list its items.
struct Ply {
    std::vector<std::string> header;
    std::map<std::string, std::vector<std::string>> properties;  ///< names, by element
    std::map<std::string, std::vector<std::vector<double>>> rows;

    double value(const std::string& element, std::size_t row, const std::string& property) const;
};
/// @throws std::runtime_error  unless the bytes are a file of this kind from its first to its last
Ply parsePly(const std::string& bytes);

}  // namespace igeo::test
