#include <igeo/surface/medial_radii.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/parallel.h>
#include <igeo/base/point_tree.h>

#include <algorithm>
#include <cmath>

namespace igeo {

namespace {

/// Cosines of the angle at a ball's center between its two touching points, which is that of the
/// normals there. Above kSmooth (40 degrees) the surface between them counts as smooth. A ball that
/// is not final and touches beyond an edge shows up to twice the edge's angle: below kTwice (80
/// degrees) the surface is not smooth.
constexpr double kSmooth = 0.766, kTwice = 0.174;

/// Cosine of normals below which sheets face each other, as in Band.
constexpr double kFacing = -0.2;

struct MedialBall {
    double radius = kInfinity;
    bool facing = false;
};

/// The ball that touches p, on one side (1) or the other (-1) of its normal.
MedialBall medialBall(const PointTree& tree, const std::vector<Vec3d>& normals, const Vec3d& p,
                      const Vec3d& normal, double side, double largest) {
    // A few steps suffice; the bound stops cycles from rounding.
    constexpr int kSteps = 40;
    // In the middle of a sphere all points are equally near: without a tolerance each query would
    // visit all. Near edges there is none, because the last steps separate smooth from sharp.
    constexpr double kPlay = 0.95, kRounding = 1 - 1e-9;
    thread_local std::vector<PointTree::Found> inside;
    MedialBall sure, now;
    const Vec3d up = side * normal;
    double r = largest;
    for (int step = 0; step < kSteps; ++step) {
        tree.nearest(p + r * up, 1, inside, r * (now.radius == sure.radius ? kPlay : kRounding));
        if (inside.empty()) return now;
        const PointTree::Index q = inside.front().point;
        const Vec3d chord = tree[q] - p;
        const double height = dot(chord, up);
        if (!(height > 0)) return now;
        r = dot(chord, chord) / (2 * height);
        const double cosine = 1 - height / r;
        if (cosine > kSmooth) break;
        now = {r, dot(normal, normals[tree.inputIndex(q)]) < kFacing};
        if (cosine < kTwice) sure = now;
    }
    return sure;
}

}  // namespace

double MedialRadii::quantile(const std::vector<double>& sorted, double share) {
    if (sorted.empty()) return kInfinity;
    return sorted[std::min(sorted.size() - 1, std::size_t(share * double(sorted.size())))];
}

double MedialRadii::shareBelow(const std::vector<double>& sorted, double value) {
    if (sorted.empty()) return 0;
    const auto end = std::lower_bound(sorted.begin(), sorted.end(), value);
    return double(end - sorted.begin()) / double(sorted.size());
}

MedialRadii medialRadii(const std::vector<Vec3d>& points, const std::vector<Vec3d>& normals,
                        std::size_t samples) {
    const std::size_t n = points.size(), asked = std::min(samples, n);
    const PointTree tree(points);
    const double largest = asked > 0 ? length(Box(points).size()) : 0;
    MedialRadii radii;
    radii.radius.assign(asked, kInfinity);
    radii.facing.assign(asked, kInfinity);
    parallelFor(asked, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t i = k * n / asked;
            for (const double side : {1.0, -1.0}) {
                const MedialBall ball =
                    medialBall(tree, normals, points[i], normals[i], side, largest);
                radii.radius[k] = std::min(radii.radius[k], ball.radius);
                if (ball.facing) radii.facing[k] = std::min(radii.facing[k], ball.radius);
            }
        }
    });
    std::sort(radii.radius.begin(), radii.radius.end());
    std::sort(radii.facing.begin(), radii.facing.end());
    return radii;
}

}  // namespace igeo
