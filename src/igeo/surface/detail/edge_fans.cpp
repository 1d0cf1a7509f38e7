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

/// Two of the normals at some neighbors of a node: one that is far from its own, and the farthest
/// from that.
struct FarNormals {
    Vec3f a, b;
    float cosine;

    FarNormals(const Band& band, NodeIndex i, std::span<const NodeIndex> neighbors)
        : a(farthest(band, band.normal[i], neighbors)),
          b(farthest(band, a, neighbors)),
          cosine(dot(a, b)) {}
    bool oppose() const { return cosine < Band::kOtherSheet; }

private:
    static Vec3f farthest(const Band& band, const Vec3f& from, std::span<const NodeIndex> nodes) {
        Vec3f to = from;
        for (const NodeIndex j : nodes)
            if (dot(from, band.normal[j]) < dot(from, to)) to = band.normal[j];
        return to;
    }
};

void addFan(const Band& band, const FanNode& here, std::vector<NodeIndex>& core) {
    constexpr float kSteeper = 0.1f;
    constexpr double kOff = 0.35;  // voxels
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
    if (!FarNormals(band, i, {linked.data(), count}).oppose()) return;

    const auto isNearSurface = [&](const Vec3d& p) { return std::abs(psiAt(band, p)) < kOff; };
    const Vec3d foot = band.footPoint(i);
    if (!isNearSurface(foot)) return;
    const NodeIndex* const end =
        std::remove_if(linked.data(), linked.data() + count, [&](NodeIndex j) {
            const Vec3d other = band.footPoint(j);
            return !isNearSurface(other) || !isNearSurface(0.5 * (foot + other));
        });
    const std::span<const NodeIndex> joined(linked.data(), end);
    const FarNormals sides(band, i, joined);
    if (!sides.oppose() || here.slope < std::sqrt((1 + sides.cosine) / 2) + kSteeper) return;
    core.push_back(i);
    for (const NodeIndex j : joined)
        if (std::abs(band.psi[j]) < kBesideFan &&
            std::min(dot(sides.a, band.normal[j]), dot(sides.b, band.normal[j])) <
                Band::kOtherSheet)
            core.push_back(j);
}

}  // namespace

void addFans(const Band& band, const std::vector<FanNode>& candidates,
             std::vector<NodeIndex>& core) {
    for (const FanNode& here : candidates)
        if (mayFan(band, here.node)) addFan(band, here, core);
}

}  // namespace igeo
