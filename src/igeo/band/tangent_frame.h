/// The chart of a foot point: the surface around it laid flat in its tangent plane, and metrics in
/// that plane.
#pragma once

#include <igeo/base/symmetric_eigen.h>
#include <igeo/base/types.h>

namespace igeo {

/// The tangent plane of a foot point, and the positions of its neighbors in it.
class TangentFrame {
public:
    /// @param faceted as Band::faceted
    explicit TangentFrame(const Vec3f& normal, bool faceted = false)
        : n_(normal), crease_(creaseCosine(faceted)) {
        t1_ = anyNormalTo(n_);
        t2_ = cross(n_, t1_);
    }
    const Vec3f& normal() const { return n_; }
    const Vec3f& axis(int k) const { return k == 0 ? t1_ : t2_; }
    Vec2f flat(const Vec3f& v) const { return {igeo::dot(v, t1_), igeo::dot(v, t2_)}; }
    Vec3f lift(Vec2f v) const { return v.x * t1_ + v.y * t2_; }

    /// The geodesic from a foot point with normal `nj` to this one, `chord` away, as a vector of
    /// the plane: the chord turned into the plane and lengthened to the arc of the circle through
    /// both normals; over a crease, the straight line over both planes, unfolded (docs/method.md,
    /// "1. Chart").
    /// @param cosine  n . nj
    Vec2f unfold(const Vec3f& chord, const Vec3f& nj, float cosine) const {
        Vec2f over;
        if (cosine < crease_ && unfoldOverCrease(chord, nj, cosine, over)) return over;
        const Vec2f in = flat(chord);
        const float in2 = dot(in, in), rise = igeo::dot(n_, chord);
        // Foot points of one voxel column coincide. Any other chord along n leads to no point of S.
        if (!(in2 > 1e-12f)) return in;
        // chord / |in| = sqrt(1 + x), x = rise^2 / in^2; with the normal curvature k along the
        // chord c, arc = c (1 + (k c)^2 / 24 + 3 (k c)^4 / 640), (k c)^2 = ((n - nj) . c)^2 / c^2.
        const float x = rise * rise / in2, c2 = in2 + rise * rise;
        const float bend = rise - igeo::dot(nj, chord), kc2 = bend * bend / c2;
        const float stretch = x < 0.02f ? 1 + x * (0.5f - 0.125f * x) : std::sqrt(1 + x);
        return (stretch * (1 + kc2 * (1.0f / 24 + kc2 * (3.0f / 640)))) * in;
    }

    /// Cosine of normals below which the geodesic goes over a crease: 37 degrees from voxel to
    /// voxel; on facets 0.8 degrees, as smaller angles are rounding.
    static constexpr float creaseCosine(bool faceted) { return faceted ? 0.9999f : 0.8f; }
    /// The crease lies between two foot points where the product of their signed distances to it
    /// is below kBetween, and the sum of these is below kFar. Beside sharp edges, where the cosine
    /// is at most kSharp, a normal may turn a little too far: a crease that lies beyond a foot
    /// point by up to kBeyond runs through it.
    static constexpr float kBetween = 0.05f, kFar = 8, kSharp = 0.5f, kBeyond = 0.2f;

private:
    bool unfoldOverCrease(const Vec3f& chord, const Vec3f& nj, float cosine, Vec2f& over) const {
        const Vec3f e = normalized(cross(n_, nj));
        const Vec3f ti = cross(n_, e), tj = cross(nj, e);
        // From each foot point to the line where the planes meet.
        float sj = igeo::dot(n_, chord) / igeo::dot(n_, tj);
        float si = -igeo::dot(nj, chord) / igeo::dot(nj, ti);
        // The crease must lie between the two, else the foot points do not belong to two faces.
        if (!(std::abs(sj) + std::abs(si) <= kFar)) return false;
        if (sj * si > kBetween) {
            float& least = std::abs(si) < std::abs(sj) ? si : sj;
            if (std::abs(least) > kBeyond || cosine > kSharp) return false;
            least = 0;
        }
        over = flat((sj - si) * ti + igeo::dot(chord, e) * e);
        return true;
    }

    Vec3f n_, t1_, t2_;
    float crease_;
};

/// The mean cost along a chord, relative to the metric `to` at its end, with `from` at the other
/// end: trapezoid rule.
inline float meanWeight(float from, float to) { return from == to ? 1 : (1 + from / to) / 2; }

/// A linear map B of a tangent plane, det B = 1, after which its metric is a multiple of the
/// Euclidean one: vectors become B a, covectors B^-T p. Upper triangular, the Cholesky factor.
class Stretch {
public:
    Stretch() = default;
    /// @param xx, xy  of the metric, which has determinant 1
    Stretch(double xx, double xy) : a_(float(std::sqrt(xx))), b_(float(xy / std::sqrt(xx))) {}

    Vec2f vector(Vec2f v) const { return {a_ * v.x + b_ * v.y, v.y / a_}; }
    Vec2f covector(Vec2f p) const {
        const float x = p.x / a_;
        return {x, a_ * (p.y - b_ * x)};
    }
    /// The inverses of the two.
    Vec2f vectorBack(Vec2f v) const {
        const float y = a_ * v.y;
        return {(v.x - b_ * y) / a_, y};
    }
    Vec2f covectorBack(Vec2f q) const { return {a_ * q.x, b_ * q.x + q.y / a_}; }

    /// The largest of |B a| / |a|; the least is its reciprocal.
    float largest() const {
        // The squares of |B a| / |a| are the eigenvalues of B^T B: this one and its reciprocal.
        const float d = a_ - 1 / a_, excess = (d * d + b_ * b_) / 2;
        return std::sqrt(largestEigenvalueOfUnitDeterminant(excess));
    }

private:
    float a_ = 1, b_ = 0;
};

/// A metric on a tangent plane, G = weight^2 B^T B.
struct PlaneMetric {
    double weight = 1;  ///< geometric mean of the costs per unit length along the principal axes
    Stretch stretch;

    PlaneMetric() = default;
    /// @param xx, xy, yy  G in the coordinates of a TangentFrame, positive definite
    PlaneMetric(double xx, double xy, double yy) {
        const double det = std::sqrt(xx * yy - xy * xy);
        weight = std::sqrt(det);
        stretch = {xx / det, xy / det};
    }
    /// Cost of a vector in the plane.
    double cost(Vec2f v) const { return weight * double(length(stretch.vector(v))); }
    double least() const { return weight / double(stretch.largest()); }
    double largest() const { return weight * double(stretch.largest()); }
};

}  // namespace igeo
