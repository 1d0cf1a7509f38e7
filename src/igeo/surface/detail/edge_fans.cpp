#include <igeo/surface/detail/edge_fans.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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

bool isNearSurface(const Band& band, const Vec3d& p) {
    constexpr double kOff = 0.35;  // voxels
    return std::abs(psiAt(band, p)) < kOff;
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

/// A plane of points p with n . p = height.
struct Plane {
    Vec3d n{};
    double height = kInfinity;
};

/// That of a node a step away, seen from where the step begins.
Plane planeAt(const Band& band, NodeIndex j, const Ijk& step) {
    const Vec3d n(band.normal[j]);
    return {n, dot(n, Vec3d(step)) - double(band.psi[j])};
}
bool areSame(const Plane& p, const Plane& q) {
    constexpr double kSame = 1e-3;
    return std::abs(p.height - q.height) < kSame && length(p.n - q.n) < kSame;
}

/// The planes of faces within two voxels, seen from a node; each once. Two nodes beside each other
/// along an axis show the same: on curved parts of S there are none.
class PlanesAround {
public:
    PlanesAround(const Band& band, NodeIndex i) {
        constexpr int kReach = 2, kSide = 2 * kReach + 1;
        std::array<Plane, kMost> shown;
        band.forBox(&BandLeaf::band, i, {}, kReach, [&](NodeIndex j, const Ijk& step) {
            if (!(std::abs(band.psi[j]) < float(kFanEnd))) return;
            const Ijk v = step + Ijk{kReach, kReach, kReach};
            Plane* const here = &shown[std::size_t((v.x * kSide + v.y) * kSide + v.z)];
            *here = planeAt(band, j, step);
            if ((v.z > 0 && areSame(*here, here[-1])) ||
                (v.y > 0 && areSame(*here, here[-kSide])) ||
                (v.x > 0 && areSame(*here, here[-kSide * kSide])))
                add(*here);
        });
    }
    const Plane* begin() const { return planes_.data(); }
    const Plane* end() const { return planes_.data() + count_; }

private:
    static constexpr std::size_t kMost = 125;
    void add(const Plane& plane) {
        if (std::none_of(begin(), end(), [&](const Plane& p) { return areSame(p, plane); }))
            planes_[count_++] = plane;
    }
    std::array<Plane, kMost> planes_;
    std::size_t count_ = 0;
};

/// The edge of two planes on which the nearest point of S to a node lies.
std::optional<FanEdge> edgeOf(const Band& band, NodeIndex i) {
    constexpr double kOff = 0.015, kOnS = 0.25;  // voxels
    // Below this cosine the faces may be those of a wall, whose planes meet anywhere.
    constexpr double kWall = -0.9;
    const double psi = double(band.psi[i]);
    const Vec3d at(band.ijk(i));
    double least = kOff;
    std::optional<FanEdge> found;
    const PlanesAround planes(band, i);
    for (const Plane* first = planes.begin(); first != planes.end(); ++first)
        for (const Plane* second = first + 1; second != planes.end(); ++second) {
            const auto& [a, toA] = *first;
            const auto& [b, toB] = *second;
            const double cosine = dot(a, b), sine2 = 1 - cosine * cosine;
            if (!(cosine < double(Band::kOtherSheet) && cosine > kWall)) continue;
            // The nearest point of their line, from the node.
            const double alongA = (toA - cosine * toB) / sine2,
                         alongB = (toB - cosine * toA) / sine2;
            if (alongA * psi > 0 || alongB * psi > 0) continue;
            const Vec3d r = alongA * a + alongB * b;
            const double off = std::abs(length(r) - std::abs(psi));
            if (!(off < least && std::abs(psiAt(band, at + r)) < kOnS)) continue;
            least = off;
            found = FanEdge{Vec3f(normalized(psi < 0 ? r : -r)), Vec3f(a), Vec3f(b)};
        }
    return found;
}

/// Whether a node shows the same plane as one beside it.
bool isOnFace(const Band& band, NodeIndex i) {
    const Plane own = planeAt(band, i, {});
    for (int face = 0; face < 6; ++face) {
        const Ijk step = Band::faceStep(face);
        const NodeIndex j = band.neighbor(i, step);
        if (j != kNoNode && areSame(planeAt(band, j, step), own)) return true;
    }
    return false;
}

/// Whether a node may be beside an edge of plane faces with which others mix.
bool mayTurn(const Band& band, const FanNode& here) {
    const auto anyBeside = [&](const auto& test) {
        for (int face = 0; face < 6; ++face) {
            const NodeIndex j = band.neighbor(here.node, Band::faceStep(face));
            if (j != kNoNode && test(j)) return true;
        }
        return false;
    };
    return std::abs(here.slope - 1) > kUneven &&
           anyBeside([&](NodeIndex j) { return band.facing[j] & Band::kFacing; }) &&
           anyBeside([&](NodeIndex j) { return isOnFace(band, j); });
}

}  // namespace

std::vector<Link> turnToEdges(Band& band, std::vector<std::vector<FanNode>>& candidates) {
    parallelFor(candidates.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            for (FanNode& here : candidates[l])
                if (mayTurn(band, here)) here.edge = edgeOf(band, here.node);
    });
    const auto forTurned = [&](const auto& visit) {
        for (const auto& part : candidates)
            for (const FanNode& here : part)
                if (here.edge) visit(here);
    };
    forTurned([&](const FanNode& here) { band.normal[here.node] = here.edge->normal; });
    std::vector<Link> leaving;
    forTurned([&](const FanNode& here) {
        const NodeIndex i = here.node;
        band.markFacing(i);
        const Vec3d foot = band.footPoint(i);
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (dot(band.normal[i], band.normal[j]) >= Band::kOtherSheet &&
                !isNearSurface(band, 0.5 * (foot + band.footPoint(j))))
                leaving.emplace_back(i, j);
        });
    });
    return leaving;
}

void addFans(const Band& band, const std::vector<FanNode>& candidates,
             std::vector<NodeIndex>& core) {
    constexpr float kLeastSlope = 0.5f;
    for (const FanNode& here : candidates)
        if ((here.edge || here.slope > kLeastSlope) && mayFan(band, here.node))
            addFan(band, here, core);
}

}  // namespace igeo
