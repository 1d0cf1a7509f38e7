#include <igeo/surface/level_set_check.h>

#include <fmt/core.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/voxel_size.h>
#include <igeo/surface/detail/grid_similarity.h>
#include <igeo/surface/detail/leaf_block.h>
#include <igeo/surface/detail/level_set_verdicts.h>
#include <igeo/surface/detail/psi_signs.h>
#include <igeo/surface/detail/psi_tally.h>
#include <igeo/surface/detail/renormalization.h>
#include <igeo/surface/detail/union_edges.h>
#include <openvdb/tools/FastSweeping.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;
using Leaf = LeafBlock::Leaf;

/// Makes voxels with |psi| of `from` voxels or more inactive.
void removeStrays(LevelSet& s, double from) {
    const openvdb::FloatGrid::Ptr psi = s.psi->deepCopy();
    LevelSetStats& st = s.stats;
    const double largest = std::exchange(st.halfWidth, 0);
    openvdb::Coord first;
    float value = 0;
    std::vector<Leaf*> leaves;
    psi->tree().getNodes(leaves);
    for (Leaf* leaf : leaves)
        for (auto it = leaf->beginValueOn(); it; ++it) {
            const double voxels = *it / s.transform.dx;
            if (std::abs(voxels) < from) {
                st.halfWidth = std::max(st.halfWidth, std::abs(voxels));
                continue;
            }
            if (st.strayVoxels++ == 0) first = it.getCoord(), value = *it;
            st.negative -= voxels < 0;
            leaf->setValueOff(it.pos(), std::copysign(psi->background(), *it));
        }
    st.activeVoxels -= st.strayVoxels;
    s.psi = psi;
    s.warnings.push_back(fmt::format(
        "{} of {} active voxels hold no distance: |psi| is up to {:.4g} voxels there, and {:.4g} "
        "voxels at most elsewhere; the first is {:g} at index {},{},{}. They are left out; rebuild "
        "the level set from its source",
        st.strayVoxels, st.strayVoxels + st.activeVoxels, largest, st.halfWidth, value, first.x(),
        first.y(), first.z()));
}

/// What is counted in leaves, by all threads. Sums of integers: the order of adding does not
/// matter.
/// @param Counts        adds others of its kind
/// @param add(to, some) adds some leaves to counts
template <typename Counts, typename Add>
Counts sumOver(const std::vector<const Leaf*>& leaves, std::size_t grain, const Add& add) {
    std::vector<std::unique_ptr<Counts>> idle;  // one per thread
    std::mutex mutex;
    parallelFor(leaves.size(), grain, [&](std::size_t begin, std::size_t end) {
        std::unique_ptr<Counts> part;
        {
            const std::lock_guard<std::mutex> lock(mutex);
            if (!idle.empty()) part = std::move(idle.back()), idle.pop_back();
        }
        if (!part) part = std::make_unique<Counts>();
        add(*part, std::span<const Leaf* const>(&leaves[begin], end - begin));
        const std::lock_guard<std::mutex> lock(mutex);
        idle.push_back(std::move(part));
    });
    Counts all;
    for (const std::unique_ptr<Counts>& part : idle) all.add(*part);
    return all;
}

Ijk firstBad(const std::vector<const Leaf*>& leaves) {
    for (const Leaf* leaf : leaves)
        for (auto it = leaf->cbeginValueOn(); it; ++it)
            if (!std::isfinite(*it))
                return {it.getCoord().x(), it.getCoord().y(), it.getCoord().z()};
    return {};
}

/// Finite values first: everything else assumes them.
void measureRange(LevelSet& s) {
    const std::vector<const Leaf*> leaves = leavesOf(*s.psi);
    const auto range = sumOver<PsiRange>(
        leaves, 1024, [&](PsiRange& to, auto some) { to.addLeaves(s.transform.dx, some); });
    LevelSetStats& st = s.stats;
    st.activeVoxels = range.active;
    st.negative = range.negative;
    st.badVoxels = range.bad;
    if (range.bad) st.firstBad = firstBad(leaves);
    st.halfWidth = range.widest / s.transform.dx;
    if (const double from = range.shells.strayFrom(); !st.badVoxels && st.halfWidth >= from)
        removeStrays(s, from);
}

/// An active tile holds one value for 8^3 voxels or more. Far from the surface that is harmless and
/// is switched off; nearer it is no distance, and becomes voxels that the checks will see.
void removeActiveTiles(LevelSet& s) {
    if (!s.psi->tree().hasActiveTiles()) return;
    const openvdb::FloatGrid::Ptr psi = s.psi->deepCopy();
    bool nearSurface = false;
    auto it = psi->tree().beginValueOn();
    it.setMaxDepth(openvdb::FloatTree::ValueOnIter::LEAF_DEPTH - 1);
    for (; it; ++it) {
        if (std::abs(*it) / s.transform.dx < s.stats.halfWidth * (1 - 1e-4))
            nearSurface = true;
        else
            it.setActiveState(false);
    }
    if (nearSurface) psi->tree().voxelizeActiveTiles();
    s.psi = psi;
}

/// The grid, or a copy where somebody else holds it: one that was read for this level set has no
/// other owner.
openvdb::FloatGrid::Ptr toChange(const LevelSet& s) {
    const bool isOurs = s.psi.use_count() == 1 && s.psi->constTreePtr().use_count() == 2;
    return isOurs ? openvdb::ConstPtrCast<openvdb::FloatGrid>(s.psi) : s.psi->deepCopy();
}

/// Gives psi of a surface that is negative on the outside the other sign.
void turnInsideOut(LevelSet& s) {
    if (!isInsideOut(leavesOf(*s.psi))) return;
    const openvdb::FloatGrid::Ptr psi = toChange(s);
    for (auto it = psi->beginValueAll(); it; ++it) it.setValue(-*it);
    psi->tree().root().setBackground(std::abs(psi->background()), false);
    s.psi = psi;
    s.stats.negative = s.stats.activeVoxels - s.stats.negative;
    s.warnings.push_back(
        "psi is negative outside of the surface: its sign was turned, so that normals point out");
}

/// Voxels that differences need on each side of the surface.
constexpr double kLeastWidth = 2;

/// The largest |psi| inside and outside; world units.
struct WidthOfSides {
    float inside = 0, outside = 0;
};
/// The same, or `enough` and more on both sides.
WidthOfSides widthOfSides(const std::vector<const Leaf*>& leaves, double enough) {
    WidthOfSides width;
    for (const Leaf* leaf : leaves) {
        for (auto it = leaf->cbeginValueOn(); it; ++it)
            width.inside = std::max(width.inside, -*it),
            width.outside = std::max(width.outside, *it);
        if (double(std::min(width.inside, width.outside)) >= enough) break;
    }
    return width;
}

/// Active voxels of one side next to the edge of the narrow band, and those of them with a neighbor
/// beyond it.
struct EdgeOfSide {
    std::uint64_t all = 0, ending = 0;
    void add(const EdgeOfSide& o) { all += o.all, ending += o.ending; }
};

/// Where the narrow band is narrower on one side than differences need, that width counts. A side
/// that does not end there is only thin, and as wide as it can be.
void takeNarrowerSide(LevelSet& s) {
    constexpr double kEdge = 0.5;  // voxels: a step leads deeper by 0.57 or more
    const std::vector<const Leaf*> leaves = leavesOf(*s.psi);
    const double dx = s.transform.dx;
    const WidthOfSides width = widthOfSides(leaves, kLeastWidth * dx);
    const bool isInside = width.inside < width.outside;
    const double narrow = std::min(width.inside, width.outside) / dx;
    if (!(narrow < std::min(s.stats.halfWidth, kLeastWidth))) return;
    const auto edge = sumOver<EdgeOfSide>(leaves, 64, [&](EdgeOfSide& to, auto some) {
        const openvdb::FloatGrid::ConstAccessor psi = s.psi->getConstAccessor();
        const auto endsAt = [&](const openvdb::Coord& at) {
            for (int axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    openvdb::Coord beside = at;
                    beside[axis] += step;
                    if (!psi.isValueOn(beside)) return true;
                }
            return false;
        };
        for (const Leaf* leaf : some)
            for (auto it = leaf->cbeginValueOn(); it; ++it) {
                if ((isInside ? -*it : *it) < (narrow - kEdge) * dx) continue;
                ++to.all;
                to.ending += endsAt(it.getCoord());
            }
    });
    if (2 * edge.ending > edge.all) s.stats.halfWidth = narrow;
}

/// Conversions from a mesh may give single voxels in slots of two or three voxels the sign of the
/// inside: they get that of their neighbors.
void turnWrongSigns(LevelSet& s) {
    const std::vector<openvdb::Coord> all = wrongSigns(*s.psi, leavesOf(*s.psi), s.transform.dx);
    if (all.empty()) return;
    const openvdb::FloatGrid::Ptr psi = toChange(s);
    for (const openvdb::Coord& at : all) {
        const float value = psi->tree().getValue(at);
        psi->tree().setValueOnly(at, -value);
        s.stats.negative += value < 0 ? -1 : 1;
    }
    s.psi = psi;
    const openvdb::Coord& first = all.front();
    s.warnings.push_back(fmt::format(
        "voxels in narrow slots or walls with the sign of the other side of the surface: {}, the "
        "first at index {},{},{}; they are turned. Smaller voxels, or the mesh itself, have none",
        all.size(), first.x(), first.y(), first.z()));
}

/// A conversion from a mesh by OpenVDB ends with a step that makes psi too low where S is hollow.
void undoConversion(LevelSet& s) {
    const bool bitsShow = isRenormalized(*s.psi);
    if (!bitsShow && !repeatsValues(*s.psi)) {
        s.stats.halfPrecision = isInHalfPrecision(*s.psi);
        return;
    }
    const openvdb::FloatGrid::Ptr psi = toChange(s);
    const double dx = s.transform.dx;
    const std::optional<Undone> undone =
        bitsShow ? undoRenormalization(*psi, dx) : undoIfEdgesShow(*psi, dx);
    if (!undone) return;
    s.stats.conversionUndone = true;
    s.stats.loweredVoxels = undone->lowered;
    s.stats.negative = undone->negative;
    s.psi = psi;
}

/// LevelSetStats::unresolvedShare.
double unresolvedShare(const PsiTally& all) {
    if (all.nearSurface == 0) return 0;
    const double least = std::sqrt(3.0), measured = double(all.curvature.total());
    const double bent =
        measured > 0 ? 1 - double(all.curvature.countBelow(scaleOfCurvature(1 / least))) / measured
                     : 0;
    // Halfway between two sheets lies one voxel per unit of area, and near each of them are two.
    const double meeting =
        4 * double(all.meeting.countBelow(least / PsiTally::kReachRange)) / double(all.nearSurface);
    return std::min(bent + meeting, 1.0);
}

/// |grad psi| that half of the voxels share, if it is clearly not 1, but near: psi is a distance
/// times that. A fifth of the voxels exceed it. Of a distance these have 1, also where all others
/// have less, at kinks and around balls of two voxels; of noise they have more, but few share it.
/// 1: none is shared.
double sharedSlope(const Histogram& gradient) {
    constexpr double kClear = 0.02, kMost = 0.1, kAlike = 0.015, kMany = 0.5, kExceeded = 0.8;
    const double slope = gradient.quantile(kExceeded) * PsiTally::kGradientRange,
                 off = std::abs(slope - 1);
    if (gradient.total() == 0 || off <= kClear || off > kMost) return 1;
    const double share = gradient.share((1 - kAlike) * slope / PsiTally::kGradientRange,
                                        (1 + kAlike) * slope / PsiTally::kGradientRange);
    return share >= kMany ? slope : 1;
}

struct Measured {
    std::vector<openvdb::Coord> ridges;  ///< voxels where |psi| has a sharp convex kink
    double slope = 1;                    ///< sharedSlope
};

Measured measure(LevelSet& s, Progress& progress) {
    const std::vector<const Leaf*> leaves = leavesOf(*s.psi);
    Steps steps(progress, "check", leaves.size());
    auto all = sumOver<PsiTally>(leaves, 64, [&](PsiTally& to, auto some) {
        if (steps.cancelled()) return;
        to.addLeaves(s.psi->constTree(), s.transform.dx, s.stats.halfWidth, some);
        steps.add(some.size());
    });
    progress.throwIfCancelled();

    LevelSetStats& st = s.stats;
    st.nearSurface = all.nearSurface;
    st.crossingShare = all.nearSurface ? double(all.crossing) / double(all.nearSurface) : 0;
    st.cutVoxels = all.cut;
    st.gradientMedian = all.gradient.total() > 0
                            ? all.gradient.quantile(0.5) * PsiTally::kGradientRange
                            : std::numeric_limits<double>::quiet_NaN();
    st.gradientShare = all.gradient.share((1 - kGradientTolerance) / PsiTally::kGradientRange,
                                          (1 + kGradientTolerance) / PsiTally::kGradientRange);
    st.largestCurvature =
        all.curvature.total() ? curvatureOfScale(all.curvature.quantile(0.95)) : 0;
    // One surface voxel in 200 may lie at a place where sheets meet before it counts.
    const double meeting = all.meeting.valueAfter(all.nearSurface / 200) * PsiTally::kReachRange;
    st.reach = std::min(meeting, st.halfWidth);
    st.unresolvedShare = unresolvedShare(all);
    return {std::move(all.ridges), sharedSlope(all.gradient)};
}

/// Makes a distance of one times a slope.
void divide(LevelSet& s, double slope) {
    const openvdb::FloatGrid::Ptr psi = toChange(s);
    for (auto it = psi->beginValueAll(); it; ++it) it.setValue(float(*it / slope));
    psi->tree().root().setBackground(float(psi->background() / slope), false);
    s.psi = psi;
    s.stats.halfWidth /= slope;
    s.stats.dividedBy = slope;
    s.warnings.push_back(
        fmt::format("psi changes by {:.3g} per unit length, where a distance changes by 1: it was "
                    "divided by {:.3g}. If the voxel size is off by this factor and not psi, all "
                    "lengths are",
                    slope, slope));
}

/// Beside the edges of unions of level sets psi is the lesser of two distances, and none itself.
void measureEdges(LevelSet& s, const std::vector<openvdb::Coord>& ridges) {
    const std::vector<EdgeDistance> all =
        distancesToUnionEdges(*s.psi, ridges, s.stats.halfWidth * s.transform.dx);
    if (all.empty()) return;
    const openvdb::FloatGrid::Ptr psi = toChange(s);
    for (const EdgeDistance& edge : all) psi->tree().setValueOnly(edge.at, edge.distance);
    s.psi = psi;
}

void take(LoadedGrid& loaded, LevelSet& s) {
    s = {};
    s.psi = std::move(loaded.grid);
    s.file = loaded.file;
    s.name = loaded.name;
    s.warnings = loaded.warnings;
    s.transform.dx = 0;
    s.transform = similarityOf(s.psi->transform(), where(s));
    requireVoxelSize(s.transform.dx, fmt::format("grid '{}' of {}", s.name, s.file));
}

}  // namespace

LevelSet checkLevelSet(LoadedGrid loaded, Progress& progress) {
    LevelSet s;
    checkLevelSet(std::move(loaded), s, progress);
    return s;
}

LevelSet describeLevelSet(LoadedGrid made, Progress& progress) {
    LevelSet s;
    take(made, s);
    measureRange(s);
    measure(s, progress);
    return s;
}

void checkLevelSet(LoadedGrid loaded, LevelSet& s, Progress& progress) {
    take(loaded, s);
    if (!loaded.isLevelSetClass)
        s.warnings.push_back(
            "the grid's class is not 'level set': its values are taken as a signed "
            "distance all the same");
    if (s.psi->activeVoxelCount() == 0)
        throw Error(Kind::BadInput, "the grid has no active voxels" + where(s),
                    "a level set needs a narrow band of active voxels around its surface");
    measureRange(s);
    removeActiveTiles(s);
    judgeExtent(s);
    judgeRange(s);
    turnInsideOut(s);
    turnWrongSigns(s);
    undoConversion(s);
    takeNarrowerSide(s);
    if (s.stats.halfWidth < kLeastWidth) widen(s, 3);
    Measured measured = measure(s, progress);
    if (measured.slope != 1) {
        const double median = s.stats.gradientMedian;
        divide(s, measured.slope);
        measured = measure(s, progress);
        s.stats.gradientMedian = median;
    }
    judgeShape(s);
    measureEdges(s, measured.ridges);
}

void widen(LevelSet& s, double halfWidth) {
    // 3 dx / dx is 2.9999998 for some dx.
    constexpr double kRounding = 1e-4;
    if (halfWidth <= s.stats.halfWidth + kRounding) return;
    // Layers grow through faces: along a space diagonal three of them gain sqrt(3) voxels.
    const double missing = halfWidth - s.stats.halfWidth - kRounding;
    const int layers = int(std::ceil(std::sqrt(3.0) * missing));
    s.warnings.push_back(
        fmt::format("the level set is {:.4g} voxels wide on its narrower side and the band needs "
                    "{:.4g}: widened by fast sweeping (first order there)",
                    s.stats.halfWidth, halfWidth));
    s.psi = openvdb::tools::dilateSdf(*s.psi, layers);
    s.stats.halfWidth = halfWidth;
}

}  // namespace igeo
