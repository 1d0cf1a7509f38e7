#include <igeo/march/detail/mesh_read.h>

#include <igeo/march/detail/fermat_update.h>

#include <algorithm>

namespace igeo {

namespace {

constexpr double kLongestWalk = 3;  // voxels

/// A core node near a point.
struct Near {
    double least;  ///< of the point, if the front comes from there
    NodeIndex node;
    Vec3d foot;
    NodeJet jet;
};

/// The core nodes with a jet whose foot points are near a point; those that matter most first.
std::vector<Near> coreNear(const Field& field, const Vec3d& p) {
    constexpr int kReach = 2;
    const Band& band = *field.band;
    std::vector<NodeIndex> nodes;
    const Ijk low = floorToIjk(p);
    for (int x = -kReach; x <= kReach + 1; ++x)
        for (int y = -kReach; y <= kReach + 1; ++y)
            for (int z = -kReach; z <= kReach + 1; ++z) {
                const NodeIndex i = band.nodeAt(low + Ijk{x, y, z});
                if (i != kNoNode && band.inCore(i) &&
                    length(band.footPoint(i) - p) < kLongestWalk)
                    nodes.push_back(i);
            }
    std::vector<NodeJet> jets(nodes.size());
    field.at(nodes, jets.data());
    std::vector<Near> found;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Vec3d foot = band.footPoint(nodes[k]);
        if (jets[k].distance < kInfinity)
            found.push_back({jets[k].distance + field.metric->at(nodes[k]) * length(foot - p),
                             nodes[k], foot, jets[k]});
    }
    std::sort(found.begin(), found.end(), [](const Near& a, const Near& b) {
        return std::pair(a.least, a.node) < std::pair(b.least, b.node);
    });
    return found;
}

}  // namespace

bool hasThinWalls(const Band& band, const BandCell& cell) {
    return band.triangles &&
           std::all_of(cell.node.begin(), cell.node.end(), [](auto i) { return i == kNoNode; }) |
               std::any_of(cell.node.begin(), cell.node.end(), [&](NodeIndex i) {
                   return i != kNoNode && band.facing[i] & Band::kBesideSevered;
               });
}

CoreByWalks::CoreByWalks(const Field& field, const SurfaceTriangles::Place& place) {
    constexpr double kOneFace = 0.8;  // 37 degrees
    constexpr double kAround = 1;     // voxels: beside the nodes from which the front comes
    const Band& band = *field.band;
    const Metric& metric = *field.metric;
    const SurfaceTriangles& triangles = *band.triangles;
    std::vector<Vec3d> faceNormal;
    ShortWalk walk(triangles);
    double first = kInfinity;
    for (const Near& near : coreNear(field, place.point)) {
        if (near.least > first + kAround * here_ || nodes_.size() == JetNeighbors::kMax) break;
        const Vec3d up(band.normal[near.node]);
        const auto from = triangles.nearest(near.foot, kInfinity, up);
        const WalkEnds way =
            walk.ends({from.triangle, near.foot}, {place.triangle, place.point}, kLongestWalk);
        if (!(way.length < kInfinity)) continue;
        if (nodes_.empty()) here_ = metric.at(near.node);
        Node node{{}, kNoFace, near.jet.label};
        node.jet.u = near.jet.distance / here_;
        const double cost = (1 + metric.at(near.node) / here_) / 2 * way.length;
        first = std::min(first, here_ * (node.jet.u + cost));
        const Vec3d normal = triangles.normal(way.last), start = triangles.normal(way.first);
        if (!way.straight || normal == Vec3d{} || start == Vec3d{}) {
            node.jet.a = {float(cost), 0};
            nodes_.push_back(node);
            continue;
        }
        node.face = 0;
        while (node.face < faceNormal.size() && dot(faceNormal[node.face], normal) < kOneFace)
            ++node.face;
        if (node.face == faceNormal.size()) faceNormal.push_back(normal);
        // The angle between walk and direction of travel is the same at both ends.
        const Vec3d own = dot(start, up) < 0 ? -1 * up : up,
                    g = normalized(turned(Vec3d(near.jet.gradient), own, start));
        const double along = dot(g, way.out), side = dot(g, cross(start, way.out)),
                     across = way.mirrored ? -side : side;
        const TangentFrame frame{Vec3f(faceNormal[node.face])};
        Vec2f to = frame.flat(Vec3f(way.in));
        to = length(to) > 0 ? (1 / length(to)) * to : Vec2f{1, 0};
        node.jet.a = float(cost) * to;
        node.jet.g = float(along) * to + float(across) * Vec2f{-to.y, to.x};
        nodes_.push_back(node);
    }
    faces_ = faceNormal.size();
}

std::vector<std::uint32_t> CoreByWalks::sources() const {
    std::vector<std::uint32_t> all;
    for (const Node& node : nodes_) all.push_back(node.source);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

double CoreByWalks::first(std::uint32_t source) const {
    double least = kInfinity;
    for (std::size_t face = 0; face < faces_; ++face) {
        JetNeighbors all;
        for (const Node& node : nodes_)
            if (node.source == source && node.face == face) all.add(node.jet);
        if (all.count() > 0) least = std::min(least, fermatUpdate(all).u);
    }
    for (const Node& node : nodes_)
        if (node.source == source && node.face == kNoFace)
            least = std::min(least, node.jet.u + double(length(node.jet.a)));
    return here_ * least;
}

}  // namespace igeo
