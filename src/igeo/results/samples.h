/// The values of jet at the foot points of the core.
#pragma once

#include <igeo/march/field.h>

#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

/// A row per foot point, world units.
struct Samples {
    std::vector<Vec3d> position;
    std::vector<Vec3f> normal;        ///< unit, outward
    std::vector<double> distance;     ///< world units times weight; +infinity: not reached
    std::vector<Vec3f> gradient;      ///< of the distance along the surface; 0: not reached
    std::vector<std::int32_t> label;  ///< the nearest source, from 0; -1: not reached
};

/// The foot points of the core (Band) with the jets solved there, in the order of its nodes:
/// samples on the surface less than a voxel apart, without interpolation. Of linked nodes with the
/// same foot point, as on edges of a mesh, only the first is kept. Distances have the sign of
/// Field::sign.
/// @throws Error  InvalidArgument for a field that is not of marchJet
/// Time O(n), in parallel.
Samples samplesOf(const Field& field);

/// Comma-separated: x,y,z,nx,ny,nz,distance,gx,gy,gz,label; `inf` and -1 where unreached. Reading
/// the numbers gives the same values.
std::string samplesCsv(const Samples& samples);

/// NumPy's archive: position (n, 3), normal (n, 3), distance (n,), gradient (n, 3), float64, and
/// label (n,), int32.
/// @throws Error  InvalidArgument for 4 GiB and more
std::string samplesNpz(const Samples& samples);

/// Binary PLY without faces: x y z and distance (double), nx ny nz, quality (the distance) and gx
/// gy gz (float), label (int). Distance -1 and label -1 where unreached.
std::string samplesPly(const Samples& samples);

}  // namespace igeo
