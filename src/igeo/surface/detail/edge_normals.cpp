#include <igeo/surface/detail/edge_normals.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <array>

namespace igeo {

namespace {

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

}  // namespace igeo
