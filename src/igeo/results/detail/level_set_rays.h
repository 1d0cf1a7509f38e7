/// Rays against a level set, and its normal, in index space. Internal to the pictures.
#pragma once

#include <igeo/results/detail/surface_rays.h>
#include <igeo/surface/level_set.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/RayIntersector.h>

#include <vector>

namespace igeo {

/// OpenVDB's ray intersector on a level set. Not for two threads at once; copies are cheap.
class LevelSetRays final : public SurfaceRays {
public:
    explicit LevelSetRays(const LevelSet& levelSet)
        : levelSet_(levelSet),
          grid_(levelSetClass(levelSet)),
          rays_(*grid_),
          accessor_(grid_->getConstAccessor()),
          cut_(levelSet.stats.cutVoxels > 0) {
        levelSet.psi->tree().getNodes(leaves_);
    }

    std::unique_ptr<SurfaceRays> copy() const override {
        return std::make_unique<LevelSetRays>(*this);
    }
    const Similarity& transform() const override { return levelSet_.transform; }
    double clearance() const override { return 1.5; }

    std::optional<double> hit(const Vec3d& from, const Vec3d& dir) const override {
        openvdb::math::Ray<double> ray(vdb(from), vdb(dir));
        openvdb::Vec3d p;
        double t = 0;
        while (rays_.intersectsIS(ray, p, t)) {
            if (!cut_ || cellIsActive(p)) return t;
            ray.setMinTime(t + kStep);
        }
        return std::nullopt;
    }

    /// Unit normal at a point of S, along grad psi: central differences, blended between the
    /// voxels, where the gradient of the trilinear interpolant would jump from cell to cell.
    Vec3d normal(const Vec3d& p, const Vec3d& = {}) const override {
        Vec3d g;
        for (int axis = 0; axis < 3; ++axis) {
            double sum = 0;
            int sides = 0;
            for (const double step : {-1.0, 1.0}) {
                Vec3d q = p;
                q[axis] += step;
                if (cut_ && !cellIsActive(vdb(q))) continue;
                sum += step * psi(q);
                ++sides;
            }
            if (sides > 0) g[axis] = sum / sides;
        }
        return normalized(g);
    }

    /// A cut surface has no inside.
    bool encloses(const Vec3d& p) const override { return !cut_ && psi(p) < 0; }

    /// The voxels at the surface.
    std::size_t chunks() const override { return (leaves_.size() + kChunk - 1) / kChunk; }
    void forPoints(std::size_t chunk,
                   const std::function<void(const Vec3d&)>& visit) const override {
        const std::size_t end = std::min(leaves_.size(), (chunk + 1) * kChunk);
        for (std::size_t l = chunk * kChunk; l < end; ++l)
            for (auto it = leaves_[l]->cbeginValueOn(); it; ++it) {
                if (std::abs(*it) > levelSet_.transform.dx) continue;
                const openvdb::Coord ijk = it.getCoord();
                visit({double(ijk.x()), double(ijk.y()), double(ijk.z())});
            }
    }

private:
    static constexpr std::size_t kChunk = 64;  // leaves

    /// psi, trilinear, world units.
    double psi(const Vec3d& p) const {
        return openvdb::tools::BoxSampler::sample(accessor_, vdb(p));
    }
    using Grid = openvdb::FloatGrid;

    static constexpr double kStep = 0.5;

    static openvdb::Vec3d vdb(const Vec3d& p) { return {p.x, p.y, p.z}; }

    /// The same voxels as a grid that the intersector accepts: of class level set, its transform
    /// without rotation. The size of its voxels only says which values are near 0; there is none
    /// below 1e-5 for OpenVDB.
    static Grid::ConstPtr levelSetClass(const LevelSet& levelSet) {
        openvdb::MetaMap meta;
        meta.insertMeta(
            openvdb::GridBase::META_GRID_CLASS,
            openvdb::StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_LEVEL_SET)));
        return openvdb::gridConstPtrCast<Grid>(levelSet.psi->copyGridReplacingMetadataAndTransform(
            meta, openvdb::math::Transform::createLinearTransform(
                      std::max(levelSet.transform.dx, 1e-4))));
    }

    /// Whether psi is known on the cell around p; beyond the edge of a cut surface a zero means
    /// nothing.
    bool cellIsActive(const openvdb::Vec3d& p) const {
        const openvdb::Coord low = openvdb::Coord::floor(p);
        for (int k = 0; k < 8; ++k)
            if (!accessor_.isValueOn(low.offsetBy(k >> 2, k >> 1 & 1, k & 1))) return false;
        return true;
    }

    const LevelSet& levelSet_;
    std::vector<const openvdb::FloatTree::LeafNodeType*> leaves_;
    Grid::ConstPtr grid_;
    openvdb::tools::LevelSetRayIntersector<Grid, openvdb::tools::LinearSearchImpl<Grid, 2>> rays_;
    Grid::ConstAccessor accessor_;
    bool cut_;
};

}  // namespace igeo
