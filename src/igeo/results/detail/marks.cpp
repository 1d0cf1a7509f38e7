#include <igeo/results/detail/marks.h>

#include <igeo/base/nearest_on_triangle.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// Whether a seed is part of a curve or of the rim of a region.
bool isPiece(const std::vector<SurfacePoint>& seeds, std::size_t k) {
    return seeds[k].joined || (k + 1 < seeds.size() && seeds[k + 1].joined);
}

}  // namespace

std::vector<MarkedSegment> markedSegments(const std::vector<Path>& paths,
                                          const std::vector<SurfacePoint>& seeds,
                                          const DrawnSurface& surface) {
    std::vector<MarkedSegment> segments;
    for (const SurfacePoint& s : seeds)
        if (s.segment != Vec3d{})
            segments.push_back({s.pIndex, s.pIndex + s.segment, surface.normalNear(s.pIndex)});
    for (const Path& path : paths)
        for (std::size_t k = 0; k + 1 < path.vertices.size(); ++k) {
            const Vec3d &a = path.vertices[k].pIndex, &b = path.vertices[k + 1].pIndex;
            segments.push_back({a, b, surface.normalNear(0.5 * (a + b))});
        }
    return segments;
}

std::vector<Dot> dots(const Field& field, const std::vector<Path>& paths,
                      const DrawnSurface& surface, const Vec3d& eye, double seedRadius) {
    std::vector<Dot> all;
    auto add = [&](const Vec3d& p, double radius, bool seed) {
        const bool seen = surface.isVisible(p, surface.normalNear(p), normalized(eye - p));
        all.push_back({p, radius, seed, !seen});
    };
    for (const Path& path : paths)
        if (!path.vertices.empty()) add(path.vertices.front().pIndex, 0.7 * seedRadius, false);
    for (std::size_t k = 0; k < field.seeds.size(); ++k)
        if (!isPiece(field.seeds, k)) add(field.seeds[k].pIndex, seedRadius, true);
    return all;
}

Strokes::Strokes(int width, int height, double reach)
    : width_(width), height_(height), reach_(reach) {}

void Strokes::add(const std::array<double, 2>& a, const std::array<double, 2>& b) {
    if (distance_.empty())
        distance_.assign(std::size_t(width_) * std::size_t(height_),
                         std::numeric_limits<float>::infinity());
    auto range = [this](double p, double q, int count) {
        const double low = std::clamp(std::min(p, q) - reach_, 0.0, double(count)),
                     high = std::clamp(std::max(p, q) + reach_, -1.0, double(count - 1));
        return std::array<int, 2>{int(low), int(std::floor(high))};
    };
    const auto [x0, x1] = range(a[0], b[0], width_);
    const auto [y0, y1] = range(a[1], b[1], height_);
    const Vec3d from{a[0], a[1], 0}, to{b[0], b[1], 0};
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double d = distanceToSegment({x + 0.5, y + 0.5, 0}, from, to);
            float& least = distance_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
            if (d < reach_) least = std::min(least, float(d));
        }
}

}  // namespace igeo
