#include <igeo/results/voronoi_cells.h>

#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>

#include <algorithm>

namespace igeo {

namespace {

using Corner = std::size_t;  // 0 to 2

/// A triangle with a jet at each corner.
struct Piece {
    std::array<Vec3d, 3> p;
    std::array<double, 3> d{};
    std::array<Vec3d, 3> g;
    std::array<std::uint32_t, 3> label{};

    /// The distance of corner k's seed at a point of the triangle.
    double at(Corner k, const Vec3d& q) const { return d[k] + dot(g[k], q - p[k]); }

    /// The point of the edge from corner i to j that is equally far from both seeds.
    Vec3d crossing(Corner i, Corner j) const {
        double t = 0.5;
        if (label[i] != kNoLabel && label[j] != kNoLabel) {
            // The advantage of i's seed falls from `ahead` to -`behind` along the edge.
            const double ahead = at(j, p[i]) - d[i], behind = at(i, p[j]) - d[j];
            if (ahead > 0 || behind > 0)
                t = std::max(ahead, 0.0) / (std::max(ahead, 0.0) + std::max(behind, 0.0));
        }
        return (1 - t) * p[i] + t * p[j];
    }

    /// The point equally far from three seeds, or, if it is not in the triangle, the mean of the
    /// crossings.
    Vec3d triplePoint(const std::array<Vec3d, 3>& crossings) const {
        const Vec3d middle = (1.0 / 3) * (crossings[0] + crossings[1] + crossings[2]);
        for (const std::uint32_t l : label)
            if (l == kNoLabel) return middle;
        // q = p0 + s u + t v; the advantages of seed 0 over 1 and 2 are linear in s and t.
        const Vec3d u = p[1] - p[0], v = p[2] - p[0], g1 = g[1] - g[0], g2 = g[2] - g[0];
        const double b1 = d[0] - at(1, p[0]), b2 = d[0] - at(2, p[0]);
        const double a11 = dot(g1, u), a12 = dot(g1, v), a21 = dot(g2, u), a22 = dot(g2, v);
        const double det = a11 * a22 - a12 * a21;
        const double s = (b1 * a22 - b2 * a12) / det, t = (a11 * b2 - a21 * b1) / det;
        return s >= 0 && t >= 0 && s + t <= 1 ? p[0] + s * u + t * v : middle;
    }
};

double area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return length(cross(b - a, c - a)) / 2;
}

/// The gradient at a vertex, blended from the nodes around it that have its label.
Vec3d gradientAt(const Field& field, const SurfaceMesh& mesh, std::uint32_t v) {
    const Vec3d n(mesh.normal[v]);
    const SurfaceCell cell(*field.band, *field.metric, mesh.position[v], n);
    Vec3d sum;
    double weight = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex j = cell.node[k];
        if (j == kNoNode || !(field.distance[j] < kInfinity) ||
            (!field.label.empty() && field.label[j] != mesh.label[v]))
            continue;
        sum += cell.weight[k] * Vec3d(field.gradient[j]);
        weight += cell.weight[k];
    }
    return weight > 0 ? tangential(sum * (1 / weight), n) : Vec3d{};
}

/// A point of a triangle and the distance there.
struct CornerSample {
    Vec3d p;
    double d;
};

class Sums {
public:
    Sums(std::size_t seeds, double limit) : limit_(limit) { all_.cells.resize(seeds); }

    /// Adds a triangle of a cell; the part beyond the limit is unreached.
    void add(std::uint32_t label, const CornerSample& a, const CornerSample& b,
             const CornerSample& c) {
        const double whole = area(a.p, b.p, c.p);
        const double part = label == kNoLabel ? 0 : whole * shareWithin({a.d, b.d, c.d});
        if (label != kNoLabel) all_.cells[label].area += part;
        all_.unreachedArea += whole - part;
    }
    /// Adds the part of the boundary of two cells that lies within the limit.
    void addBoundary(std::uint32_t a, std::uint32_t b, const CornerSample& from,
                     const CornerSample& to) {
        if (a == kNoLabel || b == kNoLabel) return;
        const auto [least, most] = std::minmax(from.d, to.d);
        const double share = most <= limit_    ? 1
                             : least >= limit_ ? 0
                                               : (limit_ - least) / (most - least);
        all_.cells[a].boundary += share * length(to.p - from.p);
        all_.cells[b].boundary += share * length(to.p - from.p);
    }
    void addWhole(double area) { all_.area += area; }
    const VoronoiCells& result() const { return all_; }

private:
    /// The share of a triangle within the limit, with distances linear between its corners.
    double shareWithin(std::array<double, 3> d) const {
        std::sort(d.begin(), d.end());
        if (d[2] <= limit_) return 1;
        if (d[0] >= limit_) return 0;
        auto part = [&](double tip, double other) { return (limit_ - tip) / (other - tip); };
        return d[1] <= limit_ ? 1 - part(d[2], d[0]) * part(d[2], d[1])
                              : part(d[0], d[1]) * part(d[0], d[2]);
    }

    const double limit_;
    VoronoiCells all_;
};

/// A triangle with corner `alone` in one cell and the other two in another.
void cutInTwo(const Piece& piece, Corner alone, Sums& sums) {
    const Corner j = (alone + 1) % 3, k = (alone + 2) % 3;
    const Vec3d q = piece.crossing(alone, j), r = piece.crossing(alone, k);
    auto own = [&](const Vec3d& p) { return CornerSample{p, piece.at(alone, p)}; };
    auto other = [&](const Vec3d& p) { return CornerSample{p, piece.at(j, p)}; };
    const CornerSample pj = {piece.p[j], piece.d[j]}, pk = {piece.p[k], piece.d[k]};
    sums.add(piece.label[alone], own(piece.p[alone]), own(q), own(r));
    sums.add(piece.label[j], other(q), pj, pk);
    sums.add(piece.label[j], other(q), pk, other(r));
    sums.addBoundary(piece.label[alone], piece.label[j], own(q), own(r));
}

void cutInThree(const Piece& piece, Sums& sums) {
    std::array<Vec3d, 3> crossings;  // k: on the edge from corner k to k + 1
    for (Corner k = 0; k < 3; ++k) crossings[k] = piece.crossing(k, (k + 1) % 3);
    const Vec3d middle = piece.triplePoint(crossings);
    for (Corner k = 0; k < 3; ++k) {
        auto own = [&](const Vec3d& p) { return CornerSample{p, piece.at(k, p)}; };
        const CornerSample corner = own(piece.p[k]), q = own(middle);
        sums.add(piece.label[k], corner, own(crossings[k]), q);
        sums.add(piece.label[k], corner, q, own(crossings[(k + 2) % 3]));
        sums.addBoundary(piece.label[k], piece.label[(k + 1) % 3], own(crossings[k]), q);
    }
}

/// Extrapolates the distance to corners that the march did not reach, by the jets of the others, so
/// that the triangle can be cut at the limit.
void continueBeyond(double limit, Piece& piece) {
    const Piece known = piece;
    for (Corner i = 0; i < 3; ++i) {
        if (known.label[i] != kNoLabel) continue;
        double least = kInfinity;
        for (Corner k = 0; k < 3; ++k)
            if (known.label[k] != kNoLabel)
                if (const double d = known.at(k, known.p[i]); d < least)
                    least = d, piece.label[i] = known.label[k], piece.g[i] = known.g[k];
        piece.d[i] = least;
        // Unreached for another reason than the limit: an obstacle, or another part of S.
        if (!(least > limit)) piece.label[i] = kNoLabel, piece.d[i] = 0, piece.g[i] = {};
    }
}

void addTriangle(const Field& field, const SurfaceMesh& mesh, const SurfaceMesh::Triangle& v,
                 Sums& sums) {
    Piece piece;
    auto alike = [&] {
        return piece.label[0] == piece.label[1] && piece.label[1] == piece.label[2];
    };
    for (Corner k = 0; k < 3; ++k) {
        piece.p[k] = mesh.position[v[k]];
        piece.label[k] = mesh.label[v[k]];
        if (piece.label[k] != kNoLabel) piece.d[k] = mesh.distance[v[k]];
    }
    sums.addWhole(area(piece.p[0], piece.p[1], piece.p[2]));
    if (!alike()) {
        for (Corner k = 0; k < 3; ++k)
            if (piece.label[k] != kNoLabel) piece.g[k] = gradientAt(field, mesh, v[k]);
        continueBeyond(field.limit, piece);
    }
    const auto& label = piece.label;
    if (alike())
        sums.add(label[0], {piece.p[0], piece.d[0]}, {piece.p[1], piece.d[1]},
                 {piece.p[2], piece.d[2]});
    else if (label[1] == label[2])
        cutInTwo(piece, 0, sums);
    else if (label[2] == label[0])
        cutInTwo(piece, 1, sums);
    else if (label[0] == label[1])
        cutInTwo(piece, 2, sums);
    else
        cutInThree(piece, sums);
}

}  // namespace

VoronoiCells voronoiCells(const Field& field, const SurfaceMesh& mesh, Progress& progress) {
    if (field.sourceCount() > 1 && field.label.empty())
        throw Error(Error::Kind::InvalidArgument,
                    "the distance (" + field.scheme +
                        ") does not know which seed is nearest, so "
                        "there are no cells",
                    "compute it with the scheme jet");
    Sums sums(field.sourceCount(), field.limit);
    Steps steps(progress, "cells", mesh.triangles.size());
    std::size_t done = 0;
    for (const SurfaceMesh::Triangle& v : mesh.triangles) {
        if (++done % 65536 == 0) steps.add(65536), progress.throwIfCancelled();
        addTriangle(field, mesh, v, sums);
    }
    return sums.result();
}

}  // namespace igeo
