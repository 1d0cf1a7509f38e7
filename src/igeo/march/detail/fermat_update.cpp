#include <igeo/march/detail/fermat_update.h>

#include <igeo/base/detail/registers.h>

#include <algorithm>
#include <bit>

namespace igeo {

/// The neighbors in a ring: after the last one all follow again, and then zeros, so that pairs of
/// them that are s apart lie side by side.
struct NeighborRing {
    static constexpr std::size_t kZeros = 8;
    using Array = std::array<float, 2 * std::size_t(JetNeighbors::kMax) + kZeros>;
    alignas(32) Array ax, ay, gx, gy, u, len;
    const std::size_t count;
    const float longest2;

    NeighborRing(std::size_t neighbors, float longest) : count(neighbors), longest2(longest) {}
    void set(std::size_t k, Vec2f a, Vec2f g, float value) {
        ax[k] = ax[k + count] = a.x, ay[k] = ay[k + count] = a.y;
        gx[k] = gx[k + count] = g.x, gy[k] = gy[k + count] = g.y;
        u[k] = u[k + count] = value;
    }
    /// Once all are set.
    void close() {
        const std::size_t end = 2 * count;
        for (Array* array : {&ax, &ay, &gx, &gy, &u, &len})
            std::fill_n(array->data() + end, kZeros, 0.0f);
        for (std::size_t k = 0; k < end; k += 4) {
            const auto x = loadLanes<4>(&ax[k]), y = loadLanes<4>(&ay[k]);
            auto length = x * x + y * y;
            takeRoots<4>(length);
            storeLanes(length, &len[k]);
        }
    }
};

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

/// Pairs of neighbors p and q = p + apart in the ring, p from `first` on.
template <int Width>
class LanePairs {
    using V = typename Registers<Width>::Vector;

public:
    IGEO_INLINE LanePairs(const NeighborRing& ring, std::size_t first, std::size_t apart)
        : ring_(ring), p_(first), q_(first + apart) {}

    /// Those that can matter, a bit each: of one front, because directions of two fronts have no
    /// interpolant; short; seen from the node at less than 120 degrees; and with a total that may
    /// be below a value.
    IGEO_INLINE unsigned find(float below) const {
        const V apx = p(ring_.ax), apy = p(ring_.ay), aqx = q(ring_.ax), aqy = q(ring_.ay);
        const V gpx = p(ring_.gx), gpy = p(ring_.gy), gqx = q(ring_.gx), gqy = q(ring_.gy);
        const V up = p(ring_.u), uq = q(ring_.u);
        const V ex = apx - aqx, ey = apy - aqy, square = ex * ex + ey * ey, zero{};
        const auto fits = (gpx * gqx + gpy * gqy >= zero + jet::kSameFront) &
                          (square <= ring_.longest2) &
                          (apx * aqx + apy * aqy >= -0.5f * (p(ring_.len) * q(ring_.len))) &
                          ((up < below) | (uq < below));
        if (!any(fits)) return 0;
        // Lower bounds of total: the cubic falls below its ends by at most 4/27 of the slopes.
        const V one = zero + 1,
                foot = (apx * ex + apy * ey) / (square > 1e-12f ? square : zero + 1e-12f),
                along = foot > 1   ? one
                        : foot > 0 ? foot
                                   : zero;
        const V mp = gpx * ex + gpy * ey, mq = gqx * ex + gqy * ey,
                dip = (4.0f / 27) * ((mp < 0 ? -mp : zero) + (mq > 0 ? mq : zero));
        const V x = apx - along * ex, y = apy - along * ey;
        V len = x * x + y * y;
        takeRoots<Width>(len);
        return bitsOf<Width>(fits & ((up < uq ? up : uq) - dip + len < below));
    }

private:
    IGEO_INLINE V p(const NeighborRing::Array& of) const { return loadLanes<Width>(&of[p_]); }
    IGEO_INLINE V q(const NeighborRing::Array& of) const { return loadLanes<Width>(&of[q_]); }
    const NeighborRing& ring_;
    const std::size_t p_, q_;
};

/// The bounds for the nodes from `first` on that fit into a register.
template <int Width>
class LaneBounds {
    using V = typename Registers<Width>::Vector;

public:
    IGEO_INLINE LaneBounds(const JetLanes& lanes, const Lanes& longest2, std::size_t first)
        : lanes_(lanes), first_(first), longest2_(in(longest2)), most_(0) {
        for (std::size_t k = first; k < first + Width; ++k)
            if (longest2[k] > 0) most_ = std::max(most_, std::size_t(lanes.count[k]));
    }

    IGEO_INLINE void find(FermatBounds& bounds) const {
        V least = V{} + JetFronts::kNoValue;
        V len[JetLanes::kMax];
        for (std::size_t p = 0; p < most_; ++p) {
            const JetLanes::Neighbor& n = lanes_.neighbor[p];
            const V ax = in(n.ax), ay = in(n.ay);
            len[p] = roots(ax * ax + ay * ay);
            const V u = in(n.u) + len[p];
            least = u < least ? u : least;
        }
        V most = least;
        for (std::size_t q = 1; q < most_; ++q)
            for (std::size_t p = 0; p < q; ++p) bound(p, q, len[p], len[q], least, most);
        out(bounds.least) = least, out(bounds.most) = most;
    }

private:
    /// The segment of two neighbors. With u linear on it the total is convex, and least at s. By
    /// how much the cubic lies below follows from the slopes at the ends, in two ways: by 4/27 of
    /// them at most; and from its value at s on it falls with these slopes at most, while the
    /// length bends up by (a x e)^2 / |a|^3 at least.
    IGEO_INLINE void bound(std::size_t p, std::size_t q, const V& lengthP, const V& lengthQ,
                           V& least, V& most) const {
        const JetLanes::Neighbor &from = lanes_.neighbor[p], &to = lanes_.neighbor[q];
        const V apx = in(from.ax), apy = in(from.ay), aqx = in(to.ax), aqy = in(to.ay);
        const V gpx = in(from.gx), gpy = in(from.gy), gqx = in(to.gx), gqy = in(to.gy);
        const V ex = apx - aqx, ey = apy - aqy, square = ex * ex + ey * ey, zero{}, one = zero + 1;
        const auto counts = (gpx * gqx + gpy * gqy >= zero + jet::kSameFront) &
                            (square <= longest2_) &
                            (apx * aqx + apy * aqy >= -0.5f * (lengthP * lengthQ));
        if (!any(counts)) return;
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
    std::size_t most_;
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

/// LanePairs::find for eight pairs.
unsigned findPairsByFour(const NeighborRing& ring, std::size_t first, std::size_t apart,
                         float below) {
    const unsigned low = LanePairs<4>(ring, first, apart).find(below);
    if (first + 4 >= ring.count) return low;
    return low | LanePairs<4>(ring, first + 4, apart).find(below) << 4;
}
#ifdef IGEO_AVX2
IGEO_AVX2 unsigned findPairsByEight(const NeighborRing& ring, std::size_t first, std::size_t apart,
                                    float below) {
    return LanePairs<8>(ring, first, apart).find(below);
}
#endif
unsigned findPairs(const NeighborRing& ring, std::size_t first, std::size_t apart, float below) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findPairsByEight(ring, first, apart, below);
#endif
    return findPairsByFour(ring, first, apart, below);
}

FermatGroup::Ends bothEnds(std::size_t p, std::size_t q) {
    return {std::uint8_t(p), std::uint8_t(q)};
}

}  // namespace

void boundFallbacks(const JetLanes& lanes, const Lanes& longest2, FermatBounds& bounds) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return boundByEight(lanes, longest2, bounds);
#endif
    boundByFour(lanes, longest2, bounds);
}

void FermatGroup::add(std::size_t node, const JetLanes& lanes, float longest2) {
    NeighborRing ring(lanes.count[node], longest2);
    for (std::size_t k = 0; k < ring.count; ++k) {
        const JetLanes::Neighbor& n = lanes.neighbor[k];
        ring.set(k, {n.ax[node], n.ay[node]}, {n.gx[node], n.gy[node]},
                 n.u[node] - lanes.neighbor[0].u[node]);
    }
    search(node, ring);
}

void FermatGroup::add(std::size_t node, const JetNeighbors& all) {
    NeighborRing ring(std::size_t(all.count()), all.longest2);
    for (int k = 0; k < all.count(); ++k) ring.set(std::size_t(k), all.a(k), all.g(k), all.u(k));
    search(node, ring);
}

Vec2f FermatGroup::g(std::size_t node) const {
    // Foot points on an edge may all but coincide: the chord between them shows no direction.
    constexpr float kSamePoint = 0.1f;
    const Node& n = nodes_[node];
    const float len = length(n.a);
    return len > kSamePoint ? (1 / len) * n.a : n.g;
}

void FermatGroup::search(std::size_t node, NeighborRing& ring) {
    ring.close();
    Node least;
    const std::size_t count = ring.count;
    for (std::size_t k = 0; k < count; ++k)
        if (const float u = ring.u[k] + ring.len[k]; u < least.u)
            least = {u, {ring.ax[k], ring.ay[k]}, {ring.gx[k], ring.gy[k]}, 0, bothEnds(k, k)};
    least.detour = length(least.a) - dot(least.a, least.g);
    nodes_[node] = least;
    for (std::size_t apart = 1; 2 * apart <= count; ++apart) {
        // Pairs of opposite neighbors come twice.
        const std::size_t pairs = 2 * apart == count ? apart : count;
        for (std::size_t first = 0; first < pairs; first += Lanes::kNodes) {
            unsigned found = findPairs(ring, first, apart, least.u);
            if (pairs - first < Lanes::kNodes) found &= (1u << (pairs - first)) - 1;
            for (; found; found &= found - 1) {
                const std::size_t p = first + std::size_t(std::countr_zero(found)), q = p + apart;
                if (q < count)
                    addSegment(node, ring, q, p);
                else
                    addSegment(node, ring, p, q - count);
            }
        }
    }
}

void FermatGroup::addSegment(std::size_t node, const NeighborRing& ring, std::size_t p,
                             std::size_t q) {
    const std::size_t lane = segments_.count++;
    const auto set = [&](SegmentLanes::End& end, std::size_t k) {
        end.ax[lane] = ring.ax[k], end.ay[lane] = ring.ay[k];
        end.gx[lane] = ring.gx[k], end.gy[lane] = ring.gy[k];
        end.u[lane] = ring.u[k];
    };
    set(segments_.p, p), set(segments_.q, q);
    segments_.node[lane] = std::uint8_t(node);
    segments_.ends[lane] = bothEnds(p, q);
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
    FermatGroup group;
    group.add(0, all);
    group.finish();
    if (ends) *ends = group.ends(0);
    Jet jet;
    jet.usedFallback = true;
    if (all.count() == 0) return jet;
    jet.u = all.base() + double(group.u(0));
    jet.g = group.g(0);
    return jet;
}

}  // namespace igeo
