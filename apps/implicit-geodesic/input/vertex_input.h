/// Obstacles and weights from grids, or from values per vertex of the mesh.
#pragma once

#include <igeo/io/grid_source.h>
#include <igeo/metric/obstacles.h>
#include <igeo/surface.h>

#include <string>
#include <vector>

/// Adds what FILE[:GRID] blocks; of a file of values per vertex the vertices whose value is not 0,
/// or, as FILE:VALUE, is that (nan: is NaN); of a .annot file the region of FILE:REGION.
/// @return warnings of the file
/// @throws igeo::Error  as the readers and ObstacleSet; BadInput for NaN where it is not named;
///         InvalidArgument for values per vertex of what is no mesh
std::vector<std::string> addObstacle(const igeo::GridSource& source, const igeo::Surface& surface,
                                     igeo::ObstacleSet& obstacles);

/// @throws igeo::Error  BadInput for a file that is for another number of vertices than the mesh
void requireVertices(const std::string& file, std::size_t count, std::size_t ofMesh);

/// Values per vertex as MetricDefinition::vertexWeights.
/// @throws igeo::Error  as readVertexData; BadInput for a weight that is not above 0 and finite;
///         InvalidArgument for what is no mesh
std::vector<double> vertexWeights(const std::string& file, const igeo::Surface& surface);
