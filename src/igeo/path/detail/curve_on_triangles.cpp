#include <igeo/path/detail/curve_on_triangles.h>

#include <igeo/path/detail/triangle_strip.h>

#include <algorithm>
#include <utility>

namespace igeo {

namespace {

std::vector<Vec3d> pointsOf(const Path& path) {
    std::vector<Vec3d> points;
    for (const PathVertex& v : path.vertices) points.push_back(v.pIndex);
    return points;
}

bool isGap(const TriangleStrip& strip) { return strip.last == SurfaceTriangles::kNone; }

}  // namespace

std::vector<double> measure(const Field& field, Path& path) {
    const Band& band = *field.band;
    std::vector<double> lengths;
    path.weightedLength = path.length = 0;
    for (std::size_t k = 0; k < path.vertices.size(); ++k) {
        const Vec3d& p = path.vertices[k].pIndex;
        if (k) {
            const Vec3d& last = path.vertices[k - 1].pIndex;
            // The middle lies within a triangle, where the normal is unique.
            const Vec3d at = band.triangles ? 0.5 * (last + p) : p;
            path.length += length(p - last);
            path.weightedLength +=
                field.metric->weighted()
                    ? segmentCost(band, *field.metric, last, p, surfaceNormal(band, at))
                    : length(p - last);
        }
        path.vertices[k].arcLength = path.length;
        lengths.push_back(path.weightedLength);
    }
    return lengths;
}

bool layOnTriangles(const Field& field, Path& path) {
    const SurfaceTriangles& triangles = *field.band->triangles;
    const std::vector<TriangleStrip> strips = stripsAlong(triangles, pointsOf(path));
    const std::vector<PathVertex> given = std::exchange(path.vertices, {});
    path.vertices.push_back(given.front());
    for (std::size_t k = 0; k < strips.size(); ++k) {
        const std::vector<Vec3d> curve = isGap(strips[k])
                                             ? std::vector<Vec3d>{strips[k].from, strips[k].to}
                                             : shortestCurve(triangles, strips[k]);
        double whole = 0, done = 0;
        for (std::size_t i = 1; i < curve.size(); ++i) whole += length(curve[i] - curve[i - 1]);
        const double from = given[k].distance, to = given[k + 1].distance;
        for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
            done += length(curve[i] - curve[i - 1]);
            path.vertices.push_back({curve[i], 0, from + done / whole * (to - from)});
        }
        path.vertices.push_back(given[k + 1]);
    }
    measure(field, path);
    return std::none_of(strips.begin(), strips.end(), isGap);
}

bool hasExactCurves(const Field& field) {
    return field.band->triangles && !field.metric->weighted() && !field.metric->obstacles;
}

std::vector<Vec3d> shortestOnTriangles(const SurfaceTriangles& triangles, const Path& path,
                                       const Progress& progress, bool winds) {
    constexpr double kStep = 1;
    const std::vector<TriangleStrip> strips = stripsAlong(triangles, pointsOf(path));
    std::vector<Vec3d> curve{path.vertices.front().pIndex};
    auto goTo = [&](const Vec3d& p) {
        const Vec3d from = curve.back();
        const int steps = std::max(1, int(std::ceil(length(p - from) / kStep)));
        for (int s = 1; s < steps; ++s) curve.push_back(from + (double(s) / steps) * (p - from));
        curve.push_back(p);
    };
    for (std::size_t begin = 0; begin < strips.size();) {
        std::size_t end = begin;
        while (end < strips.size() && !isGap(strips[end])) ++end;
        if (end > begin) {
            const auto shortest = shortestCurve(
                triangles,
                winds ? joinedWinding(triangles, strips, begin, end) : joined(strips, begin, end),
                progress);
            for (std::size_t i = 1; i < shortest.size(); ++i) goTo(shortest[i]);
        }
        if (end < strips.size()) curve.push_back(strips[end++].to);
        begin = end;
    }
    return curve;
}

}  // namespace igeo
