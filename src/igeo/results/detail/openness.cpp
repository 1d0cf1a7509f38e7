#include <igeo/results/detail/openness.h>

#include <igeo/base/parallel.h>

#include <cmath>
#include <numbers>

namespace igeo {

namespace {

constexpr int kBlock = 2;  ///< pixels along a side
/// Samples per block; side of the pattern of their rotations
constexpr int kTaps = 8, kPattern = 4;
constexpr float kOneSheet = 0.1f;  ///< of the radius: farther off a plane is another sheet

/// For small numbers; faster than std::lround, a function call.
int rounded(float x) { return int(x + (x < 0 ? -0.5f : 0.5f)); }

/// A spiral, rotated by a different angle in each block of the pattern.
struct Spiral {
    struct Tap {
        float x, y;
    };
    std::array<std::array<Tap, kTaps>, std::size_t(kPattern* kPattern)> taps;

    Spiral() {
        constexpr double kTurns = 5 * 2 * std::numbers::pi;
        // Neighbors in the pattern differ by about a quarter of a turn.
        constexpr std::array<int, 16> kTurn{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
        for (std::size_t place = 0; place < taps.size(); ++place)
            for (int k = 0; k < kTaps; ++k) {
                const double share = (k + 0.5) / kTaps,
                             angle = kTurns * share +
                                     kTurn[place] * 2 * std::numbers::pi / (kPattern * kPattern);
                taps[place][std::size_t(k)] = {float(share * std::cos(angle)),
                                               float(share * std::sin(angle))};
            }
    }
};

}  // namespace

Openness::Openness(const SeenPixels& seen, double radius)
    : seen_(seen),
      radius_(float(radius)),
      across_((seen.width + kBlock - 1) / kBlock),
      down_((seen.height + kBlock - 1) / kBlock),
      blocks_(std::size_t(across_) * std::size_t(down_)) {
    auto forBlocks = [&](auto visit) {
        parallelFor(std::size_t(down_), 8, [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < across_; ++x) visit(x, y);
        });
    };
    std::vector<float> raw(blocks_.size());
    auto index = [&](int x, int y) {
        return std::size_t(y) * std::size_t(across_) + std::size_t(x);
    };
    forBlocks([&](int x, int y) { place(x, y); });
    forBlocks([&](int x, int y) {
        if (block(x, y).covered) raw[index(x, y)] = blocked(x, y);
    });
    forBlocks([&](int x, int y) {
        if (block(x, y).covered) blocks_[index(x, y)].open = 1 - smoothed(raw, x, y);
    });
}

void Openness::place(int x, int y) {
    for (int v = kBlock * y; v < std::min(kBlock * (y + 1), seen_.height); ++v)
        for (int u = kBlock * x; u < std::min(kBlock * (x + 1), seen_.width); ++u) {
            const std::size_t i = seen_.index(u, v);
            if (!seen_.covered(i)) continue;
            blocks_[std::size_t(y) * std::size_t(across_) + std::size_t(x)] = {
                seen_.place(u, v), seen_.normal(i), 1, true};
            return;
        }
}

/// The share of light blocked from a block, 0 to 1, with the pattern's noise.
float Openness::blocked(int x, int y) const {
    constexpr float kFlat = 0.08f;  // smaller rises are ignored: curvature, rounding
    static const Spiral spiral;
    const Block& here = block(x, y);
    const Vec3f n = dot(here.normal, here.place) > 0 ? -here.normal : here.normal;
    const float reach = std::max(radius_ / (float(seen_.perPixel) * here.place.z), 3.0f) / kBlock;
    const float perSquare = 1 / (radius_ * radius_);
    float sum = 0;
    for (const auto& tap : spiral.taps[std::size_t(y % kPattern * kPattern + x % kPattern)]) {
        const int u = x + rounded(reach * tap.x), v = y + rounded(reach * tap.y);
        if (!holds(u, v)) continue;
        const Block& there = block(u, v);
        if (!there.covered) continue;
        const Vec3f r = there.place - here.place;
        const float rise = dot(r, n), square = dot(r, r), off = 1 - square * perSquare;
        if (rise > 0 && off > 0) sum += off * std::max(0.0f, rise / std::sqrt(square) - kFlat);
    }
    return std::min(1.0f, 2.2f / kTaps * sum);
}

bool Openness::onSheet(const Block& sheet, const Block& b) const {
    return b.covered && std::abs(dot(b.place - sheet.place, sheet.normal)) <= kOneSheet * radius_;
}

/// The mean of `values` over the pattern around a block, on its sheet.
float Openness::smoothed(const std::vector<float>& values, int x, int y) const {
    const int left = std::max(x - 1, 0), right = std::min(x + 2, across_ - 1),
              top = std::max(y - 1, 0), bottom = std::min(y + 2, down_ - 1);
    auto forPattern = [&](auto visit) {
        for (int v = top; v <= bottom; ++v)
            for (int u = left; u <= right; ++u)
                visit(std::size_t(v) * std::size_t(across_) + std::size_t(u));
    };
    float most = 0;
    forPattern([&](std::size_t i) { most = std::max(most, values[i]); });
    if (most == 0) return 0;
    const Block& here = block(x, y);
    float sum = 0, count = 0;
    forPattern([&](std::size_t i) {
        if (onSheet(here, blocks_[i])) sum += values[i], ++count;
    });
    return sum / count;
}

void Openness::row(int y, std::vector<float>& open) const {
    open.assign(std::size_t(kBlock * across_), 1.0f);
    const int v = y / kBlock, w = y % kBlock ? v + 1 : v - 1;
    for (int u = 0; u < across_; ++u) {
        const Block& here = block(u, v);
        if (!here.covered) continue;
        const float middle = 0.5625f * here.open + 0.1875f * beside(here, u, w);
        for (const int side : {0, 1}) {
            const int s = side ? u + 1 : u - 1;
            open[std::size_t(kBlock * u + side)] =
                middle + 0.1875f * beside(here, s, v) + 0.0625f * beside(here, s, w);
        }
    }
}

float Openness::at(int x, int y, float depth) const {
    float least = std::numeric_limits<float>::infinity(), found = 1;
    const auto first = [](int pixel) { return std::max(pixel - 1, 0) / kBlock; };
    const auto last = [](int pixel, int count) { return std::min(pixel + 1, count - 1) / kBlock; };
    for (int v = first(y); v <= last(y, seen_.height); ++v)
        for (int u = first(x); u <= last(x, seen_.width); ++u) {
            const Block& b = block(u, v);
            const float off = std::abs(b.place.z - depth);
            if (b.covered && off < least) least = off, found = b.open;
        }
    return found;
}

}  // namespace igeo
