#include <igeo/path/detail/other_ways.h>

#include <igeo/path/detail/curve_on_triangles.h>
#include <igeo/path/detail/triangle_walk.h>
#include <igeo/path/straighten.h>

namespace igeo {

namespace {

/// A point beside the middle of a segment, at most `reach` away: straight over the triangles.
Vec3d besideSegment(const SurfaceTriangles& triangles, const Vec3d& from, const Vec3d& to,
                    double reach) {
    constexpr int kMostSteps = 10000;
    const Vec3d middle = 0.5 * (from + to);
    const Vec3d normal = triangles.normal(triangles.nearest(middle).triangle);
    TriangleWalk walk(triangles, middle,
                      (reach < 0 ? -1 : 1) * normalized(cross(normal, to - from)));
    double rest = std::abs(reach);
    for (int step = 0; step < kMostSteps && rest > 0 && walk.leads(); ++step) {
        const auto moved = walk.advance(rest);
        if (!moved) break;
        rest -= *moved;
    }
    return walk.position();
}

/// The path with the part that is less than `reach` from the middle of a segment replaced by a
/// point.
std::vector<PathVertex> through(const Path& path, std::size_t segment, const Vec3d& p,
                                double reach) {
    const auto& v = path.vertices;
    const double at = (v[segment - 1].arcLength + v[segment].arcLength) / 2;
    std::vector<PathVertex> vertices{v.front()};
    for (std::size_t k = 1; k < segment; ++k)
        if (v[k].arcLength <= at - reach) vertices.push_back(v[k]);
    vertices.push_back({p, 0, 0});
    for (std::size_t k = segment; k + 1 < v.size(); ++k)
        if (v[k].arcLength >= at + reach) vertices.push_back(v[k]);
    vertices.push_back(v.back());
    return vertices;
}

}  // namespace

Path shorterWay(const Field& field, const Path& path, double enough) {
    constexpr int kStations = 4;
    const SurfaceTriangles& triangles = *field.band->triangles;
    Path best = path;
    auto look = [&](std::vector<PathVertex> vertices) {
        Path way = path;
        way.vertices = std::move(vertices);
        if (!layOnTriangles(field, way)) return;
        way = straightened(field, way);
        if (way.length < best.length) best = std::move(way);
    };
    auto withDistances = [&] {
        straighten(field, best);
        return best;
    };
    look({path.vertices.front(), path.vertices.back()});
    // Over a steep bump it is far to the other side.
    for (const double share : {0.0625, 0.125, 0.25, 0.5, 1.0})
        for (int station = 1; station < kStations; ++station) {
            const double reach = share * path.length, at = path.length * station / kStations;
            std::size_t segment = 1;
            while (segment + 1 < path.vertices.size() && path.vertices[segment].arcLength < at)
                ++segment;
            for (const double side : {-reach, reach}) {
                if (best.length <= enough) return withDistances();
                look(through(path, segment,
                             besideSegment(triangles, path.vertices[segment - 1].pIndex,
                                           path.vertices[segment].pIndex, side),
                             reach));
            }
        }
    return withDistances();
}

}  // namespace igeo
