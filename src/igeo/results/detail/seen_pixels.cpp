#include <igeo/results/detail/seen_pixels.h>

#include <igeo/base/detail/registers.h>

namespace igeo {

SeenPixels::SeenPixels(const Frame& frame)
    : width(frame.width),
      height(frame.height),
      stride((std::size_t(frame.width) + 3 * kPad - 1) / kPad * kPad),
      perPixel(frame.perPixel),
      depth(stride * std::size_t(height + 2), std::numeric_limits<float>::infinity()),
      nx(new float[depth.size()]),
      ny(new float[depth.size()]),
      nz(new float[depth.size()]),
      distance(new float[depth.size()]),
      towardX(stride),
      towardY(std::size_t(height)) {
    for (int x = 0; x < width; ++x)
        towardX[std::size_t(x + kPad)] = float(frame.toward(x + 0.5, 0).x);
    for (int y = 0; y < height; ++y) towardY[std::size_t(y)] = float(frame.toward(0, y + 0.5).y);
}

namespace {

/// So many pixels of a row, side by side.
template <int Width>
class PixelLanes {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

    template <typename Floats>
    IGEO_INLINE static V loaded(const Floats& from, std::size_t i) {
        return loadLanes<Width>(&from[i]);
    }
    IGEO_INLINE static V chosen(const Integers& first, const V& a, const V& b) {
        return first ? a : b;
    }

    struct Pixels {
        V depth, distance;
        Vectors normal, place;
        Integers covered;
    };
    IGEO_INLINE Pixels at(int x, int y) const {
        constexpr float kNone = std::numeric_limits<float>::infinity();
        const std::size_t i = seen_.index(x, y);
        Pixels p;
        p.depth = loaded(seen_.depth, i);
        p.distance = loaded(seen_.distance, i);
        p.normal = {loaded(seen_.nx, i), loaded(seen_.ny, i), loaded(seen_.nz, i)};
        p.covered = p.depth < kNone;
        const V towardX = loaded(seen_.towardX, std::size_t(x + SeenPixels::kPad)),
                towardY = V{} + (y < 0 || y >= seen_.height ? 0.0f : seen_.towardY[std::size_t(y)]);
        p.place = {p.depth * towardX, p.depth * towardY, p.depth};
        return p;
    }
    IGEO_INLINE Integers parted(const Pixels& a, const Pixels& b) const {
        constexpr float kSmooth = 0.97f, kNone = std::numeric_limits<float>::infinity();  // cosine
        const Vectors r = b.place - a.place;
        const V most = a.depth * float(1.5 * seen_.perPixel);
        const Integers both = a.covered & b.covered,
                       reach = (a.distance < kNone) ^ (b.distance < kNone),
                       crease = dot(a.normal, b.normal) < kSmooth,
                       step = (absolute(dot(r, a.normal)) > most) &
                              (absolute(dot(r, b.normal)) > most);
        return (a.covered ^ b.covered) | (both & (reach | crease | step));
    }

public:
    IGEO_INLINE explicit PixelLanes(const SeenPixels& seen) : seen_(seen) {}

    /// Whether one of some pixels or of their neighbors is covered.
    IGEO_INLINE bool anyCovered(int x, int y) const {
        V nearest = loaded(seen_.depth, seen_.index(x, y));
        for (const std::size_t i : {seen_.index(x - 1, y), seen_.index(x + 1, y),
                                    seen_.index(x, y - 1), seen_.index(x, y + 1)}) {
            const V depth = loaded(seen_.depth, i);
            nearest = depth < nearest ? depth : nearest;
        }
        return bitsOf<Width>(nearest < std::numeric_limits<float>::infinity());
    }
    IGEO_INLINE void edges(int x, int y, RowEdges& row) const {
        constexpr float kNone = std::numeric_limits<float>::infinity();
        if (!anyCovered(x, y)) {
            storeLanes(Integers{}, &row.edge[std::size_t(x)]);
            return;
        }
        const Pixels here = at(x, y);
        Integers edge{};
        V steepest[2] = {};
        for (int side = 0; side < 4; ++side) {
            const int axis = side / 2, step = side % 2 ? 1 : -1;
            const Pixels there = at(x + (axis == 0 ? step : 0), y + (axis == 1 ? step : 0));
            const Integers apart = parted(here, there);
            edge |= apart;
            const Integers counts = here.covered & ~apart & (here.distance < kNone) & there.covered;
            const V off = chosen(counts, absolute(there.distance - here.distance), V{});
            steepest[axis] = off > steepest[axis] ? off : steepest[axis];
        }
        V slope = steepest[0] * steepest[0] + steepest[1] * steepest[1];
        takeRoots<Width>(slope);
        storeLanes(edge, &row.edge[std::size_t(x)]);
        storeLanes(slope, &row.slope[std::size_t(x)]);
    }

private:
    const SeenPixels& seen_;
};

template <int Width>
IGEO_INLINE void edgesOf(const SeenPixels& seen, int y, RowEdges& row) {
    for (int x = 0; x < seen.width; x += Width) PixelLanes<Width>(seen).edges(x, y, row);
}
void edgesByFour(const SeenPixels& seen, int y, RowEdges& row) { edgesOf<4>(seen, y, row); }
#ifdef IGEO_AVX2
IGEO_AVX2 void edgesByEight(const SeenPixels& seen, int y, RowEdges& row) {
    edgesOf<8>(seen, y, row);
}
#endif

}  // namespace

RowEdges::RowEdges(const SeenPixels& seen, int y)
    : edge(new std::int32_t[seen.stride]), slope(new float[seen.stride]) {
#ifdef IGEO_AVX2
    (eightAtATime() ? edgesByEight : edgesByFour)(seen, y, *this);
#else
    edgesByFour(seen, y, *this);
#endif
}

}  // namespace igeo
