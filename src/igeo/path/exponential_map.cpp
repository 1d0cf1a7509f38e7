#include <igeo/path/exponential_map.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/path/detail/triangle_walk.h>

#include <algorithm>
#include <array>
#include <string>

namespace igeo {

namespace {

/// S around a point, from the foot points f and normals m of the nodes of its cell.
struct Local {
    bool valid = false;  ///< false beyond the edge of the band
    /// Mean of (p - f) . (m + n) / 2, n the mean normal: how far p lies above S, exact on spheres.
    double height = 0;
    /// The gradient of that, unit. Not n: only a normal of the surface that the path is projected
    /// to keeps it straight there.
    Vec3d normal;
};

Local localSurface(const Band& band, const Vec3d& p, const Vec3d& sheetNormal) {
    BandCell cell = cellAt(band, p);
    Local s;
    double present = 0, weight = 0;
    for (std::size_t k = 0; k < 8; ++k)
        if (cell.node[k] != kNoNode) present += cell.weight[k];
    const Vec3d n = dropFacingCorners(band, cell, sheetNormal);
    std::array<double, 8> height{};
    Vec3d gradient;
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex i = cell.node[k];
        if (i == kNoNode) continue;
        const Vec3d mean = 0.5 * (Vec3d(band.normal[i]) + n);
        height[k] = dot(p - band.footPoint(i), mean);
        weight += cell.weight[k];
        s.height += cell.weight[k] * height[k];
        gradient += cell.weight[k] * mean;
    }
    s.valid = present > 0.5 && weight > 0;
    if (!s.valid) return s;
    s.height /= weight;
    gradient *= 1 / weight;
    // The weights change as well. That n does, in the mean of all p - f, is of fourth order.
    const Vec3d t = cell.t;
    for (std::size_t k = 0; k < 8; ++k) {
        if (cell.node[k] == kNoNode) continue;
        const double wx = k >> 2 ? t.x : 1 - t.x, wy = k >> 1 & 1 ? t.y : 1 - t.y,
                     wz = k & 1 ? t.z : 1 - t.z, h = height[k] - s.height;
        gradient.x += (k >> 2 ? h : -h) * wy * wz;
        gradient.y += (k >> 1 & 1 ? h : -h) * wx * wz;
        gradient.z += (k & 1 ? h : -h) * wx * wy;
    }
    s.normal = normalized(gradient);
    return s;
}

/// A point of a geodesic, with its unit velocity.
struct Walker {
    Vec3d p, v, n;

    /// Moves on by an arc of the given length; false where S ends.
    bool step(const Band& band, double arc);
};

bool Walker::step(const Band& band, double arc) {
    constexpr int kRounds = 8;
    constexpr double kOnSurface = 1e-9;
    // The chord in the plane of v and n that ends on S.
    Vec3d chord = arc * v;
    Local at = localSurface(band, p + chord, n);
    for (int round = 0; round < kRounds && at.valid; ++round) {
        const Vec3d bend = at.normal - n;
        const double slope = std::max(dot(n, at.normal), 0.5);
        const Vec3d next =
            arc * (1 - dot(bend, bend) / 24) * normalized(chord - (at.height / slope) * n);
        const double change = length(next - chord);
        chord = next;
        at = localSurface(band, p + chord, n);
        if (change < kOnSurface) break;
    }
    const Vec3d along = tangential(chord, at.normal);
    if (!at.valid || !(length(along) > 0)) return false;
    p += chord;
    n = at.normal;
    v = normalized(along);
    return true;
}

constexpr double kStep = 0.5;

void requireLength(double length) {
    if (length >= 0 && length < kInfinity) return;
    throw Error(
        Error::Kind::InvalidArgument,
        fmt::format("a path of length {:f} was asked for; it has to be finite and not negative",
                    length),
        length < 0 ? "turn the direction round to walk backwards" : "");
}

[[noreturn]] void refuseDirection() {
    throw Error(Error::Kind::InvalidArgument, "the direction has no part along the surface",
                "give one that is not normal to it, and not zero");
}

void append(Path& path, const Vec3d& p, double at) {
    path.weightedLength = path.length = path.distance = at;
    path.vertices.push_back({p, at, at});
}

Path shootOnTriangles(const SurfaceTriangles& triangles, const SurfacePoint& start,
                      const Vec3d& direction, double length, Progress& progress) {
    constexpr std::size_t kLookEvery = 1024;  // steps
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
        const std::optional<double> way = walk.advance(std::min(kStep, length - path.length));
        still = way && *way > 0 ? 0 : still + 1;
        if (!way || still > kMostAtOnePlace) {
            path.status = PathStatus::Stalled;
            break;
        }
        if (*way > 0) append(path, walk.position(), path.length + *way);
    }
    return path;
}

}  // namespace

Path shoot(const Band& band, const SurfacePoint& start, const Vec3d& direction, double length,
           Progress& progress) {
    constexpr double kAlong = 1e-6;          // normals are floats
    constexpr std::size_t kLookEvery = 256;  // steps, half a millisecond
    requireLength(length);
    if (!(igeo::length(direction) > 0) || !(igeo::length(direction) < kInfinity)) refuseDirection();
    if (band.triangles)
        return shootOnTriangles(*band.triangles, start, direction, length, progress);
    Vec3d p = start.pIndex;
    Local at = localSurface(band, p, Vec3d(band.normal[start.node]));
    // psi = 0 of the interpolant is not quite S.
    p -= at.height * at.normal;
    at = localSurface(band, p, at.normal);
    if (!at.valid) throw Error(Error::Kind::BadInput, "the start lies at the edge of the band");
    const Vec3d along = tangential(direction, at.normal);
    if (!(igeo::length(along) > kAlong * igeo::length(direction))) refuseDirection();

    Path path;
    path.target = start;
    path.status = PathStatus::Reached;
    path.vertices.push_back({p, 0, 0});
    Walker walker{p, normalized(along), at.normal};
    const auto steps = std::size_t(std::ceil(length / kStep));
    for (std::size_t k = 1; k <= steps; ++k) {
        if (k % kLookEvery == 1) progress.throwIfCancelled();
        if (!walker.step(band, length / double(steps))) {
            path.status = PathStatus::Stalled;
            break;
        }
        path.weightedLength = path.length = length * double(k) / double(steps);
        path.vertices.push_back({walker.p, path.weightedLength, path.weightedLength});
    }
    path.distance = path.weightedLength;
    return path;
}

}  // namespace igeo
