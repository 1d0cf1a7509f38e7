/// Surfaces that nobody chose: unions of random balls, tori, capsules and boxes, turned at random.
#pragma once

#include <support/shapes.h>

namespace igeo::test {

/// A union of 3 to 6 parts, each with its middle in or near the one before, about 50 units across.
/// The same on every platform for the same `seed`.
/// @param blend width over which parts run into each other; 0: creases where they meet
/// @return psi is no distance yet: inside, the least of the parts' distances is that to hidden
///         pieces as well, and with a blend psi changes by less than 1 per unit length at the seams
Shape randomUnion(unsigned seed, double blend);

/// Its level set at dx = 1, redistanced with OpenVDB's fast sweeping.
openvdb::FloatGrid::Ptr randomLevelSet(unsigned seed, double blend);

}  // namespace igeo::test
