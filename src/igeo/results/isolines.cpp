#include <igeo/results/isolines.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/signed_field.h>
#include <igeo/path/curve_normals.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace igeo {

namespace {

constexpr int kMostLevels = 100000;

/// A segment of a line across one triangle, from one edge to another.
struct Segment {
    std::uint32_t from, to;
    bool operator<(const Segment& o) const { return from < o.from; }
};

/// Edges in the order in which a line crosses them.
struct Chain {
    std::vector<std::uint32_t> edges;
    bool closed = false;
};

/// Whether a line may cross a triangle: all distances known, no obstacle in between.
bool passable(const Field& field, const SurfaceMesh& mesh, const SurfaceMesh::Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (!(mesh.distance[a] < kInfinity) ||
            field.metric->blocked(mesh.position[a], mesh.position[b], Vec3d(mesh.normal[a])))
            return false;
    }
    return true;
}

/// Per level the segments of its lines, sorted by the edge at which they start.
std::vector<std::vector<Segment>> segmentsByLevel(const Field& field, const SurfaceMesh& mesh,
                                                  const MeshEdges& edges,
                                                  const std::vector<double>& levels) {
    std::vector<std::vector<Segment>> segments(levels.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const SurfaceMesh::Triangle& v = mesh.triangles[t];
        const std::array<double, 3> d{mesh.distance[v[0]], mesh.distance[v[1]],
                                      mesh.distance[v[2]]};
        const auto [least, most] = std::minmax_element(d.begin(), d.end());
        auto level = std::upper_bound(levels.begin(), levels.end(), *least);
        if (level == levels.end() || *level > *most || !passable(field, mesh, v)) continue;
        for (; level != levels.end() && *level <= *most; ++level) {
            Segment s{};
            for (std::size_t k = 0; k < 3; ++k) {
                const bool above = d[k] >= *level, nextAbove = d[(k + 1) % 3] >= *level;
                // Counter-clockwise around the triangle, the line enters where values rise, so
                // lower values lie to its left.
                if (!above && nextAbove) s.from = edges.ofTriangle[t][k];
                if (above && !nextAbove) s.to = edges.ofTriangle[t][k];
            }
            segments[std::size_t(level - levels.begin())].push_back(s);
        }
    }
    for (auto& s : segments) std::sort(s.begin(), s.end());
    return segments;
}

/// Joins segments. The two triangles of an edge traverse it in opposite directions, so at most one
/// segment starts at it and at most one ends there.
std::vector<Chain> chainsOf(const std::vector<Segment>& segments) {
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> next(segments.size(), kNone);
    std::vector<std::uint8_t> follows(segments.size()), done(segments.size());
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const auto at =
            std::lower_bound(segments.begin(), segments.end(), Segment{segments[i].to, 0});
        if (at == segments.end() || at->from != segments[i].to) continue;
        next[i] = std::size_t(at - segments.begin());
        follows[next[i]] = 1;
    }
    std::vector<Chain> chains;
    auto walk = [&](std::size_t first) {
        Chain chain;
        chain.edges.push_back(segments[first].from);
        for (std::size_t i = first; i != kNone && !done[i]; i = next[i]) {
            done[i] = 1;
            chain.edges.push_back(segments[i].to);
        }
        chain.closed = follows[first];
        if (chain.closed) chain.edges.pop_back();
        chains.push_back(std::move(chain));
    };
    for (std::size_t i = 0; i < segments.size(); ++i)
        if (!follows[i]) walk(i);
    for (std::size_t i = 0; i < segments.size(); ++i)
        if (!done[i]) walk(i);
    return chains;
}

/// The normal of the sheet of an edge.
Vec3d sheetAt(const SurfaceMesh& mesh, const std::array<std::uint32_t, 2>& ends) {
    return normalized(Vec3d(mesh.normal[ends[0]] + mesh.normal[ends[1]]));
}

/// Where the distance equals `level` on the projection of an edge to S, by regula falsi (Illinois).
Vec3d crossing(const Field& field, const SurfaceMesh& mesh,
               const std::array<std::uint32_t, 2>& ends, double level) {
    constexpr double kTolerance = 1e-6;  // voxels times weight
    constexpr int kMostSteps = 30;
    const auto [a, b] = ends;
    double lo = 0, hi = 1, atLo = mesh.distance[a] - level, atHi = mesh.distance[b] - level;
    if (atLo == 0) return ontoSurface(*field.band, mesh.position[a]);
    if (atHi == 0) return ontoSurface(*field.band, mesh.position[b]);
    const Vec3d sheetNormal = sheetAt(mesh, ends);
    Vec3d p;
    int last = 0;  // the end that moved last
    for (int step = 0; step < kMostSteps; ++step) {
        const double t = lo + (hi - lo) * (atLo / (atLo - atHi));
        p = ontoSurface(*field.band, (1 - t) * mesh.position[a] + t * mesh.position[b]);
        const double here = sampleDistance(field, p, sheetNormal) - level;
        if (std::abs(here) <= kTolerance || !(std::abs(here) < kInfinity)) break;
        if ((here < 0) == (atLo < 0)) {
            lo = t, atLo = here;
            if (last == -1) atHi /= 2;
            last = -1;
        } else {
            hi = t, atHi = here;
            if (last == 1) atLo /= 2;
            last = 1;
        }
    }
    return p;
}

/// The line without repeated points, as where a vertex lies exactly at the level.
Isoline lineOf(const std::vector<Vec3d>& points, const std::vector<Vec3d>& normals, double level,
               bool closed) {
    constexpr double kSame = 1e-9;  // voxels
    Isoline line;
    line.level = level;
    line.closed = closed;
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (!line.points.empty() && length(points[k] - line.points.back()) <= kSame) continue;
        line.points.push_back(points[k]);
        line.normals.push_back(normals[k]);
    }
    while (closed && line.points.size() > 1 &&
           length(line.points.front() - line.points.back()) <= kSame)
        line.points.pop_back(), line.normals.pop_back();
    for (std::size_t i = 1; i < line.points.size(); ++i)
        line.length += length(line.points[i] - line.points[i - 1]);
    if (closed) line.length += length(line.points.front() - line.points.back());
    return line;
}

void checkLevels(const Field& field, const std::vector<double>& levels) {
    for (const double level : levels)
        if (!(std::abs(level) < kInfinity && (level >= 0 || !field.sign.empty())))
            throw Error(Error::Kind::InvalidArgument,
                        fmt::format("a level of {:g} for isolines; levels are finite, 0 or more, "
                                    "or negative where distances have signs",
                                    level));
}

/// Gives a line the sign of the side that it is on. Beside the seeds some points may have the
/// other one.
void takeSign(const Field& field, Isoline& line) {
    double sum = 0;
    for (const Vec3d& p : line.points) sum += signAt(field, p);
    if (sum < 0) line.level = -line.level;
}

/// Of lines at |levels| those at `levels`, in ascending order of level.
std::vector<Isoline> withSigns(const Field& field, std::vector<Isoline> lines,
                               const std::vector<double>& levels) {
    for (Isoline& line : lines) takeSign(field, line);
    std::erase_if(lines, [&](const Isoline& line) {
        return std::find(levels.begin(), levels.end(), line.level) == levels.end();
    });
    std::stable_sort(lines.begin(), lines.end(),
                     [](const Isoline& a, const Isoline& b) { return a.level < b.level; });
    return lines;
}

double leastStart(const Field& field) {
    double least = kInfinity;
    for (const SurfacePoint& s : field.seeds) least = std::min(least, s.start);
    return least < kInfinity ? least : 0.0;
}

}  // namespace

std::vector<Isoline> isolines(const Field& field, const SurfaceMesh& mesh,
                              const std::vector<double>& levels, Progress& progress) {
    checkLevels(field, levels);
    std::vector<double> ascending = levels;
    for (double& level : ascending) level = std::abs(level);
    std::sort(ascending.begin(), ascending.end());
    ascending.erase(std::unique(ascending.begin(), ascending.end()), ascending.end());

    progress.update("isolines", 0);
    const MeshEdges edges = meshEdges(mesh);
    const auto segments = segmentsByLevel(field, mesh, edges, ascending);
    std::vector<Isoline> lines;
    for (std::size_t l = 0; l < ascending.size(); ++l) {
        progress.update("isolines", double(l) / double(ascending.size()));
        for (const Chain& chain : chainsOf(segments[l])) {
            progress.throwIfCancelled();
            std::vector<Vec3d> points(chain.edges.size()), normals(chain.edges.size());
            parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const auto& ends = edges.ends[chain.edges[i]];
                    points[i] = crossing(field, mesh, ends, ascending[l]);
                    normals[i] = normalAt(*field.band, points[i], sheetAt(mesh, ends));
                }
            });
            if (field.band->transform.mirrors())
                std::reverse(points.begin(), points.end()),
                    std::reverse(normals.begin(), normals.end());
            Isoline line = lineOf(points, normals, ascending[l], chain.closed);
            // A peak exactly at the level gives a line of one point.
            if (line.points.size() > (line.closed ? 2 : 1)) lines.push_back(std::move(line));
        }
    }
    progress.update("isolines", 1);
    return field.sign.empty() ? lines : withSigns(field, std::move(lines), levels);
}

std::vector<double> levelsBySpacing(const Field& field, double spacing) {
    const double first = std::floor(leastStart(field) / spacing) + 1;
    const double count = std::floor(field.maxDistance / spacing) - first + 1;
    if (!(spacing > 0 && spacing < kInfinity && count <= kMostLevels))
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("isolines {:g} voxels apart; the spacing has to be positive and "
                                "the number of levels {} at most, for distances of up to {:g}",
                                spacing, kMostLevels, field.maxDistance),
                    "choose a larger spacing");
    std::vector<double> levels;
    for (double k = 0; k < count; ++k) levels.push_back((first + k) * spacing);
    return levels;
}

std::vector<double> levelsByCount(const Field& field, int count) {
    if (count < 1 || count > kMostLevels)
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("{} levels for isolines; allowed are 1 to {}", count, kMostLevels));
    const double least = leastStart(field), range = field.maxDistance - least;
    std::vector<double> levels;
    for (int k = 1; k <= count; ++k) levels.push_back(least + range * k / (count + 1));
    return levels;
}

std::vector<double> onBothSides(const Field& field, const std::vector<double>& levels) {
    if (field.sign.empty()) return levels;
    std::vector<double> both = levels;
    for (const double level : levels)
        if (level > 0) both.push_back(-level);
    std::sort(both.begin(), both.end());
    return both;
}

std::vector<double> chosenLevels(const Field& field, int count, double spacing) {
    constexpr double kLines = 16;
    const double dx = field.band->transform.dx, range = field.maxDistance - leastStart(field);
    if (count > 0) return levelsByCount(field, count);
    if (spacing > 0) return levelsBySpacing(field, spacing / dx);
    if (!(range > 0)) return {};
    return levelsBySpacing(field, roundSpacing(range * dx, kLines) / dx);
}

double roundSpacing(double range, double lines) {
    const double exact = range / lines;
    const double power = std::pow(10, std::floor(std::log10(exact)));
    double best = power;
    for (const double factor : {2.0, 5.0, 10.0})
        if (std::abs(std::log(factor * power / exact)) < std::abs(std::log(best / exact)))
            best = factor * power;
    return best;
}

}  // namespace igeo
