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

    /// The unit normal for shading at a point of a triangle, blended from its corners.
    /// @param share  barycentric coordinates, sum 1
    /// @param dir    of the ray that meets the point; the normal is on the same side of it as that
    ///               of the triangle
    Vec3d normal(std::uint32_t triangle, const std::array<double, 3>& share,
                 const Vec3d& dir) const;
    /// Whether the corners have distances.
    bool hasDistances() const { return !distance_.empty(); }
    /// Blended from the corners, voxels; +infinity where one has none.
    double distance(std::uint32_t triangle, const std::array<double, 3>& share) const;
    /// Unit normal of the triangle nearest to a point; 0 without triangles.
    Vec3d normalNear(const Vec3d& p) const;

    /// Whether the line from a point of S in the unit direction `toEye` is free.
    /// @param n  normalNear(p)
    bool isVisible(const Vec3d& p, const Vec3d& n, const Vec3d& toEye) const;
    /// Whether S encloses a point.
    bool encloses(const Vec3d& p) const;

private:
    const Band& band_;
    std::shared_ptr<const SurfaceTriangles> triangles_;
    bool closed_;
    double clearance_;  ///< of a ray that starts on S, voxels
    std::vector<std::array<Vec3f, 3>> cornerNormals_;
    std::vector<double> distance_;  ///< per vertex
};

}  // namespace igeo
