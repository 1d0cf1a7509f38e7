#include <igeo/march/detail/jet_fit.h>

#include <igeo/base/detail/registers.h>

#include <cmath>

namespace igeo {

void JetLanes::pad(std::size_t lanes) {
    const std::uint32_t most = *std::max_element(count.begin(), count.end());
    for (std::size_t lane = 0; lane < lanes; ++lane)
        for (std::size_t k = count[lane]; k < most; ++k) {
            Neighbor& n = neighbor[k];
            n.ax[lane] = n.ay[lane] = n.gx[lane] = n.gy[lane] = 0;
            n.u[lane] = JetFronts::kNoValue;
        }
}

namespace {

/// The lanes from `first` on that fit into a register.
template <int Width>
class LaneFit {
    using V = typename Registers<Width>::Vector;
    using Mask = decltype(V{} < V{});

public:
    IGEO_INLINE LaneFit(const JetLanes& lanes, std::size_t first)
        : lanes_(lanes), first_(first), most_(0) {
        for (std::size_t k = first; k < first + Width; ++k)
            most_ = std::max(most_, std::size_t(lanes.count[k]));
    }

    IGEO_INLINE void findFronts(JetFronts& fronts) const {
        const V base = in(lanes_.base), zero{}, one = zero + 1, none = zero + JetFronts::kNoValue;
        V carried[JetLanes::kMax];
        V least = none, x{}, y{}, bound = none, straight = none;
        for (std::size_t k = 0; k < most_; ++k) {
            const auto& n = lanes_.neighbor[k];
            const V ax = in(n.ax), ay = in(n.ay), gx = in(n.gx), gy = in(n.gy), u = in(n.u);
            const V along = gx * ax + gy * ay, square = ax * ax + ay * ay;
            V len = square;
            takeRoots<Width>(len);
            // To second order |r g + a| = r + along + (|a|^2 - along^2) / (2 r), r = base + u,
            // which is enough to compare neighbors.
            const V ahead = base + u + along, r = ahead > one ? ahead : one;
            const V byCircle = u + along + (square - along * along) / (2 * r), byLine = u + len;
            carried[k] = along > zero ? byCircle : byLine;
            const Mask less = carried[k] < least;
            least = less ? carried[k] : least;
            x = less ? gx : x, y = less ? gy : y;
            bound = byLine < bound ? byLine : bound;
            const V byPlane = u + along;
            straight = byPlane < straight ? byPlane : straight;
        }
        V second = none, x2{}, y2{};
        for (std::size_t k = 0; k < most_; ++k) {
            const auto& n = lanes_.neighbor[k];
            const V gx = in(n.gx), gy = in(n.gy);
            const Mask better = (gx * x + gy * y < zero + jet::kSameFront) & (carried[k] < second);
            second = better ? carried[k] : second;
            x2 = better ? gx : x2, y2 = better ? gy : y2;
        }
        out(fronts.leadX) = x, out(fronts.leadY) = y;
        out(fronts.second) = second, out(fronts.secondX) = x2, out(fronts.secondY) = y2;
        out(fronts.bound) = bound, out(fronts.straight) = straight;
    }

    IGEO_INLINE void fit(const Lanes& startX, const Lanes& startY, JetFits& fits) {
        constexpr int kRounds = 2;
        V px, py;
        Mask ok;
        predictDirection(in(startX), in(startY), px, py);
        normalize(px, py, ok);
        V x = px, y = py;
        for (int round = 0; round < kRounds; ++round) {
            V nx, ny;
            Mask solved;
            solveDirection(x, y, px, py, nx, ny, ok);
            normalize(nx, ny, solved);
            ok &= solved & (nx * x + ny * y >= V{} + jet::kSameFront);
            x = nx, y = ny;
        }
        evaluate(x, y, ok, fits);
    }

    IGEO_INLINE void findTurns(const Lanes& directionX, const Lanes& directionY,
                               Lanes& turn) const {
        const V x = in(directionX), y = in(directionY);
        Turns turns;
        for (std::size_t k = 0; k < most_; ++k) {
            const auto& n = lanes_.neighbor[k];
            const V ax = in(n.ax), ay = in(n.ay), gx = in(n.gx), gy = in(n.gy);
            turns.add(x * ay - y * ax, x * gx + y * gy, x * gy - y * gx);
        }
        out(turn) = turns.fromLeft + turns.fromRight;
    }

private:
    /// As FrontsMeet has it.
    struct Turns {
        V fromLeft{}, fromRight{};
        IGEO_INLINE void add(const V& across, const V& cosine, const V& turn) {
            const V zero{}, one = zero + 1, whole = turn < zero ? zero - 1 : one,
                            sine = cosine > zero ? turn : whole;
            fromLeft = ((across < zero) & (-sine > fromLeft)) ? -sine : fromLeft;
            fromRight = ((across > zero) & (sine > fromRight)) ? sine : fromRight;
        }
    };

    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + first_);
    }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }

    /// @param ok  where it was not 0
    IGEO_INLINE static void normalize(V& x, V& y, Mask& ok) {
        V len = x * x + y * y;
        takeRoots<Width>(len);
        ok = len > V{};
        const V inverse = 1 / len;
        x *= inverse, y *= inverse;
    }

    /// Where the neighbors' directions, bent as circles about a source at distance u, point at the
    /// node: weighted mean of r_j g_j + a_j over the neighbors of the front. Not normalized.
    ///
    /// A front that narrows turns the other way. So where what the neighbors say differs along the
    /// front, the mean is taken to the node, with the slope of their line, less a slack.
    IGEO_INLINE void predictDirection(const V& startX, const V& startY, V& x, V& y) {
        constexpr float kSlack = 0.02f;  // 1 / voxels
        constexpr float kStiff = 0.01f;  // voxels^2: neighbors side by side show no slope
        const V base = in(lanes_.base), zero{};
        V total{}, side{}, side2{}, turned{};
        x = y = zero;
        for (std::size_t k = 0; k < most_; ++k) {
            const auto& n = lanes_.neighbor[k];
            const V ax = in(n.ax), ay = in(n.ay), gx = in(n.gx), gy = in(n.gy);
            // Foot points of one voxel column may coincide.
            const V square = ax * ax + ay * ay + 1e-12f;
            nearness_[k] = 1 / (square * (square + 0.1f));
            const V along = gx * ax + gy * ay, r = in(n.u) + base;
            const Mask ok = (startX * gx + startY * gy >= zero + jet::kSameFront) & (along > zero);
            // |r g + a| is r + along to second order in a / r; near a source a rough weight is
            // enough.
            const V weight = ok ? along * along * nearness_[k] : zero,
                    w = ok ? weight / (r + along) : zero, vx = w * (r * gx + ax),
                    vy = w * (r * gy + ay), across = startX * ay - startY * ax,
                    moment = weight * across;
            x += vx, y += vy;
            total += weight, side += moment, side2 += moment * across;
            turned += (startX * vy - startY * vx) * across;
        }
        // Positive where directions turn toward each other. Not a number without neighbors.
        const V mean = side / total, turn = startX * y - startY * x,
                slope = (turned - mean * turn) / (side2 - mean * side + kStiff * total),
                back = slope > zero + kSlack ? (slope - kSlack) * side : zero;
        x += back * startY, y -= back * startX;
    }

    /// One round of the fit: the direction that solves the normal equations with f_j and the
    /// weights taken from the direction (x, y). Not normalized: their determinant is left out, as
    /// |g| = 1 is known.
    /// @param ok  cleared where fewer than two neighbors of the front lie behind the node
    IGEO_INLINE void solveDirection(const V& x, const V& y, const V& px, const V& py, V& nx, V& ny,
                                    Mask& ok) const {
        const V zero{};
        V s0{}, sx{}, sy{}, sxx{}, sxy{}, syy{}, b0{}, bx{}, by{};
        Mask used{};
        for (std::size_t k = 0; k < most_; ++k) {
            const auto& n = lanes_.neighbor[k];
            const V ax = in(n.ax), ay = in(n.ay), gx = in(n.gx), gy = in(n.gy);
            const V cosine = x * gx + y * gy, along = x * ax + y * ay;
            const Mask counts = (cosine >= zero + jet::kSameFront) & (along > zero);
            used -= counts;
            const V w = counts ? along * along * nearness_[k] : zero;
            const V f = 1 / (1 + cosine), cx = -f * ax, cy = -f * ay;
            const V rhs = in(n.u) + f * (ax * gx + ay * gy);
            const V wx = w * cx, wy = w * cy, wr = w * rhs;
            s0 += w, sx += wx, sy += wy;
            sxx += wx * cx, sxy += wx * cy, syy += wy * cy;
            b0 += wr, bx += wr * cx, by += wr * cy;
        }
        ok &= used >= 2;
        // Eliminate u.
        const V inverse = 1 / s0, pull = lanes_.pull * s0;
        const V axx = sxx - sx * sx * inverse + pull, axy = sxy - sx * sy * inverse,
                ayy = syy - sy * sy * inverse + pull;
        const V rx = bx - sx * b0 * inverse + pull * px, ry = by - sy * b0 * inverse + pull * py;
        nx = rx * ayy - ry * axy, ny = ry * axx - rx * axy;
    }

    /// The jet of a front whose direction is known.
    IGEO_INLINE void evaluate(const V& x, const V& y, const Mask& ok, JetFits& fits) const {
        // Neighbors to the left and right of the ray; straight behind counts for both.
        constexpr float kStraight = 0.03f;
        const V zero{}, one = zero + 1;
        V total{}, value{}, square{};
        Turns turns;
        Mask left{}, right{};
        for (std::size_t k = 0; k < most_; ++k) {
            const auto& n = lanes_.neighbor[k];
            const V ax = in(n.ax), ay = in(n.ay), gx = in(n.gx), gy = in(n.gy);
            const V cosine = x * gx + y * gy, along = x * ax + y * ay;
            const Mask counts = (cosine >= zero + jet::kSameFront) & (along > zero);
            const V across = x * ay - y * ax, slack = kStraight * along;
            turns.add(across, cosine, x * gy - y * gx);
            left |= counts & (across >= -slack), right |= counts & (across <= slack);
            const V w = counts ? along * along * nearness_[k] : zero;
            const V v = in(n.u) + (along + gx * ax + gy * ay) / (1 + cosine);
            total += w, value += w * v, square += w * v * v;
        }
        const V inverse = 1 / total, u = value * inverse;
        out(fits.u) = ok ? u : zero + float(kInfinity);
        out(fits.gx) = x, out(fits.gy) = y;
        out(fits.residual2) = square * inverse - u * u;
        out(fits.oneSided) = (left & right) != 0 ? zero : one;
        out(fits.turn) = turns.fromLeft + turns.fromRight;
    }

    const JetLanes& lanes_;
    const std::size_t first_;
    std::size_t most_;
    V nearness_[JetLanes::kMax];  ///< 1 / (|a|^2 (|a|^2 + 0.1))
};

void findByFour(const JetLanes& lanes, JetFronts& fronts) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        LaneFit<4>(lanes, first).findFronts(fronts);
}
void fitByFour(const JetLanes& lanes, const Lanes& x, const Lanes& y, JetFits& fits) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        LaneFit<4>(lanes, first).fit(x, y, fits);
}
void turnsByFour(const JetLanes& lanes, const Lanes& x, const Lanes& y, Lanes& turn) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        LaneFit<4>(lanes, first).findTurns(x, y, turn);
}

#ifdef IGEO_AVX2
IGEO_AVX2 void findByEight(const JetLanes& lanes, JetFronts& fronts) {
    LaneFit<8>(lanes, 0).findFronts(fronts);
}
IGEO_AVX2 void fitByEight(const JetLanes& lanes, const Lanes& x, const Lanes& y, JetFits& fits) {
    LaneFit<8>(lanes, 0).fit(x, y, fits);
}
IGEO_AVX2 void turnsByEight(const JetLanes& lanes, const Lanes& x, const Lanes& y, Lanes& turn) {
    LaneFit<8>(lanes, 0).findTurns(x, y, turn);
}
#endif

}  // namespace

void findFronts(const JetLanes& lanes, JetFronts& fronts) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findByEight(lanes, fronts);
#endif
    findByFour(lanes, fronts);
}
void findTurns(const JetLanes& lanes, const Lanes& x, const Lanes& y, Lanes& turn) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return turnsByEight(lanes, x, y, turn);
#endif
    turnsByFour(lanes, x, y, turn);
}
JetVerdicts judge(const JetFronts& fronts, const JetFits& first) {
    constexpr float kLater = 0.2f;
    JetVerdicts verdicts{0, 0};
    for (std::size_t lane = 0; lane < Lanes::kNodes; lane += 4) {
        const auto in = [&](const Lanes& l) { return loadLanes<4>(l.of + lane); };
        const auto u = in(first.u), residual2 = in(first.residual2), later = in(fronts.second);
        const auto valid = (u <= in(fronts.bound) + jet::kSlack) &
                           ~(residual2 > jet::kResidual * jet::kResidual),
                   second = valid & (later < JetFronts::kNoValue) & (later < u + kLater);
        const auto clear = valid & ~second & (u >= in(fronts.straight) - jet::kFocus) &
                           (residual2 < jet::kDoubt * jet::kDoubt) & (in(first.oneSided) == 0) &
                           (in(first.turn) <= FrontsMeet::kTurn);
        verdicts.second |= bitsOf<4>(second) << lane;
        verdicts.clear |= bitsOf<4>(clear) << lane;
    }
    return verdicts;
}
void fitFronts(const JetLanes& lanes, const Lanes& x, const Lanes& y, JetFits& fits) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return fitByEight(lanes, x, y, fits);
#endif
    fitByFour(lanes, x, y, fits);
}

}  // namespace igeo
