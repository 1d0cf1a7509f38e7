/// Walls of obstacles on surfaces in general position, and what a front may reach behind them.
#pragma once

#include <igeo/metric/obstacles.h>
#include <support/analytic_band.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <tuple>

namespace igeo::test {

/// Random numbers that are the same everywhere.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double between(double low, double high) {
        return low + (high - low) * double(engine_()) / 4294967296.0;
    }
    Vec3d inCube(double half) {
        const double x = between(-half, half), y = between(-half, half);
        return {x, y, between(-half, half)};
    }
    Vec3d unit() {
        for (;;) {
            const Vec3d v = inCube(1);
            if (length(v) < 1 && length(v) > 0.1) return normalized(v);
        }
    }

private:
    std::mt19937 engine_;
};

inline Vec3d anyOrthogonal(const Vec3d& n) {
    return normalized(cross(n, std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
}

/// A placement of index space that is anything but plain.
inline Similarity placed() {
    const auto m = rotatedTransform(0.25, {1, -2, 3}, 40, {10, -20, 5});
    const auto image = [&](const openvdb::Vec3d& p) {
        const openvdb::Vec3d q = m->indexToWorld(p);
        return Vec3d{q.x(), q.y(), q.z()};
    };
    Similarity s;
    s.dx = 0.25;
    s.origin = image({0, 0, 0});
    s.axis = {(image({1, 0, 0}) - s.origin) * 4.0, (image({0, 1, 0}) - s.origin) * 4.0,
              (image({0, 0, 1}) - s.origin) * 4.0};
    return s;
}

inline ObstacleGrid source(const openvdb::GridBase::Ptr& grid) { return {grid, "o.vdb", "wall"}; }

inline openvdb::MaskGrid::Ptr maskOf(const std::vector<Ijk>& voxels) {
    const auto mask = openvdb::MaskGrid::create();
    for (const Ijk& v : voxels) mask->tree().setValueOn({v.x, v.y, v.z});
    return mask;
}

inline ObstacleSet only(const openvdb::GridBase::Ptr& grid, const Similarity& transform = {}) {
    ObstacleSet set(transform);
    set.addGrid(source(grid));
    return set;
}

inline bool blocksPoint(const ObstacleSet& set, const Vec3d& p, const Vec3d& n = {0, 0, 1}) {
    return set.block(p, p, n);
}

/// The links that a front may take, of the core or of the whole band.
class Links {
public:
    enum Which { Core, Faces };

    Links(const Band& band, const Obstacles& obstacles, Which which,
          const std::function<bool(const Vec3d&)>& domain)
        : band_(band), obstacles_(obstacles), which_(which) {
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const bool takesPart = which == Faces || band.inCore(i);
            const Vec3d foot = band.footPoint(i);
            open_.push_back(takesPart && domain(foot) &&
                            !obstacles.block(foot, foot, Vec3d(band.normal[i])));
        }
    }
    bool open(NodeIndex i) const { return open_[i]; }
    bool takesPart(NodeIndex i) const { return which_ == Faces || band_.inCore(i); }

    /// The nodes that can be reached from the open node whose foot point is nearest to p.
    std::vector<bool> flood(const Vec3d& p) const {
        NodeIndex start = kNoNode;
        for (NodeIndex i = 0; i < band_.size(); ++i)
            if (open(i) && (start == kNoNode ||
                            length(band_.footPoint(i) - p) < length(band_.footPoint(start) - p)))
                start = i;
        std::vector<bool> reached(band_.size());
        std::vector<NodeIndex> front{start};
        reached[start] = true;
        while (!front.empty()) {
            const NodeIndex i = front.back();
            front.pop_back();
            forLinked(i, [&](NodeIndex j) {
                if (reached[j] || !open(j) || blocked(i, j)) return;
                reached[j] = true;
                front.push_back(j);
            });
        }
        return reached;
    }

    template <typename Visit>
    void forLinked(NodeIndex i, const Visit& visit) const {
        if (which_ == Faces) {
            for (int side = 0; side < 6; ++side) {
                const NodeIndex j = band_.neighbor(i, Band::faceStep(side));
                if (j != kNoNode && band_.linked(i, j)) visit(j);
            }
            return;
        }
        band_.forNeighbors(&BandLeaf::core, i, [&](NodeIndex, int dx, int dy, int dz) {
            const NodeIndex j = band_.neighbor(i, dx, dy, dz);
            if (dot(band_.normal[i], band_.normal[j]) >= Band::kOtherSheet) visit(j);
        });
    }

private:
    bool blocked(NodeIndex i, NodeIndex j) const {
        const Vec3d n = normalized(Vec3d(band_.normal[i]) + Vec3d(band_.normal[j]));
        return obstacles_.block(band_.footPoint(i), band_.footPoint(j), n);
    }
    const Band& band_;
    const Obstacles& obstacles_;
    Which which_;
    std::vector<bool> open_;
};

/// What comes of a wall that should part p from q.
struct Parting {
    bool leaks = false;        ///< there is a path from p to q
    double swallowed = 0;      ///< how far from the wall a node belongs to neither side, voxels
    std::size_t p = 0, q = 0;  ///< nodes of either side
};

inline Parting part(const Band& band, const openvdb::MaskGrid::Ptr& wall, const Vec3d& p,
                    const Vec3d& q, Links::Which which,
                    const std::function<bool(const Vec3d&)>& judged) {
    const ObstacleSet set = only(wall);
    const Links links(band, set, which, judged);
    const auto fromP = links.flood(p), fromQ = links.flood(q);
    std::vector<Vec3d> voxels;
    for (auto it = wall->cbeginValueOn(); it; ++it) {
        const openvdb::Vec3d w = wall->indexToWorld(it.getCoord());
        voxels.emplace_back(w.x(), w.y(), w.z());
    }
    Parting result;
    for (NodeIndex i = 0; i < band.size(); ++i) {
        result.leaks |= fromP[i] && fromQ[i];
        result.p += fromP[i], result.q += fromQ[i];
        const Vec3d foot = band.footPoint(i);
        if (fromP[i] || fromQ[i] || !links.takesPart(i) || !judged(foot)) continue;
        double nearest = kInfinity;
        for (const Vec3d& v : voxels) nearest = std::min(nearest, length(foot - v));
        result.swallowed = std::max(result.swallowed, nearest);
    }
    return result;
}

/// Half the width of a voxel across a plane, along the axis nearest to its normal and in all.
inline double halfEdge(const Vec3d& n) {
    return std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) / 2;
}
inline double halfWidth(const Vec3d& n) {
    return (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) / 2;
}

/// A surface in general position and what a wall on it needs.
struct Ground {
    Band band;
    Vec3d center;                             ///< a point of S, far from every cut
    std::function<Vec3d(const Vec3d&)> onto;  ///< the nearest point of S
    std::function<bool(const Vec3d&)> farFromCut;
    double across;  ///< how far from the center to start on either side of a wall through it

    Vec3d normalAtCenter() const { return Vec3d(band.normal[band.nodeAt(roundToIjk(center))]); }
};

constexpr double kPatch = 11, kRadius = 7;

inline Ground randomGround(Random& random, bool round) {
    const Vec3d shift = random.inCube(0.5), n = random.unit();
    if (round) {
        const Vec3d middle = shift;
        return {sphereBand(middle, kRadius, 1.8), middle + kRadius * n,
                [=](const Vec3d& p) { return middle + kRadius * normalized(p - middle); },
                [](const Vec3d&) { return true; }, 5};
    }
    return {planeBand(n, dot(n, shift), {-11, -11, -11}, {11, 11, 11}, 1.8), shift,
            [=](const Vec3d& p) { return p - dot(n, p - shift) * n; },
            [=](const Vec3d& p) { return length(p - shift) < kPatch - 2; }, 6};
}

/// A plane through the center of the ground that meets S at 60 degrees at least.
inline Vec3d wallNormal(Random& random, const Ground& g) {
    for (;;) {
        const Vec3d w = random.unit();
        if (std::abs(dot(w, g.normalAtCenter())) < 0.5) return w;
    }
}

/// The nodes whose voxels come within `half` of the wall's plane, and that `takes` takes.
inline openvdb::MaskGrid::Ptr wallOf(const Ground& g, const Vec3d& w, double half,
                                     const std::function<bool(NodeIndex)>& takes) {
    const auto wall = openvdb::MaskGrid::create();
    for (NodeIndex i = 0; i < g.band.size(); ++i) {
        const Ijk v = g.band.ijk(i);
        if (std::abs(dot(w, Vec3d(v) - g.center)) <= half && takes(i))
            wall->tree().setValueOn({v.x, v.y, v.z});
    }
    return wall;
}

/// Voxels of the core from one to another, each within one step of the last, as few as can be.
inline void appendPath(const Links& core, const Band& band, NodeIndex from, NodeIndex to,
                       std::vector<Ijk>& path) {
    std::vector<NodeIndex> before(band.size(), kNoNode), queue{to};
    before[to] = to;
    for (std::size_t k = 0; before[from] == kNoNode; ++k) {
        REQUIRE(k < queue.size());
        core.forLinked(queue[k], [&](NodeIndex j) {
            if (before[j] != kNoNode) return;
            before[j] = queue[k];
            queue.push_back(j);
        });
    }
    for (NodeIndex i = from; i != to; i = before[i]) path.push_back(band.ijk(i));
}

/// A closed curve of the core, each voxel with at least a corner in common with the next, through
/// the voxels nearest to points around the ground's center.
inline std::vector<Ijk> curveVoxels(const Ground& g, double radius, int points, double start) {
    const ObstacleSet none{Similarity{}};
    const Links core(g.band, none, Links::Core, g.farFromCut);
    const Vec3d n = g.normalAtCenter(), x = anyOrthogonal(n), y = cross(n, x);
    std::vector<NodeIndex> corners;
    for (int k = 0; k < points; ++k) {
        const double angle = start + 2 * M_PI * k / points;
        const Vec3d p =
            g.onto(g.center + radius * std::cos(angle) * x + radius * std::sin(angle) * y);
        NodeIndex nearest = kNoNode;
        for (NodeIndex i = 0; i < g.band.size(); ++i)
            if (g.band.inCore(i) &&
                (nearest == kNoNode ||
                 length(Vec3d(g.band.ijk(i)) - p) < length(Vec3d(g.band.ijk(nearest)) - p)))
                nearest = i;
        corners.push_back(nearest);
    }
    std::vector<Ijk> path;
    for (std::size_t k = 0; k < corners.size(); ++k)
        appendPath(core, g.band, corners[k], corners[(k + 1) % corners.size()], path);
    return path;
}

/// No wall leaks, and none takes more than its surroundings.
struct Tally {
    int walls = 0, leaks = 0;
    double swallowed = 0;

    void add(const Ground& g, const openvdb::MaskGrid::Ptr& wall, const Vec3d& p, const Vec3d& q) {
        for (const auto which : {Links::Core, Links::Faces}) {
            const Parting parting = part(g.band, wall, p, q, which, g.farFromCut);
            leaks += parting.leaks;
            swallowed = std::max(swallowed, parting.swallowed);
        }
        ++walls;
    }
};

/// Whether voxels that share at least a corner lead from one end of the ground to the other.
inline bool leadsAcross(const openvdb::MaskGrid& wall, const Ground& g, const Vec3d& along,
                        double reach) {
    std::set<std::tuple<int, int, int>> left;
    for (auto it = wall.cbeginValueOn(); it; ++it)
        left.insert({it.getCoord().x(), it.getCoord().y(), it.getCoord().z()});
    while (!left.empty()) {
        double low = kInfinity, high = -kInfinity;
        std::vector<std::tuple<int, int, int>> front{*left.begin()};
        left.erase(left.begin());
        while (!front.empty()) {
            const auto [x, y, z] = front.back();
            front.pop_back();
            const double at = dot(along, Vec3d(x, y, z) - g.center);
            low = std::min(low, at), high = std::max(high, at);
            for (int k = 0; k < 27; ++k)
                if (const auto v = std::make_tuple(x + k / 9 - 1, y + k / 3 % 3 - 1, z + k % 3 - 1);
                    left.erase(v))
                    front.push_back(v);
        }
        if (low < -reach && high > reach) return true;
    }
    return false;
}

}  // namespace igeo::test
