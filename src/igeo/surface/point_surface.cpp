#include <igeo/surface/point_surface.h>

#include <fmt/core.h>
#include <igeo/band/band.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/symmetric_eigen.h>
#include <igeo/surface/detail/orient_normals.h>
#include <igeo/surface/detail/sheet_edges.h>
#include <igeo/surface/detail/stacked_sheets.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

namespace igeo {

namespace {

using Kind = Error::Kind;

constexpr std::size_t kLeastPoints = 16;
/// Neighbors that give the spacing and the first normal: two rings of a square lattice. kRing
/// includes the point itself; it is found once and reused.
constexpr std::size_t kNear = 12, kRing = kNear + 1;
/// Neighbors in a fit: few for exact points, to keep details; more for points with a scatter of
/// `noise` spacings, to average it out.
std::size_t fittedAt(double noise) {
    return std::size_t(std::lround(std::min(double(kNear) + 240 * noise, 96.0)));
}
/// Neighbors among which other sheets are looked for: a third more than are within the reach
/// of a fit in the blend.
constexpr std::size_t kNearby = 40;
/// Reach of a fit in the blend, and of points that support the surface, in spacings: 28 points on
/// average, all of which lie on one side of a line once in ten million cases.
constexpr double kReach = 3;
/// Points with so many times the spacing of those around them, or so many spacings off the surface
/// of their neighbors, are isolated.
constexpr double kIsolated = 3, kStray = 1.5;
/// Points on another sheet within so many spacings may close a fold.
constexpr double kFacing = 3;

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double squared(double x) { return x * x; }

struct Plane {
    Vec3d normal;
    double thickness, breadth;  ///< ratios of the variances: least to middle, middle to largest
};

/// Plane of least squares through points, by their covariance.
Plane planeThrough(const PointTree& points, const std::vector<PointTree::Found>& neighbors,
                   const std::vector<double>& weights) {
    double total = 0;
    Vec3d mean{};
    const Vec3d origin = points[neighbors.front().point];
    for (std::size_t k = 0; k < neighbors.size(); ++k) {
        total += weights[k];
        mean += weights[k] * (points[neighbors[k].point] - origin);
    }
    mean *= 1 / total;
    SymmetricMatrix3 covariance;
    for (std::size_t k = 0; k < neighbors.size(); ++k) {
        const double w = weights[k];
        const Vec3d d = points[neighbors[k].point] - origin - mean;
        covariance.xx += w * d.x * d.x, covariance.yy += w * d.y * d.y;
        covariance.zz += w * d.z * d.z, covariance.xy += w * d.x * d.y;
        covariance.xz += w * d.x * d.z, covariance.yz += w * d.y * d.z;
    }
    const SymmetricEigen3 e = symmetricEigen(covariance);
    auto ratio = [&](double a, double b) { return b > 0 ? std::max(a, 0.0) / b : 0.0; };
    return {normalized(e.vector[0]), ratio(e.value[0], e.value[1]), ratio(e.value[1], e.value[2])};
}

}  // namespace

PointSurface::PointSurface(PointCloud cloud, Progress& progress) : file_(cloud.file) {
    requireUsable(cloud);
    const std::size_t given = cloud.points.size();
    cloud = distinctPoints(cloud);
    density_.duplicates = given - cloud.points.size();
    // First the points far away, which spoil fits; then those off the fits.
    for (int round = 0; round < 3; ++round) {
        if (cloud.points.size() < kLeastPoints)
            throw Error(Kind::BadInput,
                        fmt::format("{}: {} distinct points that belong together are too few, a "
                                    "surface takes {} at least",
                                    file_, cloud.points.size(), kLeastPoints),
                        "give a denser cloud");
        points_ = PointTree(cloud.points);
        measureSpacing();
        if (round > 0) build(cloud, progress);
        const std::vector<char> off = strays();
        if (round == 2) break;
        PointCloud kept{cloud.file, {}, {}};
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (off[i]) continue;
            kept.points.push_back(points_[i]);
            if (!cloud.normals.empty())
                kept.normals.push_back(cloud.normals[points_.inputIndex(i)]);
        }
        const std::size_t lost = points_.size() - kept.points.size();
        density_.isolated += lost;
        if (round == 1 && lost == 0) break;
        cloud = std::move(kept);
    }
    density_.points = points_.size(), density_.spacing = quantile(spacing_, 0.5);
    density_.spacing99 = quantile(spacing_, 0.99);
    density_.hasNormals = !cloud.normals.empty();
    // Of fits to points of two sheets even those with the right sign may disagree.
    const Seams seams = density_.hasNormals ? seamsOf(points_, givenNormals(cloud))
                                            : seamsOf(points_, normals_, atEdge_);
    density_.turned = seams.share, density_.seam = seams.longest;
    density_.largestCurvature = quantile(curvature_, 0.95);
    std::vector<double> reach = spacing_;
    for (double& r : reach) r *= kReach;
    points_.setReach(std::move(reach));
    std::vector<Index>().swap(ring_);
    std::vector<double>().swap(thickness_);
    patches_.resize(points_.size());
    for (std::size_t i = 0; i < patches_.size(); ++i)
        patches_[i] = {points_[i], normals_[i], squared(points_.reach(i)), leastCosine(i),
                       fits_[i]};
    std::vector<Quadric>().swap(fits_);
}

void PointSurface::nearestTo(std::size_t i, std::size_t count,
                             std::vector<PointTree::Found>& found) const {
    if (count > kRing) return points_.nearest(points_[i], count, found);
    found.clear();
    for (std::size_t k = 0; k < count; ++k) {
        const Index j = ring_[kRing * i + k];
        const Vec3d r = points_[i] - points_[j];
        found.push_back({dot(r, r), j});
    }
}

void PointSurface::nearestOnSheet(std::size_t i, std::size_t count, const StackedSheets& sheets,
                                  std::vector<PointTree::Found>& found) const {
    nearestTo(i, count, found);
    if (sheets.keepOwn(found) == kInfinity) return;
    points_.nearest(points_[i], 3 * count, found);
    sheets.keepOwn(found);
    found.resize(std::min(found.size(), count));
}

void PointSurface::measureSpacing() {
    static_assert(kRing <= kLeastPoints);
    spacing_.resize(points_.size());
    ring_.resize(kRing * points_.size());
    const double perRadius = std::sqrt(std::numbers::pi / double(kNear));
    parallelFor(points_.size(), 512, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> neighbors;
        for (std::size_t i = begin; i < end; ++i) {
            points_.nearest(points_[i], kRing, neighbors);
            for (std::size_t k = 0; k < kRing; ++k) ring_[kRing * i + k] = neighbors[k].point;
            spacing_[i] = perRadius * std::sqrt(neighbors.back().squared);
        }
    });
}

std::vector<char> PointSurface::strays() const {
    std::vector<char> off(points_.size());
    parallelFor(points_.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::vector<double> around;
            for (std::size_t k = 0; k < kRing; ++k)
                if (const Index j = ring_[kRing * i + k]; j != i) around.push_back(spacing_[j]);
            const double usual = quantile(around, 0.5);
            off[i] =
                spacing_[i] > kIsolated * usual || (!fits_.empty() && off_[i] > kStray * usual);
        }
    });
    return off;
}

std::vector<Vec3d> PointSurface::givenNormals(const PointCloud& cloud) const {
    std::vector<Vec3d> given(cloud.normals.size());
    for (std::size_t i = 0; i < given.size(); ++i)
        given[i] = normalized(Vec3d(cloud.normals[points_.inputIndex(i)]));
    return given;
}

void PointSurface::build(const PointCloud& cloud, Progress& progress) {
    progress.update("fitting points", 0);
    normals_.clear(), atEdge_.clear();
    const std::vector<Vec3d> given = givenNormals(cloud);
    for (int pass = 0; pass < 2; ++pass) fitNormals(given, kNear);
    orient(given);
    const double noise = measureNoise(progress);
    density_.noise = noise * quantile(spacing_, 0.5);
    const std::size_t count = fittedAt(noise);
    if (count > 2 * kNear) fitNormals(given, count / 2), orient(given);
    const std::vector<double> misfit = fitQuadrics(count, progress);
    const SheetFits fits{points_, spacing_, misfit, fits_, normals_};
    if (given.empty()) {
        Orientation orientation;
        atEdge_ = separateSheets(fits, noise, &orientation);
        density_.pieces = orientation.pieces;
    } else {
        atEdge_ = separateSheets(fits, noise, nullptr);
    }
    density_.fitted = std::min(count, points_.size());
}

double PointSurface::measureNoise(Progress& progress) {
    // The residual of a fit has two parts: scatter, which does not depend on the number of points,
    // and shape that a quadric cannot follow, whose square grows by 3 or more on scans from 24
    // points to 48. That separates the two.
    constexpr std::size_t kCount = 24;
    constexpr double kGrowth = 3;
    const std::size_t n = points_.size();
    std::array<std::vector<double>, 2> relative{std::vector<double>(n), std::vector<double>(n)};
    Steps steps(progress, "fitting points", n, 0, 0.5);
    const StackedSheets sheets(points_, spacing_, normals_);
    parallelFor(n, 128, progress, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> nearest;
        for (std::size_t i = begin; i < end; ++i) {
            points_.nearest(points_[i], 4 * kCount, nearest);
            sheets.keepOwn(nearest);
            for (std::size_t k = 0; k < 2; ++k)
                relative[k][i] = squared(fitAt(i, kCount << k, nearest).scatter / spacing_[i]);
        }
        steps.add(end - begin);
    });
    const double left = kGrowth * quantile(relative[0], 0.5) - quantile(relative[1], 0.5);
    return std::sqrt(std::max(0.0, left / (kGrowth - 1)));
}

std::vector<Vec3d> PointSurface::clearNormals() const {
    // Beside a rim half of the nearest points may be on the sheet above, and the plane through both
    // is upright.
    constexpr double kThick = 0.12;
    std::vector<Vec3d> clear = normals_;
    parallelFor(clear.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!(thickness_[i] > kThick)) continue;
            const auto ring = ring_.begin() + std::ptrdiff_t(kRing * i);
            clear[i] = normals_[*std::min_element(ring, ring + kRing, [&](Index a, Index b) {
                return thickness_[a] < thickness_[b];
            })];
        }
    });
    return clear;
}

void PointSurface::fitNormals(const std::vector<Vec3d>& given, std::size_t count) {
    const std::size_t n = points_.size();
    const bool isFirst = normals_.empty();
    const std::vector<Vec3d> before = clearNormals();
    std::vector<double> breadth(n);
    normals_.resize(n), thickness_.resize(n);
    parallelFor(n, 256, [&](std::size_t begin, std::size_t end) {
        const StackedSheets sheets(points_, spacing_, before);
        std::vector<PointTree::Found> neighbors;
        std::vector<double> weights;
        for (std::size_t i = begin; i < end; ++i) {
            if (isFirst)
                nearestTo(i, count + 1, neighbors);
            else
                nearestOnSheet(i, count + 1, sheets, neighbors);
            const double radius2 = 1.2 * neighbors.back().squared;
            weights.clear();
            for (const PointTree::Found& f : neighbors) {
                // Given normals separate sheets.
                const bool other =
                    !given.empty() && dot(given[i], given[f.point]) < double(kOppositeNormals);
                weights.push_back(other ? 0 : squared(1 - f.squared / radius2));
            }
            const Plane plane = planeThrough(points_, neighbors, weights);
            normals_[i] = plane.normal;
            thickness_[i] = plane.thickness;
            breadth[i] = plane.breadth;
        }
    });
    // Scatter of 0.4 spacings makes a plane 0.2 thick, points throughout a volume 0.5.
    constexpr double kThick = 0.3, kNarrow = 0.01;
    if (quantile(breadth, 0.5) < kNarrow)
        throw Error(Kind::BadInput,
                    file_ + ": the points lie along curves: half of them have neighbors in a line",
                    "thin out points along scan lines, so that neighbors lie all around");
    if (quantile(thickness_, 0.5) > kThick)
        throw Error(Kind::BadInput,
                    file_ +
                        ": the points fill a volume or scatter by more than their spacing; a "
                        "surface is ambiguous",
                    "smooth or thin out the cloud");
}

void PointSurface::orient(const std::vector<Vec3d>& given) {
    const std::size_t n = points_.size();
    Orientation orientation = orientNormals(points_, normals_);
    if (!given.empty()) {
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double cosine = dot(normals_[i], given[i]);
            orientation.sign[i] = cosine < 0 ? -1 : 1;
            wrong += std::abs(cosine) < 0.5;
        }
        density_.conflicts = double(wrong) / double(n);
    }
    density_.pieces = orientation.pieces;
    for (std::size_t i = 0; i < n; ++i) normals_[i] *= double(orientation.sign[i]);
}

double PointSurface::leastCosine(std::size_t j) const {
    return !atEdge_.empty() && atEdge_[j] ? kSheetsMeet : double(kOppositeNormals);
}

PointSurface::PointFit PointSurface::fitAt(std::size_t i, std::size_t count,
                                           const std::vector<PointTree::Found>& nearest) const {
    thread_local std::vector<PointTree::Found> neighbors;
    neighbors.clear();
    for (std::size_t k = 0; k < nearest.size() && neighbors.size() < count; ++k)
        if (sameSheet(nearest[k].point, normals_[i])) neighbors.push_back(nearest[k]);
    const double radius2 = 1.1 * neighbors.back().squared, radius = std::sqrt(radius2);
    PointFit result{};
    result.normal = normals_[i];
    // First over the first plane, then over the resulting tangent plane.
    for (const int round : {0, 1}) {
        QuadricFit fit(result.normal, radius);
        double total = 0, squares = 0;
        for (const PointTree::Found& f : neighbors) {
            const double w = squared(1 - f.squared / radius2);
            fit.add(points_[f.point] - points_[i], w);
            total += w, squares += w * w;
        }
        fit.solve();
        result.normal = fit.normal();
        if (round == 0) continue;
        result.quadric = fit.quadric();
        result.curvature = fit.curvature();
        result.off = std::abs(result.quadric.value) / std::max(1e-3, 1 - fit.ownShare());
        double sum = 0;
        for (const PointTree::Found& f : neighbors)
            sum += squared(1 - f.squared / radius2) *
                   squared(fit.residual(points_[f.point] - points_[i]));
        // Corrects for the six unknowns of the fit.
        const double free = 1 - 6 * squares / (total * total);
        result.residual = std::sqrt(sum / total);
        result.scatter = free > 0.1 ? std::sqrt(sum / total / free) : 0;
    }
    return result;
}

std::vector<double> PointSurface::fitQuadrics(std::size_t count, Progress& progress) {
    const std::size_t n = points_.size();
    fits_.resize(n);
    curvature_.resize(n);
    off_.resize(n);
    std::vector<double> misfit(n);
    std::vector<Vec3d> fitted(n);
    std::atomic<std::size_t> facing{0};
    Steps steps(progress, "fitting points", n, 0.5, 1);
    layered_.assign(n, 0);
    const StackedSheets sheets(points_, spacing_, normals_);
    // Twice as many, in case half of them are on another sheet.
    const std::size_t sought = std::max(2 * count, kNearby);
    parallelFor(n, 128, progress, [&](std::size_t begin, std::size_t end) {
        std::vector<PointTree::Found> nearest;
        for (std::size_t i = begin; i < end; ++i) {
            points_.nearest(points_[i], sought, nearest);
            const double near2 = squared(kFacing * spacing_[i]), above2 = sheets.keepOwn(nearest);
            layered_[i] = above2 < kInfinity;
            facing += above2 < near2 ||
                      std::any_of(nearest.begin(), nearest.end(), [&](const PointTree::Found& f) {
                          return f.squared < near2 && !sameSheet(f.point, normals_[i]);
                      });
            const PointFit fit = fitAt(i, count, nearest);
            fits_[i] = fit.quadric;
            curvature_[i] = fit.curvature;
            off_[i] = fit.off;
            misfit[i] = std::max(fit.residual, fit.off) / spacing_[i];
            fitted[i] = fit.normal;
        }
        steps.add(end - begin);
    });
    density_.facing = double(facing) / double(n);
    normals_ = std::move(fitted);
    return misfit;
}

}  // namespace igeo
