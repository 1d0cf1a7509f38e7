/// Values of a band as volumes.
#pragma once

#include <igeo/band/band.h>
#include <igeo/march/field.h>
#include <igeo/metric/curvature.h>
#include <igeo/results/color_map.h>
#include <igeo/results/log_map.h>
#include <openvdb/openvdb.h>

#include <string>
#include <vector>

namespace igeo {

/// How many nodes of a band have distances, and how large they are.
struct Extent {
    std::size_t nodes = 0;    ///< of the band, or of its core
    std::size_t reached = 0;  ///< of them
    double maxDistance = 0;   ///< the largest, voxels times weight
};

/// Distances as a grid in world units times weight, negative where Field::sign is.
///
/// Active exactly at the nodes with a finite distance. All else is inactive and holds the largest
/// distance, as does the background, so that sublevel sets stay closed. Class unknown.
/// @param transform that of the level set, so that both grids match bit by bit
/// @param extent  set to the extent of the grid
/// For a field that is not extended, the jets of one leaf at a time are computed and freed.
openvdb::FloatGrid::Ptr distanceGrid(const Field& field, const openvdb::math::Transform& transform,
                                     const std::string& name, Extent* extent = nullptr);

/// Gradients along S (surfaceGradient) as covariant vectors in world space, weight per unit length;
/// active where the distance is known.
openvdb::Vec3SGrid::Ptr gradientGrid(const Field& field, const openvdb::math::Transform& transform,
                                     const std::string& name);

/// The index of the nearest seed; active where the distance is known, background -1. A float grid,
/// which all readers of VDB files support (Python's module in Debian reads no int32).
/// @throws Error  InvalidArgument for more than 2^24 seeds, which float cannot number
openvdb::FloatGrid::Ptr labelGrid(const Field& field, const openvdb::math::Transform& transform,
                                  const std::string& name);

/// The weight at the foot points of the band, inactive in obstacles; background 1.
openvdb::FloatGrid::Ptr weightGrid(const Band& band, const Metric& metric,
                                   const openvdb::math::Transform& transform,
                                   const std::string& name);

/// Curvature at the foot points of the band, per world unit: `<psi>_curvature_mean` (k1 + k2) / 2,
/// `_gaussian` k1 k2 (per unit squared), `_max` k1 and `_min` k2; background 0.
std::vector<openvdb::FloatGrid::Ptr> curvatureGrids(const Band& band, const Curvature& curvature,
                                                    const openvdb::math::Transform& transform,
                                                    const std::string& psi);
/// Colors of the distances in linear light, 0 to 1, for volume renderers: the map over 0 to the
/// largest distance where the distance is known; gray and inactive elsewhere.
openvdb::Vec3SGrid::Ptr colorGrid(const Field& field, const ColorMap& colors,
                                  const openvdb::math::Transform& transform,
                                  const std::string& name);

/// How unreliable results are (SurfaceSurvey::unreliability), active at unreliable nodes: 1 where a
/// bound is just met, larger is worse. Background 0, class unknown.
openvdb::FloatGrid::Ptr unreliableGrid(const Band& band, const std::vector<float>& unreliability,
                                       const openvdb::math::Transform& transform,
                                       const std::string& name);

/// The logarithmic map (u, v, 0), world units times weight, in the axes of LogMap::frames, not in
/// world axes. Active where it is known. Class unknown, vectors invariant.
openvdb::Vec3SGrid::Ptr logMapGrid(const Band& band, const LogMap& map,
                                   const openvdb::math::Transform& transform,
                                   const std::string& name);

}  // namespace igeo
