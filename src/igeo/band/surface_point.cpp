#include <igeo/band/surface_point.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// How far from its place in the file a vertex on a face of another part may be (separate), voxels.
constexpr double kOffContact = 1e-4;

struct Nearest {
    NodeIndex node = kNoNode;
    double squared = kInfinity;

    /// @param foot  of node i
    void consider(NodeIndex i, const Vec3d& foot, const Vec3d& p) {
        const Vec3d r = foot - p;
        const double s = dot(r, r);
        if (s < squared || (s == squared && i < node)) squared = s, node = i;
    }
};

Nearest nearestAmongAll(const Band& band, const Vec3d& p) {
    constexpr std::size_t kChunk = 1 << 16;
    std::vector<Nearest> slots((band.size() + kChunk - 1) / kChunk);
    parallelFor(slots.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::size_t i = c * kChunk; i < std::min(band.size(), (c + 1) * kChunk); ++i)
                slots[c].consider(NodeIndex(i), band.footPoint(NodeIndex(i)), p);
    });
    Nearest best;
    for (const Nearest& s : slots)
        // Beyond 1e154 voxels all squares are infinite, and any node will be returned.
        if (s.squared < best.squared || best.node == kNoNode) best = s;
    return best;
}

/// Calls visit(i, foot) for the nodes among the 5^3 voxels around a position, and their foot
/// points.
template <typename Visit>
void forNodesAround(const Band& band, const Vec3d& p, const Visit& visit) {
    const Ijk center = roundToIjk(p), reach{2, 2, 2};
    band.forVoxels(center - reach, center + reach, [&](NodeIndex i, const Ijk& voxel) {
        visit(i, Vec3d(voxel) + Vec3d(band.footOf(i)));
    });
}

/// @param sheetNormal  nodes whose normals oppose it are left out
Nearest nearestAround(const Band& band, const Vec3d& p, const Vec3d& sheetNormal = {}) {
    Nearest best;
    // Positions outside the range of Ijk are far from every voxel.
    if (!hasIjk(p)) return best;
    forNodesAround(band, p, [&](NodeIndex i, const Vec3d& foot) {
        if (dot(Vec3f(sheetNormal), band.normal[i]) >= Band::kOtherSheet) best.consider(i, foot, p);
    });
    // Beyond 1.5 voxels another foot point may be nearer, of a voxel outside the 5^3.
    return best.squared < 1.5 * 1.5 ? best : Nearest{};
}

Nearest nearestNode(const Band& band, const Vec3d& p) {
    Nearest best = nearestAround(band, p);
    if (best.node == kNoNode) best = nearestAmongAll(band, p);
    if (best.node == kNoNode)
        throw Error(Error::Kind::BadInput, "the band is empty: there is no surface to snap to");
    return best;
}

/// The node near a point whose foot point is nearest to it and to the plane of the triangle there.
/// For points where sheets cross or lie close together.
NodeIndex nodeOnSheet(const Band& band, const SurfaceTriangles::Place& at) {
    const Vec3d normal = band.triangles->normal(at.triangle);
    std::vector<std::pair<float, NodeIndex>> nodes;
    forNodesAround(band, at.point, [&](NodeIndex i, const Vec3d& foot) {
        const Vec3d chord = foot - at.point;
        const double rise = dot(chord, normal);
        // The normal of the band may be opposite to that of the triangle.
        const double turn = 1 - std::abs(dot(Vec3d(band.normal[i]), normal));
        nodes.emplace_back(float(dot(chord, chord) + rise * rise + turn), i);
    });
    return firstOnSheet(band, at, nodes);
}

/// The nearest point of the triangles. Where p is a vertex that lies on a face of another part, on
/// one of the vertex's own triangles.
SurfaceTriangles::Place nearestOnMesh(const SurfaceTriangles& triangles, const Vec3d& p) {
    const auto hasVertex = [&](std::uint32_t t) {
        for (unsigned k = 0; k < 3; ++k)
            if (length(triangles.corner(t, k) - p) <= kOffContact) return true;
        return false;
    };
    const SurfaceTriangles::Place nearest = triangles.nearest(p);
    if (nearest.triangle == SurfaceTriangles::kNone || hasVertex(nearest.triangle)) return nearest;
    SurfaceTriangles::Place own;
    triangles.any(p, kOffContact, [&](const SurfaceTriangles::Place& at) {
        if (hasVertex(at.triangle) && at.triangle < own.triangle) own = at;
        return false;
    });
    return own.triangle != SurfaceTriangles::kNone ? own : nearest;
}

/// The point on psi = 0, found from the node with the nearest foot point.
Vec3d onPsi(const Band& band, const Vec3d& pIndex, const Nearest& best) {
    const Vec3d foot = band.footPoint(best.node);
    // Projecting the point itself, where it is near, keeps its tangential position.
    Vec3d p = pIndex;
    // Points farther away are outside the band, and perhaps outside the range of Ijk.
    const bool close = best.squared < 1e6;
    if (close && projectToSurface(band, p) && length(p - pIndex) <= std::sqrt(best.squared) + 1e-3)
        return p;
    // At a corner of a rim, beyond nearly all voxels, the surface goes on in the plane of the
    // nearest one, as far as cells have a corner to read from.
    constexpr double kBeyond = 1.5;   // voxels
    constexpr double kInward = 1e-6;  // a corner may lie on a corner of cells
    if (best.squared < kBeyond * kBeyond && std::isnan(psiAt(band, pIndex))) {
        const Vec3d normal(band.normal[best.node]);
        p = pIndex - dot(pIndex - foot, normal) * normal;
        p += kInward * (foot - p);
        const BandCell cell = cellAt(band, p);
        if (std::any_of(cell.node.begin(), cell.node.end(),
                        [](NodeIndex i) { return i != kNoNode; }))
            return p;
    }
    return ontoSurface(band, foot);
}

}  // namespace

SurfacePoint nearestSurfacePoint(const Band& band, const Vec3d& pIndex) {
    SurfacePoint s;
    s.askedIndex = pIndex;
    Nearest best;
    const auto at =
        band.triangles ? nearestOnMesh(*band.triangles, pIndex) : SurfaceTriangles::Place{};
    if (at.triangle != SurfaceTriangles::kNone) {
        s.pIndex = at.point;
        s.triangle = at.triangle;
        // In a thin plate the nearest foot point may lie on the other face.
        best = nearestAround(band, at.point, band.triangles->normal(at.triangle));
        if (best.node == kNoNode) best = nearestNode(band, at.point);
    } else {
        best = nearestNode(band, pIndex);
        s.pIndex = onPsi(band, pIndex, best);
    }
    s.snapDistance = length(s.pIndex - pIndex);

    // In a thin plate the nearest voxel may belong to the other face.
    s.node = band.nodeAt(roundToIjk(s.pIndex));
    if (s.node == kNoNode || dot(band.normal[s.node], band.normal[best.node]) < Band::kOtherSheet)
        s.node = best.node;
    if (at.triangle != SurfaceTriangles::kNone && band.facing[s.node] & Band::kBesideSevered)
        s.node = nodeOnSheet(band, at);
    return s;
}

namespace {

/// Where p is on a mesh; if on several triangles, then on the one that a segment from p to `end`
/// follows.
SurfaceTriangles::Place placeAlong(const SurfaceTriangles& triangles, const Vec3d& p,
                                   const Vec3d& end) {
    constexpr double kStep = 1e-3;  // voxels
    const SurfaceTriangles::Place nearest = triangles.nearest(p);
    const double l = length(end - p);
    if (!(l > 0)) return nearest;
    const std::uint32_t t = triangles.nearest(p + std::min(kStep / l, 0.5) * (end - p)).triangle;
    const SurfaceTriangles::Place along = triangles.placeOn(t, p);
    return along.squared <= nearest.squared + kOffContact * kOffContact ? along : nearest;
}

}  // namespace

SurfaceTriangles::Place placeOn(const SurfaceTriangles& triangles, const SurfacePoint& seed,
                                const Vec3d& p) {
    if (p == seed.pIndex && seed.triangle != SurfaceTriangles::kNone)
        return triangles.placeOn(seed.triangle, p);
    const Vec3d end = seed.pIndex + seed.segment;
    return placeAlong(triangles, p, length(end - p) < length(seed.pIndex - p) ? seed.pIndex : end);
}

void takeTriangles(const SurfaceTriangles& triangles, SurfacePoint& from, SurfacePoint& to) {
    from.triangle = placeAlong(triangles, from.pIndex, to.pIndex).triangle;
    to.triangle = placeAlong(triangles, to.pIndex, from.pIndex).triangle;
}

std::vector<NodeIndex> nodesAround(const Band& band, const SurfacePoint& p, double radius) {
    std::vector<NodeIndex> found{p.node};
    auto within = [&](NodeIndex i) {
        return i != kNoNode && length(Vec3d(band.ijk(i)) - p.pIndex) <= radius;
    };
    std::vector<NodeIndex> seen{p.node};  // sorted: discs hold a few hundred nodes
    for (std::size_t k = 0; k < found.size(); ++k) {
        for (int face = 0; face < 6; ++face) {
            const NodeIndex j = band.neighbor(found[k], Band::faceStep(face));
            if (!within(j) || !band.linked(found[k], j)) continue;
            const auto at = std::lower_bound(seen.begin(), seen.end(), j);
            if (at != seen.end() && *at == j) continue;
            seen.insert(at, j);
            found.push_back(j);
        }
    }
    return seen;
}

}  // namespace igeo
