#include <igeo/results/detail/corner_values.h>

#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace igeo {

namespace {

constexpr float kFarAway = std::numeric_limits<float>::infinity();

/// For each vertex of the triangles one of their corners, as 3 * triangle + corner.
std::vector<std::uint32_t> cornerOfEach(const SurfaceTriangles& triangles,
                                        const std::vector<std::uint32_t>& shown) {
    std::vector<std::uint8_t> met(triangles.points().size());
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t t : shown)
        for (unsigned k = 0; k < 3; ++k)
            if (!std::exchange(met[triangles[t][k]], 1)) corners.push_back(3 * t + k);
    return corners;
}

}  // namespace

CornerValues::CornerValues(const DrawnSurface& surface, const Frame& frame, const Shader& shader,
                           const std::vector<std::uint32_t>& shown, std::size_t pixels,
                           double tolerance)
    : surface_(surface),
      frame_(frame),
      shader_(shader),
      tolerance_(tolerance),
      isSmooth_(surface.triangles().points().size()),
      corners_(surface.isCreased() ? 3 * surface.triangles().size() : isSmooth_.size()),
      triangles_(surface.triangles().size()) {
    const SurfaceTriangles& triangles = surface.triangles();
    const std::vector<std::uint32_t> each = cornerOfEach(triangles, shown);
    const bool areRead =
        !surface.hasDistances() && !shader.field().metric->weighted() && each.size() <= pixels;
    std::vector<float> distances(isSmooth_.size(), kFarAway);
    parallelFor(each.size(), 1024, [&](std::size_t begin, std::size_t end) {
        findCorners({&each[begin], end - begin}, areRead, distances);
    });
    parallelFor(shown.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t t = shown[i];
            if (surface.isCreased())
                for (unsigned k = 0; k < 3; ++k)
                    corners_[slot(t, k)] =
                        cornerOf(surface.cornerNormal(t, k), distances[triangles[t][k]]);
            triangles_[t] = {surface.hasDistances() ? Linear
                             : areRead              ? trustIn(t)
                                                    : None,
                             turnsAway(t)};
        }
    });
}

void CornerValues::findCorners(std::span<const std::uint32_t> each, bool areRead,
                               std::vector<float>& distances) {
    const SurfaceTriangles& triangles = surface_.triangles();
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;
    for (const std::uint32_t corner : each) {
        points.push_back(triangles.corner(corner / 3, corner % 3));
        normals.push_back(surface_.cornerNormal(corner / 3, corner % 3));
    }
    std::vector<float> read;
    std::vector<std::uint8_t> isSmooth;
    if (areRead) read = shader_.read(points, normals, isSmooth);
    for (std::size_t i = 0; i < each.size(); ++i) {
        const std::uint32_t v = triangles[each[i] / 3][each[i] % 3];
        if (areRead) distances[v] = read[i], isSmooth_[v] = isSmooth[i];
        if (surface_.hasDistances()) distances[v] = float(surface_.distance(v));
        if (!surface_.isCreased()) corners_[v] = cornerOf(normals[i], distances[v]);
    }
}

CornerValues::Corner CornerValues::cornerOf(const Vec3f& normal, float distance) const {
    const Vec3f n(frame_.turned(Vec3d(normal)));
    return {n.x, n.y, n.z, distance};
}

bool CornerValues::turnsAway(std::uint32_t triangle) const {
    const SurfaceTriangles& triangles = surface_.triangles();
    const Vec3d a = triangles.corner(triangle, 0);
    return dot(cross(triangles.corner(triangle, 1) - a, triangles.corner(triangle, 2) - a),
               a - frame_.eye) > 0;
}

/// A distance has a gradient of length 1. That of the linear interpolant is shorter where two
/// fronts meet in the triangle or the front is curved: if its square is 1 - s, the interpolant is
/// off by at most about sqrt(s) / 2 of the triangle's width. A single smooth front has a radius of
/// curvature of some voxels, and around a seed that of a circle.
CornerValues::Trust CornerValues::trustIn(std::uint32_t triangle) const {
    constexpr double kRough = 8;        // tolerances
    constexpr double kLeastRadius = 8;  // voxels
    const SurfaceTriangles& triangles = surface_.triangles();
    std::array<double, 3> d;
    bool isSmooth = true;
    for (unsigned k = 0; k < 3; ++k) {
        d[k] = double(corners_[slot(triangle, k)].distance);
        isSmooth = isSmooth && isSmooth_[triangles[triangle][k]];
    }
    const auto unreached = std::count(d.begin(), d.end(), kInfinity);
    if (unreached > 0) return unreached == 3 ? Linear : None;
    const Vec3d p = triangles.corner(triangle, 0), e = triangles.corner(triangle, 1) - p,
                f = triangles.corner(triangle, 2) - p;
    const double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f),
                 width2 = std::max({ee, ff, ee - 2 * ef + ff}),
                 radius = std::min({d[0], d[1], d[2]}) - shader_.field().leastStart,
                 ofSmooth = width2 / (8 * kLeastRadius);
    if (isSmooth && radius >= kLeastRadius && ofSmooth <= tolerance_) return Linear;
    const double area2 = ee * ff - ef * ef, byE = d[1] - d[0], byF = d[2] - d[0],
                 gradient2 = (ff * byE * byE - 2 * ef * byE * byF + ee * byF * byF) / area2;
    double off = std::sqrt(width2 * std::abs(1 - gradient2)) / 2;
    if (isSmooth) off = std::min(off, ofSmooth);
    off = std::max(off, width2 / (8 * radius));
    if (!(radius > 0) || !(off <= kRough * tolerance_)) return None;
    return off <= tolerance_ ? Linear : Rough;
}

CornerValues::Values CornerValues::at(const FourSamples& samples, const Values::Four& towardX,
                                      const Values::Four& towardY) const {
    using Four = Values::Four;
    using Integers = Registers<4>::Integers;
    const SurfaceTriangles& triangles = surface_.triangles();
    const bool creased = surface_.isCreased();
    std::array<SurfaceTriangles::Triangle, 4> corners;
    Integers away;
    for (std::size_t lane = 0; lane < 4; ++lane) {
        const std::uint32_t t = samples.covered(lane) ? samples.triangle[lane] : 0;
        corners[lane] =
            creased ? SurfaceTriangles::Triangle{3 * t, 3 * t + 1, 3 * t + 2} : triangles[t];
        away[lane] = -std::int32_t(triangles_[t].away);
    }
    Four p[4], q[4], r[4], sum[4];
    const auto load = [&](std::size_t k, Four(&of)[4]) {
        loadFours<4>([&](int lane) { return &corners_[corners[std::size_t(lane)][k]]; }, of);
    };
    load(0, p), load(1, q), load(2, r);
    const Four b = loadAs<Four>(&samples.second), c = loadAs<Four>(&samples.third), a = 1 - b - c;
    for (int k = 0; k < 4; ++k) sum[k] = a * p[k] + b * q[k] + c * r[k];
    Four length = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
    takeRoots<4>(length);
    const Integers hasLength = length > 0;
    const Four shorter = hasLength ? 1 / length : Four{} + 1;
    Values values{sum[0] * shorter, sum[1] * shorter, sum[2] * shorter,
                  sum[3] < kFarAway ? sum[3] : Four{} + kFarAway};
    const Integers turned = values.nx * towardX + values.ny * towardY + values.nz > 0;
    for (unsigned wrong = bitsOf<4>((turned ^ away) | ~hasLength); wrong; wrong &= wrong - 1) {
        const auto lane = std::size_t(std::countr_zero(wrong));
        if (!samples.covered(lane)) continue;
        const Vec3d n = frame_.turned(triangles.normal(samples.triangle[lane]));
        values.nx[lane] = float(n.x), values.ny[lane] = float(n.y), values.nz[lane] = float(n.z);
    }
    return values;
}

}  // namespace igeo
