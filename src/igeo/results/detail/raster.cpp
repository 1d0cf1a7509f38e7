#include <igeo/results/detail/raster.h>

#include <igeo/base/detail/four_doubles.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <type_traits>

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

    IGEO_INLINE Edges(const std::array<Vec3d, 3>& v, const Frame& frame) {
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
    /// For four samples.
    using Three = std::array<FourDoubles, 3>;
    IGEO_INLINE Three times(const std::array<double, 3>& change, const FourDoubles& x) const {
        return {change[0] * x, change[1] * x, change[2] * x};
    }
    IGEO_INLINE void show(const Three& fromX, const Three& fromY, std::uint32_t triangle,
                          FourSamples& samples) const {
        using Four = Registers<4>::Vector;
        using Integers = Registers<4>::Integers;
        const FourDoubles a = at[0] + fromX[0] + fromY[0], b = at[1] + fromX[1] + fromY[1],
                          c = at[2] + fromX[2] + fromY[2], sum = a + b + c, lesser = b < a ? b : a,
                          least = c < lesser ? c : lesser;
        const auto inside = __builtin_convertvector((sum > 0) & (least >= -kRoom * sum), Integers);
        if (!bitsOf<4>(inside)) return;
        const FourDoubles share = 1 / sum;
        const Four depth = __builtin_convertvector(volume * share, Four),
                   before = loadAs<Four>(&samples.depth);
        const Integers shown = inside & (depth < before);
        if (!bitsOf<4>(shown)) return;
        auto put = [&](const auto& now, auto& to) __attribute__((always_inline)) {
            using V = std::remove_cvref_t<decltype(now)>;
            storeLanes(shown ? now : loadAs<V>(&to), &to);
        };
        put(depth, samples.depth);
        put(Integers{} + std::int32_t(triangle), samples.triangle);
        put(__builtin_convertvector(b * share, Four), samples.second);
        put(__builtin_convertvector(c * share, Four), samples.third);
    }
};

/// A tile while it is drawn.
template <typename Pattern>
class Raster::Tile {
public:
    Tile(const Raster& raster, std::size_t tile, const Pattern& pattern, const Pixels& wanted,
         FourSamples* samples)
        : raster_(raster), pattern_(pattern), wanted_(wanted), samples_(samples) {
        const auto [left, top] = raster.origin(tile);
        left_ = left, top_ = top;
        width_ = std::min(kTile, raster.frame_.width - left_);
        height_ = std::min(kTile, raster.frame_.height - top_);
        forGroups([&](FourSamples* group, int, int) {
            std::fill_n(group, Pattern::kPerGroup, FourSamples{});
        });
        farthest_.fill(std::numeric_limits<float>::infinity());
    }

    void addAll(std::span<const std::uint32_t> triangles) {
#ifdef IGEO_AVX2
        if (eightAtATime()) return addByFour(triangles);
#endif
        for (const std::uint32_t t : triangles) add(t);
    }
    /// Finds what is hidden by all that was drawn.
    void findFarthest() {
        farthest_.fill(0);
        forGroups([&](const FourSamples* group, int x, int y) {
            float& most = farthest_[std::size_t(y / kBlock * kBlocks + x / kBlock)];
            for (std::size_t r = 0; r < Pattern::kPerGroup; ++r)
                for (const float depth : group[r].depth) most = std::max(most, depth);
        });
    }

private:
    static constexpr int kBlock = 8, kBlocks = kTile / kBlock;

    static constexpr std::uint32_t kFirstGroup = (1u << Pattern::kPixels) - 1;

    FourSamples* at(int x, int y) {
        return &samples_[std::size_t(y * kTile + x) / Pattern::kPixels * Pattern::kPerGroup];
    }
    /// Calls visit(samples, x, y) for the groups with pixels that are wanted.
    template <typename Visit>
    void forGroups(const Visit& visit) {
        for (int y = 0; y < height_; ++y)
            for (std::uint32_t bits = wanted_[std::size_t(y)]; bits;) {
                const int x = std::countr_zero(bits) & -Pattern::kPixels;
                visit(at(x, y), x, y);
                bits &= ~(kFirstGroup << x);
            }
    }
#ifdef IGEO_AVX2
    IGEO_AVX2 void addByFour(std::span<const std::uint32_t> triangles) {
        for (const std::uint32_t t : triangles) add(t);
    }
#endif
    IGEO_INLINE void add(std::uint32_t triangle) {
        const Box& box = raster_.boxes_[triangle];
        const auto [x0, y0, x1, y1] = pixelsIn(box);
        if (x0 > x1 || y0 > y1) return;
        const std::uint32_t columns = columnsFrom(x0, x1);
        std::uint32_t any = 0;
        for (int y = y0; y <= y1; ++y) any |= wanted_[std::size_t(y)];
        if (!(any & columns) || isHidden(box.nearest, x0, x1, y0, y1)) return;
        const Edges edges(raster_.seen(triangle), raster_.frame_);
        if (!(edges.volume > 0)) return;
        const bool few = (x1 - x0) / Pattern::kPixels < 3;
        const Spans spans(edges, box.nearest);
        for (int y = y0; y <= y1; ++y) {
            std::uint32_t bits =
                wanted_[std::size_t(y)] & columns & (few ? ~0u : columnsIn(spans, y, x0, x1));
            std::array<typename Edges::Three, Pattern::kPerGroup> fromY;
            for (std::size_t r = 0; r < Pattern::kPerGroup; ++r)
                fromY[r] =
                    edges.times(edges.byY, double(top_ + y) + loadAs<FourDoubles>(&pattern_.y[r]));
            while (bits) {
                const int x = std::countr_zero(bits) & -Pattern::kPixels;
                bits &= ~(kFirstGroup << x);
                FourSamples* const group = at(x, y);
                for (std::size_t r = 0; r < Pattern::kPerGroup; ++r)
                    edges.show(edges.times(edges.byX,
                                           double(left_ + x) + loadAs<FourDoubles>(&pattern_.x[r])),
                               fromY[r], triangle, group[r]);
            }
        }
    }

    /// The first and the last columns and rows with samples in a box, or one more.
    IGEO_INLINE std::array<int, 4> pixelsIn(const Box& box) const {
        using Four = Registers<4>::Vector;
        constexpr auto kEnd = float(kTile);
        const auto left = float(left_), top = float(top_);
        const Four least{0, 0, -1, -1}, most{kEnd, kEnd, float(width_ - 1), float(height_ - 1)},
            sample{pattern_.high, pattern_.high, pattern_.low, pattern_.low},
            from = loadAs<Four>(&box) - sample - Four{left, top, left, top},
            above = from > least ? from : least, at = above < most ? above : most;
        // Rounded up by rounding their difference from the end down.
        const auto whole = __builtin_convertvector(Four{kEnd, kEnd, 1, 1} + Four{-1, -1, 1, 1} * at,
                                                   Registers<4>::Integers);
        return {kTile - whole[0], kTile - whole[1], whole[2] - 1, whole[3] - 1};
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
                                byY * (top_ + y + double(byY > 0 ? pattern_.high : pattern_.low)),
                         edge = -here * spans.pixels[k];
            if (spans.pixels[k] > 0)  // also tells -0 from 0
                low = std::max(low, edge - double(pattern_.high) - kSlack);
            else
                high = std::min(high, edge - double(pattern_.low) + kSlack);
        }
        if (!(low <= high)) return 0;
        const int from = int(low);
        return columnsFrom(from + (from < low), int(high));
    }
    bool isHidden(float nearest, int x0, int x1, int y0, int y1) const {
        for (int y = y0 / kBlock; y <= y1 / kBlock; ++y)
            for (int x = x0 / kBlock; x <= x1 / kBlock; ++x)
                if (!(nearest > farthest_[std::size_t(y * kBlocks + x)])) return false;
        return true;
    }

    const Raster& raster_;
    const Pattern& pattern_;
    const Pixels& wanted_;
    FourSamples* const samples_;
    int left_, top_, width_, height_;
    std::array<float, std::size_t(kBlocks) * kBlocks> farthest_;  ///< depth, by blocks
};

Raster::Centers Raster::centers() {
    return {{{{0.5, 1.5, 2.5, 3.5}}}, {{{0.5, 0.5, 0.5, 0.5}}}, 0.5f, 0.5f};
}

/// No two in one row or column of the pixel.
Raster::Finer Raster::finer() {
    constexpr std::size_t kLanes = FourSamples::kLanes;
    auto at = [](int a, int b) { return (a + (b + 0.5) / kFiner) / kFiner; };
    Finer finer;
    finer.low = float(at(0, 0)), finer.high = float(at(kFiner - 1, kFiner - 1));
    for (std::size_t s = 0; s < Finer::kPerGroup * kLanes; ++s) {
        const int k = std::min(int(s), kFiner * kFiner - 1), a = k / kFiner, b = k % kFiner;
        finer.x[s / kLanes][s % kLanes] = at(a, b);
        finer.y[s / kLanes][s % kLanes] = at(b, a);
    }
    return finer;
}

template <typename Pattern>
void Raster::draw(std::size_t tile, const Pattern& pattern, const Pixels& wanted,
                  FourSamples* samples) const {
    Tile<Pattern> drawn(*this, tile, pattern, wanted, samples);
    auto part = [&](std::size_t k) {
        return std::span(list_.data() + first_[k], first_[k + 1] - first_[k]);
    };
    drawn.addAll(part(2 * tile));
    const auto backs = part(2 * tile + 1);
    if (backs.empty()) return;
    drawn.findFarthest();
    drawn.addAll(backs);
}
template void Raster::draw(std::size_t, const Centers&, const Pixels&, FourSamples*) const;
template void Raster::draw(std::size_t, const Finer&, const Pixels&, FourSamples*) const;

}  // namespace igeo
