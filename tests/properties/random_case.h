/// A random surface with random seeds, and the fields from them: what properties are asked of.
#pragma once

#include <igeo/march/field.h>
#include <igeo/surface/level_set.h>
#include <support/field_checks.h>
#include <support/pinned.h>
#include <support/random_surface.h>

#include <vector>

namespace igeo::test {

/// Everything follows from the number, on every platform: even ones have creases where parts meet
/// (boxes have sharp edges in either kind). About 40 to 70 voxels across, anywhere in the world, in
/// units of any size.
struct RandomCase : Pinned {
    explicit RandomCase(unsigned number);

    unsigned number;
    openvdb::FloatGrid::Ptr psi;  ///< as a file has it: the check may change that of `levelSet`
    LevelSet levelSet;
    Band band;
    bool sharp;  ///< creases where parts meet, or sheets within two voxels of each other
    std::vector<SurfacePoint> seeds;  ///< three foot points of the core, on one piece of S
    std::vector<Field> single;        ///< jet, from each seed alone
    Field all;                        ///< jet, from all
    std::vector<Field> godunov;       ///< order 1, from each seed alone
    Field allGodunov;
    FieldChecks marched, everywhere;  ///< the worst over `fields()`
    PathChecks paths;

    /// For what else a property has to choose.
    Random random(unsigned purpose) const { return Random(number * 16 + purpose); }
    /// The least of the single distances.
    double least(const std::vector<Field>& fields, NodeIndex i) const;
    std::vector<const Field*> fields() const { return {&single[0], &single[1], &single[2], &all}; }
};

/// Voxels: the least radius of curvature of what is smooth, 1.8 units at 1.1 units a voxel.
constexpr double kLeastRadius = 1.8 / 1.1;

/// The band that every property is asked of: h = sqrt(3).
Band bandOf(const LevelSet& levelSet);

}  // namespace igeo::test
