#include <igeo/straighten.h>

#include <algorithm>

namespace igeo {

namespace {

using Curve = std::vector<Vec3d>;

double lengthOf(const Curve& c) {
    double sum = 0;
    for (std::size_t k = 1; k < c.size(); ++k) sum += length(c[k] - c[k - 1]);
    return sum;
}

/// The curve at `pieces` equal steps of its length, back on S.
Curve resample(const Band& band, const Curve& c, std::size_t pieces) {
    Curve out{c.front()};
    const double step = lengthOf(c) / double(pieces);
    double start = 0;  // arc length at c[k - 1]
    std::size_t k = 1;
    for (std::size_t i = 1; i < pieces; ++i) {
        const double at = step * double(i);
        double piece = length(c[k] - c[k - 1]);
        while (start + piece < at && k + 1 < c.size()) {
            start += piece;
            ++k;
            piece = length(c[k] - c[k - 1]);
        }
        const double t = piece > 0 ? std::clamp((at - start) / piece, 0.0, 1.0) : 0.0;
        Vec3d p = c[k - 1] + t * (c[k] - c[k - 1]);
        projectToSurface(band, p);
        out.push_back(p);
    }
    out.push_back(c.back());
    return out;
}

/// The sideways shifts that cancel the geodesic curvature: -s'' = kappa_g, s = 0 at the ends, by
/// the Thomas algorithm. Curvature of S is left out: the system stays definite, and repeating does
/// the rest.
void shiftSideways(const Band& band, Curve& c) {
    const std::size_t n = c.size();
    if (n < 3) return;
    std::vector<Vec3d> side(n);
    std::vector<double> diagonal(n, 2.0), right(n, 0.0);
    for (std::size_t k = 1; k + 1 < n; ++k) {
        const PsiSample psi = samplePsi(band, c[k]);
        if (!psi.valid) return;
        side[k] = normalized(cross(normalized(psi.gradient), c[k + 1] - c[k - 1]));
        right[k] = dot(c[k + 1] - 2.0 * c[k] + c[k - 1], side[k]);
    }
    for (std::size_t k = 2; k + 1 < n; ++k) {
        const double m = -1 / diagonal[k - 1];
        diagonal[k] += m;
        right[k] -= m * right[k - 1];
    }
    double next = 0;
    for (std::size_t k = n - 2; k > 0; --k) {
        next = (right[k] + next) / diagonal[k];
        // A voxel at a time: the linear picture holds no further.
        const double s = std::clamp(next, -1.0, 1.0);
        Vec3d p = c[k] + s * side[k];
        if (projectToSurface(band, p)) c[k] = p;
    }
}

}  // namespace

void straighten(const Band& band, const Field& field, Path& path) {
    // Shorter is not cheaper where the weight varies.
    if (field.metric->weighted() || path.status != PathStatus::Reached || path.vertices.size() < 3)
        return;
    constexpr int kRounds = 40;
    constexpr double kSettled = 1e-7;
    Curve c;
    for (const PathVertex& v : path.vertices) c.push_back(v.pIndex);
    const auto pieces = std::size_t(std::max(2.0, std::ceil(2 * path.length)));
    c = resample(band, c, pieces);
    double current = lengthOf(c);
    for (int round = 0; round < kRounds; ++round) {
        Curve shorter = c;
        shiftSideways(band, shorter);
        shorter = resample(band, shorter, pieces);
        const double l = lengthOf(shorter);
        if (!(l < current)) break;
        const bool settled = current - l < kSettled * current;
        c = std::move(shorter);
        current = l;
        if (settled) break;
    }
    if (current >= path.length) return;
    const double start = field.seeds[path.seed].start, weight = field.seeds[path.seed].weight;
    path.vertices.clear();
    path.length = 0;
    for (std::size_t k = 0; k < c.size(); ++k) {
        if (k) path.length += length(c[k] - c[k - 1]);
        path.vertices.push_back({c[k], path.length, 0});
    }
    for (PathVertex& v : path.vertices) v.distance = start + weight * (path.length - v.arcLength);
}

}  // namespace igeo
