#include <igeo/march/detail/circular_front.h>

#include <igeo/march/detail/jet_blend.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace igeo {

namespace {

constexpr std::size_t kMost = 64;  ///< neighbors
/// Residuals of fits, voxels: where all neighbors agree, and the largest.
constexpr double kClean = 0.004, kBad = 0.02;

float cross(Vec2f a, Vec2f b) { return a.x * b.y - a.y * b.x; }

/// A circular front: its jet and its curvature at a point x of the chart.
struct CircularFront {
    struct Jet {
        double u, gx, gy;
        double along, across;  ///< from x
        double ahead;          ///< 1 + k along: negative beyond the focus
        double root;           ///< r, the distance to the focus, divided by that at x

        /// Whether this front arrives first: not beyond the focus, except close to it.
        bool reaches() const { return ahead > -0.7 * root || root < 0.05; }
    };

    double x, y, u, gx, gy, bend;

    Jet at(double toX, double toY) const {
        const double ax = toX - x, ay = toY - y;
        Jet jet;
        jet.along = gx * ax + gy * ay, jet.across = gx * ay - gy * ax;
        jet.ahead = 1 + bend * jet.along;
        jet.root = std::max(
            1e-9, std::sqrt(jet.ahead * jet.ahead + bend * bend * jet.across * jet.across));
        jet.u = u + (2 * jet.along + bend * (ax * ax + ay * ay)) / (1 + jet.root);
        jet.gx = (gx + bend * ax) / jet.root, jet.gy = (gy + bend * ay) / jet.root;
        return jet;
    }
    void turn(double angle) {
        const double c = std::cos(angle), s = std::sin(angle), old = gx;
        gx = c * gx - s * gy, gy = s * old + c * gy;
    }
};

/// The normal equations of a least-squares step in value, direction and curvature.
struct NormalEquations {
    std::array<std::array<double, 4>, 3> row{};  ///< the right-hand side last

    void add(const std::array<double, 3>& slope, double residual, double weight) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) row[i][j] += weight * slope[i] * slope[j];
            row[i][3] += weight * slope[i] * residual;
        }
    }
    std::array<double, 3> solve() {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i + 1; j < 3; ++j) {
                const double part = row[j][i] / row[i][i];
                for (std::size_t k = i; k < 4; ++k) row[j][k] -= part * row[i][k];
            }
        std::array<double, 3> x{};
        for (std::size_t i = 3; i-- > 0;) {
            x[i] = row[i][3];
            for (std::size_t k = i + 1; k < 3; ++k) x[i] -= row[i][k] * x[k];
            x[i] /= row[i][i];
        }
        return x;
    }
};

/// One step of a fit.
struct Step {
    double residual = kInfinity;    ///< root mean square before it
    double ofAgreeing = kInfinity;  ///< that of the neighbors that are no outliers
    std::size_t agree = 0;          ///< neighbors that are no outliers
    bool small = false;             ///< it changes hardly anything
};
Step improve(CircularFront& front, std::span<const JetNeighbor> neighbors) {
    constexpr double kLever = 0.1;     // voxels: weight of an error of a radian
    constexpr double kOutlier = 0.02;  // voxels: larger residuals get smaller weights
    constexpr double kLeastRoot = 0.05, kNear2 = 0.3, kStiff = 1e-4, kSmall = 1e-5;
    NormalEquations equations;
    Step step;
    double total = 0, squares = 0, inside = 0, squaresInside = 0;
    for (const JetNeighbor& n : neighbors) {
        const CircularFront::Jet jet = front.at(-double(n.a.x), -double(n.a.y));
        if (!(jet.root > kLeastRoot)) continue;
        // The angle, as twice the tangent of its half.
        const double byValue = n.u - jet.u,
                     byAngle = 2 * (jet.gx * double(n.g.y) - jet.gy * double(n.g.x)) /
                               std::max(0.1, 1 + jet.gx * double(n.g.x) + jet.gy * double(n.g.y)),
                     square = byValue * byValue + kLever * kLever * byAngle * byAngle,
                     w = 1 /
                         ((double(dot(n.a, n.a)) + kNear2) * (1 + square / (kOutlier * kOutlier)));
        const double r = jet.root, r2 = r * r, l = jet.across;
        equations.add({1, l / r, l * l / (r * (r + jet.ahead))}, byValue, w);
        equations.add({0, jet.ahead / r2, l / r2}, byAngle, w * kLever * kLever);
        total += w, squares += w * square;
        if (square < kOutlier * kOutlier) inside += w, squaresInside += w * square, ++step.agree;
    }
    if (!(total > 0)) return step;
    equations.row[2][2] += kStiff * total;
    const auto [u, angle, bend] = equations.solve();
    front.u += u, front.bend += bend;
    front.turn(angle);
    step.residual = std::sqrt(squares / total);
    if (step.agree) step.ofAgreeing = std::sqrt(squaresInside / inside);
    step.small = std::max({std::abs(u), std::abs(angle), std::abs(bend)}) < kSmall;
    return step;
}

/// A neighbor whose front reaches the origin.
struct Carried {
    JetNeighbor from;
    float bend;  ///< curvature of the front there
    double u;    ///< value at the origin; g is the direction there
    Vec2f g;

    CircularFront front() const {
        const double len = std::hypot(double(from.g.x), double(from.g.y));
        return {-double(from.a.x),      -double(from.a.y),      from.u,
                double(from.g.x) / len, double(from.g.y) / len, double(bend)};
    }
};

/// The curvature of the front at a neighbor, from the directions at others. At a distance s ahead
/// and l to the side the direction differs by the angle t, tan t (1 + k s) = k l.
float curvatureAt(const JetNeighbor& n, std::span<const JetNeighbor> neighbors) {
    constexpr float kAgree = 0.02f;  // voxels: larger differences mean two fronts
    constexpr float kReach2 = 3;
    float top = 0, bottom = 0;
    for (const JetNeighbor& other : neighbors) {
        const Vec2f step = n.a - other.a;
        const float same = dot(n.g, other.g);
        if (dot(step, step) > kReach2 || same < jet::kSameFront ||
            std::abs(float(other.u - n.u) - dot(n.g + other.g, step) / (1 + same)) > kAgree)
            continue;
        const float tangent = cross(n.g, other.g) / same,
                    side = cross(n.g, step) - dot(n.g, step) * tangent;
        top += tangent * side, bottom += side * side;
    }
    return bottom > 0 ? top / bottom : 0;
}

std::optional<Carried> carry(const JetNeighbor& n, std::span<const JetNeighbor> neighbors) {
    if (!(dot(n.a, n.g) > 0)) return {};  // no direction, as at seeds
    Carried c{n, curvatureAt(n, neighbors), 0, {}};
    const CircularFront::Jet jet = c.front().at(0, 0);
    if (!jet.reaches()) return {};
    c.u = jet.u, c.g = {float(jet.gx), float(jet.gy)};
    return c;
}

/// Whether two neighbors belong to a front that spreads (jet_blend.h).
bool spreads(const JetNeighbor& a, const JetNeighbor& b) {
    JetNeighbors pair;
    pair.add(a), pair.add(b);
    return jet::spreads(pair);
}

/// A fit and its residual.
struct Fit {
    Jet jet;
    double residual = kInfinity;  ///< root mean square, voxels; +inf for no fit
    bool clean = false;           ///< all neighbors agree well
    std::uint64_t members = 0;    ///< bits: neighbors that it was fitted to
};

/// The neighbors whose fronts reach the origin.
class Neighborhood {
public:
    explicit Neighborhood(std::span<const JetNeighbor> neighbors) {
        for (const JetNeighbor& n : neighbors.first(std::min(neighbors.size(), kMost)))
            if (const auto c = carry(n, neighbors)) {
                carried_[count_++] = *c;
                longest_ = std::min(longest_, n.u + double(length(n.a)));
                least_ = std::min(least_, byLine(*c));
            }
    }
    /// The neighbors that give the least value, one by circles and one by straight lines: where two
    /// fronts meet at a small angle, circles through both are misleading.
    std::vector<std::size_t> leads() const {
        if (count_ == 0) return {};
        std::size_t onCircle = 0, onLine = 0;
        for (std::size_t k = 1; k < count_; ++k) {
            if (carried_[k].u < carried_[onCircle].u) onCircle = k;
            if (byLine(carried_[k]) < byLine(carried_[onLine])) onLine = k;
        }
        if (onCircle == onLine) return {onCircle};
        return {onCircle, onLine};
    }
    /// Fits the front of a neighbor: of all neighbors with directions within 45 degrees of its own,
    /// or within 16; or, if these belong to two fronts that meet at a small angle, of those that
    /// spread with it.
    Fit fitFrontOf(std::size_t lead) const {
        constexpr float kTight = 0.96f;
        const Carried& own = carried_[lead];
        auto within = [&](float cosine) {
            return fit(lead, -kInfinity,
                       [&](const Carried& c) { return dot(c.g, own.g) >= cosine; });
        };
        const Fit first = within(jet::kSameFront);
        if (first.clean) return first;
        const Fit second = within(kTight);
        if (second.clean) return second;
        const Fit narrow =
            fit(lead, 0, [&](const Carried& c) { return spreads(c.from, own.from); });
        if (narrow.clean) return narrow;
        for (const Fit* f : {&first, &second})
            if (allows(*f)) return *f;
        return narrow;
    }

    /// Whether neighbors agree with a fit, and its value is within its bounds.
    bool allows(const Fit& fit) const {
        constexpr double kFocus = 0.03, kSlack = 0.02;  // voxels
        return fit.residual < kBad && fit.jet.u < longest_ + kSlack && fit.jet.u > least_ - kFocus;
    }

private:
    static double byLine(const Carried& c) { return c.from.u + double(dot(c.from.g, c.from.a)); }
    template <typename IsMember>
    Fit fit(std::size_t lead, double leastBend, const IsMember& isMember) const {
        constexpr int kSteps = 4;
        constexpr std::size_t kLeast = 3, kAgreeing = 4;  // neighbors
        Fit fit;
        std::array<JetNeighbor, kMost> members;
        std::size_t size = 0, back = lead;  // the member of least value, farthest from a focus
        for (std::size_t k = 0; k < count_; ++k) {
            if (!isMember(carried_[k])) continue;
            members[size++] = carried_[k].from;
            fit.members |= std::uint64_t(1) << k;
            if (carried_[k].from.u < carried_[back].from.u) back = k;
        }
        if (size < kLeast) return {};
        CircularFront front = carried_[back].front();
        Step step;
        for (int k = 0; k < kSteps && !step.small; ++k) {
            front.bend = std::max(front.bend, leastBend);
            step = improve(front, {members.data(), size});
        }
        // Outliers are nodes whose own values suffered from the other front.
        const bool most = step.agree >= kAgreeing && 2 * step.agree >= size;
        fit.residual = most ? step.ofAgreeing : step.residual;
        fit.clean = step.agree == size && fit.residual < kClean;
        front.bend = std::max(front.bend, leastBend);
        const CircularFront::Jet jet = front.at(0, 0);
        if (!jet.reaches()) return {};
        fit.jet = {jet.u, {float(jet.gx), float(jet.gy)}, false};
        return fit;
    }

    std::array<Carried, kMost> carried_;
    std::size_t count_ = 0;
    double longest_ = kInfinity;  ///< upper bound: the straight lines from the neighbors
    double least_ = kInfinity;    ///< lower bound: the plane fronts of all neighbors
};

}  // namespace

std::optional<Jet> fitCircularFront(std::span<const JetNeighbor> neighbors) {
    const Neighborhood all(neighbors);
    Fit best;
    for (const std::size_t lead : all.leads()) {
        if (best.members >> lead & 1) continue;
        const Fit fit = all.fitFrontOf(lead);
        if (all.allows(fit) && fit.jet.u < best.jet.u) best = fit;
    }
    if (!(best.jet.u < kInfinity)) return {};
    return best.jet;
}

}  // namespace igeo
