#include <igeo/path/exponential_map.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/path/detail/crease.h>
#include <igeo/path/detail/triangle_walk.h>
#include <igeo/path/detail/walker.h>

#include <algorithm>
#include <vector>

namespace igeo {

namespace {

constexpr double kRayStep = 0.5;

void requireLength(double length) {
    if (length >= 0 && length < kInfinity) return;
    throw Error(
        Error::Kind::InvalidArgument,
        fmt::format("a path of length {:g} was asked for; it has to be finite and not negative",
                    length),
        length < 0 ? "reverse the direction instead" : "");
}

[[noreturn]] void refuseDirection() {
    throw Error(Error::Kind::InvalidArgument,
                "the direction is zero, or within 0.6 degrees of the surface's normal",
                "give one that leads along the surface");
}

void append(Path& path, const Vec3d& p, double at) {
    path.weightedLength = path.length = path.distance = at;
    path.vertices.push_back({p, at, at});
}

Path shootOnTriangles(const SurfaceTriangles& triangles, const SurfacePoint& start,
                      const Vec3d& direction, double length, Progress& progress) {
    constexpr std::size_t kLookEvery = 1024;  // steps between tests of cancellation
    constexpr int kMostAtOnePlace = 1000;
    TriangleWalk walk(triangles, start.pIndex, direction);
    if (!walk.leads()) refuseDirection();
    Path path;
    path.target = start;
    path.status = PathStatus::Reached;
    append(path, walk.position(), 0);
    int still = 0;
    for (std::size_t k = 0; path.length < length; ++k) {
        if (k % kLookEvery == 0) progress.throwIfCancelled();
        const std::optional<double> way = walk.advance(std::min(kRayStep, length - path.length));
        still = way && *way > 0 ? 0 : still + 1;
        if (!way || still > kMostAtOnePlace) {
            path.status = PathStatus::Stalled;
            break;
        }
        if (*way > 0) append(path, walk.position(), path.length + *way);
    }
    return path;
}

/// Walks from a start in steps; stops early where S ends.
std::vector<Walker> walkOver(const Band& band, const Walker& start, double length,
                             CreaseWalk& creases, Progress& progress) {
    constexpr std::size_t kLookEvery = 256;  // steps, half a millisecond
    const auto surface = [&](const Vec3d& p, const Vec3d& n) { return localSurface(band, p, n); };
    std::vector<Walker> track{start};
    for (double from = 0; track.back().at < length;) {
        const auto steps = std::size_t(std::ceil((length - from) / kRayStep));
        for (std::size_t k = 1; k <= steps; ++k) {
            if (k % kLookEvery == 1) progress.throwIfCancelled();
            if (creases.advance(track)) break;
            Walker next = track.back();
            if (!next.step(surface, (length - from) / double(steps))) return track;
            next.at = k == steps ? length : from + (length - from) * double(k) / double(steps);
            track.push_back(next);
        }
        from = track.back().at;
    }
    return track;
}

}  // namespace

Path shoot(const Band& band, const SurfacePoint& start, const Vec3d& direction, double length,
           Progress& progress) {
    // Within 0.6 degrees of the normal a direction is too uncertain.
    constexpr double kAlong = 0.01;
    constexpr double kClose = 1;
    requireLength(length);
    if (!(igeo::length(direction) > 0) || !(igeo::length(direction) < kInfinity)) refuseDirection();
    if (band.triangles)
        return shootOnTriangles(*band.triangles, start, direction, length, progress);
    Vec3d p = start.pIndex;
    Local at = localSurface(band, p, Vec3d(band.normal[start.node]));
    // psi = 0 differs slightly from this S.
    p -= at.height * at.normal;
    at = localSurface(band, p, at.normal);
    if (!at.valid) throw Error(Error::Kind::BadInput, "the start lies at the edge of the band");
    CreaseWalk creases(band, length);
    Walker first{p, {}, at.normal};
    const bool isClose = igeo::length(start.askedIndex - p) < kClose;
    creases.settle(first, isClose ? start.askedIndex : p, direction);
    const Vec3d along = tangential(direction, first.n);
    if (!(igeo::length(along) > kAlong * igeo::length(direction))) refuseDirection();

    Path path;
    path.target = start;
    path.status = PathStatus::Reached;
    first.v = normalized(along);
    const std::vector<Walker> track = walkOver(band, first, length, creases, progress);
    for (const Walker& w : track) append(path, w.p, w.at);
    path.roundedBends = creases.roundedBends(track);
    path.closeCorners = creases.closeCorners();
    if (path.length < length) path.status = PathStatus::Stalled;
    return path;
}

}  // namespace igeo
