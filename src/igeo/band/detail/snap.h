/// The allowed distance between given points and the surface. Internal.
#pragma once

#include <fmt/core.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>

#include <algorithm>
#include <string>

namespace igeo {

/// @param maxSnap  world units; a relative excess of 1e-6 passes, for rounding
inline bool isNear(const SurfacePoint& p, const Similarity& transform, double maxSnap) {
    return p.snapDistance <= maxSnap / transform.dx * (1 + 1e-6);
}

/// Whether a point was probably given in the other of world and index space: taken so, it is within
/// two voxels of the surface, and as given it is more than four times as far. Where voxels of about
/// 1 make both spaces nearly one, it is not.
inline bool isInOtherSpace(const SurfacePoint& asGiven, const SurfacePoint& asOther) {
    constexpr double kNear = 2, kTimes = 4;
    return asOther.snapDistance <= kNear &&
           asGiven.snapDistance > kTimes * std::max(asOther.snapDistance, kNear);
}

/// @param what  names the point in the message
/// @param hint  a further remedy
/// @throws Error  InvalidArgument, with the nearest point
[[noreturn]] inline void refuseFar(const SurfacePoint& p, const Similarity& transform,
                                   double maxSnap, const std::string& what,
                                   const std::string& hint = {}) {
    throw Error(Error::Kind::InvalidArgument,
                what + fmt::format(" is {:.6g} from the surface, {:.6g} is allowed",
                                   p.snapDistance * transform.dx, maxSnap),
                "the nearest point of the surface is " +
                    textOf(transform.worldFromIndex(p.pIndex), 9) +
                    " (world); move it there or raise maxSnap" + hint);
}

/// @throws Error  as refuseFar, unless isNear()
inline void requireNear(const SurfacePoint& p, const Similarity& transform, double maxSnap,
                        const std::string& what) {
    if (!isNear(p, transform, maxSnap)) refuseFar(p, transform, maxSnap, what);
}

}  // namespace igeo
