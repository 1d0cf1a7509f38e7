/// The triangles that a picture shows, in index space. Internal to the pictures.
#pragma once

#include <igeo/band/band.h>
#include <igeo/results/surface_mesh.h>

#include <array>
#include <memory>
#include <vector>

namespace igeo {

/// Triangles with normals for shading and a tree for rays. Several threads may use it at once.
class DrawnSurface {
public:
    /// Of a mesh: its own triangles, shaded smoothly over edges of less than 40 degrees. Otherwise
    /// psi = 0 of the band (bandMesh). The band must outlive this.
    explicit DrawnSurface(const Band& band);
    /// Triangles on S, made from a level set. If the mesh has distances, pictures use them and its
    /// normals, linear in each triangle, instead of those of the field and of psi.
    /// @param closed  whether they have an inside
    DrawnSurface(const Band& band, SurfaceMesh mesh, bool closed);

    const Similarity& transform() const { return band_.transform; }
    const SurfaceTriangles& triangles() const { return *triangles_; }

    /// Whether normals differ from triangle to triangle at a vertex.
    bool isCreased() const { return !creased_.empty(); }
    /// The unit normal for shading at a corner of a triangle.
    Vec3f cornerNormal(std::uint32_t triangle, unsigned corner) const;
    /// Whether the vertices have distances.
    bool hasDistances() const { return !distance_.empty(); }
    /// At a vertex, voxels; +infinity: unreached.
    double distance(std::uint32_t vertex) const { return distance_[vertex]; }
    /// Unit normal of the triangle nearest to a point; 0 without triangles.
    Vec3d normalNear(const Vec3d& p) const;

    /// Whether S has no rim, and normals away from its inside: what turns its back is hidden.
    bool hidesBacks() const { return hidesBacks_; }
    /// False where a point of S with this normal is on the far side of what it encloses.
    bool mayBeVisible(const Vec3d& n, const Vec3d& toEye) const {
        return !hidesBacks_ || dot(n, toEye) >= 0;
    }
    /// Whether the line from a point of S in the unit direction `toEye` is free.
    /// @param n  normalNear(p)
    bool isVisible(const Vec3d& p, const Vec3d& n, const Vec3d& toEye) const;
    /// Whether S encloses a point.
    bool encloses(const Vec3d& p) const;

private:
    const Band& band_;
    std::shared_ptr<const SurfaceTriangles> triangles_;
    bool closed_, hidesBacks_;
    double clearance_;                           ///< of a ray that starts on S, voxels
    std::vector<std::array<Vec3f, 3>> creased_;  ///< normals per triangle and corner
    std::vector<Vec3f> normal_;                  ///< per vertex: the mean of its triangles
    std::vector<double> distance_;               ///< per vertex
};

}  // namespace igeo
