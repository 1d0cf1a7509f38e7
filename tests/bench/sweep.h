/// Distances in a band by sweeping, OpenVDB's tools::maskSdf.
#pragma once

#include <igeo/march/field.h>
#include <openvdb/openvdb.h>

namespace igeo::test {

/// The distance within the band from one seed as maskSdf finds it: the first-order equations of
/// `godunov` in sweeps along the axes, in single precision, from exact distances in a ball of
/// `startRadius` voxels around the seed.
class Sweep {
public:
    Sweep(const Band& band, const SurfacePoint& seed, double startRadius);

    /// maskSdf itself; so many iterations of eight sweeps each.
    void run(int iterations);

    /// What it found, in voxels per band node.
    Field field() const;

private:
    const Band& band_;
    SurfacePoint seed_;
    double startRadius_;
    openvdb::FloatGrid start_, swept_;
    openvdb::BoolGrid mask_;
};

}  // namespace igeo::test
