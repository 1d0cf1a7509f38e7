/// Walks over creases of a level set. Internal to the paths.
#pragma once

#include <igeo/path/detail/walker.h>

#include <vector>

namespace igeo {

/// Finds the creases that a walk has crossed, and lays the two sheets flat there.
///
/// Around a crease foot points and normals are those of a rounded edge, which turns a walk by some
/// degrees. So each sheet is fitted to nodes that show only this sheet: those on the inner side of
/// the bend, where psi has a kink and differences stay on one side of it. The fit is a normal with
/// a linear part along the sheet, and the height by it: accurate for planes, cylinders and spheres.
/// The walk then crosses one sheet to the line where the sheets meet, and keeps its angle to this
/// line.
class CreaseWatch {
public:
    /// @param length  of the whole walk
    CreaseWatch(const Band& band, double length) : band_(band), length_(length) {}

    /// Call after each step.
    /// @param track  the walk so far; after a crease, its end is replaced
    /// @return whether it was replaced
    bool unfold(std::vector<Walker>& track);

    /// The number of sharp bends of the walk, of 10 degrees or more, that were not unfolded: too
    /// flat for a fit of each sheet, or too close to another. After them its direction is off by
    /// some degrees.
    std::size_t roundedBends(const std::vector<Walker>& track) const;

private:
    const Band& band_;
    double length_;
    /// Positions along the walk of bends that were unfolded or counted below
    std::vector<double> seen_;
    std::size_t missed_ = 0;
    std::size_t first_ = 0;  ///< of the walk: the part before it is done
    std::size_t bend_ = 0;   ///< where the walk has turned; 0: no turn
};

}  // namespace igeo
