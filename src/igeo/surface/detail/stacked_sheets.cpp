#include <igeo/surface/detail/stacked_sheets.h>

#include <algorithm>
#include <cmath>

namespace igeo {

StackedSheets::Offset StackedSheets::offset(PointTree::Index i, PointTree::Index j) const {
    const Vec3d d = points_[j] - points_[i];
    const double cosine = dot(normal_[i], normal_[j]);
    const double overI = dot(normal_[i], d),
                 overJ = cosine < 0 ? -dot(normal_[j], d) : dot(normal_[j], d);
    const double above = overI * overJ > 0 ? std::min(std::abs(overI), std::abs(overJ)) : 0;
    return {above, std::sqrt(std::max(0.0, dot(d, d) - above * above)), std::abs(cosine)};
}

double StackedSheets::keepOwn(Neighbors& near) const {
    constexpr double kAbove = 1, kSteep = 0.3, kAlike = 0.8;
    // Of neighbors on one sheet: one step, and what scatter may add to it across.
    constexpr double kStep = 1.6, kLevel = 0.75;
    constexpr std::ptrdiff_t kSheet = 6;
    const PointTree::Index own = near.front().point;
    const double least = kAbove * spacing_[own];
    const auto liesAbove = [&](const PointTree::Found& f) {
        if (f.squared < least * least) return false;
        const Offset o = offset(own, f.point);
        return o.cosine > kAlike && o.above > std::max(least, kSteep * o.along);
    };
    // Few points have any.
    if (std::none_of(near.begin(), near.end(), liesAbove)) return kInfinity;
    std::vector<char> isAbove(near.size());
    std::transform(near.begin(), near.end(), isAbove.begin(), liesAbove);
    auto left = std::size_t(std::count(isAbove.begin(), isAbove.end(), 1));

    // From the first over all that belong together.
    std::vector<char> joined(near.size());
    std::vector<std::size_t> front{0};
    joined[0] = 1;
    while (!front.empty() && left > 0) {
        const std::size_t a = front.back();
        front.pop_back();
        for (std::size_t b = 1; b < near.size(); ++b) {
            if (joined[b]) continue;
            const PointTree::Index i = near[a].point, j = near[b].point;
            const double spacing = std::max(spacing_[i], spacing_[j]);
            const Vec3d d = points_[j] - points_[i];
            if (dot(d, d) > kStep * kStep * spacing * spacing ||
                offset(i, j).above > kLevel * spacing)
                continue;
            joined[b] = 1, left -= std::size_t(isAbove[b]);
            front.push_back(b);
        }
    }
    // A few points by themselves are scatter.
    if (left == 0 || std::count(joined.begin(), joined.end(), 1) < kSheet) return kInfinity;
    double nearest = kInfinity;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < near.size(); ++k)
        if (isAbove[k] && !joined[k])
            nearest = std::min(nearest, near[k].squared);
        else
            near[kept++] = near[k];
    near.resize(kept);
    return nearest;
}

}  // namespace igeo
