/// The triangles that a picture shows, in index space. Internal to the pictures.
#pragma once

#include <igeo/band/band.h>
#include <igeo/results/surface_mesh.h>

#include <array>
#include <memory>
#include <vector>

namespace igeo {

/// Triangles with normals for light and a tree for rays. For several threads at once.
class DrawnSurface {
public:
    /// Of a mesh: its own triangles, smooth over edges of less than 40 degrees. Else psi = 0 of the
    /// band (bandMesh). The band has to outlive this.
    explicit DrawnSurface(const Band& band);
    /// Triangles on S that were made of a level set. Where the mesh has distances, pictures take
    /// them, linear in each triangle, instead of those of the field.
    /// @param closed  whether they have an inside
    DrawnSurface(const Band& band, SurfaceMesh mesh, bool closed);

    const Similarity& transform() const { return band_.transform; }
    const SurfaceTriangles& triangles() const { return *triangles_; }

    /// Unit normal for light at a point of a triangle, blended from its corners.
    /// @param share  of the corners, their sum 1
    /// @param dir    of the ray that meets the point; the normal faces it as the triangle does
    Vec3d normal(std::uint32_t triangle, const std::array<double, 3>& share,
                 const Vec3d& dir) const;
    /// Whether the corners have distances.
    bool hasDistances() const { return !distance_.empty(); }
    /// Blended from the corners, voxels; +infinity where one has none.
    double distance(std::uint32_t triangle, const std::array<double, 3>& share) const;
    /// Unit normal of the triangle nearest to a point; 0 where there is none.
    Vec3d normalNear(const Vec3d& p) const;

    /// Whether nothing lies between a point of S and an eye in the unit direction `toEye`.
    bool isVisible(const Vec3d& p, const Vec3d& toEye) const;
    /// Whether S has an inside that holds a point.
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
