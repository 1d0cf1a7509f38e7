#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_meeting_lanes.h>

#include <algorithm>

namespace igeo {

namespace {

/// The points from `first` on that fit into a register.
template <int Width>
class FrontLanes {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;

public:
    IGEO_INLINE explicit FrontLanes(std::size_t first) : first_(first) {}

    IGEO_INLINE void find(const Arrivals& arrivals, ArrivingFronts& fronts) const {
        constexpr float kApart = 0.98f;  // 11 degrees
        constexpr float kLater = 0.2f;   // voxels
        const V none = V{} + JetFronts::kNoValue;
        V earliest = none, x[ArrivingFronts::kMax], y[ArrivingFronts::kMax];
        Integers count{}, more = ~Integers{};
        for (std::size_t f = 0; f < ArrivingFronts::kMax && any(more); ++f) {
            V least = none;
            x[f] = y[f] = V{};
            for (std::size_t k = 0; k < arrivals.count; ++k) {
                const Arrivals::Neighbor& n = arrivals.neighbor[k];
                const V gx = in(n.gx), gy = in(n.gy), u = in(n.u);
                Integers counts = u < least;
                for (std::size_t e = 0; e < f; ++e) counts &= gx * x[e] + gy * y[e] <= kApart;
                least = counts ? u : least;
                x[f] = counts ? gx : x[f], y[f] = counts ? gy : y[f];
            }
            if (f == 0) earliest = least;
            more &= (least < none) & (least <= earliest + kLater);
            count -= more;
            out(fronts.x[f]) = x[f], out(fronts.y[f]) = y[f];
        }
        storeLanes(count, fronts.count.data() + first_);
    }

    IGEO_INLINE void find(const CoreJets& jets, const LinkedNodes& nodes,
                          LinkedFronts& fronts) const {
        constexpr float kToward = 0.1f;
        const JetState* const states = jets.state.data();
        const auto width = float(jets.buckets.width);
        const float weight = jets.core->nodes[nodes.node[0]].weight;
        const V zero{}, one = zero + 1, none = zero + JetFronts::kNoValue;
        V own[4];
        loadFours<Width>(states, sizeof(JetState), nodes.node.data() + first_, own);
        const Integers bucket = Integers(own[0]);
        const auto links = loadAs<Integers>(nodes.links.data() + first_);
        V least = none, fromLeft{}, fromRight{};
        for (std::size_t k = 0; k < fronts.arrivals.count; ++k) {
            const JetLink* at[Width];
            for (int l = 0; l < Width; ++l) {
                const std::size_t lane = first_ + std::size_t(l);
                at[l] = nodes.link[lane] + (std::int32_t(k) < nodes.links[lane] ? k : 0);
            }
            V link[4], state[4];
            loadFours<Width>([&](int l) { return &at[l]->ax; }, link);
            loadFours<Width>([&](int l) { return &states[at[l]->node()]; }, state);
            const auto there = (std::int32_t(k) < links) & (state[1] < float(kInfinity));
            const V ax = link[0], ay = link[1], gx = link[2] * state[2] - link[3] * state[3],
                    gy = link[3] * state[2] + link[2] * state[3];
            // As FrontsMeet has it.
            const V side = own[2] * ay - own[3] * ax, turn = own[2] * gy - own[3] * gx,
                    whole = turn < zero ? -one : one,
                    sine = own[2] * gx + own[3] * gy > zero ? turn : whole;
            const auto right = there & (side > zero), left = there & (side < zero);
            fromRight = (right & (sine > fromRight)) ? sine : fromRight;
            fromLeft = (left & (-sine > fromLeft)) ? -sine : fromLeft;
            const auto toward = (right & (sine > kToward)) | (left & (-sine > kToward));
            const unsigned bits = bitsOf<Width>(toward) << first_;
            fronts.toward[k] = std::uint8_t(first_ ? fronts.toward[k] | bits : bits);

            const V u = (__builtin_convertvector(Integers(state[0]) - bucket, V) * width +
                         state[1]) /
                        weight,
                    along = ax * gx + ay * gy;
            least = (there & (u < least)) ? u : least;
            Arrivals::Neighbor& to = fronts.arrivals.neighbor[k];
            out(to.gx) = gx, out(to.gy) = gy;
            out(to.u) = (there & (along > zero)) ? u + along : none;
        }
        out(fronts.least) = least;
        const unsigned meet = bitsOf<Width>(fromLeft + fromRight > FrontsMeet::kTurn) << first_;
        fronts.meet = first_ ? fronts.meet | meet : meet;
    }

private:
    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + first_);
    }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }

    const std::size_t first_;
};

template <typename... Of>
void findByFour(Of&... of) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4) FrontLanes<4>(first).find(of...);
}
#ifdef IGEO_AVX2
template <typename... Of>
IGEO_AVX2 void findByEight(Of&... of) {
    FrontLanes<8>(0).find(of...);
}
#endif
template <typename... Of>
void find(Of&... of) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findByEight(of...);
#endif
    findByFour(of...);
}

}  // namespace

void findFronts(const Arrivals& arrivals, ArrivingFronts& fronts) { find(arrivals, fronts); }

void findFronts(const CoreJets& jets, const LinkedNodes& nodes, LinkedFronts& fronts) {
    fronts.arrivals.count = std::size_t(*std::max_element(nodes.links.begin(), nodes.links.end()));
    find(jets, nodes, fronts);
}

}  // namespace igeo
