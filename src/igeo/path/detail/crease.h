/// Straight on over creases of a level set. Internal to the paths.
#pragma once

#include <igeo/path/detail/walker.h>

#include <vector>

namespace igeo {

/// Looks at a walk for places where it went over a crease, and lays its two sides out flat there.
///
/// Around a crease foot points and normals are those of a rounded edge, over which a walk loses
/// some degrees. So each side is fitted to the nodes that show it alone: those on the inner side of
/// the bend, where psi has a kink and differences keep to one side of it. A normal that is linear
/// along the sheet, and the height by it, are good for planes, cylinders and spheres. The walk then
/// goes over one sheet to where it meets the other, and keeps its angle to the line where they
/// meet.
class CreaseWatch {
public:
    /// @param length  of the whole walk
    CreaseWatch(const Band& band, double length) : band_(band), length_(length) {}

    /// To be called after each step.
    /// @param track  the walk so far; where it has come over a crease, its end is replaced
    /// @return whether it has
    bool unfold(std::vector<Walker>& track);

    /// How many sharp bends of the walk, of 10 degrees or more, were not unfolded: too flat for a
    /// fit of each side, or too near to another. Behind them its direction is off by some degrees.
    std::size_t roundedBends(const std::vector<Walker>& track) const;

private:
    const Band& band_;
    double length_;
    std::vector<double> seen_;  ///< along the walk: bends that were unfolded, or counted below
    std::size_t missed_ = 0;
    std::size_t first_ = 0;  ///< of the walk: what comes before is done
    std::size_t bend_ = 0;   ///< where the walk has turned; 0: nowhere
};

}  // namespace igeo
