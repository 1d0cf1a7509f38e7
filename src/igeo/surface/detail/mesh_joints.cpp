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

class Joints {
public:
    Joints(const MeshBand& on, double gap) : on_(on), gap_(gap), reach_(gap + kBeside) {}
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
    /// The gap between two sides, around two of their nodes.
    double gapBetween(NodeIndex i, NodeIndex j) const;
    void add(NodeIndex i, NodeIndex j) {
        // Where normals differ too much a jet cannot be transported: the front starts again.
        const bool jump = dot(on_.band.normal[i], on_.band.normal[j]) < 0.5f;
        bridges_.push_back({i, j, 1, jump});
    }

    const MeshBand& on_;
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

double Joints::gapBetween(NodeIndex i, NodeIndex j) const {
    // Alternating projections between the sides, from the foot points to their rims.
    const MeshPoint there = nearestAround(on_.foot(i).at, on_.foot(j)),
                    here = nearestAround(there.at, on_.foot(i));
    return length(nearestAround(here.at, there).at - here.at);
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

void Joints::joinRims(const Side& rims, Progress& progress) {
    constexpr std::size_t kMost = 64;
    std::vector<PointTree::Found> found;
    MeshWalk walk(on_.adjacency);
    for (const NodeIndex i : rims.nodes) {
        progress.throwIfCancelled();
        const MeshPoint from = on_.foot(i);
        rims.tree.nearest(from.at, kMost, found, reach_);
        for (const PointTree::Found& f : found) {
            const NodeIndex j = rims.nodes[rims.tree.inputIndex(f.point)];
            const double most = 3 * (std::sqrt(f.squared) + kBeside);
            if (j == i || walk.length(from, on_.foot(j), most) < kInfinity ||
                gapBetween(i, j) > gap_)
                continue;
            add(i, j);
            break;
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
