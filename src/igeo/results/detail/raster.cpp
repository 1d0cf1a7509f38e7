#include <igeo/results/detail/raster.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace igeo {

namespace {

/// Margin of barycentric coordinates, so that no ray passes between two triangles
constexpr double kRoom = 1e-9;
constexpr double kNearest = 1e-6;  ///< least depth of what is drawn, voxels

}  // namespace

Raster::Raster(const SurfaceTriangles& triangles, bool withBacks, const Frame& frame)
    : triangles_(triangles),
      frame_(frame),
      across_((frame.width + kTile - 1) / kTile),
      down_((frame.height + kTile - 1) / kTile),
      corners_(triangles.points().size()),
      boxes_(new Box[triangles.size()]),
      first_(2 * tiles() + 1) {
    parallelFor(corners_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const Vec3d at = frame.seen(triangles.points()[v]);
            const auto [x, y] = frame.place(at);
            constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
            corners_[v] = {at, at.z >= kNearest ? float(x) : kNowhere, float(y)};
        }
    });
    struct Range {
        std::int16_t left = 0, top = 0, right = -1, bottom = -1;  // of tiles, inclusive
        bool back = false;
    };
    std::vector<Range> ranges(triangles.size());
    // Camera coordinates are left-handed where those of index space are not mirrored.
    const bool mirrored = dot(cross(frame.right, frame.up), frame.back) < 0;
    const auto width = float(frame.width), height = float(frame.height);
    parallelFor(ranges.size(), 4096, [&](std::size_t begin, std::size_t end) {
        auto tile = [](float pixel) { return std::int16_t(int(pixel) / kTile); };
        for (std::size_t t = begin; t < end; ++t) {
            const auto [u, v, w] = seen(t);
            const bool back = (dot(u, cross(v, w)) < 0) != mirrored;
            if (back && !withBacks) continue;
            const Box b = boxes_[t] = boxOf(t);
            if (b.right < 0 || b.bottom < 0 || b.left >= width || b.top >= height) continue;
            ranges[t] = {tile(std::max(b.left, 0.0f)), tile(std::max(b.top, 0.0f)),
                         tile(std::min(b.right, width - 1)), tile(std::min(b.bottom, height - 1)),
                         back};
        }
    });
    auto forTiles = [&](auto visit) {
        for (std::size_t t = 0; t < ranges.size(); ++t)
            for (int y = ranges[t].top; y <= ranges[t].bottom; ++y)
                for (int x = ranges[t].left; x <= ranges[t].right; ++x)
                    visit(std::size_t(2 * (y * across_ + x) + ranges[t].back), std::uint32_t(t));
    };
    forTiles([&](std::size_t part, std::uint32_t) { ++first_[part + 1]; });
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    list_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    forTiles([&](std::size_t part, std::uint32_t t) { list_[next[part]++] = t; });
}

/// Clips what lies behind the eye, with a margin for rounding.
Raster::Box Raster::boxOf(std::size_t triangle) const {
    constexpr float kSlack = 1e-3f;  // pixels
    const auto& [i, j, k] = triangles_[triangle];
    const Corner &p = corners_[i], &q = corners_[j], &r = corners_[k];
    if (!std::isnan(p.x + q.x + r.x))
        return {std::min({p.x, q.x, r.x}) - kSlack, std::min({p.y, q.y, r.y}) - kSlack,
                std::max({p.x, q.x, r.x}) + kSlack, std::max({p.y, q.y, r.y}) + kSlack,
                float(std::min({p.at.z, q.at.z, r.at.z}))};
    Box box{1e30f, 1e30f, -1e30f, -1e30f, 0};
    auto add = [&](const Vec3d& s) {
        const auto [x, y] = frame_.place(s);
        box.left = std::min(box.left, float(x) - kSlack);
        box.right = std::max(box.right, float(x) + kSlack);
        box.top = std::min(box.top, float(y) - kSlack);
        box.bottom = std::max(box.bottom, float(y) + kSlack);
    };
    const std::array<Vec3d, 3> v = seen(triangle);
    for (unsigned c = 0; c < 3; ++c) {
        const Vec3d &a = v[c], &b = v[(c + 1) % 3];
        if (a.z >= kNearest) add(a);
        if ((a.z < kNearest) == (b.z < kNearest)) continue;
        Vec3d cut = a + ((kNearest - a.z) / (b.z - a.z)) * (b - a);
        cut.z = kNearest;
        add(cut);
    }
    return box;
}

/// The barycentric coordinates of a triangle times a common factor, as linear functions of the
/// picture position: the values at (0, 0), and the change per pixel.
struct Raster::Edges {
    std::array<double, 3> at, byX, byY;
    double volume;  ///< depth times the sum of the three; not positive: not visible

    Edges(const std::array<Vec3d, 3>& v, const Frame& frame) {
        // Each is proportional to the volume of the ray with the opposite edge.
        std::array<Vec3d, 3> e{cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])};
        volume = dot(v[0], e[0]);
        if (volume < 0) {
            volume = -volume;
            for (Vec3d& edge : e) edge = -edge;
        }
        if (!std::isfinite(volume)) volume = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            byX[k] = e[k].x * frame.perPixel;
            byY[k] = -e[k].y * frame.perPixel;
            at[k] = e[k].z - 0.5 * frame.width * byX[k] - 0.5 * frame.height * byY[k];
        }
    }
    void show(double x, double y, std::uint32_t triangle, Sample& sample) const {
        const double a = at[0] + byX[0] * x + byY[0] * y, b = at[1] + byX[1] * x + byY[1] * y,
                     c = at[2] + byX[2] * x + byY[2] * y, sum = a + b + c;
        if (!(sum > 0) || std::min({a, b, c}) < -kRoom * sum) return;
        const double share = 1 / sum;
        const auto depth = float(volume * share);
        if (depth < sample.depth) sample = {depth, triangle, float(b * share), float(c * share)};
    }
};

/// A tile while it is drawn.
class Raster::Tile {
public:
    Tile(const Raster& raster, std::size_t tile, const std::vector<Offset>& offsets,
         const Pixels& wanted, std::vector<Sample>& samples)
        : raster_(raster), offsets_(offsets), wanted_(wanted), samples_(samples) {
        const auto [left, top] = raster.origin(tile);
        left_ = left, top_ = top;
        width_ = std::min(kTile, raster.frame_.width - left_);
        height_ = std::min(kTile, raster.frame_.height - top_);
        for (const Offset& o : offsets) {
            lowX_ = std::min(lowX_, float(o[0])), highX_ = std::max(highX_, float(o[0]));
            lowY_ = std::min(lowY_, float(o[1])), highY_ = std::max(highY_, float(o[1]));
        }
        for (int y = 0; y < height_; ++y)
            for (std::uint32_t bits = wanted[std::size_t(y)]; bits; bits &= bits - 1)
                std::fill_n(at(std::countr_zero(bits), y), offsets.size(), Sample{});
        farthest_.fill(std::numeric_limits<float>::infinity());
    }

    void add(std::uint32_t triangle) {
        const Box& box = raster_.boxes_[triangle];
        const int x0 = firstIn(box.left - highX_ - float(left_)),
                  x1 = lastIn(box.right - lowX_ - float(left_), width_),
                  y0 = firstIn(box.top - highY_ - float(top_)),
                  y1 = lastIn(box.bottom - lowY_ - float(top_), height_);
        if (x0 > x1 || y0 > y1) return;
        const std::uint32_t columns = columnsFrom(x0, x1);
        std::uint32_t any = 0;
        for (int y = y0; y <= y1; ++y) any |= wanted_[std::size_t(y)];
        if (!(any & columns) || isHidden(box.nearest, x0, x1, y0, y1)) return;
        const Edges edges(raster_.seen(triangle), raster_.frame_);
        if (!(edges.volume > 0)) return;
        const Spans spans(edges, box.nearest);
        for (int y = y0; y <= y1; ++y)
            for (std::uint32_t bits = wanted_[std::size_t(y)] & columns &
                                      (x1 - x0 < 3 ? ~0u : columnsIn(spans, y, x0, x1));
                 bits; bits &= bits - 1) {
                const int x = std::countr_zero(bits);
                Sample* sample = at(x, y);
                for (const Offset& o : offsets_)
                    edges.show(left_ + x + o[0], top_ + y + o[1], triangle, *sample++);
            }
    }
    /// Finds what is hidden by all that was drawn.
    void findFarthest() {
        farthest_.fill(0);
        for (int y = 0; y < height_; ++y)
            for (std::uint32_t bits = wanted_[std::size_t(y)]; bits; bits &= bits - 1) {
                const int x = std::countr_zero(bits);
                float& most = farthest_[std::size_t(y / kBlock * kBlocks + x / kBlock)];
                const Sample* sample = at(x, y);
                for (std::size_t s = 0; s < offsets_.size(); ++s)
                    most = std::max(most, sample[s].depth);
            }
    }

private:
    static constexpr int kBlock = 8, kBlocks = kTile / kBlock;

    static int firstIn(float from) {
        const float x = std::clamp(from, 0.0f, float(kTile));
        const int i = int(x);
        return i + (float(i) < x);
    }
    static int lastIn(float to, int count) {
        return to < 0 ? -1 : int(std::min(to, float(count - 1)));
    }
    static std::uint32_t columnsFrom(int x0, int x1) {
        return x0 > x1 ? 0 : ~0u << x0 & ~0u >> (kTile - 1 - x1);
    }
    /// What bounds the pixels of a row that may have samples in a triangle.
    struct Spans {
        const Edges& edges;
        double room;
        std::array<double, 3> pixels;  ///< for a change of each coordinate by 1

        Spans(const Edges& e, float nearest)
            : edges(e), room(2 * kRoom * e.volume / double(nearest)) {
            for (std::size_t k = 0; k < 3; ++k) pixels[k] = 1 / e.byX[k];
        }
    };
    std::uint32_t columnsIn(const Spans& spans, int y, int x0, int x1) const {
        constexpr double kSlack = 1e-3;  // pixels
        double low = x0, high = x1;
        for (std::size_t k = 0; k < 3; ++k) {
            const double byY = spans.edges.byY[k],
                         here = spans.edges.at[k] + spans.room + spans.edges.byX[k] * left_ +
                                byY * (top_ + y + double(byY > 0 ? highY_ : lowY_)),
                         edge = -here * spans.pixels[k];
            if (spans.edges.byX[k] >= 0)
                low = std::max(low, edge - double(highX_) - kSlack);
            else
                high = std::min(high, edge - double(lowX_) + kSlack);
        }
        if (!(low <= high)) return 0;
        const int from = int(low);
        return columnsFrom(from + (from < low), int(high));
    }
    Sample* at(int x, int y) { return &samples_[std::size_t(y * kTile + x) * offsets_.size()]; }
    bool isHidden(float nearest, int x0, int x1, int y0, int y1) const {
        for (int y = y0 / kBlock; y <= y1 / kBlock; ++y)
            for (int x = x0 / kBlock; x <= x1 / kBlock; ++x)
                if (!(nearest > farthest_[std::size_t(y * kBlocks + x)])) return false;
        return true;
    }

    const Raster& raster_;
    const std::vector<Offset>& offsets_;
    const Pixels& wanted_;
    std::vector<Sample>& samples_;
    int left_, top_, width_, height_;
    float lowX_ = 1, highX_ = 0, lowY_ = 1, highY_ = 0;
    std::array<float, std::size_t(kBlocks) * kBlocks> farthest_;  ///< depth, by blocks
};

void Raster::draw(std::size_t tile, const std::vector<Offset>& offsets, const Pixels& wanted,
                  std::vector<Sample>& samples) const {
    Tile drawn(*this, tile, offsets, wanted, samples);
    for (std::size_t l = first_[2 * tile]; l < first_[2 * tile + 1]; ++l) drawn.add(list_[l]);
    drawn.findFarthest();
    for (std::size_t l = first_[2 * tile + 1]; l < first_[2 * tile + 2]; ++l) drawn.add(list_[l]);
}

}  // namespace igeo
