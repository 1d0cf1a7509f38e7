#include <igeo/path/detail/point_stretch.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace igeo {

namespace {

/// Points beside a place of a path. They fill a disc of two spacings, so places are as far apart.
constexpr std::size_t kBeside = 12;
constexpr double kApart = 2;
/// A point and its neighbors, which give its spacing as in CloudDensity.
constexpr std::size_t kAround = 13;
/// Squared distances in spacings: of all pairs, as farther ones pass over facets; of very near, of
/// near and of far ones.
constexpr double kAll = 1.5, kClosest = 0.0225, kClose = 0.15, kWide = 0.75;
/// Heights of near pairs differ 0.2 to 0.4 times as much as those of far ones where facets are two
/// spacings wide and wider, 1.0 to 1.8 times where points scatter. Of facets as wide as the spacing
/// those of near pairs differ 0.35 to 0.9 times as much, those of very near ones 0.1 to 0.3 times.
constexpr double kShape = 0.5, kNarrow = 0.35;
/// So many very near pairs at least; of these a pair is counted some four times.
constexpr double kLeastClosest = 40, kTimes = 4;
/// Cosine of normals on one sheet.
constexpr double kOneSheet = 0.5;

/// A point over S, index space.
struct PointFoot {
    Vec3d p, q, normal;  ///< the point, its foot point; zero normal: none

    double height() const { return dot(p - q, normal); }
};

PointFoot footUnder(const Band& band, const Vec3d& p) {
    PointFoot foot{p, p, {}};
    if (projectToSurface(band, foot.q)) foot.normal = surfaceNormal(band, foot.q);
    return foot;
}

void addPair(PointStretch& sums, const PointFoot& a, const PointFoot& b, const Vec3d& along,
             double spacing2) {
    const Vec3d apart = b.p - a.p, step = b.q - a.q;
    const double square = dot(step, step), h2 = square / spacing2, cosine = dot(step, along);
    if (!(square > 0) || h2 > kAll) return;
    // 1 + 2 cos(2 a) = 4 cos(a)^2 - 1. Far pairs differ more by chance.
    const double excess = (4 * cosine * cosine / square - 1) * (dot(apart, apart) - square) /
                          (2 * spacing2),
                 weight = 1 / ((h2 + 0.05) * (h2 + 0.05));
    const std::array<double, 3> terms{1, h2, h2 * std::sqrt(h2)};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) sums.matrix[i][j] += weight * terms[i] * terms[j];
        sums.right[i] += weight * terms[i] * excess;
    }
    const double rise = b.height() - a.height();
    const double rise2 = rise * rise / spacing2;
    if (h2 < kClosest) sums.closest.add(rise2, h2);
    if (h2 < kClose) sums.close.add(rise2, h2);
    if (!(h2 > kWide)) return;
    const Vec3d turn = b.normal - a.normal;
    sums.wide.add(rise2, h2);
    sums.turned.add(dot(turn, turn) / h2, h2);
}

}  // namespace

void PointStretch::Pairs::add(double square, double h2) {
    count += 1, squares += square, apart2 += h2;
}

void PointStretch::Pairs::add(const Pairs& pairs, double times) {
    count += times * pairs.count;
    squares += times * pairs.squares;
    apart2 += times * pairs.apart2;
}

void PointStretch::add(const PointStretch& sums, double times) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) matrix[i][j] += times * sums.matrix[i][j];
        right[i] += times * sums.right[i];
    }
    closest.add(sums.closest, times), close.add(sums.close, times);
    wide.add(sums.wide, times), turned.add(sums.turned, times);
}

double PointStretch::stretch() const {
    // Cramer's rule; not a number where the pairs do not determine it.
    const Vec3d x{matrix[0][0], matrix[1][0], matrix[2][0]},
        y{matrix[0][1], matrix[1][1], matrix[2][1]}, z{matrix[0][2], matrix[1][2], matrix[2][2]};
    return dot(x, cross({right[0], right[1], right[2]}, z)) / dot(x, cross(y, z));
}

bool PointStretch::isShape() const {
    constexpr double kErrors = 3;
    const auto below = [&](const Pairs& near, double least, double times) {
        const double byChance = kErrors * std::sqrt(2 * times / near.count);
        return near.count >= least && wide.count > 0 &&
               near.mean() * (1 + byChance) < kShape * wide.mean();
    };
    return below(close, 1, 1) || below(closest, kLeastClosest, kTimes);
}

bool PointStretch::isScatter() const {
    constexpr double kErrors = 2;
    const double byChance = kErrors * std::sqrt(2 * kTimes / closest.count);
    return closest.count >= kLeastClosest && wide.count > 0 &&
           closest.mean() * (1 - byChance) > kShape * wide.mean();
}

bool PointStretch::isNarrow() const {
    return isShape() && closest.count >= kLeastClosest && close.mean() > kNarrow * wide.mean();
}

PointStretch stretchAlong(const Band& band, const Path& path, const FitError& fit) {
    const PointTree& points = *fit.points;
    const double dx = band.transform.dx;
    std::unordered_map<PointTree::Index, PointFoot> feet;
    auto footOf = [&](PointTree::Index i) {
        const auto found = feet.find(i);
        if (found != feet.end()) return found->second;
        const PointFoot foot = footUnder(band, band.transform.indexFromWorld(points[i]));
        feet.emplace(i, foot);
        return foot;
    };
    PointStretch sums;
    std::vector<PointTree::Found> beside, around;
    double next = 0;
    for (std::size_t k = 1; k < path.vertices.size(); ++k) {
        const PathVertex& v = path.vertices[k];
        const Vec3d step = v.pIndex - path.vertices[k - 1].pIndex;
        if (v.arcLength < next || !(dot(step, step) > 0)) continue;
        next = v.arcLength + kApart * fit.spacing;
        points.nearest(band.transform.worldFromIndex(v.pIndex), kBeside, beside);
        for (const PointTree::Found& i : beside) {
            const PointFoot foot = footOf(i.point);
            if (!(dot(foot.normal, v.normal) > kOneSheet)) continue;
            points.nearest(points[i.point], kAround, around);
            const double spacing2 = std::numbers::pi / double(kAround - 1) * around.back().squared;
            for (const PointTree::Found& j : around) {
                // Foot points are hardly farther apart than points.
                if (j.squared > 1.2 * kAll * spacing2) break;
                if (j.point == i.point) continue;
                const PointFoot other = footOf(j.point);
                if (dot(other.normal, v.normal) > kOneSheet)
                    addPair(sums, foot, other, normalized(step), spacing2 / (dx * dx));
            }
        }
    }
    return sums;
}

double stretchShown(const std::vector<PointStretch>& geodesics) {
    constexpr std::size_t kLeast = 8;
    constexpr double kErrors = 2;
    PointStretch all;
    for (const PointStretch& g : geodesics) all.add(g, 1);
    if (geodesics.size() < kLeast || !all.isShape()) return 0;
    if (all.isNarrow()) return all.closest.squares / (2 * all.closest.apart2);
    const double n = double(geodesics.size()), stretch = all.stretch();
    double sum = 0, squares = 0;
    for (const PointStretch& g : geodesics) {
        PointStretch others = all;
        others.add(g, -1);
        const double change = others.stretch() - stretch;
        sum += change, squares += change * change;
    }
    const double variance = (n - 1) / n * (squares - sum * sum / n);
    // Less what chance adds. Also 0 for what is not a number.
    const double shown = stretch - kErrors * kErrors * variance / stretch;
    return stretch > 0 && shown > 0 ? shown : 0;
}

}  // namespace igeo
