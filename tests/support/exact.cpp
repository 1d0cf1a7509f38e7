#include "exact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A rigid motion x -> rotation x + shift.
struct Motion {
    std::array<Vec3d, 3> columns{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
    Vec3d shift{0, 0, 0};

    Vec3d turn(const Vec3d& x) const {
        return x[0] * columns[0] + x[1] * columns[1] + x[2] * columns[2];
    }
    Vec3d operator()(const Vec3d& x) const { return turn(x) + shift; }
};

/// Unfolds a box centered at the origin; a face is its axis and side, normal = sign e_axis.
class BoxUnfolding {
public:
    struct Face {
        int axis;
        int sign;
        Vec3d normal() const {
            Vec3d n(0.0);
            n[axis] = sign;
            return n;
        }
        int number() const { return 2 * axis + (sign > 0 ? 1 : 0); }
    };

    BoxUnfolding(const Vec3d& halfSize, const Vec3d& p, const Vec3d& q)
        : halfSize_(halfSize), p_(p), q_(q), start_(faceOf(p)), end_(faceOf(q)) {}

    double shortest() {
        visit(start_, Motion());
        return best_;
    }

private:
    struct Edge {
        Vec3d a, b;
    };

    Face faceOf(const Vec3d& p) const {
        Face face{0, 1};
        double nearest = kInfinity;
        for (int axis = 0; axis < 3; ++axis) {
            const double gap = std::abs(std::abs(p[axis]) - halfSize_[axis]);
            if (gap < nearest) {
                nearest = gap;
                face = {axis, p[axis] < 0 ? -1 : 1};
            }
        }
        return face;
    }

    /// `unfold` carries `face` into the plane of the first face.
    void visit(const Face& face, const Motion& unfold) {
        if (face.number() == end_.number()) {
            tryStraight(unfold(q_));
            return;
        }
        visited_[face.number()] = true;
        for (int axis = 0; axis < 3; ++axis) {
            for (int sign : {-1, 1}) {
                const Face next{axis, sign};
                if (axis == face.axis || visited_[next.number()]) continue;
                const Edge edge = edgeBetween(face, next);
                edges_.push_back({unfold(edge.a), unfold(edge.b)});
                visit(next, rollOver(face, next, unfold));
                edges_.pop_back();
            }
        }
        visited_[face.number()] = false;
    }

    Edge edgeBetween(const Face& f, const Face& g) const {
        Vec3d middle(0.0), half(0.0);
        middle[f.axis] = f.sign * halfSize_[f.axis];
        middle[g.axis] = g.sign * halfSize_[g.axis];
        const int along = 3 - f.axis - g.axis;
        half[along] = halfSize_[along];
        return {middle - half, middle + half};
    }

    /// `unfold` after the quarter turn about the common edge that lays `next` into f's plane.
    Motion rollOver(const Face& f, const Face& next, const Motion& unfold) const {
        const Vec3d nf = f.normal(), ng = next.normal();
        Motion turned;
        for (int i = 0; i < 3; ++i) {
            Vec3d e(0.0);
            e[i] = 1;
            const double alongF = e.dot(nf), alongG = e.dot(ng);
            turned.columns[i] =
                unfold.turn(e - alongF * nf - alongG * ng + alongG * nf - alongF * ng);
        }
        const Vec3d onEdge = edgeBetween(f, next).a;
        turned.shift = unfold(onEdge) - turned.turn(onEdge);
        return turned;
    }

    /// Accepts the segment p -> q if it crosses the unfolded edges in their order: the faces are
    /// convex, so it then stays inside them.
    void tryStraight(const Vec3d& q) {
        const Vec3d direction = q - p_;
        const double length = direction.length();
        if (length >= best_) return;
        const double slack = 1e-12 * halfSize_.length();
        double previous = -slack;
        for (const Edge& edge : edges_) {
            const Vec3d normal = start_.normal();
            const double a = direction.cross(edge.a - p_).dot(normal);
            const double b = direction.cross(edge.b - p_).dot(normal);
            if (a * b > slack * slack) return;  // both ends on one side
            if (a == b) continue;               // the segment runs along the edge
            const Vec3d crossing = edge.a + a / (a - b) * (edge.b - edge.a);
            const double at = length > 0 ? (crossing - p_).dot(direction) / length : 0.0;
            if (at < previous - slack || at > length + slack) return;
            previous = at;
        }
        best_ = length;
    }

    Vec3d halfSize_, p_, q_;
    Face start_, end_;
    std::array<bool, 6> visited_{};
    std::vector<Edge> edges_;
    double best_ = kInfinity;
};

/// Length along the outline of a rounded rectangle from (half.x, 0) to (x, y), counterclockwise.
double alongOutline(const Vec3d& half, double radius, double x, double y) {
    const double cx = half.x() - radius, cy = half.y() - radius, corner = radius * M_PI / 2;
    const double quarter = cx + corner + cy, dx = std::abs(x) - cx, dy = std::abs(y) - cy;
    const double inQuarter = dy <= 0 && dx > 0 ? std::abs(y)
                             : dx <= 0         ? cy + corner - dx
                                               : cy + radius * std::atan2(dy, dx);
    if (x < 0) return y < 0 ? 2 * quarter + inQuarter : 2 * quarter - inQuarter;
    return y < 0 ? 4 * quarter - inQuarter : inQuarter;
}

}  // namespace

double geodesicOnSphere(const Vec3d& center, double radius, const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - center, b = q - center;
    return radius * std::atan2(a.cross(b).length(), a.dot(b));
}

double geodesicOnCylinder(const Vec3d& center, double radius, const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - center, b = q - center;
    const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
    return std::hypot(radius * angle, b.z() - a.z());
}

double geodesicOnConeSide(const Vec3d& center, double wide, double narrow, double halfHeight,
                          const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - center, b = q - center;
    const double slant = std::hypot(wide - narrow, 2 * halfHeight);
    const double sine = (wide - narrow) / slant, cosine = 2 * halfHeight / slant;
    const double apex = halfHeight + narrow * cosine / sine;
    const auto fromApex = [&](const Vec3d& x) {
        return sine * std::hypot(x.x(), x.y()) + cosine * (apex - x.z());
    };
    const double sa = fromApex(a), sb = fromApex(b), top = narrow / sine, base = wide / sine;
    const double angle =
        sine * std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
    const double straight = std::hypot(sb * std::cos(angle) - sa, sb * std::sin(angle));
    return straight < std::min(sa + sb - 2 * top, 2 * base - sa - sb) ? straight : std::nan("");
}

double geodesicAroundRoundedBox(const Vec3d& center, const Vec3d& halfSize, double radius,
                                const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - center, b = q - center;
    const double belt = halfSize.z() - radius;
    if (std::max(std::abs(a.z()), std::abs(b.z())) > belt) return std::nan("");
    const double around = 4 * (halfSize.x() + halfSize.y() - 2 * radius) + 2 * M_PI * radius;
    const double arc = std::abs(alongOutline(halfSize, radius, a.x(), a.y()) -
                                alongOutline(halfSize, radius, b.x(), b.y()));
    const double straight = std::hypot(std::min(arc, around - arc), b.z() - a.z());
    return straight < 2 * belt - std::abs(a.z() + b.z()) ? straight : std::nan("");
}

double geodesicOnBox(const Vec3d& center, const Vec3d& halfSize, const Vec3d& p, const Vec3d& q) {
    return BoxUnfolding(halfSize, p - center, q - center).shortest();
}

}  // namespace igeo::test
