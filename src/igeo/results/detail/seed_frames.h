/// The frames of a logarithmic map: transported from its seeds, parallel along geodesics. Internal
/// to the logarithmic map.
#pragma once

#include <igeo/band/tangent_frame.h>
#include <igeo/march/detail/jet_state.h>
#include <igeo/march/field.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace igeo {

inline float cross(Vec2f a, Vec2f b) { return a.x * b.y - a.y * b.x; }
inline Vec2f normalized(Vec2f v) {
    const float len = length(v);
    return len > 0 ? (1 / len) * v : v;
}
inline Vec2f turned(Vec2f v, float angle) {
    if (angle == 0) return v;
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * v.x - s * v.y, s * v.x + c * v.y};
}
inline float angleFrom(Vec2f a, Vec2f b) { return std::atan2(cross(a, b), dot(a, b)); }

/// Least squares for y = at + slope x.
struct LineFit {
    float s0 = 0, sx = 0, sxx = 0, b0 = 0, bx = 0;
    void add(float w, float x, float y) {
        s0 += w, sx += w * x, sxx += w * x * x;
        b0 += w * y, bx += w * x * y;
    }
    /// @param pull toward slopeGuess, as a weight relative to the sum of all others
    void solve(float pull, float slopeGuess, float& at, float& slope) const {
        const float xx = sxx + pull * s0, x = bx + pull * s0 * slopeGuess;
        const float det = s0 * xx - sx * sx;
        at = (xx * b0 - sx * x) / det;
        slope = (s0 * x - sx * b0) / det;
    }
};

/// A node's tangent plane, the direction of its geodesic there, and the weight.
struct Chart {
    Vec3d foot;
    TangentFrame frame;
    Vec2f direction;
    double distance;
    float weight;
    Vec3f logGradient;
};

/// A neighbor in that chart: where its geodesic passes the node. Lengths are times the weight.
struct FrontNeighbor {
    NodeIndex core;
    float weight;        ///< for fits: larger for nearer neighbors
    Vec2f vector;        ///< the chord from it
    float ahead, aside;  ///< its parts along and to the left of its geodesic
    float along;         ///< the node is so far ahead of it, along both geodesics
    float left;          ///< so far to the left of the node its geodesic passes
    float rise;          ///< of the distance
    float slope;         ///< of its departure, to the left of the node's chart
    bool bends;          ///< the geodesics bend between the two
    Vec3f chord;         ///< in space, voxels
};

/// The neighbors that one front reached.
class FrontNeighbors {
public:
    void add(const FrontNeighbor& n) {
        if (count_ < all_.size()) all_[count_++] = n;
    }
    const FrontNeighbor* begin() const { return all_.data(); }
    const FrontNeighbor* end() const { return all_.data() + count_; }
    bool empty() const { return count_ == 0; }

private:
    std::array<FrontNeighbor, 40> all_;
    std::size_t count_ = 0;
};

/// The axes of the tangent plane at a seed, index space: orthonormal, u x v the normal of S.
struct SeedAxes {
    Vec3d u, v;
};

/// A frame that is parallel along the geodesic to a node; stores its first axis.
struct SeedFrame {
    Vec3f axis;  ///< 0: not known
    /// Rotation of the frames, counterclockwise, per length (times weight) along the front to the
    /// left
    float turn = 0;
    Vec3f logGradient;  ///< of the weight
    bool known() const { return !(axis == Vec3f{}); }
};

/// The frames of core nodes, by core number.
class SeedFrames {
public:
    /// @param field      must outlive this
    /// @param reference  of logMap
    SeedFrames(const Field& field, const Vec3d& reference);

    const std::vector<SeedAxes>& atSeeds() const { return atSeeds_; }
    /// Core nodes in the band.
    const std::vector<NodeIndex>& nodes() const { return nodes_; }
    std::uint32_t label(NodeIndex i) const { return label_.empty() ? 0 : label_[i]; }
    /// With the start value of the seed.
    double arrival(NodeIndex i) const { return distance_[i]; }
    double distance(NodeIndex i) const { return distance_[i] - field_.seeds[label(i)].start; }
    const Vec3f& gradient(NodeIndex i) const { return gradient_[i]; }
    float weight(NodeIndex i) const { return float(metric_.at(i)); }
    /// At the point where the march has a core node.
    Chart chart(NodeIndex core) const;
    /// At the foot point of a node of the band.
    Chart chartAtFoot(NodeIndex i) const;

    /// Near the seed: the seed's frame, transported along the chord. False elsewhere.
    bool fromSeed(NodeIndex i, const Chart& here, SeedFrame& out) const;
    /// By least squares from those of neighbors. False if none in front has one.
    bool fromNeighbors(const Chart& here, const FrontNeighbors& all, SeedFrame& out) const;
    void set(NodeIndex core, const Chart& here, const SeedFrame& frame);
    /// The angle between geodesic and frame, which is constant along the geodesic, as a direction.
    Vec2f measure(NodeIndex i, const SeedFrame& frame) const;

private:
    Chart chart(NodeIndex i, const Vec3d& foot, const Vec3f& gradient, double distance) const;
    Vec3f logGradient(NodeIndex i) const;

    const Band& band_;
    const Field& field_;
    const Metric& metric_;
    const JetCore& core_;
    /// Those of the field; of core nodes at rims and corners of obstacles those of the march.
    std::span<const double> distance_;
    std::span<const Vec3f> gradient_;
    std::span<const std::uint32_t> label_;
    std::vector<double> ownDistance_;
    std::vector<Vec3f> ownGradient_;
    std::vector<std::uint32_t> ownLabel_;
    std::vector<SeedAxes> atSeeds_;
    std::vector<NodeIndex> nodes_;
    std::vector<SeedFrame> frames_;
};

}  // namespace igeo
