/// What has to hold of every distance, whatever the surface.
#pragma once

#include "random_case.h"

#include <vector>

namespace igeo::test {

/// A property says by how much a case fails to have it, and how much it may: by what the method is
/// good for, on smooth surfaces and on those with creases or with sheets that meet.
struct Property {
    const char* name;
    double (*misfit)(const RandomCase&);
    double smooth, sharp = smooth;  ///< allowed; voxels, or a number of failures
};

/// Beside a crease, or where sheets come within two voxels, distances have no bound in voxels: a
/// start disc is crossed straight, and whether a front passes a gap that the grid does not resolve
/// may hang on a rounding. So what rests on accuracy is measured there and not judged.
constexpr double kMeasured = kInfinity;

/// What one band shows: values, bounds between them, symmetry, paths.
extern const std::vector<Property> kOfOneBand;
/// What stays or changes as is known when something else does: units, place, axes, weights,
/// number of threads.
extern const std::vector<Property> kOfChanges;

}  // namespace igeo::test
