/// Where scheme `jet` starts: the start discs around the seeds, in which jets are known.
#pragma once

#include <igeo/march/detail/jet_state.h>

#include <map>

namespace igeo {

/// The jet of a foot point that lies within the start disc of seed k: value and gradient of the
/// straight line to the seed, its chord lengthened to the arc, at the mean cost on it, by
/// Simpson's rule. On a mesh without tensors those of the shortest walk on the triangles.
/// @param foot    the foot point, index space; `local` its chart
/// @return false where it lies outside of the disc, or across a crease from the seed
bool seedNeighborhoodJet(const JetCore& core, const JetSeeds& seeds, std::uint32_t k,
                         const LocalFrame& local, const Vec3d& foot, Solved& s);

/// Whether distances in start discs are lengths of walks. The straight line to a seed may leave the
/// triangles: over bends, and on a face around whose rim the path leads.
inline bool takesWalks(const JetCore& core) { return core.band.triangles && core.stretch.empty(); }

/// A lower bound of a value over a walk: over the chord.
double leastOverWalk(const JetCore& core, const JetSeeds& seeds, std::uint32_t k,
                     const LocalFrame& local, const Vec3d& foot);

/// Whether a front counts that comes to a foot point before its start disc does. Of a curve or a
/// group the seed next to it may lie over an edge, and others lead past that; and the discs of
/// seeds beside folds of a mesh reach beyond those of nearer seeds. A value below the straight line
/// to every seed is that of no front. For one cost in all directions.
/// @param u, disc  values by the front and by the disc
/// @param weight   at the foot point
bool overtakesDisc(const JetCore& core, const JetSeeds& seeds, double u, double disc, double weight,
                   const Vec3d& foot);

using JetsByNode = std::map<NodeIndex, Solved>;

/// Jets of core nodes around the seeds.
struct StartDiscs {
    JetsByNode jets;
    /// On the next face of a level set over an edge, along the straight line over both planes:
    /// paths as long as these exist, so they count where the march finds a longer one. Without
    /// tensors.
    JetsByNode overEdges;
};

/// The start discs of all seeds, each connected to its seed over links of the core; the least value
/// where they overlap, and the earlier seed where they are equal. Sets JetSeeds::largestInDisc.
StartDiscs startDiscs(const JetCore& core, JetSeeds& seeds);

}  // namespace igeo
