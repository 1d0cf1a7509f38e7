/// What igeo_bench does besides timing spheres: the parts of scripts/compare.py that need nothing
/// but the library and OpenVDB. Each prints one line of JSON.
#pragma once

#include <support/arguments.h>

namespace igeo::test {

/// --sdf F --seed x,y,z --method jet|jet-points|godunov1|godunov2|sweep [--threads T]
/// [--points OUT.csv] [--samples N] [--start-radius V] [--bucket-width V]: the stages of a run as
/// the program has them, distances at foot points. Further seeds of `jet` share its links, made in
/// the stage "links". `jet-points` finds values at 1,000 points alone, as a row of a matrix; its
/// links are in the stage "setup".
void benchSolve(const Arguments& args);

/// --sdf F --seed x,y,z --exact IN.csv --image OUT.png [--most P] [--camera x,y,z] [--up x,y,z]:
/// the error of `jet` in % of the largest distance as colors, from 0 (dark) to P or more (pale).
/// IN.csv: exact distances at all points that `solve` writes.
void benchPicture(const Arguments& args);

/// --shape sphere|torus|box --seed x,y,z --points IN.csv --out OUT.csv: exact distances there, on a
/// sphere of radius 0.4, a torus of radii 0.3 and 0.12 and a box of sides 0.606, 0.514, 0.704 about
/// (0.5, 0.5, 0.5).
void benchExact(const Arguments& args);

/// --sdf F --seed x,y,z: the vertex of the extracted mesh that is nearest to the seed.
/// --mesh F --share S: the vertex of a mesh file at a share S in [0, 1) of all.
void benchVertex(const Arguments& args);

/// [--shape sphere|torus|trefoil] [--n N] or --sdf F; [--seeds S] [--parts P,...] [--pieces K,...]:
/// marches from S seeds placed by chance and replays the march over P domains of K pieces each
/// (domains.h), for scripts/scaling.py. A line for each pair of P and K; "buckets" are those that
/// the march went through, "steps" those with values in them, "late" the most nodes that waited at
/// the end of the bucket of their value.
void benchDomains(const Arguments& args);

}  // namespace igeo::test
