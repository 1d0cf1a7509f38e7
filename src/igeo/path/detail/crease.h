/// Walks over creases of a level set. Internal to the paths.
#pragma once

#include <igeo/path/detail/sheet_fit.h>

#include <optional>
#include <vector>

namespace igeo {

/// Carries a walk on near creases, on the sheets that meet there.
///
/// Voxels round an edge off, and nodes within three voxels of it are disturbed. So within this
/// distance a walk goes on the sheet that the nodes around it show (SheetFit), to the line where
/// this sheet meets another one, and over it at the same angle to the line. A sheet counts where
/// nodes are on it behind the line, and none on the first sheet.
class CreaseWalk {
public:
    /// @param length  of the whole walk
    CreaseWalk(const Band& band, double length) : band_(band), length_(length) {}

    /// Puts the start on its sheet where a crease is near; the velocity is left as it is.
    /// @param asked  where the user puts it
    /// @return whether it was moved
    bool settle(Walker& start, const Vec3d& asked, const Vec3d& direction);

    /// Call it before each step.
    /// @param track  the walk so far; gets the steps near a crease, over one crease at most
    /// @return false where no crease is near, or none that fits: the walk goes on over S as voxels
    ///         show it
    bool advance(std::vector<Walker>& track);

    /// The number of sharp bends of the walk, of 10 degrees or more, that were not unfolded: too
    /// flat for a fit of each sheet, or too close to another. After them its direction is off by
    /// some degrees.
    std::size_t roundedBends(const std::vector<Walker>& track) const;

    /// The number of edges that the walk crossed within about a voxel of a corner, where a small
    /// shift leads to another sheet.
    std::size_t closeCorners() const { return corners_; }

private:
    struct Sheets;
    struct Crossing;

    bool isNearCrease(const Walker& w) const;
    std::optional<Crossing> firstCrossing(const Walker& w, const Sheets& sheets) const;
    Crossing overLine(const Walker& last, const Walker& roughly, const Sheets& sheets,
                      const SheetFit& other, Crossing crossing) const;
    std::vector<Walker> onSheet(const Walker& w, const SheetFit& sheet, double arc) const;

    const Band& band_;
    double length_;
    std::optional<SheetFit> own_;  ///< the sheet of the walk, while a crease is near
    Vec3d without_{kInfinity, kInfinity, kInfinity};  ///< where no other sheet was found
    /// Positions along the walk of bends that were unfolded, and of those that were not
    std::vector<double> seen_, lost_;
    std::size_t corners_ = 0;
};

}  // namespace igeo
