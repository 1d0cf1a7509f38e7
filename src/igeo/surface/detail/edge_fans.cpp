#include <igeo/surface/detail/edge_fans.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace igeo {

namespace {

/// Whether the normal turns by 20 degrees to a neighbor along an axis, as in a fan, and near S
/// sheets face each other.
bool mayFan(const Band& band, NodeIndex i) {
    constexpr float kTurn = 0.94f;
    bool turns = false, faces = std::abs(band.psi[i]) >= kBesideFan;
    for (int face = 0; face < 6 && !(turns && faces); ++face) {
        const NodeIndex j = band.neighbor(i, Band::faceStep(face));
        if (j == kNoNode) continue;
        turns |= dot(band.normal[i], band.normal[j]) < kTurn;
        faces |= bool(band.facing[j] & Band::kFacing);
    }
    return turns && faces;
}

/// Two normals around a node of a fan, of one face each, and their cosine.
struct Sides {
    Vec3f a, b;
    float cosine = 1;
    bool oppose() const { return cosine < Band::kOtherSheet; }
};

/// Those at some neighbors: one that is far from the node's own, and the farthest from that. Those
/// of the edge that is known, if both faces are among the neighbors.
Sides sidesAt(const Band& band, const FanNode& here, std::span<const NodeIndex> neighbors) {
    if (!here.edge) {
        auto farthest = [&](const Vec3f& from) {
            Vec3f to = from;
            for (const NodeIndex j : neighbors)
                if (dot(from, band.normal[j]) < dot(from, to)) to = band.normal[j];
            return to;
        };
        const Vec3f a = farthest(band.normal[here.node]), b = farthest(a);
        return {a, b, dot(a, b)};
    }
    constexpr float kOnFace = 0.9f;
    auto hasFace = [&](const Vec3f& n) {
        return std::any_of(neighbors.begin(), neighbors.end(),
                           [&](NodeIndex j) { return dot(n, band.normal[j]) > kOnFace; });
    };
    const auto& [normal, a, b] = *here.edge;
    return {a, b, hasFace(a) && hasFace(b) ? dot(a, b) : 1.0f};
}

void addFan(const Band& band, const FanNode& here, std::vector<NodeIndex>& core) {
    constexpr float kSteeper = 0.1f;
    const NodeIndex i = here.node;
    const bool severed = band.facing[i] & Band::kSevered;
    std::array<NodeIndex, 26> linked;
    std::size_t count = 0;
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        if (std::abs(band.psi[j]) < float(kFanEnd) &&
            dot(band.normal[i], band.normal[j]) >= Band::kOtherSheet &&
            !(severed && band.severed(i, j)))
            linked[count++] = j;
    });
    if (!sidesAt(band, here, {linked.data(), count}).oppose()) return;

    const Vec3d foot = band.footPoint(i);
    if (!isNearSurface(band, foot)) return;
    const NodeIndex* const end =
        std::remove_if(linked.data(), linked.data() + count, [&](NodeIndex j) {
            const Vec3d other = band.footPoint(j);
            return !isNearSurface(band, other) || !isNearSurface(band, 0.5 * (foot + other));
        });
    const std::span<const NodeIndex> joined(linked.data(), end);
    const Sides sides = sidesAt(band, here, joined);
    // Beside a known edge the normals of a face may be mixed.
    const float apart = here.edge ? 0 : Band::kOtherSheet;
    if (!sides.oppose() ||
        !(here.edge || here.slope >= std::sqrt((1 + sides.cosine) / 2) + kSteeper))
        return;
    core.push_back(i);
    for (const NodeIndex j : joined)
        if (std::abs(band.psi[j]) < kBesideFan &&
            std::min(dot(sides.a, band.normal[j]), dot(sides.b, band.normal[j])) < apart)
            core.push_back(j);
}

}  // namespace

void addFans(const Band& band, const std::vector<FanNode>& candidates,
             std::vector<NodeIndex>& core) {
    constexpr float kLeastSlope = 0.5f;
    for (const FanNode& here : candidates)
        if ((here.edge || here.slope > kLeastSlope) && mayFan(band, here.node))
            addFan(band, here, core);
}

}  // namespace igeo
