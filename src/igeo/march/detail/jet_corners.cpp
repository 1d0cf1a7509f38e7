#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_corners.h>

#include <algorithm>

namespace igeo {

namespace {

/// The nodes from `first` on that fit into a register.
template <int Width>
class LaneNodes {
    using V = typename Registers<Width>::Vector;
    using Flags = decltype(V{} < V{});
    using Vectors = VectorLanes<Width>;

    IGEO_INLINE static V choose(const Flags& first, const V& a, const V& b) {
        return first ? a : b;
    }
    IGEO_INLINE static V roots(const V& square) {
        V v = square;
        takeRoots<Width>(v);
        return v;
    }

public:
    IGEO_INLINE LaneNodes(const JetCorners& corners, std::size_t first)
        : corners_(corners),
          first_(first),
          normal_{in(corners.nx), in(corners.ny), in(corners.nz)} {
        for (std::size_t k = first; k < first + Width; ++k)
            most_ = std::max(most_, std::size_t(corners.count[k]));
    }

    IGEO_INLINE void carry(bool faceted, CarriedJets& jets) const {
        const Vectors g = meanDirection();
        V value{}, total{}, least = V{} + 1;
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            const V w = in(c.weight);
            const Vectors own = direction(c);
            const V cosine = dot(g, own);
            least = choose((w > 0) & (cosine < least), cosine, least);
            // Directions in space, not in one plane, change the step by (k c)^2 / 12 at curvature
            // k.
            value += w * (in(c.u) + in(c.mean) * dot(g + own, chord(c)) / (1 + cosine));
            total += w;
        }
        out(jets.u) = value / total;
        out(jets.gx) = g.x, out(jets.gy) = g.y, out(jets.gz) = g.z;
        const Flags similar = least >= jet::kSameFront;
        Flags close = least >= jet::kClose;
        // Where S is curved directions differ that are close in its plane. Then no pair differs.
        if (any(similar & ~close)) close |= similar & closeInPlane(g);
        Fronts fronts{close, close};
        if (any(similar & ~close)) {
            const Fronts byPairs = frontsOfPairs(faceted);
            fronts.spreads |= similar & byPairs.spreads;
            fronts.one |= similar & byPairs.one;
        }
        storeLanes(fronts.spreads & 1, &jets.spreads[first_]);
        storeLanes(fronts.one & 1, &jets.oneFront[first_]);
    }

private:
    /// CarriedJets::spreads and CarriedJets::oneFront.
    struct Fronts {
        Flags spreads, one;
    };
    /// A corner in the chart of its node, as vectors of the tangent plane in space.
    struct Neighbor {
        Flags there;
        Vectors a, g;
        V u;
    };

    IGEO_INLINE V in(const Lanes& l) const { return *reinterpret_cast<const V*>(l.of + first_); }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }
    IGEO_INLINE Vectors direction(const JetCorners::Corner& c) const {
        return {in(c.gx), in(c.gy), in(c.gz)};
    }
    IGEO_INLINE Vectors chord(const JetCorners::Corner& c) const {
        return {in(c.x), in(c.y), in(c.z)};
    }

    /// Unit, in the tangent plane of each node; 0 where the corners cancel each other.
    IGEO_INLINE Vectors meanDirection() const {
        Vectors g{};
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            g = g + direction(c) * in(c.weight);
        }
        g = g - normal_ * dot(g, normal_);
        const V len = roots(dot(g, g)), zero{};
        return g * choose(len > 0, 1 / len, zero);
    }

    /// The direction at a corner, turned into the tangent plane of the point.
    IGEO_INLINE Vectors turned(const JetCorners::Corner& c) const {
        const Vectors other{in(c.mx), in(c.my), in(c.mz)}, g = direction(c);
        return g - (normal_ + other) * (dot(g, normal_) / (1 + dot(normal_, other)));
    }
    /// Whether these directions are so close to one that any two of them are alike (jet::kAlike2).
    IGEO_INLINE Flags closeInPlane(const Vectors& g) const {
        constexpr float kHalfAlike = 0.99875f;  // 2.9 degrees
        Flags close = ~Flags{};
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            close &= (dot(g, turned(c)) >= kHalfAlike) | (in(c.weight) <= 0);
        }
        return close;
    }

    /// As flattened() has it.
    IGEO_INLINE Neighbor flattened(const JetCorners::Corner& c, bool faceted) const {
        const Vectors other{in(c.mx), in(c.my), in(c.mz)};
        const Flags there = in(c.weight) > 0;
        return {there, unfold(chord(c), other, dot(normal_, other), there, faceted) * in(c.mean),
                turned(c), in(c.u)};
    }
    /// As TangentFrame::unfold has it.
    IGEO_INLINE Vectors unfold(const Vectors& chord, const Vectors& other, const V& cosine,
                               const Flags& there, bool faceted) const {
        const V rise = dot(normal_, chord);
        const Vectors in = chord - normal_ * rise;
        const V in2 = dot(in, in), x = rise * rise / in2, c2 = in2 + rise * rise,
                bend = rise - dot(other, chord), kc2 = bend * bend / c2,
                stretch = choose(x < 0.02f, 1 + x * (0.5f - 0.125f * x), roots(1 + x)),
                longer = stretch * (1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640))), one = V{} + 1;
        const Vectors arc = in * choose(in2 > 1e-12f, longer, one);
        const Flags crease = there & (cosine < TangentFrame::creaseCosine(faceted));
        if (!any(crease)) return arc;
        // The planes of both foot points, unfolded about the line where they meet.
        const Vectors axis = cross(normal_, other), e = axis * (1 / roots(dot(axis, axis))),
                      ti = cross(normal_, e), tj = cross(other, e);
        const V zero{}, sj = dot(normal_, chord) / dot(normal_, tj),
                        si = -dot(other, chord) / dot(other, ti), farJ = absolute(sj),
                        farI = absolute(si);
        const Flags lessI = (farI < farJ), beyond = (sj * si > TangentFrame::kBetween);
        const Flags through =
            (cosine <= TangentFrame::kSharp) & (choose(lessI, farI, farJ) <= TangentFrame::kBeyond);
        const Flags between = crease & (~beyond | through) & (farJ + farI <= TangentFrame::kFar);
        const V fromJ = choose(beyond & ~lessI, zero, sj), fromI = choose(beyond & lessI, zero, si);
        const Vectors over = ti * (fromJ - fromI) + e * dot(chord, e);
        return {choose(between, over.x, arc.x), choose(between, over.y, arc.y),
                choose(between, over.z, arc.z)};
    }

    /// By jet::Pair, for every two corners.
    IGEO_INLINE Fronts frontsOfPairs(bool faceted) const {
        std::array<Neighbor, JetCorners::kMax> all;
        Fronts fronts{~Flags{}, ~Flags{}};
        for (std::size_t i = 0; i < most_; ++i) {
            all[i] = flattened(corners_.corner[i], faceted);
            for (std::size_t j = 0; j < i; ++j) add(all[i], all[j], fronts);
        }
        return fronts;
    }
    IGEO_INLINE static void add(const Neighbor& i, const Neighbor& j, Fronts& fronts) {
        using jet::Pair;
        const Vectors apart = i.a - j.a, turned = j.g - i.g;
        const V cosine = dot(i.g, j.g), bend2 = dot(turned, turned),
                along = dot(turned, apart),  // the radius, times bend2
            miss = absolute(j.u - i.u - dot(i.g + j.g, apart) / (1 + cosine));
        const Flags same = cosine >= jet::kSameFront, narrows = same & (miss <= Pair::kAgree),
                    spreads =
                        same & ((bend2 <= jet::kAlike2) | (along >= Pair::kLeastRadius * bend2)),
                    focus = (bend2 > Pair::kFocusBend2) & (along < 0) & narrows,
                    absent = ~(i.there & j.there);
        fronts.spreads &= spreads | absent;
        fronts.one &= ((spreads | narrows) & ~focus) | absent;
    }

    const JetCorners& corners_;
    std::size_t first_;
    Vectors normal_;
    std::size_t most_ = 0;  ///< corners of a point
};

void carryByFour(const JetCorners& corners, bool faceted, CarriedJets& jets) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        LaneNodes<4>(corners, first).carry(faceted, jets);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void carryByEight(const JetCorners& corners, bool faceted, CarriedJets& jets) {
    LaneNodes<8>(corners, 0).carry(faceted, jets);
}
#endif

}  // namespace

void carryFromCorners(const JetCorners& corners, bool faceted, CarriedJets& jets) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return carryByEight(corners, faceted, jets);
#endif
    carryByFour(corners, faceted, jets);
}

}  // namespace igeo
