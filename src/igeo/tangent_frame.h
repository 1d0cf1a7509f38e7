/// The surface around a foot point, laid out flat in its tangent plane.
#pragma once

#include <igeo/jet_update.h>
#include <igeo/types.h>

namespace igeo {

/// The tangent plane of a node, and what its neighbours look like in it.
class TangentFrame {
public:
    explicit TangentFrame(const Vec3d& normal) : n_(normal) {
        // The coordinate axis furthest from n keeps the cross product long.
        const Vec3d m{std::abs(n_.x), std::abs(n_.y), std::abs(n_.z)};
        const Vec3d axis = m.x <= m.y && m.x <= m.z ? Vec3d{1, 0, 0}
                           : m.y <= m.z             ? Vec3d{0, 1, 0}
                                                    : Vec3d{0, 0, 1};
        t1_ = normalized(igeo::cross(n_, axis));
        t2_ = igeo::cross(n_, t1_);
    }
    Vec2d flat(const Vec3d& v) const { return {igeo::dot(v, t1_), igeo::dot(v, t2_)}; }
    Vec3d lift(Vec2d v) const { return v.x * t1_ + v.y * t2_; }

    const Vec3d& normal() const { return n_; }

    /// A node with foot point `chord` back from this one, normal `nj` (cosine = n . nj), gradient
    /// and value, as the local solve sees it.
    JetNeighbour neighbour(const Vec3d& chord, const Vec3d& nj, double cosine,
                           const Vec3d& gradient, double value) const {
        JetNeighbour n;
        n.a = flat(way(chord, nj, cosine));
        n.len = std::max(igeo::length(n.a), 1e-9);
        n.g = flat(transport(gradient, nj, cosine));
        n.u = value;
        return n;
    }

    /// The way along S from a foot point with normal `nj` to this one, `chord` away: the chord
    /// turned into the plane and lengthened to the arc; over a crease, the way across both planes.
    Vec3d way(const Vec3d& chord, const Vec3d& nj, double cosine) const {
        if (cosine < kCrease) {
            Vec3d across;
            if (wayOverCrease(chord, nj, across)) return across;
        }
        const Vec3d in = tangential(chord, n_);
        const double inLength = igeo::length(in), c2 = igeo::dot(chord, chord);
        // Foot points of one voxel column coincide; a chord along n otherwise leads nowhere on S.
        if (!(inLength > 1e-9)) return in;
        // Normal curvature k along the chord c: arc = c (1 + (k c)^2 / 24 + 3 (k c)^4 / 640).
        const double kc2 = std::pow(igeo::dot(n_ - nj, chord), 2) / c2;
        return (std::sqrt(c2) * (1 + kc2 * (1.0 / 24 + kc2 * (3.0 / 640))) / inLength) * in;
    }

    /// A tangent vector at normal `nj` turned along with the plane (the least rotation nj -> n).
    Vec3d transport(const Vec3d& v, const Vec3d& nj, double cosine) const {
        return v - (igeo::dot(v, n_) / (1 + cosine)) * (n_ + nj);
    }

private:
    static constexpr double kCrease = 0.8;  ///< 37 degrees from voxel to voxel

    bool wayOverCrease(const Vec3d& chord, const Vec3d& nj, Vec3d& way) const {
        const Vec3d e = normalized(igeo::cross(n_, nj));
        const Vec3d ti = igeo::cross(n_, e), tj = igeo::cross(nj, e);
        // From each foot point to the line in which the planes meet.
        const double sj = igeo::dot(n_, chord) / igeo::dot(n_, tj);
        const double si = -igeo::dot(nj, chord) / igeo::dot(nj, ti);
        // The crease must lie between the two, else the foot points do not belong to two faces.
        if (!(sj * si <= 0.05) || std::abs(sj) + std::abs(si) > 8) return false;
        way = (sj - si) * ti + igeo::dot(chord, e) * e;
        return true;
    }

    Vec3d n_, t1_, t2_;
};

}  // namespace igeo
