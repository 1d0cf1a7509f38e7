/// Rays against the triangles of a mesh. Internal to the pictures.
#pragma once

#include <igeo/band/band.h>
#include <igeo/results/detail/surface_rays.h>

#include <array>
#include <memory>
#include <vector>

namespace igeo {

class TriangleRays final : public SurfaceRays {
public:
    /// @param band  with triangles; it has to outlive this and its copies
    explicit TriangleRays(const Band& band);

    std::unique_ptr<SurfaceRays> copy() const override;
    const Similarity& transform() const override { return band_.transform; }
    double clearance() const override { return 0.01; }
    std::optional<double> hit(const Vec3d& from, const Vec3d& dir) const override;
    /// Blended from the corners of the nearest triangle.
    Vec3d normal(const Vec3d& p, const Vec3d& dir = {}) const override;
    bool encloses(const Vec3d& p) const override;
    std::size_t chunks() const override;
    void forPoints(std::size_t chunk,
                   const std::function<void(const Vec3d&)>& visit) const override;

private:
    const Band& band_;
    const SurfaceTriangles& triangles_;
    /// Per triangle and corner: the mean normal of the faces there that are nearly parallel.
    std::shared_ptr<const std::vector<std::array<Vec3f, 3>>> cornerNormals_;
};

}  // namespace igeo
