#include <igeo/path/detail/sharp_bends.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

using Vertices = std::vector<PathVertex>;

/// A sheet beside an edge: a point of the path on it, the normal there, and the direction of the
/// path toward the edge; zero: not known.
struct SheetEnd {
    Vec3d p, normal, along;
};

/// The sheet at vertex k, continued toward the edge by `arc` as it turns before that vertex.
/// @param step  1 where the edge is behind the vertex, -1 where it is before it
SheetEnd continued(const Band& band, const Vertices& v, std::size_t k, int step, double arc) {
    constexpr double kBack = 2, kAlike = 0.9;  // voxels; cosine of normals
    const std::size_t outermost = step > 0 ? 0 : v.size() - 1;
    const Vec3d n = v[k].normal;
    const NodeIndex i = nearestSurfacePoint(band, v[k].pIndex).node;
    const Vec3d own(band.normal[i]);
    // Psi between voxels may be uneven here.
    auto onSheet = [&](const Vec3d& across) {
        return v[k].pIndex - dot(v[k].pIndex - band.footPoint(i), across) * across;
    };
    if (k == outermost) return {onSheet(own), own, {}};
    // On a quadric the line to another point is normal to the mean of both normals.
    const Vec3d p = dot(n, own) > kAlike ? onSheet(normalized(n + own)) : v[k].pIndex;
    std::size_t from = k;
    while (from != outermost && std::abs(v[from].arcLength - v[k].arcLength) < kBack)
        from -= std::size_t(step);
    const Vec3d turn = (1 / std::abs(v[k].arcLength - v[from].arcLength)) * (n - v[from].normal);
    const Vec3d along = normalized(tangential(p - v[k - std::size_t(step)].pIndex, n));
    const double bend = dot(turn, along);
    return {p + arc * along - (arc * arc / 2 * bend) * n, normalized(n + arc * turn),
            normalized(along - (arc * bend) * n)};
}

/// Two sheets, and the edge where they meet.
class Edge {
public:
    Edge(const SheetEnd& a, const SheetEnd& b)
        : a_(a), b_(b), e_(normalized(cross(a.normal, b.normal))) {
        acrossA_ = cross(a.normal, e_), acrossB_ = cross(b.normal, e_);
        const Vec3d chord = b.p - a.p;
        if (dot(acrossA_ + acrossB_, chord) < 0) acrossA_ = -acrossA_, acrossB_ = -acrossB_;
        fromA_ = dot(b.normal, chord) / dot(b.normal, acrossA_);
        fromB_ = dot(a.normal, chord) / dot(a.normal, acrossB_);
        along_ = dot(chord, e_);
        side_ = dot(a.normal, acrossB_) < 0 ? 1 : -1;
        point_ = a.p + fromA_ * acrossA_ + along_ / 2 * e_;
    }
    bool isBetween() const {
        constexpr double kOff = 0.5;  // voxels
        return std::min(fromA_, fromB_) > -kOff;
    }
    const Vec3d& point() const { return point_; }
    /// The distance of a point from both sheets.
    double psiAt(const Vec3d& p) const {
        const Vec3d r = p - point_;
        if (dot(r, acrossA_) > 0 && dot(r, acrossB_) < 0)
            return side_ * length(r - dot(r, e_) * e_);
        return side_ * std::max(side_ * dot(r, a_.normal), side_ * dot(r, b_.normal));
    }
    /// The geodesic from point to point, with both sheets laid flat.
    SharpBend bend() const {
        const double across = fromA_ + fromB_, straight = std::atan2(along_, across);
        auto angle = [&](const Vec3d& to, const Vec3d& acrossEdge) {
            return to == Vec3d{} ? straight : std::atan2(dot(to, e_), dot(to, acrossEdge));
        };
        SharpBend bend;
        bend.length = std::hypot(across, along_);
        bend.turnBefore = straight - angle(a_.along, acrossA_);
        bend.turnAfter = angle(-b_.along, acrossB_) - straight;
        return bend;
    }

private:
    SheetEnd a_, b_;
    Vec3d e_, acrossA_, acrossB_, point_;
    double fromA_, fromB_, along_, side_;
};

/// The bend over an edge between two vertices; empty where psi shows no such edge.
/// @param middle  arc length at the edge, roughly
SharpBend bendBetween(const Band& band, const Vertices& v, std::size_t first, std::size_t last,
                      double middle) {
    constexpr double kLeast = 0.966, kMost = -0.94;  // cosines of 15 and 160 degrees
    constexpr double kShort = 0.75, kOff = 0.05;     // voxels
    constexpr int kFewest = 4;
    const double before = first > 0 ? middle - v[first].arcLength - kShort : 0,
                 after = last + 1 < v.size() ? v[last].arcLength - middle - kShort : 0;
    const SheetEnd a = continued(band, v, first, 1, before),
                   b = continued(band, v, last, -1, after);
    const double cosine = dot(a.normal, b.normal);
    if (cosine > kLeast || cosine < kMost) return {};
    const Edge edge(a, b);
    if (!edge.isBetween() || !hasIjk(edge.point())) return {};
    const BandCell cell = cellAt(band, edge.point());
    int seen = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeIndex i = cell.node[k];
        if (i == kNoNode) continue;
        if (!(std::abs(double(band.psi[i]) - edge.psiAt(Vec3d(cell.voxel(k)))) < kOff)) return {};
        ++seen;
    }
    if (seen < kFewest) return {};
    SharpBend bend = edge.bend();
    bend.first = first, bend.last = last;
    bend.from = v[first].arcLength + before, bend.to = v[last].arcLength - after;
    return bend;
}

}  // namespace

std::vector<SharpBend> sharpBends(const Band& band, const Path& path) {
    constexpr double kLeastRate = 0.15, kClear = 1.5, kWidest = 5;  // per voxel; voxels
    const Vertices& v = path.vertices;
    auto turns = [&](std::size_t k) {
        return length(v[k].normal - v[k - 1].normal) >
               kLeastRate * (v[k].arcLength - v[k - 1].arcLength);
    };
    std::vector<SharpBend> bends;
    for (std::size_t k = 1; k < v.size(); ++k) {
        if (!turns(k)) continue;
        std::size_t first = k - 1, last = k;
        for (; k < v.size() && v[k - 1].arcLength - v[last].arcLength < kClear; ++k)
            if (turns(k)) last = k;
        k = last;
        const double from = v[first].arcLength, to = v[last].arcLength;
        if (to - from > kWidest) continue;
        while (first > 0 && from - v[first].arcLength < kClear) --first;
        while (last + 1 < v.size() && v[last].arcLength - to < kClear) ++last;
        const SharpBend bend = bendBetween(band, v, first, last, (from + to) / 2);
        if (bend.last > 0) bends.push_back(bend);
    }
    return bends;
}

double lengthOver(const Path& path, const std::vector<SharpBend>& bends) {
    double direction = 0, at = 0, x = 0, y = 0;
    auto go = [&](double length) {
        x += length * std::cos(direction), y += length * std::sin(direction);
    };
    for (const SharpBend& bend : bends) {
        go(bend.from - at);
        direction += bend.turnBefore;
        go(bend.length);
        direction += bend.turnAfter;
        at = bend.to;
    }
    go(path.length - at);
    return std::hypot(x, y);
}

}  // namespace igeo
