/// What a picture needs to know of a surface, in index space. Internal to the pictures.
#pragma once

#include <igeo/base/types.h>

#include <functional>
#include <memory>
#include <optional>

namespace igeo {

/// Rays against a surface. Not for two threads at once: each takes a copy, which is cheap.
class SurfaceRays {
public:
    virtual ~SurfaceRays() = default;
    virtual std::unique_ptr<SurfaceRays> copy() const = 0;

    virtual const Similarity& transform() const = 0;
    /// Distance along the unit direction `dir` from `from` to S, voxels; nothing if it misses.
    virtual std::optional<double> hit(const Vec3d& from, const Vec3d& dir) const = 0;
    /// Unit normal at a point of S, for light.
    /// @param dir  of the ray that met S there; a normal faces it as S itself does
    virtual Vec3d normal(const Vec3d& p, const Vec3d& dir = {}) const = 0;
    /// How far off S a ray from S to an eye starts, so that it does not meet S at once; voxels.
    virtual double clearance() const = 0;
    /// Whether S has an inside that holds a point.
    virtual bool encloses(const Vec3d& p) const = 0;

    /// Points that S lies between, in chunks.
    virtual std::size_t chunks() const = 0;
    virtual void forPoints(std::size_t chunk,
                           const std::function<void(const Vec3d& pIndex)>& visit) const = 0;

protected:
    SurfaceRays() = default;
    SurfaceRays(const SurfaceRays&) = default;
    SurfaceRays& operator=(const SurfaceRays&) = default;
};

}  // namespace igeo
