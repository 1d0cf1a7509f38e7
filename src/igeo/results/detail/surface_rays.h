/// Rays against a level set, and its normal, in index space. Internal to the pictures.
#pragma once

#include <igeo/base/types.h>
#include <igeo/surface/level_set.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/RayIntersector.h>

#include <optional>

namespace igeo {

/// OpenVDB's ray intersector on a level set. Not for two threads at once; copies are cheap.
class SurfaceRays {
public:
    explicit SurfaceRays(const LevelSet& levelSet)
        : grid_(levelSetClass(levelSet)),
          rays_(*grid_),
          accessor_(grid_->getConstAccessor()),
          cut_(levelSet.stats.cutVoxels > 0) {}

    /// Distance along the unit direction `dir` from `from` to S, voxels; nothing if it misses.
    std::optional<double> hit(const Vec3d& from, const Vec3d& dir) const {
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
    Vec3d normal(const Vec3d& p) const {
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

    /// psi, trilinear, world units.
    double psi(const Vec3d& p) const {
        return openvdb::tools::BoxSampler::sample(accessor_, vdb(p));
    }

private:
    using Grid = openvdb::FloatGrid;

    static constexpr double kStep = 0.5;

    static openvdb::Vec3d vdb(const Vec3d& p) { return {p.x, p.y, p.z}; }

    /// The same voxels as a grid that the intersector accepts: of class level set, its transform
    /// without rotation. The size of its voxels only says which values are near 0; there is none
    /// below 1e-5 for OpenVDB.
    static Grid::ConstPtr levelSetClass(const LevelSet& levelSet) {
        openvdb::MetaMap meta;
        meta.insertMeta(openvdb::GridBase::META_GRID_CLASS,
                        openvdb::StringMetadata(
                            openvdb::GridBase::gridClassToString(openvdb::GRID_LEVEL_SET)));
        return openvdb::gridConstPtrCast<Grid>(
            levelSet.psi->copyGridReplacingMetadataAndTransform(
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

    Grid::ConstPtr grid_;
    openvdb::tools::LevelSetRayIntersector<Grid, openvdb::tools::LinearSearchImpl<Grid, 2>> rays_;
    Grid::ConstAccessor accessor_;
    bool cut_;
};

}  // namespace igeo
