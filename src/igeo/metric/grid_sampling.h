/// Metrics from grids: weights and tensors at the foot points of a band.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/io/vdb_read.h>
#include <igeo/metric/metric.h>

#include <vector>

namespace igeo {

/// The weight of every band node: the grid, read trilinearly at the node's foot point and so
/// constant along normals (M&S (10)). Inactive voxels have the background value. The grid may have
/// any linear transform.
/// @throws Error  BadInput, with the first place in node order, the value there and the number of
///         such places: where the weight is not positive and finite, or the grid has no active
///         voxel there and its background is no weight; for a grid without active voxels at the
///         surface, and for a transform that is not linear; Cancelled
/// Time O(n), in parallel.
std::vector<float> sampleWeight(const LoadedGrid& grid, const Band& band,
                                Progress& progress = Progress::none());

/// A lower bound of all values of sampleWeight, on any band: the least active value, and the
/// background if it may be used; 0 where that is not positive. O(active voxels).
double leastWeight(const LoadedGrid& grid);

/// The metric tensor of every band node, in index axes: the components, given in world axes, are
/// read trilinearly at the node's foot point, as by sampleWeight, and turned.
/// @throws Error  BadInput as sampleWeight, where the tensor is not finite or not positive definite
///         (least eigenvalue above 1e-6 of the largest, the resolution of floats); Cancelled
/// Time O(n), in parallel.
std::vector<Tensor> sampleTensor(const TensorGrids& grids, const Band& band,
                                 Progress& progress = Progress::none());

}  // namespace igeo
