#include <igeo/results/detail/raster.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// Margin of barycentric coordinates, so that no ray passes between two triangles
constexpr double kRoom = 1e-9;

}  // namespace

Raster::Raster(const SurfaceTriangles& triangles, const Frame& frame)
    : triangles_(triangles),
      frame_(frame),
      across_((frame.width + kTile - 1) / kTile),
      down_((frame.height + kTile - 1) / kTile),
      first_(tiles() + 1) {
    struct Range {
        int left, top, right, bottom;  // of tiles, inclusive
    };
    std::vector<Range> ranges(triangles.size());
    parallelFor(ranges.size(), 4096, [&](std::size_t begin, std::size_t end) {
        auto tile = [](double pixel, int count) {
            return int(std::clamp(std::floor(pixel / kTile), -1.0, double(count)));
        };
        for (std::size_t t = begin; t < end; ++t) {
            const Box b = boxOf(t);
            ranges[t] = {std::max(tile(b.left, across_), 0), std::max(tile(b.top, down_), 0),
                         std::min(tile(b.right, across_), across_ - 1),
                         std::min(tile(b.bottom, down_), down_ - 1)};
        }
    });
    auto forTiles = [&](auto visit) {
        for (std::size_t t = 0; t < ranges.size(); ++t)
            for (int y = ranges[t].top; y <= ranges[t].bottom; ++y)
                for (int x = ranges[t].left; x <= ranges[t].right; ++x)
                    visit(std::size_t(y * across_ + x), std::uint32_t(t));
    };
    forTiles([&](std::size_t tile, std::uint32_t) { ++first_[tile + 1]; });
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    list_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    forTiles([&](std::size_t tile, std::uint32_t t) { list_[next[tile]++] = t; });
}

/// Clips what lies behind the eye, with a margin for rounding.
Raster::Box Raster::boxOf(std::size_t triangle) const {
    constexpr double kNearest = 1e-6;  // voxels
    constexpr double kSlack = 1e-3;    // pixels
    std::array<Vec3d, 3> v;
    for (unsigned k = 0; k < 3; ++k) v[k] = frame_.seen(triangles_.corner(triangle, k));
    Box box;
    auto add = [&](const Vec3d& s) {
        const auto [x, y] = frame_.place(s);
        box.left = std::min(box.left, x - kSlack), box.right = std::max(box.right, x + kSlack);
        box.top = std::min(box.top, y - kSlack), box.bottom = std::max(box.bottom, y + kSlack);
    };
    for (unsigned k = 0; k < 3; ++k) {
        const Vec3d &a = v[k], &b = v[(k + 1) % 3];
        if (a.z >= kNearest) add(a);
        if ((a.z < kNearest) == (b.z < kNearest)) continue;
        Vec3d cut = a + ((kNearest - a.z) / (b.z - a.z)) * (b - a);
        cut.z = kNearest;
        add(cut);
    }
    return box;
}

void Raster::draw(std::size_t tile, const std::vector<Offset>& offsets,
                  const std::vector<std::uint8_t>& wanted, std::vector<Sample>& samples) const {
    const std::size_t n = offsets.size();
    samples.assign(std::size_t(kTile) * kTile * n, Sample{});
    const auto [left, top] = origin(tile);
    const int right = std::min(left + kTile, frame_.width) - 1,
              bottom = std::min(top + kTile, frame_.height) - 1;
    for (std::size_t l = first_[tile]; l < first_[tile + 1]; ++l) {
        const std::uint32_t t = list_[l];
        const Box box = boxOf(t);
        std::array<Vec3d, 3> v;
        for (unsigned k = 0; k < 3; ++k) v[k] = frame_.seen(triangles_.corner(t, k));
        // A barycentric coordinate is proportional to the volume of the ray with the opposite edge.
        std::array<Vec3d, 3> e{cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])};
        double volume = dot(v[0], e[0]);
        if (volume == 0 || !std::isfinite(volume)) continue;
        if (volume < 0) {
            volume = -volume;
            for (Vec3d& edge : e) edge = -edge;
        }
        // As linear functions of the picture position: the value at (0, 0), and the change per
        // pixel.
        std::array<double, 3> at, byX, byY;
        for (std::size_t k = 0; k < 3; ++k) {
            byX[k] = e[k].x / frame_.scale;
            byY[k] = -e[k].y / frame_.scale;
            at[k] = e[k].z - 0.5 * frame_.width * byX[k] - 0.5 * frame_.height * byY[k];
        }
        const int x0 = int(std::max(box.left, double(left))),
                  x1 = int(std::min(box.right, double(right)));
        const int y0 = int(std::max(box.top, double(top))),
                  y1 = int(std::min(box.bottom, double(bottom)));
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const auto k = std::size_t((y - top) * kTile + x - left);
                if (!wanted.empty() && !wanted[k]) continue;
                Sample* pixel = &samples[k * n];
                for (std::size_t s = 0; s < n; ++s) {
                    const double px = x + offsets[s][0], py = y + offsets[s][1];
                    const double a = at[0] + byX[0] * px + byY[0] * py,
                                 b = at[1] + byX[1] * px + byY[1] * py,
                                 c = at[2] + byX[2] * px + byY[2] * py, sum = a + b + c;
                    if (!(sum > 0) || std::min({a, b, c}) < -kRoom * sum) continue;
                    const auto depth = float(volume / sum);
                    if (depth < pixel[s].depth) pixel[s] = {depth, t};
                }
            }
    }
}

std::array<double, 3> Raster::shares(std::uint32_t triangle, const Vec3d& toward) const {
    std::array<Vec3d, 3> v;
    for (unsigned k = 0; k < 3; ++k) v[k] = triangles_.corner(triangle, k) - frame_.eye;
    const std::array<double, 3> e{dot(cross(v[1], v[2]), toward), dot(cross(v[2], v[0]), toward),
                                  dot(cross(v[0], v[1]), toward)};
    const double sum = e[0] + e[1] + e[2];
    return {e[0] / sum, e[1] / sum, e[2] / sum};
}

}  // namespace igeo
