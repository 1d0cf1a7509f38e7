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
        for (int l = 0; l < Width; ++l) links[l] = &rows_[l]->knownLink(k);
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

    const JetRows::Row* const* const rows_;
    const JetState* const state_;
    const std::uint32_t first_;
    const float width_;
    const Lanes* const weight_;
    JetLanes& lanes_;
    const std::size_t lane_;
    Integers count_;
};

/// Which neighbors have a jet changes from node to node: no branches.
/// @param next  the bucket behind the batch, with its first bit turned
IGEO_INLINE void split(const JetState* state, const Integers& next, const Integers& anyBucket,
                       JetRows::Row& row) {
    using Two = double __attribute__((vector_size(16)));
    static_assert(JetLanes::kMax <= 32);
    static constexpr std::uint8_t kFirst[] = {0, 1, 3, 7, 15};
    const std::span<const JetLink> links = row.links;
    const Integers sign = Integers{} + std::numeric_limits<std::int32_t>::min();
    std::memset(row.known.data(), 0, 32), row.waiting.fill(0);
    std::uint8_t *known = row.known.data(), *waiting = row.waiting.data();
    for (std::size_t k = 0; k < links.size(); k += 4) {
        const JetLink* const four = links.data() + k;
        const auto both = [&](std::size_t l) { return bucketAndRest(stateAt(state, four[l])); };
        const Two a{both(0), both(1)}, b{both(2), both(3)};
        const auto low = loadAs<Integers>(&a), high = loadAs<Integers>(&b);
        const Integers bucket = __builtin_shufflevector(low, high, 0, 2, 4, 6) ^ sign,
                       rest = __builtin_shufflevector(low, high, 1, 3, 5, 7),
                       may = ((bucket > next) | anyBucket) & (bucket != next);
        const unsigned there = kFirst[std::min(links.size() - k, std::size_t(4))],
                       accepted = bitsOf<4>(loadAs<Four>(&rest) < float(kInfinity)) & there;
        append(accepted, std::uint32_t(k), known);
        append(bitsOf<4>(may) & ~accepted & there, std::uint32_t(k), waiting);
    }
    row.knownCount = std::size_t(known - row.known.data());
    row.waitingCount = std::size_t(waiting - row.waiting.data());
}

/// Jets that go on, of the lanes that fit into a register.
template <int Width>
class Carrying {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;

public:
    IGEO_INLINE Carrying(const BucketScale& scale, JetsOnLinks& jets, std::size_t lane)
        : scale_(scale), jets_(jets), lane_(lane) {
        for (std::size_t l = 0; l < Width; ++l)
            row_[l] = jets.row[lane + l < jets.size ? lane + l : 0];
    }

    IGEO_INLINE void carry(std::size_t most) const {
        for (std::size_t k = 0; k < most; ++k) carryTo(k);
    }

private:
    IGEO_INLINE void carryTo(std::size_t k) const {
        V link[4];
        loadFours<Width>([&](int l) { return &row_[l]->waitingLink(k).ax; }, link);
        const V zero{}, cost = zero - in(jets_.weight), x = cost * link[0], y = cost * link[1],
                        along = in(jets_.gx) * x + in(jets_.gy) * y;
        const auto ahead = along > 0;
        const V base = ahead ? along : zero, r = ahead ? in(jets_.radius) + along : zero,
                rest = x * x + y * y - base * base, across = rest > 0 ? rest : zero;
        V root = r * r + across;
        takeRoots<Width>(root);
        const V buckets = (in(jets_.u) + base + across / (root + r)) / scale_.width,
                within = buckets < scale_.most ? buckets : zero + scale_.most;
        // Not a number where foot points coincide.
        const Integers whole = __builtin_convertvector(within > 0 ? within : zero, Integers);
        storeLanes(whole + std::int32_t(scale_.first), &jets_.bucket[k][lane_]);
    }
    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + lane_);
    }

    const BucketScale scale_;
    JetsOnLinks& jets_;
    const std::size_t lane_;
    const JetRows::Row* row_[Width];
};

void carryByFour(const BucketScale& scale, JetsOnLinks& jets, std::size_t most) {
    for (std::size_t lane = 0; lane < jets.size; lane += 4)
        Carrying<4>(scale, jets, lane).carry(most);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void carryByEight(const BucketScale& scale, JetsOnLinks& jets, std::size_t most) {
    Carrying<8>(scale, jets, 0).carry(most);
}
#endif

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

void split(std::span<JetRows::Row> rows, const JetState* state, std::uint32_t next,
           bool isotropic) {
    // Registers compare numbers with signs.
    const Integers sign = Integers{} + std::numeric_limits<std::int32_t>::min(),
                   nextOne = (Integers{} + std::int32_t(next)) ^ sign,
                   anyBucket = Integers{} - (isotropic ? 0 : 1);
    for (JetRows::Row& row : rows) split(state, nextOne, anyBucket, row);
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

void carry(const BucketScale& scale, JetsOnLinks& jets) {
    std::size_t most = 0;
    for (std::size_t k = 0; k < jets.size; ++k) most = std::max(most, jets.row[k]->waitingCount);
#ifdef IGEO_AVX2
    if (eightAtATime()) return carryByEight(scale, jets, most);
#endif
    carryByFour(scale, jets, most);
}

}  // namespace igeo
