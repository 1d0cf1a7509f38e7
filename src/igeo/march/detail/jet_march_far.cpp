#include <igeo/march/detail/jet_march.h>

#include <igeo/band/detail/chord.h>

#include <algorithm>
#include <tuple>

// Beyond links: over two of them, and over jumps.
namespace igeo {

JetGroup::Solution JetMarch::overTwoLinks(NodeIndex i, const JetRows::Row& row, const Batch& batch,
                                          JetGroup::Solution s) const {
    constexpr float kAlike = 0.2f;
    constexpr double kOff = 0.15;  // voxels
    const JetNode& here = core_.nodes[i];
    const TangentFrame frame(here.normal, core_.band.faceted);
    const Ijk voxel = core_.voxelOf(here);
    // A path goes on to a neighbor, so one has to lie lower.
    float least = float(kInfinity);
    for (std::size_t k = 0; k < row.knownCount; ++k)
        least = std::min(least, valueIn(batch, row.knownLink(k).node()) / here.weight);
    const auto lower = [&](NodeIndex k) {
        const JetNode& other = core_.nodes[k];
        const float cosine = dot(here.normal, other.normal);
        if (cosine < kAlike || other.obstacleState != Metric::Clear) return;
        const Vec3f chord = here.foot - other.foot - Vec3f(core_.voxelOf(other) - voxel);
        const Vec2f a = frame.unfold(chord, other.normal, cosine);
        const float len = length(a), u = valueIn(batch, k) / here.weight + len;
        if (!(u > least && u < s.u && len > 0) ||
            !staysNearPsi(core_.band, core_.footOf(here), -Vec3d(chord), 3, kOff))
            return;
        s.u = u, s.g = (1 / len) * a, s.source = jets_.labelOf(k);
    };
    for (std::size_t k = 0; k < row.knownCount; ++k)
        forLinks(
            core_, row.knownLink(k).node(),
            [&](NodeIndex j, const Ijk&, const Vec3f&, float) { lower(j); },
            [&](NodeIndex j) { return jets_.accepted(j); });
    return s;
}

JetsByWalks JetMarch::jumpsByWalks(NodeIndex i) const {
    // A walk before it is pulled tight; jumps that matter, beside the first.
    constexpr double kLonger = 1.1, kRoom = 0.1, kAround = 1;  // voxels
    const JetNode& node = core_.nodes[i];
    const Vec3d foot = core_.footOf(node);
    const SurfaceTriangles& triangles = *core_.band.triangles;
    JetsByWalks jets(triangles, triangles.nearest(foot, kInfinity, Vec3d(node.normal)),
                     core_.largestCostAt(i));
    struct From {
        double least;  ///< of the node, if the front comes from there
        double chord;
        NodeIndex node;
        bool operator<(const From& o) const {
            return std::tie(least, node) < std::tie(o.least, o.node);
        }
    };
    std::vector<From> from;
    forJumps(core_, i, [&](NodeIndex j, const Vec3f& chord) {
        const double cost = (core_.largestCostAt(i) + core_.largestCostAt(j)) / 2,
                     far = double(length(chord));
        if (jets_.accepted(j)) from.push_back({jets_.valueOf(j) + cost * far, far, j});
    });
    std::sort(from.begin(), from.end());
    double first = kInfinity;
    for (const From& f : from) {
        if (f.least > first + kAround * core_.largestCostAt(i)) break;
        const JetNode& other = core_.nodes[f.node];
        first = std::min(first, jets.add(core_.footOf(other), Vec3d(other.normal),
                                         {jets_.valueOf(f.node), jets_.gradientOf(f.node),
                                          jets_.labelOf(f.node)},
                                         core_.largestCostAt(f.node), kLonger * f.chord + kRoom));
    }
    return jets;
}

JetMarch::Jump JetMarch::jumpTo(NodeIndex i) const {
    Jump jump;
    if (core_.band.triangles && isotropic_) {
        const JetsByWalks jets = jumpsByWalks(i);
        const Vec3d up(core_.nodes[i].normal);
        for (const std::uint32_t source : jets.sources()) {
            const JetsByWalks::First first = jets.first(source);
            const float u = fromStart(first.distance);
            if (!(u < jump.u)) continue;
            const Vec3d face = dot(first.normal, up) < 0 ? -1 * first.normal : first.normal;
            const Vec2f g =
                core_.localFrame(i).frame.flat(Vec3f(turned(first.direction, face, up)));
            jump = {u, length(g) > 0 ? (1 / length(g)) * g : Vec2f{}, source};
        }
        if (jump.u < float(kInfinity)) return jump;
    }
    forJumps(core_, i, [&](NodeIndex j, const Vec3f& chord) {
        if (!jets_.accepted(j)) return;
        const double cost = (core_.largestCostAt(i) + core_.largestCostAt(j)) / 2;
        const float u = fromStart(jets_.valueOf(j) + cost * double(length(chord)));
        if (u < jump.u) jump = {u, {}, jets_.labelOf(j)};
    });
    return jump;
}

void JetMarch::enqueueJumps(NodeIndex from, const Result& jet, const Batch& batch, Chunk& chunk) {
    forJumps(core_, from, [&](NodeIndex j, const Vec3f& chord) {
        if (jets_.accepted(j)) return;
        const double cost = (core_.largestCostAt(from) + core_.largestCostAt(j)) / 2;
        put(j, jet.u + float(cost) * length(chord), batch, chunk);
    });
}

}  // namespace igeo
