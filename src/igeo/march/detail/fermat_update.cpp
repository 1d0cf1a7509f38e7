#include <igeo/march/detail/fermat_update.h>

#include <igeo/base/detail/registers.h>

#include <algorithm>
#include <bit>

namespace igeo {

namespace {

/// The least costs across segments: total(s) = H(s) + |a_p - s e|, 0 <= s <= 1, with e the segment
/// and H the cubic Hermite interpolant of the jets at its ends.
struct SegmentMinima {
    Lanes u;
    Lanes x, y;  ///< from the minima to the node
};

/// The segments from `first` on that fit into a register.
template <int Width>
class LaneSegments {
    using V = typename Registers<Width>::Vector;

public:
    IGEO_INLINE LaneSegments(const SegmentLanes& lanes, std::size_t first)
        : first_(first),
          apx_(in(lanes.p.ax)),
          apy_(in(lanes.p.ay)),
          // Both neighbors are at -a.
          ex_(apx_ - in(lanes.q.ax)),
          ey_(apy_ - in(lanes.q.ay)),
          up_(in(lanes.p.u)),
          du_(in(lanes.q.u) - up_),
          mp_(in(lanes.p.gx) * ex_ + in(lanes.p.gy) * ey_),
          mq_(in(lanes.q.gx) * ex_ + in(lanes.q.gy) * ey_) {}

    /// By golden section: 8 steps locate the minima to 2 % of the segment, where total is flat.
    IGEO_INLINE void findMinima(SegmentMinima& minima) const {
        constexpr float kGolden = 0.618034f;
        V lo{}, hi = lo + 1, s1 = lo + (1 - kGolden), s2 = lo + kGolden, f1, f2;
        total(s1, f1), total(s2, f2);
        for (int k = 0; k < 8; ++k) {
            const auto below = f1 < f2;
            hi = below ? s2 : hi, lo = below ? lo : s1;
            const V part = kGolden * (hi - lo), s = below ? hi - part : lo + part;
            V f;
            total(s, f);
            const V keptS = below ? s1 : s2, keptF = below ? f1 : f2;
            s1 = below ? s : keptS, f1 = below ? f : keptF;
            s2 = below ? keptS : s, f2 = below ? keptF : f;
        }
        const V at = f1 < f2 ? s1 : s2;
        out(minima.u) = f1 < f2 ? f1 : f2;
        out(minima.x) = apx_ - at * ex_, out(minima.y) = apy_ - at * ey_;
    }

private:
    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + first_);
    }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }

    IGEO_INLINE void total(const V& s, V& f) const {
        const V t = 1 - s, x = apx_ - s * ex_, y = apy_ - s * ey_;
        V len = x * x + y * y;
        takeRoots<Width>(len);
        f = up_ + s * s * (3 - 2 * s) * du_ + s * t * (t * mp_ - s * mq_) + len;
    }

    const std::size_t first_;
    const V apx_, apy_, ex_, ey_, up_, du_, mp_, mq_;
};

void findByFour(const SegmentLanes& lanes, SegmentMinima& minima) {
    for (std::size_t first = 0; first < lanes.count; first += 4)
        LaneSegments<4>(lanes, first).findMinima(minima);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void findByEight(const SegmentLanes& lanes, SegmentMinima& minima) {
    LaneSegments<8>(lanes, 0).findMinima(minima);
}
#endif

void findMinima(const SegmentLanes& lanes, SegmentMinima& minima) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findByEight(lanes, minima);
#endif
    findByFour(lanes, minima);
}

/// The bounds for the nodes from `first` on that fit into a register.
template <int Width>
class LaneBounds {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;

public:
    IGEO_INLINE LaneBounds(const JetLanes& lanes, const Lanes& longest2, std::size_t first)
        : lanes_(lanes), first_(first), longest2_(in(longest2)) {}

    IGEO_INLINE void find(FermatBounds& bounds) const {
        const std::size_t count = bounds.count;
        const V firstU = in(lanes_.neighbor[0].u), none = V{} + JetFronts::kNoValue;
        V least = none, leastEnd = none;
        Integers end{};
        V len[JetLanes::kMax];
        for (std::size_t p = 0; p < count; ++p) {
            const JetLanes::Neighbor& n = lanes_.neighbor[p];
            const V ax = in(n.ax), ay = in(n.ay);
            len[p] = roots(ax * ax + ay * ay);
            const V u = in(n.u) + len[p], fromFirst = (in(n.u) - firstU) + len[p];
            least = u < least ? u : least;
            const Integers less = fromFirst < leastEnd;
            leastEnd = less ? fromFirst : leastEnd;
            end = less ? Integers{} + std::int32_t(p) : end;
        }
        out(bounds.leastEnd) = leastEnd;
        storeLanes(end, bounds.end.data() + first_);
        V most = least, low[FermatBounds::kMostPairs];
        for (std::size_t q = 1, pair = 0; q < count; ++q)
            for (std::size_t p = 0; p < q; ++p, ++pair)
                low[pair] = bound(p, q, len[p], len[q], least, most);
        out(bounds.least) = least, out(bounds.most) = most;
        const std::size_t pairs = count * (count - 1) / 2;
        for (std::size_t pair = 0; pair < pairs; ++pair) {
            const unsigned bits = bitsOf<Width>(low[pair] < most + FermatBounds::kRounding)
                                  << first_;
            bounds.mayBeLeast[pair] = std::uint8_t(first_ ? bounds.mayBeLeast[pair] | bits : bits);
        }
    }

private:
    /// The segment of two neighbors. With u linear on it the total is convex, and least at s. By
    /// how much the cubic lies below follows from the slopes at the ends, in two ways: by 4/27 of
    /// them at most; and from its value at s on it falls with these slopes at most, while the
    /// length bends up by (a x e)^2 / |a|^3 at least.
    ///
    /// Segments count between neighbors of one front, because directions of two fronts have no
    /// interpolant; if they are short; and seen from the node at less than 120 degrees.
    /// @return the lower bound
    IGEO_INLINE V bound(std::size_t p, std::size_t q, const V& lengthP, const V& lengthQ, V& least,
                        V& most) const {
        const JetLanes::Neighbor &from = lanes_.neighbor[p], &to = lanes_.neighbor[q];
        const V apx = in(from.ax), apy = in(from.ay), aqx = in(to.ax), aqy = in(to.ay);
        const V gpx = in(from.gx), gpy = in(from.gy), gqx = in(to.gx), gqy = in(to.gy);
        const V ex = apx - aqx, ey = apy - aqy, square = ex * ex + ey * ey, zero{}, one = zero + 1;
        const auto counts = (gpx * gqx + gpy * gqy >= zero + jet::kSameFront) &
                            (square <= longest2_) &
                            (apx * aqx + apy * aqy >= -0.5f * (lengthP * lengthQ));
        if (!any(counts)) return zero + JetFronts::kNoValue;
        constexpr float kTiny = 1e-12f;
        const V up = in(from.u), du = in(to.u) - up, flat = square - du * du,
                root = roots(flat > kTiny ? flat : kTiny + zero),
                area = absolute(apx * ey - apy * ex),
                at = ((apx * ex + apy * ey) * root - area * du) /
                     ((square > kTiny ? square : kTiny + zero) * root),
                s = at > 1   ? one
                    : at > 0 ? at
                             : zero,
                t = 1 - s;
        const V x = apx - s * ex, y = apy - s * ey, linear = up + s * du + roots(x * x + y * y);
        const V mp = gpx * ex + gpy * ey - du, mq = gqx * ex + gqy * ey - du,
                dip = (4.0f / 27) * ((mp < 0 ? -mp : zero) + (mq > 0 ? mq : zero)),
                high = linear + s * t * (t * mp - s * mq);
        const V farther = lengthP > lengthQ ? lengthP : lengthQ, slopeP = absolute(mp),
                slopeQ = absolute(mq), slope = slopeP > slopeQ ? slopeP : slopeQ,
                fall = slope * slope * (farther * farther * farther) / (2 * area * area + kTiny),
                byDip = linear - dip, byBend = high - fall, low = byDip > byBend ? byDip : byBend;
        least = (counts & (low < least)) ? low : least;
        most = (counts & (high < most)) ? high : most;
        return counts ? low : zero + JetFronts::kNoValue;
    }
    IGEO_INLINE static V roots(V v) {
        takeRoots<Width>(v);
        return v;
    }
    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + first_);
    }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }

    const JetLanes& lanes_;
    const std::size_t first_;
    const V longest2_;
};

void boundByFour(const JetLanes& lanes, const Lanes& longest2, FermatBounds& bounds) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        LaneBounds<4>(lanes, longest2, first).find(bounds);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void boundByEight(const JetLanes& lanes, const Lanes& longest2, FermatBounds& bounds) {
    LaneBounds<8>(lanes, longest2, 0).find(bounds);
}
#endif

}  // namespace

void boundFallbacks(const JetLanes& lanes, const Lanes& longest2, FermatBounds& bounds) {
    bounds.count = 0;
    for (std::size_t k = 0; k < Lanes::kNodes; ++k)
        if (longest2[k] > 0) bounds.count = std::max(bounds.count, std::size_t(lanes.count[k]));
#ifdef IGEO_AVX2
    if (eightAtATime()) return boundByEight(lanes, longest2, bounds);
#endif
    boundByFour(lanes, longest2, bounds);
}

Vec2f FermatGroup::g(std::size_t node) const {
    // Foot points on an edge may all but coincide: the chord between them shows no direction.
    constexpr float kSamePoint = 0.1f;
    const Node& n = nodes_[node];
    const float len = length(n.a);
    return len > kSamePoint ? (1 / len) * n.a : n.g;
}

void FermatGroup::search(unsigned nodes) {
    for (unsigned left = nodes; left; left &= left - 1) {
        const auto node = std::size_t(std::countr_zero(left));
        const auto end = std::size_t(bounds_.end[node]);
        const JetNeighbor n = lanes_.at(node, end);
        const auto number = std::uint8_t(end);
        nodes_[node] = {bounds_.leastEnd[node], n.a, n.g, length(n.a) - dot(n.a, n.g),
                        Ends{number, number}};
    }
    for (std::size_t q = 1, pair = 0; q < bounds_.count; ++q)
        for (std::size_t p = 0; p < q; ++p, ++pair)
            for (unsigned left = bounds_.mayBeLeast[pair] & nodes; left; left &= left - 1)
                addSegment(std::size_t(std::countr_zero(left)), q, p);
    if (segments_.count > 0) takeSegments();
}

void FermatGroup::addSegment(std::size_t node, std::size_t p, std::size_t q) {
    const std::size_t lane = segments_.count++;
    const float firstU = lanes_.neighbor[0].u[node];
    const auto set = [&](SegmentLanes::End& end, const JetLanes::Neighbor& n) {
        end.ax[lane] = n.ax[node], end.ay[lane] = n.ay[node];
        end.gx[lane] = n.gx[node], end.gy[lane] = n.gy[node];
        end.u[lane] = n.u[node] - firstU;
    };
    set(segments_.p, lanes_.neighbor[p]), set(segments_.q, lanes_.neighbor[q]);
    segments_.node[lane] = std::uint8_t(node);
    segments_.ends[lane] = {std::uint8_t(p), std::uint8_t(q)};
    if (segments_.count == Lanes::kNodes) takeSegments();
}

void FermatGroup::takeSegments() {
    SegmentMinima minima;
    findMinima(segments_, minima);
    for (std::size_t l = 0; l < segments_.count; ++l)
        if (Node& node = nodes_[segments_.node[l]]; minima.u[l] < node.u) {
            const SegmentLanes::End &p = segments_.p, &q = segments_.q;
            const Vec2f a{minima.x[l], minima.y[l]}, gp{p.gx[l], p.gy[l]}, gq{q.gx[l], q.gy[l]};
            node = {minima.u[l], a, gp, length(a) - std::max(dot(a, gp), dot(a, gq)),
                    segments_.ends[l]};
        }
    segments_.count = 0;
}

Jet fermatUpdate(const JetNeighbors& all, std::array<std::uint8_t, 2>* ends) {
    Jet jet;
    jet.usedFallback = true;
    if (ends) *ends = {};
    if (all.count() == 0) return jet;
    JetLanes lanes;
    Lanes longest2{};
    lanes.count[0] = std::uint32_t(all.count()), longest2[0] = all.longest2;
    for (int k = 0; k < all.count(); ++k) {
        JetLanes::Neighbor& n = lanes.neighbor[std::size_t(k)];
        n.ax[0] = all.a(k).x, n.ay[0] = all.a(k).y;
        n.gx[0] = all.g(k).x, n.gy[0] = all.g(k).y, n.u[0] = all.u(k);
    }
    lanes.pad();
    FermatBounds bounds;
    boundFallbacks(lanes, longest2, bounds);
    FermatGroup group(lanes, bounds);
    group.search(1);
    if (ends) *ends = group.ends(0);
    jet.u = all.base() + double(group.u(0));
    jet.g = group.g(0);
    return jet;
}

}  // namespace igeo
