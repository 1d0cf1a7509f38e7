#include "shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::BBoxd;
using openvdb::Vec3d;

BBoxd around(const Vec3d& center, const Vec3d& halfSize) {
    return {center - halfSize, center + halfSize};
}

/// Distance to the set {q <= 0} of the quadrant: faces inside, faces, edges and corners outside.
double boxDistance(const Vec3d& q) {
    const Vec3d outside(std::max(q.x(), 0.0), std::max(q.y(), 0.0), std::max(q.z(), 0.0));
    return outside.length() + std::min(std::max({q.x(), q.y(), q.z()}), 0.0);
}

Vec3d absolute(const Vec3d& p) { return {std::abs(p.x()), std::abs(p.y()), std::abs(p.z())}; }

/// Distance to the closed curve c(t) = (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t).
class TrefoilCurve {
public:
    TrefoilCurve() {
        for (int i = 0; i <= kSamples; ++i) points_.push_back(point(i * kStep));
    }

    double distance(const Vec3d& p) const {
        thread_local std::vector<double> sampled;
        sampled.resize(points_.size());
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < points_.size(); ++i) {
            sampled[i] = (points_[i] - p).length();
            nearest = std::min(nearest, sampled[i]);
        }
        // Every piece of the curve that could hold a nearer point is searched, so the minimum
        // found is the global one and not that of another strand.
        for (int i = 0; i < kSamples; ++i) {
            const double lowerBound = 0.5 * (sampled[i] + sampled[i + 1] - kMaxSpeed * kStep);
            if (lowerBound < nearest)
                nearest = std::min(nearest, distanceToPiece(p, i * kStep, (i + 1) * kStep));
        }
        return nearest;
    }

private:
    static constexpr int kSamples = 512;
    static constexpr double kStep = 2 * M_PI / kSamples;
    /// |c'|^2 = 17 + 8 cos 3t + 9 cos^2 3t <= 34
    static constexpr double kMaxSpeed = 5.831;

    static Vec3d point(double t) {
        return {std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t),
                -std::sin(3 * t)};
    }
    static Vec3d velocity(double t) {
        return {std::cos(t) + 4 * std::cos(2 * t), -std::sin(t) + 4 * std::sin(2 * t),
                -3 * std::cos(3 * t)};
    }
    static Vec3d acceleration(double t) {
        return {-std::sin(t) - 8 * std::sin(2 * t), -std::cos(t) + 8 * std::cos(2 * t),
                9 * std::sin(3 * t)};
    }

    /// Half the derivative of |c(t) - p|^2.
    static double slope(const Vec3d& p, double t) { return (point(t) - p).dot(velocity(t)); }

    /// Smallest distance to c([low, high]) if it lies inside, by Newton steps kept in a bracket of
    /// the slope's sign change; without one the minimum is at a sample and known already.
    static double distanceToPiece(const Vec3d& p, double low, double high) {
        if (slope(p, low) > 0 || slope(p, high) < 0) return std::numeric_limits<double>::infinity();
        double t = 0.5 * (low + high);
        for (int round = 0; round < 60; ++round) {
            const double f = slope(p, t);
            (f > 0 ? high : low) = t;
            const double curvature = velocity(t).lengthSqr() + (point(t) - p).dot(acceleration(t));
            double next = t - f / curvature;
            if (!(next > low && next < high)) next = 0.5 * (low + high);
            // The distance is stationary in t, so an error of 1e-9 in t is below 1e-15 in it.
            if (std::abs(next - t) < 1e-9) return (point(next) - p).length();
            t = next;
        }
        return (point(t) - p).length();
    }

    std::vector<Vec3d> points_;
};

/// The planes of all blocks' faces divide space into cells; S is the rectangles between solid cells
/// and empty ones.
class BlockPart {
public:
    explicit BlockPart(const std::vector<Block>& blocks) : blocks_(blocks) {
        for (int a = 0; a < 3; ++a) {
            for (const Block& b : blocks) planes_[a].insert({b.low[a], b.high[a]});
        }
        for (int a = 0; a < 3; ++a) addFacesAcross(a);
    }

    double distance(const Vec3d& p) const {
        double least = std::numeric_limits<double>::infinity();
        for (const BBoxd& face : faces_) {
            const Vec3d nearest =
                openvdb::math::minComponent(openvdb::math::maxComponent(p, face.min()), face.max());
            least = std::min(least, (p - nearest).lengthSqr());
        }
        return isSolid(p) ? -std::sqrt(least) : std::sqrt(least);
    }

private:
    bool isSolid(const Vec3d& p) const {
        bool solid = false;
        for (const Block& b : blocks_)
            if (BBoxd(b.low, b.high).isInside(p)) solid = !b.isCut;
        return solid;
    }
    /// Calls visit(low, high) for the intervals between planes.
    template <typename Visit>
    void forIntervals(int axis, const Visit& visit) const {
        for (auto low = planes_[axis].begin(), high = std::next(low); high != planes_[axis].end();
             ++low, ++high)
            visit(*low, *high);
    }
    void addFacesAcross(int a) {
        const int u = (a + 1) % 3, v = (a + 2) % 3;
        constexpr double kBeside = 1e-6;
        for (const double at : planes_[a])
            forIntervals(u, [&](double lowU, double highU) {
                forIntervals(v, [&](double lowV, double highV) {
                    Vec3d low, high;
                    low[a] = high[a] = at;
                    low[u] = lowU, high[u] = highU, low[v] = lowV, high[v] = highV;
                    Vec3d below = 0.5 * (low + high), above = below;
                    below[a] -= kBeside, above[a] += kBeside;
                    if (isSolid(below) != isSolid(above)) faces_.emplace_back(low, high);
                });
            });
    }

    std::vector<Block> blocks_;
    std::array<std::set<double>, 3> planes_;
    std::vector<BBoxd> faces_;
};

}  // namespace

Shape sphere(const Vec3d& center, double radius) {
    return {"sphere", [=](const Vec3d& p) { return (p - center).length() - radius; },
            around(center, Vec3d(radius)), true, nullptr};
}

Shape torus(const Vec3d& center, double majorRadius, double minorRadius) {
    const auto sdf = [=](const Vec3d& p) {
        const Vec3d q = p - center;
        return std::hypot(std::hypot(q.x(), q.y()) - majorRadius, q.z()) - minorRadius;
    };
    const double outer = majorRadius + minorRadius;
    return {"torus", sdf, around(center, Vec3d(outer, outer, minorRadius)), true, nullptr};
}

Vec3d nearestOnEllipsoid(const Vec3d& center, const Vec3d& halfAxes, const Vec3d& p) {
    // q = p - center is y + t grad(sum y^2 / a^2) / 2, so y = a^2 q / (a^2 + t). What y lacks to be
    // on the surface falls with t from the nearest point's branch, t > -min a^2, on.
    const Vec3d q = p - center, a2 = halfAxes * halfAxes;
    const auto point = [&](double t) { return a2 * q / (a2 + Vec3d(t)); };
    const auto excess = [&](double t) { return (point(t) / halfAxes).lengthSqr() - 1; };
    double low = -std::min({a2.x(), a2.y(), a2.z()});
    double high = q.length() * std::max({halfAxes.x(), halfAxes.y(), halfAxes.z()});
    for (;;) {
        const double t = 0.5 * (low + high);
        if (t <= low || t >= high) return center + point(t);
        (excess(t) > 0 ? low : high) = t;
    }
}

Shape ellipsoid(const Vec3d& center, const Vec3d& halfAxes) {
    const auto sdf = [=](const Vec3d& p) {
        const double distance = (p - nearestOnEllipsoid(center, halfAxes, p)).length();
        return ((p - center) / halfAxes).lengthSqr() < 1 ? -distance : distance;
    };
    return {"ellipsoid", sdf, around(center, halfAxes), true, nullptr};
}

Shape trefoilTube(const Vec3d& center, double scale, double tubeRadius) {
    const auto curve = std::make_shared<const TrefoilCurve>();
    const auto sdf = [=](const Vec3d& p) {
        return scale * curve->distance((p - center) / scale) - tubeRadius;
    };
    const Vec3d halfSize = scale * Vec3d(3, 3, 1) + Vec3d(tubeRadius);
    return {"trefoil", sdf, around(center, halfSize), true, nullptr};
}

Shape box(const Vec3d& center, const Vec3d& halfSize) {
    const auto sdf = [=](const Vec3d& p) { return boxDistance(absolute(p - center) - halfSize); };
    return {"box", sdf, around(center, halfSize), true, nullptr};
}

Shape roundedBox(const Vec3d& center, const Vec3d& halfSize, double radius) {
    const Vec3d core = halfSize - Vec3d(radius);
    if (core.x() < 0 || core.y() < 0 || core.z() < 0)
        throw std::invalid_argument("rounded box: the radius exceeds half a side");
    const auto sdf = [=](const Vec3d& p) {
        return boxDistance(absolute(p - center) - core) - radius;
    };
    return {"rounded_box", sdf, around(center, halfSize), true, nullptr};
}

Shape twoSpheres(const Vec3d& center0, double radius0, const Vec3d& center1, double radius1) {
    if ((center1 - center0).length() <= radius0 + radius1)
        throw std::invalid_argument("two spheres: they touch");
    const auto sdf = [=](const Vec3d& p) {
        return std::min((p - center0).length() - radius0, (p - center1).length() - radius1);
    };
    BBoxd bounds = around(center0, Vec3d(radius0));
    bounds.expand(around(center1, Vec3d(radius1)));
    return {"two_spheres", sdf, bounds, true, nullptr};
}

Shape thinSheet(const Vec3d& center, double halfX, double halfY, double thickness) {
    Shape sheet = roundedBox(center, Vec3d(halfX, halfY, 0.5 * thickness), 0.5 * thickness);
    sheet.name = "thin_sheet";
    return sheet;
}

Shape planePatch(const Vec3d& center, const Vec3d& normal, double size) {
    const Vec3d n = normal.unit();
    const Vec3d u = n.getArbPerpendicular().unit();
    const Vec3d v = n.cross(u);
    const double half = 0.5 * size;
    const auto sdf = [=](const Vec3d& p) { return (p - center).dot(n); };
    const auto domain = [=](const Vec3d& p) {
        return std::max(std::abs((p - center).dot(u)), std::abs((p - center).dot(v))) - half;
    };
    return {"plane_patch", sdf, around(center, half * (absolute(u) + absolute(v))), false, domain};
}

Shape cylinder(const Vec3d& center, double radius, double halfHeight) {
    const auto sdf = [=](const Vec3d& p) {
        const Vec3d q = p - center;
        const double side = std::hypot(q.x(), q.y()) - radius;
        const double end = std::abs(q.z()) - halfHeight;
        return std::hypot(std::max(side, 0.0), std::max(end, 0.0)) +
               std::min(std::max(side, end), 0.0);
    };
    return {"cylinder", sdf, around(center, Vec3d(radius, radius, halfHeight)), true, nullptr};
}

Shape partOf(const std::vector<Block>& blocks) {
    const auto part = std::make_shared<const BlockPart>(blocks);
    BBoxd bounds;
    for (const Block& b : blocks)
        if (!b.isCut) bounds.expand(BBoxd(b.low, b.high));
    return {"part", [=](const Vec3d& p) { return part->distance(p); }, bounds, true, nullptr};
}

Shape frustum(const Vec3d& center, double wide, double narrow, double halfHeight) {
    const double dr = narrow - wide, dz = 2 * halfHeight;
    const auto sdf = [=](const Vec3d& p) {
        const Vec3d q = p - center;
        const double r = std::hypot(q.x(), q.y()), z = q.z();
        const double low = std::hypot(std::max(r - wide, 0.0), z + halfHeight);
        const double high = std::hypot(std::max(r - narrow, 0.0), z - halfHeight);
        const double along = ((r - wide) * dr + (z + halfHeight) * dz) / (dr * dr + dz * dz);
        const double t = std::min(std::max(along, 0.0), 1.0);
        const double side = r - wide - t * dr;
        const double nearest = std::min({low, high, std::hypot(side, z + halfHeight - t * dz)});
        return side < 0 && std::abs(z) < halfHeight ? -nearest : nearest;
    };
    return {"frustum", sdf, around(center, Vec3d(wide, wide, halfHeight)), true, nullptr};
}

openvdb::math::Transform::Ptr rotatedTransform(double dx, const Vec3d& axis, double angleDegrees,
                                               const Vec3d& translation) {
    // Rodrigues' formula; OpenVDB multiplies row vectors, so row i is the image of voxel side i.
    const Vec3d n = axis.unit();
    const double angle = angleDegrees * M_PI / 180, c = std::cos(angle), s = std::sin(angle);
    openvdb::Mat4d worldFromIndex = openvdb::Mat4d::identity();
    for (int i = 0; i < 3; ++i) {
        Vec3d side(0.0);
        side[i] = dx;
        const Vec3d turned = c * side + s * n.cross(side) + (1 - c) * n.dot(side) * n;
        for (int j = 0; j < 3; ++j) worldFromIndex(i, j) = turned[j];
    }
    worldFromIndex.setTranslation(translation);
    return openvdb::math::Transform::createLinearTransform(worldFromIndex);
}

}  // namespace igeo::test
