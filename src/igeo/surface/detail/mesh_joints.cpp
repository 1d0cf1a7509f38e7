#include <igeo/surface/detail/mesh_joints.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/point_tree.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// Foot points on the two sides of a gap may be this much farther apart than the gap is wide,
/// because they are about a voxel apart along it.
constexpr double kBeside = 1.5;
/// Bridges from a node to another component: enough to fit a front.
constexpr std::size_t kNearest = 4;

/// Core nodes to search: those of a component, or those at its boundary.
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

class Joints {
public:
    Joints(const MeshBand& on, double gap) : on_(on), gap_(gap), reach_(gap + kBeside) {}
    MeshJoints find(Progress& progress);

private:
    /// Joins the nodes of one side to the nearest of the other.
    void join(const Side& from, const Side& to);
    /// Joins nodes at the boundary of one component that no walk joins.
    void joinBoundaries(const Side& boundary, Progress& progress);
    /// The point nearest to p on the part of a component around one of its nodes.
    Vec3d nearestTo(const Vec3d& p, NodeIndex on) const;
    /// The gap between two components, around two of their nodes.
    double gapBetween(NodeIndex i, NodeIndex j) const;
    /// The gap between foot points at boundaries of one component.
    double gapBetweenRims(NodeIndex i, NodeIndex j) const;
    bool atBoundary(NodeIndex i) const;
    void add(NodeIndex i, NodeIndex j) {
        // Where normals differ too much a jet cannot be transported: the front starts again.
        const bool jump = dot(on_.band.normal[i], on_.band.normal[j]) < 0.5f;
        bridges_.push_back({i, j, 1, jump});
    }

    const MeshBand& on_;
    const double gap_, reach_;
    std::vector<Bridge> bridges_;
};

Vec3d Joints::nearestTo(const Vec3d& p, NodeIndex on) const {
    const MeshAdjacency& adjacency = on_.adjacency;
    const std::uint32_t component = adjacency.componentOf(on_.voxel(on).triangle);
    Vec3d best;
    double least = kInfinity;
    for (const std::uint32_t t : on_.leaves[on_.band.leafOf(on)].triangles) {
        if (adjacency.componentOf(t) != component) continue;
        const auto& [a, b, c] = adjacency.mesh().triangles[t];
        const std::vector<Vec3d>& points = adjacency.mesh().points;
        const Vec3d q = nearestOnTriangle(p, points[a], points[b], points[c]).point;
        if (const double d2 = dot(q - p, q - p); d2 < least) least = d2, best = q;
    }
    return best;
}

double Joints::gapBetween(NodeIndex i, NodeIndex j) const {
    // Alternating projections between the sides, from the foot points to their rims.
    const Vec3d there = nearestTo(on_.foot(i).at, j), here = nearestTo(there, i);
    return length(nearestTo(here, j) - here);
}

double Joints::gapBetweenRims(NodeIndex i, NodeIndex j) const {
    auto offTriangle = [&](const Vec3d& p, std::uint32_t t) {
        const auto& [a, b, c] = on_.adjacency.mesh().triangles[t];
        const std::vector<Vec3d>& points = on_.adjacency.mesh().points;
        return length(nearestOnTriangle(p, points[a], points[b], points[c]).point - p);
    };
    const MeshPoint a = on_.foot(i), b = on_.foot(j);
    return std::min(offTriangle(a.at, b.triangle), offTriangle(b.at, a.triangle));
}

bool Joints::atBoundary(NodeIndex i) const {
    const NearVoxel& v = on_.voxel(i);
    if (v.feature < 3) return on_.adjacency.isAtBoundary(v.triangle, v.feature);
    return v.feature < 6 && on_.adjacency.isBoundary(v.triangle, std::size_t(v.feature - 3));
}

void Joints::join(const Side& from, const Side& to) {
    std::vector<PointTree::Found> found;
    for (const NodeIndex i : from.nodes) {
        to.tree.nearest(on_.foot(i).at, kNearest, found, reach_);
        for (const PointTree::Found& f : found) {
            const NodeIndex j = to.nodes[to.tree.inputIndex(f.point)];
            if (gapBetween(i, j) <= gap_) add(i, j);
        }
    }
}

void Joints::joinBoundaries(const Side& boundary, Progress& progress) {
    constexpr std::size_t kMost = 64;
    std::vector<PointTree::Found> found;
    MeshWalk walk(on_.adjacency);
    for (const NodeIndex i : boundary.nodes) {
        progress.throwIfCancelled();
        const MeshPoint from = on_.foot(i);
        boundary.tree.nearest(from.at, kMost, found, reach_);
        for (const PointTree::Found& f : found) {
            const NodeIndex j = boundary.nodes[boundary.tree.inputIndex(f.point)];
            const double most = 3 * (std::sqrt(f.squared) + kBeside);
            if (j == i || walk.length(from, on_.foot(j), most) < kInfinity) continue;
            if (gapBetweenRims(i, j) <= gap_) add(i, j);
            break;
        }
    }
}

MeshJoints Joints::find(Progress& progress) {
    const Band& band = on_.band;
    std::vector<Side> sides(on_.adjacency.components()), boundaries(sides.size());
    for (NodeIndex i = 0; i < band.size(); ++i) {
        if (!band.inCore(i)) continue;
        const MeshPoint foot = on_.foot(i);
        const std::uint32_t c = on_.adjacency.componentOf(foot.triangle);
        sides[c].add(i, foot.at);
        if (atBoundary(i)) boundaries[c].add(i, foot.at);
    }
    for (auto* all : {&sides, &boundaries})
        for (Side& side : *all)
            if (!side.nodes.empty()) side.finish();
    MeshJoints joints;
    for (std::size_t a = 0; a < sides.size(); ++a) {
        progress.throwIfCancelled();
        if (!boundaries[a].nodes.empty()) {
            const std::size_t before = bridges_.size();
            joinBoundaries(boundaries[a], progress);
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
