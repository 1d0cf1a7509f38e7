/// Surfaces by chance: unions of random balls, tori, capsules and boxes, turned at random.
#pragma once

#include <support/shapes.h>

#include <random>

namespace igeo::test {

/// Numbers that are the same on every platform for the same seed, which those of the distributions
/// of <random> are not. One per statement: compilers choose the order of arguments.
class Random {
public:
    explicit Random(unsigned seed) : bits_(seed) {}
    double between(double low, double high) { return low + (high - low) * bits_() / 4294967296.0; }
    openvdb::Vec3d direction();

private:
    std::mt19937 bits_;
};

/// A union of 3 to 6 parts, each with its middle in or near the one before, about 50 units across.
/// The same on every platform for the same `seed`.
/// @param blend width over which parts run into each other, and twice the radius of the edges of
///              boxes; 0: creases there
/// @return psi is no distance yet: inside, the least of the parts' distances is that to hidden
///         pieces as well, and with a blend psi changes by less than 1 per unit length at the seams
Shape randomUnion(unsigned seed, double blend);

/// A level set of it, redistanced with OpenVDB's fast sweeping.
openvdb::FloatGrid::Ptr randomLevelSet(unsigned seed, double blend,
                                       const openvdb::math::Transform& transform);

}  // namespace igeo::test
