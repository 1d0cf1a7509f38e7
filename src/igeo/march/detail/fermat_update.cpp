#include <igeo/march/detail/fermat_update.h>

#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_fit.h>

namespace igeo {

namespace {

using jet::Four;

/// Two neighbors.
struct NeighborPair {
    std::uint8_t p, q;
};

/// Up to eight segments, each from a neighbor p to a neighbor q. Values are relative to base().
struct SegmentLanes {
    struct End {
        Lanes ax, ay, gx, gy, u;  ///< as in JetNeighbor
    };
    End p, q;
    std::size_t count = 0;
};
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

/// Segments from a neighbor to each of a group.
class ShortSegments {
public:
    ShortSegments(const JetNeighbors& all, int p, const JetNeighbors::Group& q)
        : apx_(Four{} + all.a(p).x),
          apy_(Four{} + all.a(p).y),
          ex_(apx_ - q.ax),
          ey_(apy_ - q.ay),
          up_(Four{} + all.u(p)),
          du_(q.u - up_),
          mp_(all.g(p).x * ex_ + all.g(p).y * ey_),
          mq_(q.gx * ex_ + q.gy * ey_) {}
    Four squaredLength() const { return ex_ * ex_ + ey_ * ey_; }
    /// Lower bounds of total: the cubic falls below its ends by at most 4/27 of the slopes there.
    Four bound() const {
        const Four zero{},
            one = zero + 1, square = squaredLength(),
            foot = (apx_ * ex_ + apy_ * ey_) / (square > 1e-12f ? square : zero + 1e-12f),
            along = foot > 1   ? one
                    : foot > 0 ? foot
                               : zero;
        const Four dip = (4.0f / 27) * ((mp_ < 0 ? -mp_ : zero) + (mq_ > 0 ? mq_ : zero));
        const Four x = apx_ - along * ex_, y = apy_ - along * ey_;
        return up_ + (du_ < 0 ? du_ : zero) - dip + jet::roots(x * x + y * y);
    }

private:
    Four apx_, apy_, ex_, ey_, up_, du_, mp_, mq_;
};

/// The pairs of neighbors whose segments may have a total below a given value.
class SegmentPairs {
public:
    SegmentPairs(const JetNeighbors& all, float below) : all_(all) {
        std::array<Four, JetNeighbors::kMax / 4> len;
        for (int group = 0; group < all.groups(); ++group) {
            const auto n = all.group(group);
            len[std::size_t(group)] = jet::roots(n.ax * n.ax + n.ay * n.ay);
        }
        for (int j = 1; j < all.count(); ++j)
            for (int group = 0; 4 * group < j; ++group)
                add(j, group, len[std::size_t(group)], below);
    }
    std::size_t count() const { return count_; }
    NeighborPair operator[](std::size_t k) const { return pair_[k]; }
    /// Up to eight pairs from `first` on.
    SegmentLanes lanes(std::size_t first) const {
        SegmentLanes lanes{};
        lanes.count = std::min(Lanes::kNodes, count_ - first);
        for (std::size_t l = 0; l < lanes.count; ++l) {
            const NeighborPair pair = pair_[first + l];
            set(lanes.p, l, pair.p), set(lanes.q, l, pair.q);
        }
        return lanes;
    }

private:
    void set(SegmentLanes::End& end, std::size_t lane, int k) const {
        const Vec2f a = all_.a(k), g = all_.g(k);
        end.ax[lane] = a.x, end.ay[lane] = a.y, end.gx[lane] = g.x, end.gy[lane] = g.y;
        end.u[lane] = all_.u(k);
    }
    /// Adds the pairs of neighbor j with earlier ones of a group that can matter: of one front,
    /// because directions of two fronts have no interpolant; short; seen from the node at less than
    /// 120 degrees; and with a lower bound below the value.
    void add(int j, int group, const Four& len, float below) {
        const auto n = all_.group(group);
        const Vec2f a = all_.a(j), g = all_.g(j);
        const ShortSegments segments(all_, j, n);
        const Four cosine = g.x * n.gx + g.y * n.gy, lengths = all_.len(j) * len;
        auto fits = (cosine >= jet::kSameFront) & (segments.squaredLength() <= all_.longest2) &
                    (a.x * n.ax + a.y * n.ay >= -0.5f * lengths) &
                    ((n.u < below) | (all_.u(j) < below ? ~0 : 0));
        if (!(fits[0] | fits[1] | fits[2] | fits[3])) return;
        fits &= segments.bound() < below;
        for (int k = 4 * group; k < std::min(4 * group + 4, j); ++k) {
            pair_[count_] = {std::uint8_t(j), std::uint8_t(k)};
            count_ += fits[k - 4 * group] ? 1 : 0;
        }
    }
    const JetNeighbors& all_;
    std::size_t count_ = 0;
    std::array<NeighborPair, std::size_t(JetNeighbors::kMax*(JetNeighbors::kMax - 1) / 2)> pair_;
};

}  // namespace

Jet fermatUpdate(const JetNeighbors& all) {
    float best = float(kInfinity);
    Vec2f direction;
    int from = -1;  // the neighbor, or an end of the segment
    for (int k = 0; k < all.count(); ++k)
        if (const float u = all.u(k) + all.len(k); u < best)
            best = u, direction = all.a(k), from = k;
    const SegmentPairs pairs(all, best);
    for (std::size_t k = 0; k < pairs.count(); k += Lanes::kNodes) {
        const SegmentLanes lanes = pairs.lanes(k);
        SegmentMinima minima;
        findMinima(lanes, minima);
        for (std::size_t l = 0; l < lanes.count; ++l)
            if (minima.u[l] < best) {
                best = minima.u[l], direction = {minima.x[l], minima.y[l]};
                from = pairs[k + l].p;
            }
    }
    Jet jet;
    jet.usedFallback = true;
    if (from < 0) return jet;
    jet.u = all.base() + double(best);
    const float len = length(direction);
    jet.g = len > 0 ? (1 / len) * direction : all.g(from);
    return jet;
}

}  // namespace igeo
