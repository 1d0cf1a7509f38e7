#include <igeo/path/detail/sheet_fit.h>

#include <algorithm>
#include <utility>

namespace igeo {

namespace {

constexpr double kSheetRadius = 6, kSheetPsi = 1.3, kSheetWidth = 0.5;
constexpr std::size_t kFewestOfSheet = 8;

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The spread of points across the line that fits them best, voxels.
double widthOf(const std::vector<Vec3d>& points, const Vec3d& u, const Vec3d& v) {
    Vec3d mean;
    for (const Vec3d& p : points) mean += p;
    mean *= 1 / double(points.size());
    double uu = 0, uv = 0, vv = 0;
    for (const Vec3d& p : points) {
        const double a = dot(p - mean, u), b = dot(p - mean, v);
        uu += a * a, uv += a * b, vv += b * b;
    }
    const double half = (uu + vv) / 2, root = std::hypot((uu - vv) / 2, uv);
    return std::sqrt(std::max(half - root, 0.0) / double(points.size()));
}

/// Whether central differences of psi mix sheets at a node: their length is not 1.
bool isMixed(const Band& band, NodeIndex i) {
    constexpr double kOff = 0.03;
    Vec3d gradient;
    for (int a = 0; a < 3; ++a) {
        const Ijk step{a == 0, a == 1, a == 2};
        const NodeIndex low = band.neighbor(i, Ijk{} - step), high = band.neighbor(i, step);
        if (low == kNoNode || high == kNoNode) return true;
        gradient[a] = (double(band.psi[high]) - double(band.psi[low])) / 2;
    }
    return std::abs(length(gradient) - 1) > kOff;
}

}  // namespace

std::vector<SheetNode> nodesForSheets(const Band& band, const Vec3d& center) {
    constexpr int kReach = 8, kReach2 = 67;  // foot points, psi and rounding
    std::vector<SheetNode> nodes;
    const Ijk middle = roundToIjk(center);
    for (int x = -kReach; x <= kReach; ++x)
        for (int y = -kReach; y <= kReach; ++y)
            for (int z = -kReach; z <= kReach; ++z) {
                if (x * x + y * y + z * z > kReach2) continue;
                const NodeIndex i = band.nodeAt(middle + Ijk{x, y, z});
                if (i == kNoNode || std::abs(band.psi[i]) > kSheetPsi) continue;
                const Vec3d foot = band.footPoint(i);
                if (length(foot - center) > kSheetRadius) continue;
                nodes.push_back({Vec3d(middle + Ijk{x, y, z}), foot, Vec3d(band.normal[i]),
                                 band.psi[i], isMixed(band, i)});
            }
    return nodes;
}

SheetFit::SheetFit(const std::vector<SheetNode>& nodes, const Vec3d& center, const Vec3d& n,
                   int side)
    : center_(center), up_(n) {
    constexpr double kAlike = 0.9, kSlope = 0.3, kRise = 0.7, kUneven = 0.03;
    along_[0] = anyNormalTo(n);
    along_[1] = cross(n, along_[0]);
    // Another sheet may have the same normal.
    auto isOnSheet = [&](const SheetNode& node) {
        const Vec3d r = node.foot - center;
        return dot(node.normal, n) >= kAlike && std::abs(dot(r, n)) <= kSlope * length(r) + kRise;
    };
    auto collect = [&](bool kinkSide) {
        feet_.clear(), normals_.clear();
        // Beside an edge a node has the normal of a plane, which is off where the sheet is curved.
        for (const SheetNode& node : nodes)
            if (isOnSheet(node) && (!kinkSide || (node.psi * side >= 0 && !node.mixed)))
                feet_.push_back(node.foot), normals_.push_back(node.normal);
        return feet_.size() >= kFewestOfSheet;
    };
    if (!collect(false)) return;
    plane_ = valid_ = findPlane();
    if (valid_ || !collect(true)) return;
    fit();
    while (dropOutliers()) {
        if (feet_.size() < kFewestOfSheet) return;
        fit();
    }
    std::vector<double> heights;
    for (const Vec3d& foot : feet_) heights.push_back(std::abs(height(foot)));
    valid_ = widthOf(feet_, along_[0], along_[1]) >= kSheetWidth && medianOf(heights) < kUneven;
}

/// The plane on which most nodes lie.
bool SheetFit::findPlane() {
    constexpr double kSame = 0.002, kOff = 0.01;  // of normals; voxels
    constexpr double kTimes = 4, kRounding = 1e-5;
    constexpr double kExact = 2e-4, kLeastShare = 0.25, kMostly = 0.5;
    std::vector<std::size_t> most;
    for (std::size_t k = 0; k < feet_.size() && 2 * most.size() <= feet_.size(); ++k) {
        std::vector<std::size_t> alike;
        for (std::size_t i = 0; i < feet_.size(); ++i)
            if (length(normals_[i] - normals_[k]) < kSame &&
                std::abs(dot(feet_[i] - feet_[k], normals_[k])) < kOff)
                alike.push_back(i);
        if (alike.size() > most.size()) most = std::move(alike);
    }
    const double share = double(most.size()) / double(feet_.size());
    if (most.size() < kFewestOfSheet || share < kLeastShare) return false;
    std::vector<Vec3d> feet, normals;
    for (const std::size_t i : most) feet.push_back(feet_[i]), normals.push_back(normals_[i]);
    // Nodes around an edge along the lattice agree as well: their foot points are on the edge.
    if (widthOf(feet, along_[0], along_[1]) < kSheetWidth) return false;
    // Nodes beside the crease are slightly off: the median is not.
    for (int a = 0; a < 3; ++a) {
        std::vector<double> part;
        for (const Vec3d& n : normals) part.push_back(n[a]);
        constant_[a] = medianOf(std::move(part));
    }
    std::vector<double> off;
    for (const Vec3d& n : normals) off.push_back(length(n - constant_));
    const double typical = medianOf(off), limit = std::max(kTimes * typical, kRounding);
    // A part of a curved sheet is flat as well, but not to rounding.
    if (typical > kExact && share < kMostly) return false;
    Vec3d sum;
    for (const Vec3d& n : normals)
        if (length(n - constant_) <= limit) sum += n;
    constant_ = normalized(sum);
    std::vector<double> heights;
    for (const Vec3d& foot : feet) heights.push_back(dot(foot, constant_));
    offset_ = medianOf(std::move(heights));
    return true;
}

/// Least squares, component by component.
void SheetFit::fit() {
    std::array<double, 6> m{};  // of 1, u, v: 11 1u 1v uu uv vv
    std::array<Vec3d, 3> right{};
    for (std::size_t k = 0; k < feet_.size(); ++k) {
        const double u = dot(feet_[k] - center_, along_[0]), v = dot(feet_[k] - center_, along_[1]);
        const std::array<double, 6> more{1, u, v, u * u, u * v, v * v};
        for (std::size_t i = 0; i < 6; ++i) m[i] += more[i];
        right[0] += normals_[k], right[1] += u * normals_[k], right[2] += v * normals_[k];
    }
    // Subtracting the means leaves two equations.
    const double count = m[0], u = m[1] / count, v = m[2] / count;
    const double uu = m[3] - count * u * u, uv = m[4] - count * u * v, vv = m[5] - count * v * v;
    const Vec3d mean = (1 / count) * right[0], a = right[1] - (count * u) * mean,
                b = right[2] - (count * v) * mean;
    const double volume = uu * vv - uv * uv;
    // Foot points on one line do not determine the slope across it.
    slope_ = {};
    if (volume > 0.01 * count * count)
        slope_ = {(1 / volume) * (vv * a - uv * b), (1 / volume) * (uu * b - uv * a)};
    constant_ = mean - u * slope_[0] - v * slope_[1];
}

/// Removes the node with the largest error of the normal, if that is too large: by itself, or
/// beside the errors of most.
bool SheetFit::dropOutliers() {
    constexpr double kOff = 0.05, kTimes = 3, kLeast = 0.002;
    std::vector<double> off;
    for (std::size_t k = 0; k < feet_.size(); ++k)
        off.push_back(length(normals_[k] - normal(feet_[k])));
    double most = std::clamp(kTimes * medianOf(off), kLeast, kOff);
    std::size_t worst = feet_.size();
    for (std::size_t k = 0; k < feet_.size(); ++k)
        if (off[k] > most) most = off[k], worst = k;
    if (worst == feet_.size()) return false;
    feet_.erase(feet_.begin() + std::ptrdiff_t(worst));
    normals_.erase(normals_.begin() + std::ptrdiff_t(worst));
    return true;
}

}  // namespace igeo
