/// The fallback of scheme `jet`, by Fermat's principle: the minimum, over the neighbors and the
/// segments between them, of the value there plus the length of the straight line from there to the
/// node. It is the update of the jet marching method of S. F. Potter and M. K. Cameron, Jet
/// marching methods for solving the eikonal equation, SIAM J. Sci. Comput. 43 (2021).
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo {

namespace jet {

/// Two neighbors.
struct NeighborPair {
    std::uint8_t p, q;
};

/// The costs across four segments, each from a neighbor p to a neighbor q, in vector lanes and
/// relative to base(): total(s) = H(s) + |a_p - s e|, 0 <= s <= 1, with e the segment and H the
/// cubic Hermite interpolant of the jets at its ends.
class Segments {
public:
    Segments(const JetNeighbors& all, const NeighborPair* pairs) {
        auto four = [&](const auto& of) {
            return Four{of(pairs[0]), of(pairs[1]), of(pairs[2]), of(pairs[3])};
        };
        apx_ = four([&](NeighborPair n) { return all.a(n.p).x; });
        apy_ = four([&](NeighborPair n) { return all.a(n.p).y; });
        // Both neighbors are at -a.
        ex_ = apx_ - four([&](NeighborPair n) { return all.a(n.q).x; });
        ey_ = apy_ - four([&](NeighborPair n) { return all.a(n.q).y; });
        up_ = four([&](NeighborPair n) { return all.u(n.p); });
        du_ = four([&](NeighborPair n) { return all.u(n.q); }) - up_;
        mp_ = four([&](NeighborPair n) { return all.g(n.p).x; }) * ex_ +
              four([&](NeighborPair n) { return all.g(n.p).y; }) * ey_;
        mq_ = four([&](NeighborPair n) { return all.g(n.q).x; }) * ex_ +
              four([&](NeighborPair n) { return all.g(n.q).y; }) * ey_;
    }
    /// Lower bounds of total: the cubic falls below its ends by at most 4/27 of the slopes there.
    Four bound() const {
        const Four zero{},
            one = zero + 1, square = ex_ * ex_ + ey_ * ey_,
            foot = (apx_ * ex_ + apy_ * ey_) / (square > 1e-12f ? square : zero + 1e-12f),
            along = foot > 1   ? one
                    : foot > 0 ? foot
                               : zero;
        const Four dip = (4.0f / 27) * ((mp_ < 0 ? -mp_ : zero) + (mq_ > 0 ? mq_ : zero));
        const Four x = apx_ - along * ex_, y = apy_ - along * ey_;
        return up_ + (du_ < 0 ? du_ : zero) - dip + roots(x * x + y * y);
    }
    /// The minima of total, by golden section: 8 steps locate them to 2 % of the segment, where
    /// total is flat.
    /// @param x, y  from the minima to the node
    Four least(Four& x, Four& y) const {
        constexpr float kGolden = 0.618034f;
        Four lo{}, hi = lo + 1, s1 = lo + (1 - kGolden), s2 = lo + kGolden, f1 = total(s1),
                   f2 = total(s2);
        for (int k = 0; k < 8; ++k) {
            const auto below = f1 < f2;
            hi = below ? s2 : hi, lo = below ? lo : s1;
            const Four part = kGolden * (hi - lo), s = below ? hi - part : lo + part, f = total(s);
            const Four keptS = below ? s1 : s2, keptF = below ? f1 : f2;
            s1 = below ? s : keptS, f1 = below ? f : keptF;
            s2 = below ? keptS : s, f2 = below ? keptF : f;
        }
        const Four at = f1 < f2 ? s1 : s2;
        x = apx_ - at * ex_, y = apy_ - at * ey_;
        return f1 < f2 ? f1 : f2;
    }

private:
    Four total(const Four& s) const {
        const Four t = 1 - s, x = apx_ - s * ex_, y = apy_ - s * ey_;
        return up_ + s * s * (3 - 2 * s) * du_ + s * t * (t * mp_ - s * mq_) + roots(x * x + y * y);
    }

    Four apx_, apy_, ex_, ey_, up_, du_, mp_, mq_;
};

/// The pairs of neighbors whose segments may have a total below a given value.
class SegmentPairs {
public:
    SegmentPairs(const JetNeighbors& all, float below) : all_(all) {
        for (int j = 1; j < all.count(); ++j)
            for (int group = 0; 4 * group < j; ++group) addShort(j, group, below);
        // Of these, those with a lower bound below it.
        const std::size_t found = count_;
        count_ = 0;
        for (std::size_t k = 0; k < found; k += 4) {
            fill(k, found);
            const Four bound = Segments(all, &pair_[k]).bound();
            for (std::size_t l = k; l < std::min(k + 4, found); ++l)
                if (bound[l - k] < below) pair_[count_++] = pair_[l];
        }
    }
    std::size_t count() const { return count_; }
    NeighborPair operator[](std::size_t k) const { return pair_[k]; }
    /// Four pairs from `first` on; the last one is repeated to fill them.
    Segments four(std::size_t first) {
        fill(first, count_);
        return {all_, &pair_[first]};
    }

private:
    /// Adds the pairs of neighbor j with earlier ones of a group that can matter: of one front,
    /// because directions of two fronts have no interpolant; short; and seen from the node at less
    /// than 120 degrees.
    void addShort(int j, int group, float below) {
        const auto n = all_.group(group);
        const Vec2f a = all_.a(j), g = all_.g(j);
        const Four ex = a.x - n.ax, ey = a.y - n.ay, cosine = g.x * n.gx + g.y * n.gy,
                   lengths = all_.len(j) * roots(n.ax * n.ax + n.ay * n.ay);
        const auto fits = (cosine >= kSameFront) & (ex * ex + ey * ey <= all_.longest2) &
                          (a.x * n.ax + a.y * n.ay >= -0.5f * lengths) &
                          ((n.u < below) | (all_.u(j) < below ? ~0 : 0));
        for (int k = 4 * group; k < std::min(4 * group + 4, j); ++k) {
            pair_[count_] = {std::uint8_t(j), std::uint8_t(k)};
            count_ += fits[k - 4 * group] ? 1 : 0;
        }
    }
    void fill(std::size_t first, std::size_t end) {
        for (std::size_t k = end; k < first + 4; ++k) pair_[k] = pair_[end - 1];
    }

    const JetNeighbors& all_;
    std::size_t count_ = 0;
    std::array<NeighborPair, JetNeighbors::kMax*(JetNeighbors::kMax - 1) / 2 + 4> pair_;
};

}  // namespace jet

/// The fallback: the minimum of u_j + |a_j| over the neighbors, and over the segments between them.
/// Never below the values it starts from; at least first order, second where the front is smooth.
/// @return u = +infinity without neighbors
inline Jet fermatUpdate(const JetNeighbors& all) {
    float best = float(kInfinity);
    Vec2f direction;
    int from = -1;  // the neighbor, or an end of the segment
    for (int k = 0; k < all.count(); ++k)
        if (const float u = all.u(k) + all.len(k); u < best)
            best = u, direction = all.a(k), from = k;
    jet::SegmentPairs pairs(all, best);
    for (std::size_t k = 0; k < pairs.count(); k += 4) {
        jet::Four x, y;
        const jet::Four least = pairs.four(k).least(x, y);
        for (std::size_t l = 0; l < 4 && k + l < pairs.count(); ++l)
            if (least[l] < best) best = least[l], direction = {x[l], y[l]}, from = pairs[k + l].p;
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
