#include <igeo/surface/detail/mesh_distance.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace igeo {

namespace {

using Triangle = TriangleMesh::Triangle;

double square(double x) { return x * x; }

/// A triangle close to a leaf.
struct Meeting {
    Ijk leaf;  ///< origin / 8
    std::uint32_t triangle;

    bool operator<(const Meeting& o) const {
        return std::tie(leaf.x, leaf.y, leaf.z, triangle) <
               std::tie(o.leaf.x, o.leaf.y, o.leaf.z, o.triangle);
    }
};

struct BoxedCorners : TriangleCorners {
    Vec3d low, high, normal;

    BoxedCorners(const std::vector<Vec3d>& p, const Triangle& t)
        : TriangleCorners(p[t[0]], p[t[1]], p[t[2]]) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min({a[k], b[k], c[k]});
            high[k] = std::max({a[k], b[k], c[k]});
        }
        normal = normalized(cross(ab, ac));
    }
    /// How far p is from its box along an axis.
    double fromBox(const Vec3d& p, int axis) const {
        return std::max({low[axis] - p[axis], 0.0, p[axis] - high[axis]});
    }
    /// Whether it may be within r of p, by its plane and its box.
    bool mayReach(const Vec3d& p, double r) const {
        return std::abs(dot(normal, p - a)) <= r &&
               square(fromBox(p, 0)) + square(fromBox(p, 1)) + square(fromBox(p, 2)) <= square(r);
    }
    /// Whether its box is within r of the box of a leaf's voxels.
    bool mayReach(const Ijk& leaf, double r) const {
        for (int k = 0; k < 3; ++k)
            if (low[k] > leaf[k] + 7 + r || high[k] < leaf[k] - r) return false;
        return true;
    }
};

/// Finds the leaves that a triangle is close to.
void findMeetings(const BoxedCorners& t, std::uint32_t number, double reach,
                  std::vector<Meeting>& out) {
    constexpr double kHalfDiagonal = 3.5 * 1.7320508075688772;
    const Vec3d margin{reach, reach, reach};
    const Ijk from = floorToIjk(0.125 * (t.low - margin)),
              to = floorToIjk(0.125 * (t.high + margin));
    const bool one = from == to;
    for (int x = from.x; x <= to.x; ++x)
        for (int y = from.y; y <= to.y; ++y)
            for (int z = from.z; z <= to.z; ++z) {
                const Vec3d center{8.0 * x + 3.5, 8.0 * y + 3.5, 8.0 * z + 3.5};
                const double r = reach + kHalfDiagonal;
                if (!one && !t.mayReach(center, r)) continue;
                // The box of a triangle across many leaves contains leaves that are not close to
                // it.
                if (!one && length(t.nearest(center).point - center) > r) continue;
                out.push_back({{x, y, z}, number});
            }
}

/// The nearest triangle so far, per voxel of a leaf.
struct Best {
    double squared = kInfinity, distance = kInfinity;
    std::uint32_t triangle = 0;
    NearestOnTriangle nearest;
};

void lookAt(const BoxedCorners& t, std::uint32_t number, const Ijk& origin, double reach,
            std::vector<Best>& best) {
    Ijk from, to;
    for (int a = 0; a < 3; ++a) {
        from[a] = std::max(0, int(std::ceil(t.low[a] - reach - origin[a])));
        to[a] = std::min(7, int(std::floor(t.high[a] + reach - origin[a])));
    }
    for (int x = from.x; x <= to.x; ++x)
        for (int y = from.y; y <= to.y; ++y) {
            // How far a row is from the box of the triangle and from its plane, so that most voxels
            // need no more.
            const Vec3d row(origin + Ijk{x, y, 0});
            const double fromBox2 = square(t.fromBox(row, 0)) + square(t.fromBox(row, 1)),
                         fromPlane = dot(t.normal, row - t.a);
            if (fromBox2 > square(reach)) continue;
            for (int z = from.z; z <= to.z; ++z) {
                Best& b = best[std::size_t(x << 6 | y << 3 | z)];
                const double most = std::min(reach, b.distance);
                const Vec3d p(row.x, row.y, row.z + z);
                if (std::abs(fromPlane + z * t.normal.z) > most ||
                    fromBox2 + square(t.fromBox(p, 2)) > square(most))
                    continue;
                const NearestOnTriangle n = t.nearest(p);
                const double d2 = dot(n.point - p, n.point - p);
                if (d2 < reach * reach && d2 < b.squared) b = {d2, std::sqrt(d2), number, n};
            }
        }
}

}  // namespace

std::vector<NearLeaf> voxelsNear(const std::vector<Vec3d>& points,
                                 const std::vector<Triangle>& triangles, double reach,
                                 Progress& progress) {
    constexpr std::size_t kChunk = 1 << 14;
    std::vector<std::vector<Meeting>> parts((triangles.size() + kChunk - 1) / kChunk);
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end && !progress.cancelled(); ++c) {
            const std::size_t last = std::min(triangles.size(), (c + 1) * kChunk);
            for (std::size_t t = c * kChunk; t < last; ++t)
                findMeetings(BoxedCorners(points, triangles[t]), std::uint32_t(t), reach + 1,
                             parts[c]);
        }
    });
    progress.throwIfCancelled();
    std::vector<Meeting> meetings;
    for (auto& part : parts) {
        meetings.insert(meetings.end(), part.begin(), part.end());
        std::vector<Meeting>().swap(part);
    }
    std::sort(meetings.begin(), meetings.end());
    std::vector<std::size_t> starts;
    for (std::size_t k = 0; k < meetings.size(); ++k)
        if (k == 0 || meetings[k].leaf != meetings[k - 1].leaf) starts.push_back(k);
    starts.push_back(meetings.size());

    std::vector<NearLeaf> all(starts.size() - 1);
    parallelFor(all.size(), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<Best> best;
        for (std::size_t l = begin; l < end && !progress.cancelled(); ++l) {
            const Ijk at = meetings[starts[l]].leaf;
            all[l].origin = {8 * at.x, 8 * at.y, 8 * at.z};
            best.assign(512, {});
            for (std::size_t k = starts[l]; k < starts[l + 1]; ++k) {
                const BoxedCorners t(points, triangles[meetings[k].triangle]);
                if (!t.mayReach(all[l].origin, reach + 1)) continue;
                all[l].triangles.push_back(meetings[k].triangle);
                lookAt(t, meetings[k].triangle, all[l].origin, reach, best);
            }
            for (unsigned o = 0; o < 512; ++o) {
                const Best& b = best[o];
                if (!(b.squared < kInfinity)) continue;
                const Vec3d p(all[l].origin + Ijk{int(o >> 6), int(o >> 3 & 7), int(o & 7)});
                all[l].voxels.push_back({b.triangle, std::uint16_t(o),
                                         std::uint8_t(b.nearest.feature), b.nearest.point - p});
            }
        }
    });
    progress.throwIfCancelled();
    all.erase(
        std::remove_if(all.begin(), all.end(), [](const NearLeaf& l) { return l.voxels.empty(); }),
        all.end());
    return all;
}

}  // namespace igeo
