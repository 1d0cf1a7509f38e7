#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_corners.h>

namespace igeo {

namespace {

static_assert(sizeof(JetState) == 16 && sizeof(LiftedJet) == 16 &&
              offsetof(JetNode, normal) == 12 && offsetof(JetNode, weight) == 24 &&
              offsetof(JetNode, offset) == 28);

/// What is set in the last four bytes that are read of a node at an obstacle, or where links are
/// severed around it.
std::int32_t hindranceBits() {
    JetNode node{};
    node.obstacleState = Metric::ObstacleState(Metric::Beside | Metric::Inside);
    node.facing = Band::kBesideSevered;
    std::int32_t bits;
    std::memcpy(&bits, &node.offset, sizeof bits);
    return bits;
}

/// TangentFrame::lift.
template <int Width>
IGEO_INLINE VectorLanes<Width> lift(const VectorLanes<Width>& normal,
                                    const typename Registers<Width>::Vector& x,
                                    const typename Registers<Width>::Vector& y) {
    const VectorLanes<Width> t = anyNormalTo<Width>(normal);
    return t * x + cross(normal, t) * y;
}

/// What all points have in common.
struct CoreArrays {
    const JetNode* nodes;
    const JetState* states;
    const LiftedJet* lifted;  ///< null: computed from the states
    bool ofS;                 ///< without gradients
    float bucketWidth;
    bool weighted;
    std::int32_t hindrance = hindranceBits();
};

/// The corners that count, found as they are asked for.
template <int Width>
class CornersInCells {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;

public:
    IGEO_INLINE CornersInCells(const CellPoints& points, std::size_t first)
        : points_(points), first_(first) {
        constexpr float kLight = 0.01f;
        const V x = in(points_.x), y = in(points_.y), z = in(points_.z);
        const V low[] = {1 - x, 1 - y, 1 - z},
                high[] = {1 - absolute(x - 1), 1 - absolute(y - 1), 1 - absolute(z - 1)};
        for (int k = 0; k < int(JetCorners::kMax); ++k) {
            const V weight =
                (k & 4 ? high : low)[0] * (k & 2 ? high : low)[1] * (k & 1 ? high : low)[2];
            const auto node = loadAs<Integers>(points_.node[std::size_t(k)].data() + first_);
            left_ |= (node != std::int32_t(kNoNode)) & (weight >= kLight) & (1 << k);
        }
    }
    IGEO_INLINE const Integers& bits() const { return left_; }
    /// The next corner of each point.
    /// @param there   whether it has one
    /// @param corner  in its cell
    IGEO_INLINE bool next(Integers& there, Integers& corner, Integers& node) {
        if (!any(left_)) return false;
        there = left_ != 0;
        const Integers bit = left_ & -left_;
        left_ ^= bit;
        // A power of two as a floating-point number has its logarithm in its exponent.
        corner = there & ((Integers(__builtin_convertvector(bit, V)) >> 23) - 127);
        alignas(32) std::uint32_t k[Width], index[Width];
        storeLanes(corner, k);
        for (int lane = 0; lane < Width; ++lane)
            index[lane] = points_.node[k[lane]][first_ + std::size_t(lane)];
        node = loadAs<Integers>(index);
        return true;
    }

private:
    IGEO_INLINE V in(const Lanes& l) const { return *reinterpret_cast<const V*>(l.of + first_); }

    const CellPoints& points_;
    const std::size_t first_;
    Integers left_{};
};

template <int Width>
struct BytesPerLane;
template <>
struct BytesPerLane<4> {
    typedef std::uint8_t Vector __attribute__((vector_size(4)));
};
template <>
struct BytesPerLane<8> {
    typedef std::uint8_t Vector __attribute__((vector_size(8)));
};

/// The corners that count, as they are known.
template <int Width>
class KnownCorners {
    using Integers = typename Registers<Width>::Integers;

public:
    IGEO_INLINE KnownCorners(std::span<const CornerSlot> slots, std::size_t first)
        : at_(slots.data()), end_(at_ + slots.size()), first_(first) {}
    IGEO_INLINE bool next(Integers& there, Integers& corner, Integers& node) {
        if (at_ == end_) return false;
        node = loadAs<Integers>(at_->node.data() + first_);
        there = node != std::int32_t(kNoNode);
        using Bytes = typename BytesPerLane<Width>::Vector;
        corner = __builtin_convertvector(loadAs<Bytes>(at_->corner.data() + first_), Integers);
        ++at_;
        return true;
    }

private:
    const CornerSlot *at_, *const end_;
    const std::size_t first_;
};

template <int Width>
class CornerLanes {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

public:
    IGEO_INLINE CornerLanes(const CellPoints& points, std::size_t first, JetCorners& corners)
        : points_(points), first_(first), corners_(corners) {}

    template <typename Corners>
    IGEO_INLINE void gather(const CoreArrays& core, Corners at) const {
        constexpr float kFlat = 0.8f;
        const V x = in(points_.x), y = in(points_.y), z = in(points_.z);
        const V low[] = {1 - x, 1 - y, 1 - z},
                high[] = {1 - absolute(x - 1), 1 - absolute(y - 1), 1 - absolute(z - 1)};
        const Vectors normal{in(points_.nx), in(points_.ny), in(points_.nz)};
        const V weight = in(points_.weight);
        Integers count{}, bucket{}, marks{}, smooth = ~Integers{}, there, k, node;
        for (std::size_t slot = 0; at.next(there, k, node); ++slot) {
            count -= there;  // flags are -1
            const Integers a = k >> 2, b = k >> 1 & 1, c = k & 1;
            put(corners_.node[slot].data(), node);
            node &= there;
            alignas(32) std::uint32_t index[Width];
            storeLanes(node, index);

            V footAndX[4], rest[4], state[4], lifted[4];
            loadFours<Width>(core.nodes, sizeof(JetNode), index, footAndX);
            loadFours<Width>(&core.nodes->normal.y, sizeof(JetNode), index, rest);
            loadFours<Width>(core.states, sizeof(JetState), index, state);
            if (core.lifted) {
                loadFours<Width>(core.lifted, sizeof(LiftedJet), index, lifted);
                state[1] = lifted[3];
            }
            const Vectors foot{footAndX[0], footAndX[1], footAndX[2]},
                other{footAndX[3], rest[0], rest[1]};
            const Integers inBucket = Integers(state[0]);
            if (slot == 0) bucket = inBucket;
            marks |= there & Integers(rest[3]);
            smooth &= ((state[1] < float(kInfinity)) & (dot(normal, other) >= kFlat)) | ~there;

            JetCorners::Corner& to = corners_.corner[slot];
            V u = __builtin_convertvector(inBucket - bucket, V) * core.bucketWidth + state[1],
              mean = V{} + 1;
            if (core.weighted) {
                u /= weight;
                mean = rest[2] == weight ? mean : (1 + rest[2] / weight) / 2;
            }
            out(to.weight) =
                where(there, (a != 0 ? high[0] : low[0]) * (b != 0 ? high[1] : low[1]) *
                                 (c != 0 ? high[2] : low[2]));
            out(to.u) = where(there, u), out(to.mean) = mean;
            out(to.x) = x - __builtin_convertvector(a, V) - foot.x;
            out(to.y) = y - __builtin_convertvector(b, V) - foot.y;
            out(to.z) = z - __builtin_convertvector(c, V) - foot.z;
            out(to.mx) = other.x, out(to.my) = other.y, out(to.mz) = other.z;
            if (core.ofS) continue;
            const Vectors g = core.lifted ? Vectors{lifted[0], lifted[1], lifted[2]}
                                          : lift<Width>(other, state[2], state[3]);
            out(to.gx) = where(there, g.x), out(to.gy) = where(there, g.y);
            out(to.gz) = where(there, g.z);
        }
        out(corners_.nx) = normal.x, out(corners_.ny) = normal.y, out(corners_.nz) = normal.z;
        put(corners_.count.data(), count), put(corners_.bucket.data(), bucket);
        put(corners_.smooth.data(), smooth);
        put(corners_.hindered.data(), marks & core.hindrance);
    }

private:
    IGEO_INLINE static V where(const Integers& there, const V& v) { return V(there & Integers(v)); }
    IGEO_INLINE V in(const Lanes& l) const { return *reinterpret_cast<const V*>(l.of + first_); }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }
    template <typename T>
    IGEO_INLINE void put(T* to, const Integers& all) const {
        std::memcpy(to + first_, &all, sizeof all);
    }

    const CellPoints& points_;
    std::size_t first_;
    JetCorners& corners_;
};

void gatherByFour(const CoreArrays& core, const CellPoints& points, JetCorners& corners) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        CornerLanes<4>(points, first, corners).gather(core, CornersInCells<4>(points, first));
}
void gatherKnownByFour(const CoreArrays& core, const CellPoints& points,
                       std::span<const CornerSlot> slots, JetCorners& corners) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        CornerLanes<4>(points, first, corners).gather(core, KnownCorners<4>(slots, first));
}
#ifdef IGEO_AVX2
IGEO_AVX2 void gatherByEight(const CoreArrays& core, const CellPoints& points,
                             JetCorners& corners) {
    CornerLanes<8>(points, 0, corners).gather(core, CornersInCells<8>(points, 0));
}
IGEO_AVX2 void gatherKnownByEight(const CoreArrays& core, const CellPoints& points,
                                  std::span<const CornerSlot> slots, JetCorners& corners) {
    CornerLanes<8>(points, 0, corners).gather(core, KnownCorners<8>(slots, 0));
}
#endif

/// The jets of nodes side by side, as the march has left them.
template <int Width>
IGEO_INLINE void liftHere(const CoreJets& jets, std::size_t begin, std::size_t end, LiftedJet* to) {
    using V = typename Registers<Width>::Vector;
    using Vectors = VectorLanes<Width>;
    const JetNode* const nodes = jets.core->nodes.data();
    const JetState* const states = jets.state.data();
    for (std::size_t k = begin; k < end; k += Width) {
        auto at = [&](int lane) { return std::min(k + std::size_t(lane), end - 1); };
        V of[4], state[4];
        loadFours<Width>([&](int lane) { return &nodes[at(lane)].normal; }, of);
        loadFours<Width>([&](int lane) { return &states[at(lane)]; }, state);
        const Vectors g = lift<Width>({of[0], of[1], of[2]}, state[2], state[3]);
        const V zero{};
        const auto accepted = state[1] < float(kInfinity);
        alignas(32) float x[Width], y[Width], z[Width];
        storeLanes(accepted ? g.x : zero, x), storeLanes(accepted ? g.y : zero, y);
        storeLanes(accepted ? g.z : zero, z);
        for (std::size_t lane = 0; lane < std::min(std::size_t(Width), end - k); ++lane)
            to[k + lane] = {{x[lane], y[lane], z[lane]}, states[k + lane].rest};
    }
}
void liftByFour(const CoreJets& jets, std::size_t begin, std::size_t end, LiftedJet* to) {
    liftHere<4>(jets, begin, end, to);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void liftByEight(const CoreJets& jets, std::size_t begin, std::size_t end,
                           LiftedJet* to) {
    liftHere<8>(jets, begin, end, to);
}
#endif
void liftAll(const CoreJets& jets, std::size_t begin, std::size_t end, LiftedJet* to) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return liftByEight(jets, begin, end, to);
#endif
    liftByFour(jets, begin, end, to);
}

}  // namespace

LiftedJets liftedOf(const CoreJets& jets) {
    LiftedJets lifted;
    resizeByAll(lifted, jets.state.size());
    parallelFor(jets.state.size(), 4096, [&](std::size_t begin, std::size_t end) {
        liftAll(jets, begin, end, lifted.data());
    });
    if (jets.meetings)
        jets.meetings->findAll(jets, [&](NodeIndex k, const JetState& state) {
            lifted[k] = {jets.gradientOf(k, state), state.rest};
        });
    return lifted;
}

namespace {

void gather(const CoreArrays& core, const CellPoints& points, JetCorners& corners) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return gatherByEight(core, points, corners);
#endif
    gatherByFour(core, points, corners);
}
CoreArrays arraysOf(const CoreJets& jets, const LiftedJet* lifted = nullptr, bool ofS = false) {
    return {jets.core->nodes.data(),   jets.state.data(),           lifted, ofS,
            float(jets.buckets.width), jets.core->metric.weighted()};
}

/// Sets value and direction of the corners across which fronts meet.
void takeMeetings(const CoreJets& jets, const CellPoints& points, JetCorners& corners) {
    constexpr std::size_t kMost = Lanes::kNodes * JetCorners::kMax;
    struct Place {
        std::uint8_t lane, corner;
    };
    std::array<Place, kMost> place;
    std::array<NodeIndex, kMost> node;
    std::array<JetState, kMost> state;
    std::size_t count = 0;
    for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane)
        for (std::size_t c = 0; c < corners.count[lane]; ++c)
            if (const NodeIndex k = corners.node[c][lane]; jets.meetings->at(k))
                node[count] = k, place[count++] = {std::uint8_t(lane), std::uint8_t(c)};
    if (count == 0) return;
    jets.meetings->find(jets, {node.data(), count}, state.data());
    for (std::size_t n = 0; n < count; ++n) {
        const auto [lane, c] = place[n];
        JetCorners::Corner& to = corners.corner[c];
        const auto buckets = float(std::int32_t(state[n].bucket - corners.bucket[lane]));
        const float beyond = buckets * float(jets.buckets.width) + state[n].rest;
        to.u[lane] = beyond / points.weight[lane];
        const Vec3f g = jets.gradientOf(node[n], state[n]);
        to.gx[lane] = g.x, to.gy[lane] = g.y, to.gz[lane] = g.z;
    }
}

}  // namespace

void findCornersThatCount(const CellPoints& points, JetCorners::PerLane<std::uint32_t>& bits) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        storeLanes(CornersInCells<4>(points, first).bits(), bits.data() + first);
}

void gatherMarched(const CoreJets& jets, const CellPoints& points, JetCorners& corners) {
    gather(arraysOf(jets), points, corners);
}

void gatherCornersOfS(const CoreJets& jets, const CellPoints& points, JetCorners& corners) {
    gather(arraysOf(jets, nullptr, true), points, corners);
}

void gatherCorners(const CoreJets& jets, const LiftedJets& lifted, const CellPoints& points,
                   JetCorners& corners) {
    if (!lifted.empty()) return gather(arraysOf(jets, lifted.data()), points, corners);
    gatherMarched(jets, points, corners);
    if (jets.meetings) takeMeetings(jets, points, corners);
}

void gatherCorners(const CoreJets& jets, const LiftedJets& lifted, const CellPoints& points,
                   std::span<const CornerSlot> slots, JetCorners& corners) {
    const CoreArrays core = arraysOf(jets, lifted.data());
#ifdef IGEO_AVX2
    if (eightAtATime()) return gatherKnownByEight(core, points, slots, corners);
#endif
    gatherKnownByFour(core, points, slots, corners);
}

}  // namespace igeo
