#include <igeo/march/detail/jet_march_lanes.h>

#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_queue.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace igeo {

namespace {

using Four = Registers<4>::Vector;
using Integers = Registers<4>::Integers;

/// For each set of four flags: the numbers of those that are set, a byte each, and how many.
struct Compressed {
    std::array<std::uint32_t, 16> numbers{};
    std::array<std::uint8_t, 16> count{};
    constexpr Compressed() {
        for (std::uint32_t set = 0; set < 16; ++set)
            for (std::uint32_t k = 0; k < 4; ++k)
                if (set >> k & 1) numbers[set] |= k << 8 * count[set]++;
    }
};
constexpr Compressed kCompressed;

/// Appends the numbers of links from `first` on.
IGEO_INLINE void append(unsigned set, std::uint32_t first, std::uint8_t*& numbers) {
    const std::uint32_t four = kCompressed.numbers[set] + 0x01010101 * first;
    std::memcpy(numbers, &four, sizeof four);
    numbers += kCompressed.count[set];
}

/// The state of a neighbor.
const JetState* stateAt(const JetState* state, const JetLink& link) {
    static_assert(sizeof(JetState) == 16);
    return reinterpret_cast<const JetState*>(reinterpret_cast<const char*>(state) +
                                             std::size_t(8) * (link.key & ~JetLink::kCrease));
}
/// Bucket and rest at once: another thread may lower the bucket.
double bucketAndRest(const JetState* state) {
    static_assert(offsetof(JetState, bucket) == 0 && offsetof(JetState, rest) == 4);
    using Both = double __attribute__((may_alias));
    Both both;
    __atomic_load(reinterpret_cast<const Both*>(state), &both, __ATOMIC_RELAXED);
    return both;
}

template <int Width>
class NeighborLayout {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;

public:
    IGEO_INLINE NeighborLayout(const JetRows& rows, const JetState* state, std::uint32_t first,
                               float width, const Lanes* weight, JetLanes& lanes, std::size_t lane)
        : rows_(rows.of.data() + lane),
          state_(state),
          first_(first),
          width_(width),
          weight_(weight),
          lanes_(lanes),
          lane_(lane) {
        for (std::size_t l = 0; l < Width; ++l) count_[l] = std::int32_t(lanes.count[lane + l]);
    }

    IGEO_INLINE void layOut(std::size_t most) const {
        for (std::size_t k = 0; k < most; ++k) layOutNeighbor(k);
    }

private:
    IGEO_INLINE void layOutNeighbor(std::size_t k) const {
        const JetLink* links[Width];
        for (int l = 0; l < Width; ++l) links[l] = rows_[l].link + rows_[l].known[k];
        V link[4], state[4];
        loadFours<Width>([&](int l) { return &links[l]->ax; }, link);
        loadFours<Width>([&](int l) { return stateAt(state_, *links[l]); }, state);
        V u = bucketsFromFirst(loadAs<Integers>(&state[0])) * width_ + state[1];
        if (weight_) u /= in(*weight_);
        const V cosine = link[2], sine = link[3], gx = state[2], gy = state[3], zero{};
        const auto there = std::int32_t(k) < count_;
        JetLanes::Neighbor& n = lanes_.neighbor[k];
        out(n.ax) = there ? link[0] : zero, out(n.ay) = there ? link[1] : zero;
        out(n.gx) = there ? cosine * gx - sine * gy : zero;
        out(n.gy) = there ? sine * gx + cosine * gy : zero;
        out(n.u) = there ? u : zero + JetFronts::kNoValue;
    }
    /// By halves of buckets, as a difference may take 33 bits.
    IGEO_INLINE V bucketsFromFirst(const Integers& bucket) const {
        const Integers high = (bucket >> 16 & 0xffff) - std::int32_t(first_ >> 16),
                       low = (bucket & 0xffff) - std::int32_t(first_ & 0xffff);
        return __builtin_convertvector(high, V) * 65536 + __builtin_convertvector(low, V);
    }
    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + lane_);
    }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + lane_); }

    const JetRows::Row* const rows_;
    const JetState* const state_;
    const std::uint32_t first_;
    const float width_;
    const Lanes* const weight_;
    JetLanes& lanes_;
    const std::size_t lane_;
    Integers count_;
};

void layOutByFour(const JetRows& rows, const JetState* state, std::uint32_t first, float width,
                  const Lanes* weight, JetLanes& lanes, std::size_t most) {
    for (std::size_t lane = 0; lane < Lanes::kNodes; lane += 4)
        NeighborLayout<4>(rows, state, first, width, weight, lanes, lane).layOut(most);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void layOutByEight(const JetRows& rows, const JetState* state, std::uint32_t first,
                             float width, const Lanes* weight, JetLanes& lanes, std::size_t most) {
    NeighborLayout<8>(rows, state, first, width, weight, lanes, 0).layOut(most);
}
#endif

}  // namespace

void split(std::span<const JetLink> links, const JetState* state, std::uint32_t next,
           bool isotropic, JetRows::Row& row) {
    // Which neighbors have a jet changes from node to node: no branches.
    using Two = double __attribute__((vector_size(16)));
    static_assert(JetLanes::kMax <= 32);
    std::memset(row.known.data(), 0, 32);
    std::uint8_t *known = row.known.data(), *waiting = row.waiting.data();
    // Registers compare numbers with signs.
    const Integers sign = Integers{} + std::numeric_limits<std::int32_t>::min(),
                   nextOne = (Integers{} + std::int32_t(next)) ^ sign,
                   anyBucket = Integers{} - (isotropic ? 0 : 1);
    static constexpr std::uint8_t kFirst[] = {0, 1, 3, 7, 15};
    for (std::size_t k = 0; k < links.size(); k += 4) {
        const JetLink* const four = links.data() + k;
        const auto both = [&](std::size_t l) { return bucketAndRest(stateAt(state, four[l])); };
        const Two a{both(0), both(1)}, b{both(2), both(3)};
        const auto low = loadAs<Integers>(&a), high = loadAs<Integers>(&b);
        const Integers bucket = __builtin_shufflevector(low, high, 0, 2, 4, 6) ^ sign,
                       rest = __builtin_shufflevector(low, high, 1, 3, 5, 7),
                       may = ((bucket > nextOne) | anyBucket) & (bucket != nextOne);
        const unsigned there = kFirst[std::min(links.size() - k, std::size_t(4))],
                       accepted = bitsOf<4>(loadAs<Four>(&rest) < float(kInfinity)) & there;
        append(accepted, std::uint32_t(k), known);
        append(bitsOf<4>(may) & ~accepted & there, std::uint32_t(k), waiting);
    }
    row.link = links.data();
    row.knownCount = std::size_t(known - row.known.data());
    row.waitingCount = std::size_t(waiting - row.waiting.data());
    std::memset(waiting, 0, 4);
}

void layOut(const JetRows& rows, const JetState* state, std::uint32_t first, float width,
            const Lanes* weight, JetLanes& lanes) {
    const std::size_t most = *std::max_element(lanes.count.begin(), lanes.count.end());
#ifdef IGEO_AVX2
    if (eightAtATime()) return layOutByEight(rows, state, first, width, weight, lanes, most);
#endif
    layOutByFour(rows, state, first, width, weight, lanes, most);
}

BucketScale::BucketScale(std::uint32_t bucket, float bucketWidth)
    : first(bucket),
      width(bucketWidth),
      // What single precision has.
      most(float(std::min(kLastBucket - bucket, std::uint32_t(1) << 30) & ~127u)) {}

void carry(const CarriedJet& jet, const BucketScale& scale, const JetRows::Row& row,
           std::uint32_t* bucket) {
    const Four zero{}, weight = zero - jet.weight;
    for (std::size_t k = 0; k < row.waitingCount; k += 4) {
        Four link[4];
        loadFours<4>([&](int l) { return &row.link[row.waiting[k + std::size_t(l)]].ax; }, link);
        const Four x = weight * link[0], y = weight * link[1], along = jet.g.x * x + jet.g.y * y;
        const auto ahead = along > 0;
        const Four base = ahead ? along : zero, r = ahead ? jet.radius + along : zero,
                   rest = x * x + y * y - base * base, across = rest > 0 ? rest : zero;
        Four root = r * r + across;
        takeRoots<4>(root);
        const Four buckets = (jet.u + base + across / (root + r)) / scale.width,
                   within = buckets < scale.most ? buckets : zero + scale.most;
        // Not a number where foot points coincide.
        const Integers whole = __builtin_convertvector(within > 0 ? within : zero, Integers);
        storeLanes(whole + std::int32_t(scale.first), bucket + k);
    }
}

}  // namespace igeo
