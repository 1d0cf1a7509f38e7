#include <igeo/surface/detail/mesh_joints.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/point_tree.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace igeo {

namespace {

/// Foot points on the two sides of a gap may be this much farther apart than the gap is wide,
/// because they are about a voxel apart along it.
constexpr double kBeside = 1.5;
/// Bridges from a node to another component: enough to fit a front.
constexpr std::size_t kNearest = 4;

/// Core nodes to search: those of a component, or those beside its boundary.
struct Side {
    std::vector<NodeIndex> nodes;
    std::vector<Vec3d> feet;
    Box box;
    PointTree tree;

    void add(NodeIndex i, const Vec3d& foot) { nodes.push_back(i), feet.push_back(foot); }
    void finish() {
        box = Box(feet);
        tree = PointTree(feet);
    }
    bool near(const Side& other, double reach) const {
        for (int k = 0; k < 3; ++k)
            if (box.low[k] > other.box.high[k] + reach || other.box.low[k] > box.high[k] + reach)
                return false;
        return true;
    }
};

/// The nearest points of two segments.
std::pair<Vec3d, Vec3d> nearestOfSegments(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                          const Vec3d& d) {
    const Vec3d u = b - a, v = d - c, w = a - c;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), area2 = uu * vv - uv * uv;
    auto onOther = [](const Vec3d& p, const Vec3d& from, const Vec3d& along, double square) {
        return square > 0 ? std::clamp(dot(p - from, along) / square, 0.0, 1.0) : 0.0;
    };
    double s = area2 > 1e-12 * uu * vv
                   ? std::clamp((uv * dot(v, w) - vv * dot(u, w)) / area2, 0.0, 1.0)
                   : 0;
    const double t = onOther(a + s * u, c, v, vv);
    s = onOther(c + t * v, a, u, uu);
    return {a + s * u, c + t * v};
}

/// A straight line from one side of a gap to the other.
struct Crossing {
    MeshPoint here, there;
    double width = kInfinity;

    Crossing() = default;
    Crossing(const MeshPoint& a, const MeshPoint& b)
        : here(a), there(b), width(length(b.at - a.at)) {}
    Crossing back() const { return {there, here}; }
};

/// The shortest between two triangles that do not cross.
Crossing shortestBetween(const MeshAdjacency& mesh, std::uint32_t t, std::uint32_t u) {
    Crossing best;
    auto take = [&](const Vec3d& a, const Vec3d& b) {
        if (length(b - a) < best.width) best = {{t, a}, {u, b}};
    };
    auto nearest = [&](const Vec3d& p, std::uint32_t on) {
        return nearestOnTriangle(p, mesh.corner(on, 0), mesh.corner(on, 1), mesh.corner(on, 2))
            .point;
    };
    for (std::size_t k = 0; k < 3; ++k) {
        take(mesh.corner(t, k), nearest(mesh.corner(t, k), u));
        take(nearest(mesh.corner(u, k), t), mesh.corner(u, k));
        for (std::size_t l = 0; l < 3; ++l) {
            const auto [a, b] = nearestOfSegments(mesh.corner(t, k), mesh.corner(t, k + 1),
                                                  mesh.corner(u, l), mesh.corner(u, l + 1));
            take(a, b);
        }
    }
    return best;
}

class Joints {
public:
    Joints(const MeshBand& on, double gap)
        : on_(on), walk_(on.adjacency), gap_(gap), reach_(gap + kBeside) {}
    MeshJoints find(Progress& progress);

private:
    /// Joins the nodes of one side to the nearest of the other.
    void join(const Side& from, const Side& to);
    /// Joins nodes beside the boundary of one component that no walk joins.
    void joinRims(const Side& rims, Progress& progress);
    /// Per component, the core nodes within a voxel of a boundary: few have foot points on it.
    std::vector<Side> besideBoundaries() const;
    /// The point of the mesh nearest to p, down over triangles from a point on: not beyond a wall
    /// or a slot.
    MeshPoint nearestAround(const Vec3d& p, MeshPoint on) const;
    /// The crossing beside `from` to the side of `to`.
    Crossing beside(const MeshPoint& from, const MeshPoint& to) const;
    /// The same; if it is wider than the gap may be, the narrowest around, or one that is narrow
    /// enough.
    Crossing crossingFrom(const MeshPoint& from, const MeshPoint& to) const;
    /// Down over pairs of triangles from a crossing on, until it is narrow enough.
    Crossing narrowed(const Crossing& from) const;
    /// The path from node i to node j on another side: along the mesh to the gap, straight across,
    /// and along the mesh. +infinity: the gap between is too wide.
    double pathBetween(NodeIndex i, NodeIndex j);
    /// Along the mesh, or straight if no walk is found.
    double along(const MeshPoint& from, const MeshPoint& to);
    /// @return whether the gap between the nodes is narrow enough
    bool add(NodeIndex i, NodeIndex j);

    const MeshBand& on_;
    MeshWalk walk_;
    const double gap_, reach_;
    std::vector<Bridge> bridges_;
};

MeshPoint Joints::nearestAround(const Vec3d& p, MeshPoint on) const {
    constexpr double kSame = 1e-9;  // voxels: the next triangle at an edge or a corner
    const MeshAdjacency& mesh = on_.adjacency;
    double least = kInfinity;
    std::vector<std::uint32_t> seen{on.triangle};
    for (std::size_t n = 0; n < seen.size(); ++n) {
        const std::uint32_t t = seen[n];
        const Vec3d q =
            nearestOnTriangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)).point;
        const double d = length(q - p);
        if (d > least + kSame) continue;
        if (d < least) least = d, on = {t, q};
        for (std::size_t k = 0; k < 3; ++k)
            mesh.forBeyond(t, k, [&](std::uint32_t u) {
                if (std::find(seen.begin(), seen.end(), u) == seen.end()) seen.push_back(u);
            });
    }
    return on;
}

Crossing Joints::narrowed(const Crossing& from) const {
    constexpr double kSame = 1e-9;          // voxels: the next triangle at an edge or a corner
    constexpr std::size_t kMost = 1 << 10;  // pairs
    using TwoTriangles = std::pair<std::uint32_t, std::uint32_t>;
    const MeshAdjacency& mesh = on_.adjacency;
    Crossing best;
    std::vector<TwoTriangles> seen{{from.here.triangle, from.there.triangle}};
    auto add = [&](const TwoTriangles& pair) {
        if (std::find(seen.begin(), seen.end(), pair) == seen.end()) seen.push_back(pair);
    };
    for (std::size_t n = 0; n < std::min(seen.size(), kMost) && best.width > gap_; ++n) {
        const auto [t, u] = seen[n];
        const Crossing c = shortestBetween(mesh, t, u);
        // Between parallel faces all are as short.
        const bool shorter = c.width < best.width - kSame,
                   same = c.width < best.width + kSame &&
                          length(c.here.at - best.here.at) < kSame &&
                          length(c.there.at - best.there.at) < kSame;
        if (!shorter && !same) continue;
        if (shorter) best = c;
        for (std::size_t k = 0; k < 3; ++k) {
            mesh.forBeyond(t, k, [&, u = u](std::uint32_t other) { add({other, u}); });
            mesh.forBeyond(u, k, [&, t = t](std::uint32_t other) { add({t, other}); });
        }
    }
    return best;
}

Crossing Joints::beside(const MeshPoint& from, const MeshPoint& to) const {
    // Alternating projections end at once where faces or rims are parallel.
    const MeshPoint there = nearestAround(from.at, to), here = nearestAround(there.at, from);
    return {here, nearestAround(here.at, there)};
}

Crossing Joints::crossingFrom(const MeshPoint& from, const MeshPoint& to) const {
    const Crossing first = beside(from, to);
    return first.width > gap_ ? narrowed(first) : first;
}

double Joints::along(const MeshPoint& from, const MeshPoint& to) {
    constexpr double kNone = 1e-6, kMost = 3;  // voxels; times the straight line
    const double straight = length(to.at - from.at);
    if (straight < kNone) return straight;
    const double walk = walk_.tightLength(from, to, kMost * (straight + kBeside));
    return walk < kInfinity ? walk : straight;
}

double Joints::pathBetween(NodeIndex i, NodeIndex j) {
    const MeshPoint from = on_.foot(i), to = on_.foot(j);
    const Crossing first = crossingFrom(from, to), last = crossingFrom(to, from).back();
    if (std::max(first.width, last.width) > gap_) return kInfinity;
    // The gap and what is beyond it are laid flat: the crossings are at right angles to its sides.
    const double straight = length(to.at - from.at), before = along(from, first.here),
                 after = along(last.there, to);
    auto laidFlat = [](double across, double beyond, double slanted) {
        return std::sqrt(across * across + 2 * across * beyond + slanted * slanted);
    };
    return std::max({straight, laidFlat(before + first.width, after, along(first.there, to)),
                     laidFlat(after + last.width, before, along(from, last.here))});
}

bool Joints::add(NodeIndex i, NodeIndex j) {
    const Band& band = on_.band;
    const Vec3f &here = band.normal[i], &there = band.normal[j], chord = chordOf(band, i, j);
    const MeshPoint from = on_.foot(i), to = on_.foot(j);
    // Where normals differ too much, the path bends or goes up a step, a jet cannot be transported:
    // the front starts again.
    const bool differ = dot(here, there) < 0.5f;
    if (on_.adjacency.componentOf(from.triangle) == on_.adjacency.componentOf(to.triangle)) {
        // Rims of one component have few nodes, so that straight lines are the better lengths.
        if (beside(from, to).width > gap_) return false;
        bridges_.push_back({i, j, 1, differ});
        return true;
    }
    const double path = pathBetween(i, j);
    if (!(path < kInfinity)) return false;
    constexpr double kShort = 1e-3;                              // voxels: nothing to stretch
    constexpr double kLonger = 1.05, kMore = 0.05, kRise = 0.3;  // times; voxels
    const double flat = flatLength(band, i, chord, j),
                 rise = std::abs(dot(chord, normalized(here + there)));
    const bool jump = differ || path > kLonger * flat + kMore || rise > std::max(gap_, kRise);
    const double straight = jump ? double(length(chord)) : flat;
    bridges_.push_back({i, j, straight > kShort ? float(path / straight) : 1, jump});
    return true;
}

void Joints::join(const Side& from, const Side& to) {
    std::vector<PointTree::Found> found;
    for (const NodeIndex i : from.nodes) {
        to.tree.nearest(on_.foot(i).at, kNearest, found, reach_);
        for (const PointTree::Found& f : found) {
            const NodeIndex j = to.nodes[to.tree.inputIndex(f.point)];
            add(i, j);
        }
    }
}

void Joints::joinRims(const Side& rims, Progress& progress) {
    constexpr std::size_t kMost = 64;
    std::vector<PointTree::Found> found;
    for (const NodeIndex i : rims.nodes) {
        progress.throwIfCancelled();
        const MeshPoint from = on_.foot(i);
        rims.tree.nearest(from.at, kMost, found, reach_);
        for (const PointTree::Found& f : found) {
            const NodeIndex j = rims.nodes[rims.tree.inputIndex(f.point)];
            const double most = 3 * (std::sqrt(f.squared) + kBeside);
            if (j != i && !(walk_.length(from, on_.foot(j), most) < kInfinity) && add(i, j)) break;
        }
    }
}

std::vector<Side> Joints::besideBoundaries() const {
    constexpr double kWithin = 1;  // voxels
    const MeshAdjacency& mesh = on_.adjacency;
    std::vector<Side> rims(mesh.components());
    for (LeafIndex l = 0; l < on_.band.leaves.size(); ++l) {
        std::vector<std::pair<std::uint32_t, std::size_t>> edges;
        for (const std::uint32_t t : on_.leaves[l].triangles)
            for (std::size_t k = 0; k < 3; ++k)
                if (mesh.isBoundary(t, k)) edges.emplace_back(t, k);
        if (edges.empty()) continue;
        on_.band.forNodes(l, [&](NodeIndex i, unsigned) {
            if (!on_.band.inCore(i)) return;
            const MeshPoint foot = on_.foot(i);
            if (std::any_of(edges.begin(), edges.end(), [&](const auto& e) {
                    return distanceToSegment(foot.at, mesh.corner(e.first, e.second),
                                             mesh.corner(e.first, e.second + 1)) < kWithin;
                }))
                rims[mesh.componentOf(foot.triangle)].add(i, foot.at);
        });
    }
    for (Side& rim : rims)
        if (!rim.nodes.empty()) rim.finish();
    return rims;
}

MeshJoints Joints::find(Progress& progress) {
    const Band& band = on_.band;
    std::vector<Side> sides(on_.adjacency.components());
    for (NodeIndex i = 0; i < band.size(); ++i) {
        if (!band.inCore(i)) continue;
        const MeshPoint foot = on_.foot(i);
        const std::uint32_t c = on_.adjacency.componentOf(foot.triangle);
        sides[c].add(i, foot.at);
    }
    for (Side& side : sides)
        if (!side.nodes.empty()) side.finish();
    const std::vector<Side> rims = besideBoundaries();
    MeshJoints joints;
    for (std::size_t a = 0; a < sides.size(); ++a) {
        progress.throwIfCancelled();
        if (!rims[a].nodes.empty()) {
            const std::size_t before = bridges_.size();
            joinRims(rims[a], progress);
            joints.pairs += bridges_.size() > before;
        }
        for (std::size_t b = a + 1; b < sides.size(); ++b) {
            if (sides[a].nodes.empty() || sides[b].nodes.empty() ||
                !sides[a].near(sides[b], reach_))
                continue;
            const std::size_t before = bridges_.size();
            join(sides[a], sides[b]);
            join(sides[b], sides[a]);
            joints.pairs += bridges_.size() > before;
        }
    }
    joints.bridges = thinned(std::move(bridges_));
    return joints;
}

}  // namespace

MeshJoints jointsOverGaps(const MeshBand& on, double gap, Progress& progress) {
    return Joints(on, gap).find(progress);
}

}  // namespace igeo
