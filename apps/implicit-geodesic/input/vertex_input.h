/// Obstacles and weights from grids, or from values per vertex of the mesh.
#pragma once

#include <igeo/io/grid_source.h>
#include <igeo/metric/obstacles.h>
#include <igeo/surface.h>

#include <string>
#include <vector>

/// Adds the obstacle FILE[:GRID]. Of a file of values per vertex it blocks the vertices with
/// nonzero values or, as FILE:VALUE, with this value (nan: NaN); of a .annot file the region of
/// FILE:REGION.
/// @return warnings about the file
/// @throws igeo::Error  as the readers and ObstacleSet; BadInput for NaN unless it is the given
///         value; InvalidArgument for values per vertex of a surface that is no mesh
std::vector<std::string> addObstacle(const igeo::GridSource& source, const igeo::Surface& surface,
                                     igeo::ObstacleSet& obstacles);

/// The same as a region of seeds: lines of vertices and lone ones have no width.
std::vector<std::string> addRegion(const igeo::GridSource& source, const igeo::Surface& surface,
                                   igeo::ObstacleSet& region);

/// @throws igeo::Error  BadInput for a file with another number of vertices than the mesh
void requireVertices(const std::string& file, std::size_t count, std::size_t ofMesh);

/// Values per vertex, as MetricDefinition::vertexWeights takes them.
/// @throws igeo::Error  as readVertexData; BadInput for a weight that is not above 0 and finite;
///         InvalidArgument for a surface that is no mesh
std::vector<double> vertexWeights(const std::string& file, const igeo::Surface& surface);
