/// The surface around a foot point, laid out flat in its tangent plane.
#pragma once

#include <igeo/jet_update.h>
#include <igeo/types.h>

namespace igeo {

/// The tangent plane of a foot point, and what its neighbours look like in it.
class TangentFrame {
public:
    explicit TangentFrame(const Vec3f& normal) : n_(normal) {
        // The coordinate axis furthest from n keeps the cross product long.
        const Vec3f m{std::abs(n_.x), std::abs(n_.y), std::abs(n_.z)};
        const Vec3f axis = m.x <= m.y && m.x <= m.z ? Vec3f{1, 0, 0}
                           : m.y <= m.z             ? Vec3f{0, 1, 0}
                                                    : Vec3f{0, 0, 1};
        t1_ = normalized(cross(n_, axis));
        t2_ = cross(n_, t1_);
    }
    const Vec3f& normal() const { return n_; }
    Vec2f flat(const Vec3f& v) const { return {igeo::dot(v, t1_), igeo::dot(v, t2_)}; }
    Vec3f lift(Vec2f v) const { return v.x * t1_ + v.y * t2_; }

    /// A node with foot point `chord` back from this one, normal `nj` (cosine = n . nj), gradient
    /// and value, as the local solve sees it.
    JetNeighbour neighbour(const Vec3f& chord, const Vec3f& nj, float cosine, const Vec3f& gradient,
                           double value) const {
        // The gradient turned along with the plane: the least rotation that takes nj to n.
        const Vec2f g = flat(gradient) - (igeo::dot(gradient, n_) / (1 + cosine)) * flat(nj);
        return {way(chord, nj, cosine), g, value};
    }

    /// The way along S from a foot point with normal `nj` to this one, `chord` away: the chord
    /// turned into the plane and lengthened to the arc; over a crease, the way across both planes.
    Vec2f way(const Vec3f& chord, const Vec3f& nj, float cosine) const {
        Vec2f across;
        if (cosine < kCrease && wayOverCrease(chord, nj, across)) return across;
        const Vec2f in = flat(chord);
        const float in2 = dot(in, in), rise = igeo::dot(n_, chord);
        // Foot points of one voxel column coincide; a chord along n otherwise leads nowhere on S.
        if (!(in2 > 1e-12f)) return in;
        // chord / |in| = sqrt(1 + x), x = rise^2 / in^2; with the normal curvature k along the
        // chord c, arc = c (1 + (k c)^2 / 24 + 3 (k c)^4 / 640), (k c)^2 = ((n - nj) . c)^2 / c^2.
        const float x = rise * rise / in2, c2 = in2 + rise * rise;
        const float bend = rise - igeo::dot(nj, chord), kc2 = bend * bend / c2;
        const float stretch = x < 0.02f ? 1 + x * (0.5f - 0.125f * x) : std::sqrt(1 + x);
        return (stretch * (1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640)))) * in;
    }

private:
    static constexpr float kCrease = 0.8f;  ///< 37 degrees from voxel to voxel

    bool wayOverCrease(const Vec3f& chord, const Vec3f& nj, Vec2f& way) const {
        const Vec3f e = normalized(cross(n_, nj));
        const Vec3f ti = cross(n_, e), tj = cross(nj, e);
        // From each foot point to the line in which the planes meet.
        const float sj = igeo::dot(n_, chord) / igeo::dot(n_, tj);
        const float si = -igeo::dot(nj, chord) / igeo::dot(nj, ti);
        // The crease must lie between the two, else the foot points do not belong to two faces.
        if (!(sj * si <= 0.05f) || std::abs(sj) + std::abs(si) > 8) return false;
        way = flat((sj - si) * ti + igeo::dot(chord, e) * e);
        return true;
    }

    Vec3f n_, t1_, t2_;
};

}  // namespace igeo
