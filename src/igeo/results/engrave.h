/// Isolines and paths cut into the surface, for viewers that show only level sets.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/path/trace.h>
#include <igeo/results/isolines.h>
#include <igeo/surface/level_set.h>

#include <vector>

namespace igeo {

/// Half the width of a groove, voxels, that is visible whenever the voxels are.
constexpr double kGrooveRadius = 1.2;
/// Largest half-width of an engraved level set, voxels: the work grows with its square.
constexpr double kEngravedWidth = 10;

/// The level set with a groove along every line and path: S minus round tubes around them
/// (OpenVDB's csgDifference, psi' = max(psi, radius - distance to the line)).
///
/// That maximum is the exact distance inside S and a lower bound outside, so the result is a level
/// set of the same half-width, at most kEngravedWidth, without redistancing. Farther than radius +
/// half-width from all lines it has the values of psi bit by bit. The groove cuts through walls
/// thinner than the radius.
/// @param radius depth and half the width of the grooves, voxels
/// @return a grid of class level set with psi's transform, named <psi>_engraved
/// @throws Error  InvalidArgument unless 0.5 <= radius <= 10; Cancelled through `progress`
/// Time O(length of the lines (radius + half-width)^2 + active voxels).
openvdb::FloatGrid::Ptr engraved(const LevelSet& levelSet, const std::vector<Isoline>& lines,
                                 const std::vector<Path>& paths, double radius = kGrooveRadius,
                                 Progress& progress = Progress::none());

}  // namespace igeo
