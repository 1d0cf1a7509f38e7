/// What may be wrong with results: sentences for users, each with a remedy; none where nothing is
/// seen.
#pragma once

#include <igeo/geodesic_solver.h>
#include <igeo/path/accuracy_estimate.h>

#include <string>
#include <vector>

namespace igeo {

/// Of the whole surface: what its voxels do not resolve (unresolvedWarnings), gaps to be joined
/// where there are none, curvature on wide facets (wideFacetWarning) and costs with which distances
/// may be off (costWarnings). Empty until a method of the solver has made its band.
std::vector<std::string> surfaceWarnings(const GeodesicSolver& solver,
                                         Progress& progress = Progress::none());

/// Of a march: seeds that start after the front of another has passed (overrunWarnings), and costs
/// with which distances may be off (costWarnings).
/// @param sources  their names; a missing or empty name is replaced by the number
std::vector<std::string> marchWarnings(const Distance& distance,
                                       const std::vector<std::string>& sources = {});

/// Vertices of the mesh and targets without a distance that triangles join to a seed (LostPoints).
/// Looks at 1000 vertices at most, spread over the file.
std::vector<std::string> lostWarnings(const Distance& distance,
                                      Progress& progress = Progress::none());
/// The same of pairs.
std::vector<std::string> lostWarnings(const GeodesicSolver& solver,
                                      const std::vector<PairDistance>& pairs,
                                      Progress& progress = Progress::none());

/// Of paths from targets: lengths that differ from their distances by two voxels and by 2 %, of
/// godunov 5 %, as one of the two is then wrong; and on voxels, where a path has a vertex per
/// voxel, steps of more than 2.5 voxels. On a mesh paths have long steps over its triangles.
/// @param byJet  whether the scheme is jet
std::vector<std::string> pathWarnings(const Surface& surface, bool byJet,
                                      const std::vector<Polyline>& paths);
/// The same of the paths of pairs.
std::vector<std::string> pathWarnings(const Surface& surface,
                                      const std::vector<PairDistance>& pairs);

/// Of the estimate on points: most of it is facets that may as well be scatter.
std::vector<std::string> estimateWarnings(const AccuracyEstimate& estimate);

/// Of walks (GeodesicSolver::shoot): sharp bends that the voxels round off, and corners passed
/// closely.
std::vector<std::string> walkWarnings(const std::vector<Polyline>& walks);

}  // namespace igeo
