#include <igeo/surface/detail/sheet_edges.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace igeo {

namespace {

using Flags = std::vector<std::uint8_t>;
using Neighbors = std::vector<PointTree::Found>;

/// Spacings around a point in which sheets matter to it.
constexpr double kAround = 3;
/// Cosine of the normals of one sheet, or of two that do not cross: 18 degrees.
constexpr double kAlongside = 0.95;

class SheetSeparation {
public:
    SheetSeparation(const SheetFits& fits, double noise)
        : fits_(fits), clean_(fits.normal.size()), taken_(clean_.size()), other_(fits.quadric) {
        // Scatter of a fit is a little less than that of the points.
        constexpr double kClean = 0.03, kNoise = 3;
        const double most = std::max(kClean, kNoise * noise);
        for (std::size_t i = 0; i < clean_.size(); ++i) clean_[i] = fits.misfit[i] <= most;
    }

    /// Gives points whose fits are not clean those of clean ones, from these outward.
    void takeCleanFits();
    /// Signs of normals, by fits that are taken where two sheets meet.
    Orientation orient();
    /// Gives points back their own fits but where two sheets meet.
    /// @return per point: kAtEdge and kBesideEdge
    Flags finish();

private:
    Neighbors around(std::size_t i) const {
        constexpr std::size_t kMost = 64;
        Neighbors found;
        fits_.points.nearest(fits_.points[i], kMost, found, kAround * fits_.spacing[i]);
        return found;
    }
    bool takeCleanFit(std::size_t i, Quadric& fit) const;
    void set(std::size_t i, const Quadric& fit) {
        fits_.quadric[i] = fit;
        fits_.normal[i] = normalized(fit.gradient);
    }
    /// Exchanges the fits that points have taken for their own, or back, but those at edges.
    void exchangeBut(const Flags& atEdge);
    /// Whether another sheet meets that of a point nearby, and all points around are of the two.
    /// @param largest  cosine of their normals
    /// @param eitherSide  normals have no signs yet
    bool isAtEdge(std::size_t i, double largest, bool eitherSide) const;
    /// Whether the sheet of point j, continued, meets that of point i near it.
    bool meet(std::size_t i, std::size_t j) const;
    template <typename Test>
    Flags where(const Test& test) const {
        Flags flags(clean_.size());
        parallelFor(flags.size(), 128, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) flags[i] = test(i);
        });
        return flags;
    }

    const SheetFits& fits_;
    Flags clean_;                 ///< per point: whether its fit misses no points around
    Flags taken_;                 ///< per point: whether it has taken that fit
    std::vector<Quadric> other_;  ///< where a fit is taken: the own one, or while that is used
};

bool SheetSeparation::takeCleanFit(std::size_t i, Quadric& fit) const {
    constexpr double kClose = 0.05;  // spacings
    double least = kClose * fits_.spacing[i];
    bool found = false;
    for (const PointTree::Found& f : around(i)) {
        if (!clean_[f.point]) continue;
        const Vec3d d = fits_.points[i] - fits_.points[f.point];
        const double off = std::abs(fits_.quadric[f.point].at(d));
        if (!(off < least)) continue;
        least = off, found = true;
        fit = fits_.quadric[f.point].movedBy(d);
    }
    return found;
}

void SheetSeparation::takeCleanFits() {
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Quadric> taken(clean_.size());
        const Flags now =
            where([&](std::size_t i) { return !clean_[i] && takeCleanFit(i, taken[i]); });
        bool any = false;
        for (std::size_t i = 0; i < now.size(); ++i)
            if (now[i]) clean_[i] = taken_[i] = 1, set(i, taken[i]), any = true;
        if (!any) return;
    }
}

bool SheetSeparation::meet(std::size_t i, std::size_t j) const {
    constexpr double kWithin = 2;  // spacings
    const Vec3d d = fits_.points[i] - fits_.points[j], slope = fits_.quadric[j].gradientAt(d);
    const double along = length(tangential(slope, fits_.normal[i]));
    return std::abs(fits_.quadric[j].at(d)) < kWithin * fits_.spacing[i] * along &&
           std::abs(dot(normalized(slope), fits_.normal[i])) < kAlongside;
}

bool SheetSeparation::isAtEdge(std::size_t i, double largest, bool eitherSide) const {
    // Each normal around may be off by a part of the angle between the sheets.
    constexpr double kPart = 0.2, kClose = 1.5;
    if (!clean_[i]) return false;
    const Vec3d n = fits_.normal[i];
    const Neighbors near = around(i);
    const double close2 = kClose * fits_.spacing[i] * kClose * fits_.spacing[i];
    const auto isClose = [&](const PointTree::Found& f) { return f.squared < close2; };
    if (std::any_of(near.begin(), near.end(),
                    [&](const PointTree::Found& f) { return isClose(f) && !clean_[f.point]; }))
        return false;
    const auto other = std::find_if(near.begin(), near.end(), [&](const PointTree::Found& f) {
        const double cosine = dot(fits_.normal[f.point], n);
        return clean_[f.point] && (eitherSide ? std::abs(cosine) : cosine) <= largest &&
               meet(i, f.point);
    });
    if (other == near.end()) return false;
    const Vec3d m = fits_.normal[other->point];
    const double cosine = std::clamp(dot(n, m), -1.0, 1.0);
    const double turn = std::acos(eitherSide ? -std::abs(cosine) : cosine);
    const double least = std::cos(kPart * turn);
    return std::none_of(near.begin(), near.end(), [&](const PointTree::Found& f) {
        const Vec3d& k = fits_.normal[f.point];
        return isClose(f) && std::max(std::abs(dot(k, n)), std::abs(dot(k, m))) < least;
    });
}

void SheetSeparation::exchangeBut(const Flags& atEdge) {
    for (std::size_t i = 0; i < taken_.size(); ++i) {
        if (!taken_[i] || atEdge[i]) continue;
        const Quadric from = fits_.quadric[i];
        const bool turned = dot(other_[i].gradient, from.gradient) < 0;
        set(i, turned ? -other_[i] : other_[i]);
        other_[i] = from;
    }
}

Orientation SheetSeparation::orient() {
    const Flags at = where([&](std::size_t i) { return isAtEdge(i, kAlongside, true); });
    exchangeBut(at);
    Orientation found = orientNormals(fits_.points, fits_.normal, at);
    for (std::size_t i = 0; i < at.size(); ++i)
        if (found.sign[i] < 0) set(i, -fits_.quadric[i]);
    exchangeBut(at);
    return found;
}

Flags SheetSeparation::finish() {
    const Flags at = where([&](std::size_t i) { return isAtEdge(i, kSheetsMeet, false); });
    exchangeBut(at);
    Flags flags(at.size());
    auto mark = [&](std::size_t i, std::uint8_t bit) {
        std::atomic_ref(flags[i]).fetch_or(bit, std::memory_order_relaxed);
    };
    parallelFor(at.size(), 128, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!at[i]) continue;
            mark(i, kAtEdge);
            for (const PointTree::Found& f : around(i)) mark(f.point, kBesideEdge);
        }
    });
    return flags;
}

}  // namespace

std::vector<std::uint8_t> separateSheets(const SheetFits& fits, double noise,
                                         Orientation* orientation) {
    SheetSeparation sheets(fits, noise);
    sheets.takeCleanFits();
    if (orientation) *orientation = sheets.orient();
    return sheets.finish();
}

}  // namespace igeo
