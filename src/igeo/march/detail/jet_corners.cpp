#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_corners.h>

#include <algorithm>

namespace igeo {

void JetCorners::pad() {
    const std::uint32_t most = *std::max_element(count.begin(), count.end());
    for (std::size_t lane = 0; lane < count.size(); ++lane)
        for (std::size_t k = count[lane]; k < most; ++k) {
            Corner& c = corner[k];
            c.weight[lane] = c.x[lane] = c.y[lane] = c.z[lane] = 0;
            c.mx[lane] = c.my[lane] = c.mz[lane] = 0;
            c.gx[lane] = c.gy[lane] = c.gz[lane] = c.u[lane] = c.mean[lane] = 0;
        }
}

namespace {

using jet::Four;

/// A vector per node.
struct FourVectors {
    Four x, y, z;
    FourVectors operator+(const FourVectors& v) const { return {x + v.x, y + v.y, z + v.z}; }
    FourVectors operator-(const FourVectors& v) const { return {x - v.x, y - v.y, z - v.z}; }
    FourVectors operator*(const Four& s) const { return {s * x, s * y, s * z}; }
};
Four dot(const FourVectors& v, const FourVectors& w) { return v.x * w.x + v.y * w.y + v.z * w.z; }
FourVectors cross(const FourVectors& v, const FourVectors& w) {
    return {v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x};
}
using FourFlags = decltype(Four{} < Four{});
Four choose(const FourFlags& first, const Four& a, const Four& b) { return first ? a : b; }
Four absolute(const Four& v) { return choose(v < 0, -v, v); }

/// Four of the nodes, from `first` on.
class FourNodes {
public:
    FourNodes(const JetCorners& corners, std::size_t first) : corners_(corners), first_(first) {
        for (std::size_t k = first; k < first + 4; ++k)
            most_ = std::max(most_, std::size_t(corners.count[k]));
        normal_ = {in(corners.nx), in(corners.ny), in(corners.nz)};
    }

    void carry(bool faceted, CarriedJets& jets) const {
        const FourVectors g = meanDirection();
        Four value{}, total{}, least = Four{} + 1;
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            const Four w = in(c.weight);
            const FourVectors own = direction(c);
            const Four cosine = dot(g, own);
            least = choose((w > 0) & (cosine < least), cosine, least);
            // Directions in space, not in one plane, change the step by (k c)^2 / 12 at curvature
            // k.
            value += w * (in(c.u) + in(c.mean) * dot(g + own, chord(c)) / (1 + cosine));
            total += w;
        }
        out(jets.u) = value / total;
        out(jets.gx) = g.x, out(jets.gy) = g.y, out(jets.gz) = g.z;
        const FourFlags close = least >= jet::kClose, similar = least >= jet::kSameFront;
        Fronts fronts{close, close};
        if (any(similar & ~close)) {
            const Fronts byPairs = frontsOfPairs(faceted);
            fronts.spreads |= similar & byPairs.spreads;
            fronts.one |= similar & byPairs.one;
        }
        for (std::size_t k = 0; k < 4; ++k) {
            jets.spreads[first_ + k] = fronts.spreads[k];
            jets.oneFront[first_ + k] = fronts.one[k];
        }
    }

private:
    /// CarriedJets::spreads and CarriedJets::oneFront.
    struct Fronts {
        FourFlags spreads, one;
    };
    /// A corner in the chart of its node, as vectors of the tangent plane in space.
    struct Neighbor {
        FourFlags there;
        FourVectors a, g;
        Four u;
    };

    static bool any(const FourFlags& f) { return (f[0] | f[1] | f[2] | f[3]) != 0; }
    Four in(const Lanes& l) const { return *reinterpret_cast<const Four*>(l.of + first_); }
    Four& out(Lanes& l) const { return *reinterpret_cast<Four*>(l.of + first_); }
    FourVectors direction(const JetCorners::Corner& c) const {
        return {in(c.gx), in(c.gy), in(c.gz)};
    }
    FourVectors chord(const JetCorners::Corner& c) const { return {in(c.x), in(c.y), in(c.z)}; }

    /// Unit, in the tangent plane of each node; 0 where the corners cancel each other.
    FourVectors meanDirection() const {
        FourVectors g{};
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            g = g + direction(c) * in(c.weight);
        }
        g = g - normal_ * dot(g, normal_);
        const Four len = jet::roots(dot(g, g)), zero{};
        return g * choose(len > 0, 1 / len, zero);
    }

    /// As flattened() has it.
    Neighbor flattened(const JetCorners::Corner& c, bool faceted) const {
        const FourVectors other{in(c.mx), in(c.my), in(c.mz)}, g = direction(c);
        const Four cosine = dot(normal_, other);
        return {in(c.weight) > 0, unfold(chord(c), other, cosine, faceted) * in(c.mean),
                g - (normal_ + other) * (dot(g, normal_) / (1 + cosine)), in(c.u)};
    }
    /// As TangentFrame::unfold has it.
    FourVectors unfold(const FourVectors& chord, const FourVectors& other, const Four& cosine,
                       bool faceted) const {
        const Four rise = dot(normal_, chord);
        const FourVectors in = chord - normal_ * rise;
        const Four in2 = dot(in, in), x = rise * rise / in2, c2 = in2 + rise * rise,
                   bend = rise - dot(other, chord), kc2 = bend * bend / c2,
                   stretch = choose(x < 0.02f, 1 + x * (0.5f - 0.125f * x), jet::roots(1 + x)),
                   longer = stretch * (1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640))),
                   one = Four{} + 1;
        const FourVectors arc = in * choose(in2 > 1e-12f, longer, one);
        const FourFlags crease = cosine < TangentFrame::creaseCosine(faceted);
        if (!any(crease)) return arc;
        // The planes of both foot points, unfolded about the line where they meet.
        const FourVectors axis = cross(normal_, other),
                          e = axis * (1 / jet::roots(dot(axis, axis))), ti = cross(normal_, e),
                          tj = cross(other, e);
        const Four sj = dot(normal_, chord) / dot(normal_, tj),
                   si = -dot(other, chord) / dot(other, ti);
        const FourFlags between = crease & (sj * si <= TangentFrame::kBetween) &
                                  (absolute(sj) + absolute(si) <= TangentFrame::kFar);
        const FourVectors over = ti * (sj - si) + e * dot(chord, e);
        return {choose(between, over.x, arc.x), choose(between, over.y, arc.y),
                choose(between, over.z, arc.z)};
    }

    /// By jet::Pair, for every two corners.
    Fronts frontsOfPairs(bool faceted) const {
        std::array<Neighbor, JetCorners::kMax> all;
        Fronts fronts{~FourFlags{}, ~FourFlags{}};
        for (std::size_t i = 0; i < most_; ++i) {
            all[i] = flattened(corners_.corner[i], faceted);
            for (std::size_t j = 0; j < i; ++j) add(all[i], all[j], fronts);
        }
        return fronts;
    }
    static void add(const Neighbor& i, const Neighbor& j, Fronts& fronts) {
        using jet::Pair;
        const FourVectors apart = i.a - j.a, turned = j.g - i.g;
        const Four cosine = dot(i.g, j.g), bend2 = dot(turned, turned),
                   along = dot(turned, apart),  // the radius, times bend2
            miss = absolute(j.u - i.u - dot(i.g + j.g, apart) / (1 + cosine));
        const FourFlags same = cosine >= jet::kSameFront, narrows = same & (miss <= Pair::kAgree),
                        spreads = same &
                                  ((bend2 <= jet::kAlike2) | (along >= Pair::kLeastRadius * bend2)),
                        focus = (bend2 > Pair::kFocusBend2) & (along < 0) & narrows,
                        absent = ~(i.there & j.there);
        fronts.spreads &= spreads | absent;
        fronts.one &= ((spreads | narrows) & ~focus) | absent;
    }

    const JetCorners& corners_;
    std::size_t first_, most_ = 0;
    FourVectors normal_;
};

}  // namespace

void carryFromCorners(const JetCorners& corners, bool faceted, CarriedJets& jets) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        FourNodes(corners, first).carry(faceted, jets);
}

}  // namespace igeo
