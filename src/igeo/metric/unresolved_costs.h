/// Where costs change faster along S than a march follows.
#pragma once

#include <igeo/metric/metric.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// The share of the nodes next to S where distances with a tensor may be off by more than 5 %:
///
///     r^2 (turn / 0.3 + bend / 3) > 1,   r the ratio of the costs along the two axes,
///
/// with the angles per voxel by which the cheap axis turns along S, and the normal. A front of such
/// a metric is a needle r times as long as wide, and directions along it err by these angles. The
/// limits are measured, on cylinders and on polar tensors of planes (docs/trials.md, Tensors).
/// @return 0 without tensors
/// Time O(1): looks at 50,000 nodes at most, evenly spread. In parallel.
double shareOfTurningTensors(const Band& band, const Metric& metric);

/// The share of the nodes next to S where the weight changes by more than 40 % per voxel, so that
/// what a cheap strip or a step over the change costs is not known to the voxel. From 8 % of the
/// nodes on, distances were off by 0.3 to 19 % in the mean (docs/trials.md, Weights).
/// @return 0 without weights
/// Time O(1), as above.
double shareOfSteepWeights(const Band& band, const Metric& metric);

/// The share of the nodes next to S that lie inside an obstacle beside a passage narrower than a
/// voxel, which leads on for 1.5 voxels to both sides. In it there may be no node, so that no front
/// passes (docs/trials.md, Obstacles). Passages between obstacles without nodes inside, as thin
/// walls, are not seen.
/// @return 0 without obstacles
/// Time O(n), times the obstacles at their rims. In parallel.
double shareAtNarrowPassages(const Band& band, const Metric& metric);

/// Sentences on costs with which distances may be off: on three or more pages of a mesh that share
/// an edge, one of them without nodes beside it (fronts pass to such pages well only where one cost
/// is everywhere and no obstacle, Band::spine), and on each of the three shares above.
/// @param byJet  whether the scheme is jet
std::vector<std::string> costWarnings(const Band& band, const Metric& metric, bool byJet);

/// These sentences of one band and metric, found when they are first asked for.
class CostWarnings {
public:
    std::vector<std::string> of(const Band& band, const Metric& metric, bool byJet);

private:
    std::mutex mutex_;
    std::optional<std::vector<std::string>> found_;
};

}  // namespace igeo
