#include <igeo/results/detail/openness.h>

#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>

#include <cmath>
#include <numbers>

namespace igeo {

namespace {

/// Samples per block; side of the pattern of their rotations
constexpr int kTaps = 8, kPattern = 4;
constexpr float kOneSheet = 0.1f;  ///< of the radius: farther off a plane is another sheet

/// A spiral, rotated by a different angle in each block of the pattern.
struct Spiral {
    struct Taps {
        std::array<float, kTaps> x, y;
    };
    std::array<Taps, std::size_t(kPattern* kPattern)> taps;

    Spiral() {
        constexpr double kTurns = 5 * 2 * std::numbers::pi;
        // Neighbors in the pattern differ by about a quarter of a turn.
        constexpr std::array<int, 16> kTurn{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
        for (std::size_t place = 0; place < taps.size(); ++place)
            for (int k = 0; k < kTaps; ++k) {
                const double share = (k + 0.5) / kTaps,
                             angle = kTurns * share +
                                     kTurn[place] * 2 * std::numbers::pi / (kPattern * kPattern);
                taps[place].x[std::size_t(k)] = float(share * std::cos(angle));
                taps[place].y[std::size_t(k)] = float(share * std::sin(angle));
            }
    }
};

/// So many taps of a block, or blocks of a row, side by side.
template <int Width>
class BlockLanes {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

    template <typename Triple>
    IGEO_INLINE static Vectors load(const Triple* from) {
        V of[4];
        loadFours<Width>([from](int lane) { return &from[lane]; }, of);
        return {of[0], of[1], of[2]};
    }
    IGEO_INLINE static Integers rounded(const V& x) {
        const V half = V{} + 0.5f;
        return __builtin_convertvector(x + (x < 0 ? -half : half), Integers);
    }
    /// Blocks of a row and their sheets.
    struct Sheets {
        Vectors place, normal;
    };
    IGEO_INLINE Sheets sheets(std::size_t i) const {
        return {load(&blocks_.place[i]), load(&blocks_.normal[i])};
    }
    IGEO_INLINE Integers hold(const Sheets& sheets, std::size_t i) const {
        const V off = absolute(dot(load(&blocks_.place[i]) - sheets.place, sheets.normal));
        return off <= V{} + kOneSheet * blocks_.radius;
    }
    IGEO_INLINE V openAt(std::size_t i, const Sheets& sheets, const V& otherwise) const {
        return hold(sheets, i) ? loadLanes<Width>(&blocks_.open[i]) : otherwise;
    }

public:
    IGEO_INLINE explicit BlockLanes(const OpenBlocks& blocks) : blocks_(blocks) {}

    /// The share of light that each of some taps blocks from a block.
    IGEO_INLINE void block(int x, int y, std::size_t tap, float* shares) const {
        constexpr float kFlat = 0.08f;  // smaller rises are ignored: curvature, rounding
        static const Spiral spiral;
        const OpenBlocks::Place& here = blocks_.place[blocks_.index(x, y)];
        const OpenBlocks::Normal& n = blocks_.normal[blocks_.index(x, y)];
        const auto& taps = spiral.taps[std::size_t(y % kPattern * kPattern + x % kPattern)];
        const float reach =
            std::max(blocks_.radius / (blocks_.perPixel * here.z), 3.0f) / OpenBlocks::kBlock;
        const Integers u = x + rounded(reach * loadLanes<Width>(&taps.x[tap])),
                       v = y + rounded(reach * loadLanes<Width>(&taps.y[tap])),
                       inside = (u >= 0) & (v >= 0) & (u < blocks_.across) & (v < blocks_.down);
        // Beyond the picture it is the first block, of the background.
        std::uint32_t index[Width];
        storeLanes(inside & ((v + OpenBlocks::kPad) * int(blocks_.stride) + u + OpenBlocks::kPad),
                   index);
        V of[4];
        loadFours<Width>(blocks_.place.data(), sizeof(OpenBlocks::Place), index, of);
        const Vectors r{of[0] - here.x, of[1] - here.y, of[2] - here.z};
        const V rise = r.x * n.x + r.y * n.y + r.z * n.z, square = dot(r, r),
                off = 1 - square * (1 / (blocks_.radius * blocks_.radius));
        V away = square;
        takeRoots<Width>(away);
        const V over = rise / away - kFlat;
        const Integers blocks = (rise > 0) & (off > 0) & (over > 0);
        storeLanes(blocks ? off * over : V{}, shares);
    }
    /// The mean of what is blocked over the pattern around blocks, on their sheets.
    IGEO_INLINE V smoothed(int x, int y) const {
        const Sheets here = sheets(blocks_.index(x, y));
        V sum{}, count{};
        const V one = V{} + 1;
        for (int v = y - 1; v <= y + 2; ++v)
            for (int u = x - 1; u <= x + 2; ++u) {
                const std::size_t i = blocks_.index(u, v);
                const Integers counts = hold(here, i);
                sum += counts ? loadLanes<Width>(&blocks_.blocked[i]) : V{};
                count += counts ? one : V{};
            }
        return sum / (count > 0 ? count : one);
    }
    /// At the pixels of blocks, in the row on the side of the row `beside`. A block on another
    /// sheet has no influence.
    IGEO_INLINE void between(int x, int y, int beside, float* open) const {
        const std::size_t i = blocks_.index(x, y);
        const Sheets here = sheets(i);
        const V own = loadLanes<Width>(&blocks_.open[i]);
        const std::size_t j = blocks_.index(x, beside);
        const V middle = 0.5625f * own + 0.1875f * openAt(j, here, own),
                left = middle + 0.1875f * openAt(i - 1, here, own) +
                       0.0625f * openAt(j - 1, here, own),
                right = middle + 0.1875f * openAt(i + 1, here, own) +
                        0.0625f * openAt(j + 1, here, own);
        for (int lane = 0; lane < Width; ++lane)
            open[2 * lane] = left[lane], open[2 * lane + 1] = right[lane];
    }

private:
    const OpenBlocks& blocks_;
};

/// Steps of a row of blocks.
template <int Width>
IGEO_INLINE void blockRow(OpenBlocks& blocks, int y) {
    const BlockLanes<Width> lanes(blocks);
    for (int x = 0; x < blocks.across; ++x) {
        if (!blocks.place[blocks.index(x, y)].covered()) continue;
        std::array<float, kTaps> shares;
        for (std::size_t tap = 0; tap < kTaps; tap += Width) lanes.block(x, y, tap, &shares[tap]);
        float sum = 0;
        for (const float share : shares) sum += share;
        blocks.blocked[blocks.index(x, y)] = std::min(1.0f, 2.2f / kTaps * sum);
    }
}
/// Whether one of some blocks of a row is covered.
template <int Width>
IGEO_INLINE bool anyCovered(const OpenBlocks& blocks, int x, int y) {
    bool covered = false;
    for (int lane = 0; lane < Width; ++lane)
        covered |= blocks.place[blocks.index(x + lane, y)].covered();
    return covered;
}
template <int Width>
IGEO_INLINE void smoothRow(OpenBlocks& blocks, int y) {
    const BlockLanes<Width> lanes(blocks);
    for (int x = 0; x < blocks.across; x += Width)
        if (anyCovered<Width>(blocks, x, y))
            storeLanes(1 - lanes.smoothed(x, y), &blocks.open[blocks.index(x, y)]);
}
template <int Width>
IGEO_INLINE void rowBetween(const OpenBlocks& blocks, int y, int beside, std::vector<float>& open) {
    const BlockLanes<Width> lanes(blocks);
    for (int x = 0; x < blocks.across; x += Width)
        if (anyCovered<Width>(blocks, x, y))
            lanes.between(x, y, beside, &open[std::size_t(OpenBlocks::kBlock * x)]);
}

void blockByFour(OpenBlocks& blocks, int y) { blockRow<4>(blocks, y); }
void smoothByFour(OpenBlocks& blocks, int y) { smoothRow<4>(blocks, y); }
void betweenByFour(const OpenBlocks& blocks, int y, int beside, std::vector<float>& open) {
    rowBetween<4>(blocks, y, beside, open);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void blockByEight(OpenBlocks& blocks, int y) { blockRow<8>(blocks, y); }
IGEO_AVX2 void smoothByEight(OpenBlocks& blocks, int y) { smoothRow<8>(blocks, y); }
IGEO_AVX2 void betweenByEight(const OpenBlocks& blocks, int y, int beside,
                              std::vector<float>& open) {
    rowBetween<8>(blocks, y, beside, open);
}
#else
constexpr auto blockByEight = blockByFour;
constexpr auto smoothByEight = smoothByFour;
constexpr auto betweenByEight = betweenByFour;
#endif

}  // namespace

OpenBlocks::OpenBlocks(const SeenPixels& seen, float itsRadius)
    : across((seen.width + kBlock - 1) / kBlock),
      down((seen.height + kBlock - 1) / kBlock),
      stride((std::size_t(across) + 3 * kPad - 1) / kPad * kPad),
      radius(itsRadius),
      perPixel(float(seen.perPixel)),
      place(stride * std::size_t(down + 2 * kPad)),
      normal(place.size()),
      blocked(place.size()),
      open(place.size(), 1.0f) {}

Openness::Openness(const SeenPixels& seen, double radius)
    : seen_(seen), blocks_(seen, float(radius)) {
    auto forRows = [&](auto visit) {
        parallelFor(std::size_t(blocks_.down), 8, [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end); ++y) visit(y);
        });
    };
    const bool eight = eightAtATime();
    forRows([&](int y) {
        for (int x = 0; x < blocks_.across; ++x) place(x, y);
    });
    forRows([&](int y) { (eight ? blockByEight : blockByFour)(blocks_, y); });
    forRows([&](int y) { (eight ? smoothByEight : smoothByFour)(blocks_, y); });
}

void Openness::place(int x, int y) {
    for (int v = kBlock * y; v < std::min(kBlock * (y + 1), seen_.height); ++v)
        for (int u = kBlock * x; u < std::min(kBlock * (x + 1), seen_.width); ++u) {
            const std::size_t i = seen_.index(u, v), block = blocks_.index(x, y);
            if (!seen_.covered(i)) continue;
            const Vec3f p = seen_.place(u, v), n = seen_.normal(i);
            const Vec3f toward = dot(n, p) > 0 ? -n : n;
            blocks_.place[block] = {p.x, p.y, p.z};
            blocks_.normal[block] = {toward.x, toward.y, toward.z};
            return;
        }
}

void Openness::row(int y, std::vector<float>& open) const {
    open.assign(std::size_t(kBlock * (blocks_.across + OpenBlocks::kPad)), 1.0f);
    const int v = y / kBlock, beside = y % kBlock ? v + 1 : v - 1;
    (eightAtATime() ? betweenByEight : betweenByFour)(blocks_, v, beside, open);
}

float Openness::at(int x, int y, float depth) const {
    float least = std::numeric_limits<float>::infinity(), found = 1;
    const auto first = [](int pixel) { return std::max(pixel - 1, 0) / kBlock; };
    const auto last = [](int pixel, int count) { return std::min(pixel + 1, count - 1) / kBlock; };
    for (int v = first(y); v <= last(y, seen_.height); ++v)
        for (int u = first(x); u <= last(x, seen_.width); ++u) {
            const std::size_t i = blocks_.index(u, v);
            const float off = std::abs(blocks_.place[i].z - depth);  // infinity beside the surface
            if (off < least) least = off, found = blocks_.open[i];
        }
    return found;
}

}  // namespace igeo
