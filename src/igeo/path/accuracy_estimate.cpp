#include <igeo/path/accuracy_estimate.h>

#include <igeo/base/parallel.h>
#include <igeo/path/curve_normals.h>
#include <igeo/path/detail/curve_on_triangles.h>
#include <igeo/path/detail/point_stretch.h>
#include <igeo/path/detail/sharp_bends.h>
#include <igeo/path/straighten.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace igeo {

namespace {

/// A point of a mesh that is no foot point, near one that is: the nearest corner of its triangle,
/// or where that is more than three voxels away, the point nearest to the middle between voxels.
Vec3d besideFoot(const SurfaceTriangles& triangles, const Vec3d& foot) {
    const std::uint32_t t = triangles.nearest(foot).triangle;
    Vec3d best = foot + Vec3d{0.5, 0.5, 0.5};
    double least = 3;
    for (unsigned k = 0; k < 3; ++k)
        if (const Vec3d c = triangles.corner(t, k); length(c - foot) < least)
            best = c, least = length(c - foot);
    return best;
}

double meanOf(const std::vector<double>& values) {
    if (values.empty()) return 0;
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// The mean, in which the two largest values count as the third, unless half their number times
/// the median is more: one or two that are far off add little.
double steadyMeanOf(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    const double most =
        std::max(values[n - std::min<std::size_t>(n, 3)], double(n) / 2 * values[n / 2]);
    for (double& x : values) x = std::min(x, most);
    return meanOf(values);
}

/// How S rounds an edge off. A geodesic over an edge of angle a becomes shorter by a share of a^2,
/// and the turn w = dn/ds of the normal along it shows a: the loss is `perBend` times the integral
/// of |w(s + apart) - w(s)|^2 / 2, in which |w| is `sharpest` at most. At an angle b to the normal
/// of the edge the loss falls with cos b, as that of w does; the curvature along the geodesic falls
/// with cos(b)^2. Scatter alone makes `byScatter` of that per length. Voxels.
struct Rounding {
    double apart, sharpest, perBend, byScatter;
};

/// Voxels round an edge to an arc about 1.1 voxels long, which is 1.1 a^2 / 12 shorter. The
/// integral of w^2 over it is a^2 / 1.1. Distances lose three quarters of that, and less at sharp
/// edges.
constexpr Rounding kByVoxels{3, 1.2, 0.075, 0};

/// A fit to points rounds an edge over its radius r, whatever the voxels: 0.044 r a^2 is lost. The
/// fewer points beyond its unknowns a fit has, the nearer it passes to them, and the less is lost.
/// The normal turns there by up to 1.6 a / r, or what voxels leave of that. A quadric follows slow
/// changes of curvature, so places that are compared are not farther apart than the arc.
Rounding roundingBy(const FitError& fit) {
    const double r = fit.radius, seen = std::hypot(r, 1.8);
    if (!(r > 0)) return kByVoxels;
    return {0.6 * seen, 2.1 / seen, r * seen * fit.freedom / 20,
            160 * fit.heightNoise / std::pow(seen, 5)};
}

/// The share of a length that facets about as wide as the spacing of the points lack on S, where
/// `square` is the mean of k^2 in all directions: facets that lie askew have slopes along a
/// geodesic that does not bend. Facets of width w have heights over S with the variance k^2 w^4 /
/// 720 and make a geodesic longer by k^2 w^2 / 24. Points may show that as scatter: then S is
/// smooth, and points next to each other are on different facets, so they show no stretch. Real
/// scatter is taken for facets up to what facets of 1.2 spacings have.
double lackingOfFacets(const FitError& fit, double square) {
    constexpr double kWidest = 1.2;
    if (!(fit.spacing > 0)) return 0;
    const double s2 = fit.spacing * fit.spacing,
                 scatter2 = fit.heightNoise * std::numbers::pi * fit.radius / (6 * s2);
    return std::min(30 * scatter2 / s2, kWidest * kWidest * square * s2 / 24);
}

/// Integrals along a geodesic, of its normal curvature k and the turn w of the normal.
struct Bending {
    double square = 0;  ///< of k^2
    double uneven = 0;  ///< of |w(s + apart) - w(s)|^2 / 2: none where S is smooth
    double arcs = 0;    ///< by which S is longer than the chords between vertices
};

/// @param path  with normals
/// @param sharp  its bends that do not count
Bending bendingOf(const Path& path, const Rounding& rounding, const std::vector<SharpBend>& sharp) {
    const std::vector<PathVertex>& v = path.vertices;
    std::vector<Vec3d> turn(v.size());
    Bending bending;
    auto next = sharp.begin();
    for (std::size_t k = 1, before = 1; k < v.size(); ++k) {
        const Vec3d step = v[k].pIndex - v[k - 1].pIndex;
        const double squared = dot(step, step), len = std::sqrt(squared);
        if (!(squared > 0)) continue;
        const Vec3d change = v[k].normal - v[k - 1].normal;
        const double bend = dot(change, step) / squared;
        bending.square += bend * bend * len;
        while (next != sharp.end() && next->last < k) ++next;
        if (next != sharp.end() && next->first < k) {
            turn[k] = turn[k - 1];
        } else {
            turn[k] = (1 / std::max(len, length(change) / rounding.sharpest)) * change;
            bending.arcs += bend * bend * squared * len / 24;
        }
        while (v[k].arcLength - v[before].arcLength > rounding.apart) ++before;
        if (before == 1) continue;
        const Vec3d other = turn[k] - turn[before];
        bending.uneven += dot(other, other) / 2 * len;
    }
    return bending;
}

/// What is compared along one geodesic; errors are relative to its length.
struct Sample {
    bool found = false;     ///< a geodesic
    double difference = 0;  ///< of the distance from the length; positive: the distance is longer
    double byScatter = 0;   ///< standard deviation of the length
    double rounded = 0;     ///< of the length, at edges that S shows
    double hidden = 0;      ///< of the length, if facets that S hides are what scatters
    PointStretch stretch;
};

/// By how much the length of a geodesic may be off as S is not the true surface.
void addErrorsOfSurface(const Band& band, Path straight, const FitError& fit, Sample& sample) {
    const double meanOfDeviation = std::sqrt(2 / std::numbers::pi);  // of a normal distribution
    addNormals(band, straight);
    const Rounding rounding = roundingBy(fit);
    const std::vector<SharpBend> sharp = sharpBends(band, straight);
    const Bending bending = bendingOf(straight, rounding, sharp);
    const double len = straight.length;
    sample.difference -= (lengthOver(straight, sharp) + bending.arcs) / len - 1;
    sample.rounded =
        rounding.perBend * std::max(0.0, bending.uneven - rounding.byScatter * len) / len;
    sample.byScatter = meanOfDeviation * std::sqrt(fit.heightNoise * bending.square) / len;
    if (!fit.points) return;
    sample.stretch = stretchAlong(band, straight, fit);
    double square = bending.square / len;
    if (const PointStretch::Pairs& turned = sample.stretch.turned; turned.count > 0)
        square = std::max(square, turned.mean() / (fit.spacing * fit.spacing));
    sample.hidden = lackingOfFacets(fit, square);
}

/// The errors of samples, combined. What S lacks of the true surface shows as edges or as stretch,
/// or may be hidden: the largest counts. A distance that is longer than the length lacks less of it
/// than the length.
/// @param hides  whether S may hide facets
std::vector<double> errorsOf(const std::vector<Sample>& samples, bool hides = true) {
    std::vector<PointStretch> sums;
    PointStretch all;
    for (const Sample& s : samples)
        if (s.found) sums.push_back(s.stretch), all.add(s.stretch, 1);
    const double stretch = stretchShown(sums);
    hides = hides && !all.isScatter();
    std::vector<double> errors;
    for (const Sample& s : samples) {
        if (!s.found) continue;
        const double lacking = std::max({s.rounded, stretch, hides ? s.hidden : 0});
        const double both =
            s.difference > 0 ? std::max(s.difference, lacking) : std::hypot(s.difference, lacking);
        errors.push_back(std::hypot(both, s.byScatter));
    }
    return errors;
}

/// Whether the two largest values are more than 30 % of the sum.
bool fewDecide(std::vector<double> values) {
    if (values.size() < 3) return true;
    std::partial_sort(values.begin(), values.begin() + 2, values.end(), std::greater<>());
    return values[0] + values[1] > 0.3 * double(values.size()) * meanOf(values);
}

/// Nodes spread over what the field reaches, each in the middle or at the beginning of its part.
std::vector<NodeIndex> spread(const Field& field, std::size_t count, bool middle) {
    constexpr std::size_t kMostTried = 1 << 16;
    const std::size_t size = field.band->size();
    std::vector<NodeIndex> reached;
    if (field.reached < field.size()) {
        std::vector<NodeIndex> tried;
        for (std::size_t i = 0; i < size; i += size / kMostTried + 1) tried.push_back(NodeIndex(i));
        std::vector<NodeJet> jets(tried.size());
        field.at(tried, jets.data());
        for (std::size_t k = 0; k < tried.size(); ++k)
            if (jets[k].distance < kInfinity) reached.push_back(tried[k]);
    }
    std::vector<NodeIndex> nodes(count);
    for (std::size_t k = 0; k < count; ++k)
        nodes[k] = reached.empty() ? NodeIndex((2 * k + middle) * size / (2 * count))
                                   : reached[(2 * k + middle) * reached.size() / (2 * count)];
    return nodes;
}

/// A path that is longer than its distance by this share may lead another way.
constexpr double kOtherWay = 1e-3;

/// The error of the geodesic from each node; on a mesh, of every other one from a point beside it.
void takeSamples(const Field& field, const FitError& fit, const std::vector<NodeIndex>& nodes,
                 Progress& progress, std::vector<Sample>& samples) {
    const Band& band = *field.band;
    const bool exact = hasExactCurves(field);
    // Close to a seed the distance is exact by construction, and would lower the estimate. On a
    // surface that ends there, only the farther half is left.
    const double near = std::min(3 * field.startRadius, field.maxDistance / 2);
    const std::size_t before = samples.size();
    samples.resize(before + nodes.size());
    const auto take = [&](const SurfacePoint& from, bool rough) {
        // Straightening forgives coarse steps.
        TraceOptions trace{.maxStep = 2, .tolerance = 0.01};
        trace.rough = rough;
        const Path path = tracePath(field, from, trace);
        Sample sample;
        if (path.status != PathStatus::Reached || path.distance < near) return sample;
        const Path straight = straightened(field, path, progress);
        const double start = field.seeds[path.seed].start;
        sample.found = true;
        sample.difference = (path.distance - start - straight.weightedLength) / path.distance;
        if (!band.triangles) addErrorsOfSurface(band, straight, fit, sample);
        return sample;
    };
    parallelFor(nodes.size(), 1, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            Vec3d p = band.footPoint(nodes[k]);
            if (band.triangles && k % 2 == 1) p = besideFoot(*band.triangles, p);
            const SurfacePoint from = nearestSurfacePoint(band, p);
            Sample& sample = samples[before + k];
            sample = take(from, exact);
            if (!exact || !(sample.difference < -kOtherWay)) continue;
            // A rough path may lead another way than the distance.
            const Sample again = take(from, false);
            if (again.found && again.difference > sample.difference) sample = again;
        }
    });
}

}  // namespace

AccuracyEstimate estimateAccuracy(const Field& field, const FitError& fit, Progress& progress) {
    AccuracyEstimate e;
    if (field.band->size() == 0) return e;
    if (field.solved) e.fallbackShare = double(field.fallbackCount) / double(field.solved);
    const bool exact = hasExactCurves(field);
    const std::size_t count = exact ? 64 : 16;
    std::vector<Sample> samples;
    takeSamples(field, fit, spread(field, count, true), progress, samples);
    // Errors beside corners may be most of the sum: as many samples again find more of them.
    if (exact && fewDecide(errorsOf(samples)))
        takeSamples(field, fit, spread(field, count, false), progress, samples);
    const std::vector<double> error = errorsOf(samples);
    e.samples = error.size();
    // Paths over triangles that lead another way are traced again; elsewhere one or two may remain.
    e.meanError = exact ? meanOf(error) : steadyMeanOf(error);
    e.withoutFacets = exact ? e.meanError : steadyMeanOf(errorsOf(samples, false));
    for (const double x : error) e.largestError = std::max(e.largestError, x);
    return e;
}

}  // namespace igeo
