/// Reading VDB files, and choosing a grid.
#pragma once

#include <igeo/io/grid_source.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// A scalar grid as read, before any check of its values.
struct LoadedGrid {
    openvdb::FloatGrid::ConstPtr grid;
    std::string file;  ///< as given, for messages
    std::string name;  ///< unique in the file: the second of two grids `psi` is `psi[1]`
    bool isLevelSetClass = false;            ///< by the file's metadata
    std::vector<std::string> warnings = {};  ///< about the file, one sentence each
};

/// The metadata of a grid in a file.
struct GridEntry {
    std::string name;       ///< unique in the file, as in LoadedGrid
    std::string type;       ///< of its values: float, vec3s, mask, ...; "unknown type ..."
    std::string gridClass;  ///< as OpenVDB names it: level set, fog volume, unknown, ...
    std::optional<std::uint64_t> activeVoxels;  ///< none if the file does not say
    bool surface, weight, obstacle;             ///< uses that its type and class allow
};

/// Reads one scalar grid: the named one, else the only one of class level set, else the only float
/// or double grid of class unknown. Float, double (rounded to float) and half floats, half grids
/// where OpenVDB has them (13); any file format that OpenVDB reads, with a warning for a newer one.
/// Other grids of the file may have types unknown to OpenVDB.
/// @throws Error  Io when the file cannot be opened; BadInput when it is not a VDB file, is cut
///         off, holds no such grid, none that fits or several (the message lists them), or when the
///         grid is a fog volume or no scalar
/// @param entries receives all grids of the file, in its order, even if none is usable; null: not
///                needed
LoadedGrid readLevelSetGrid(const GridSource& source, std::vector<GridEntry>* entries = nullptr);

/// Reads one scalar grid of any class, for a weight: the named one, else the only float or double
/// grid that is no level set (a weight may be in the file of its surface), else the only one.
/// @throws Error  as readLevelSetGrid, but for the fog volume
LoadedGrid readScalarGrid(const GridSource& source);

/// A grid of the parts of space that no path may enter.
struct ObstacleGrid {
    openvdb::GridBase::Ptr grid;  ///< a BoolGrid, MaskGrid or FloatGrid
    std::string file, name;       ///< as in LoadedGrid
    std::vector<std::string> warnings = {};
};

/// Reads one grid of bool, mask, float or double (rounded to float), chosen as by readScalarGrid.
/// @throws Error  as readScalarGrid
ObstacleGrid readObstacleGrid(const GridSource& source);

/// The components of a symmetric tensor in world axes, as read.
struct TensorGrids {
    openvdb::Vec3SGrid::Ptr diagonal;     ///< xx, yy, zz
    openvdb::Vec3SGrid::Ptr offdiagonal;  ///< xy, xz, yz; null: zero everywhere
    std::string file, name;               ///< as in LoadedGrid; the name is that of `diagonal`
    std::vector<std::string> warnings = {};
};

/// Reads the grids named GRIDdiagonal and, if there is one, GRIDoffdiagonal: vectors of float or
/// double (rounded to float).
/// @throws Error  as readScalarGrid
TensorGrids readTensorGrids(const GridSource& source);

/// The named grid of points (PointDataGrid), or the only one.
/// @throws Error  as readScalarGrid
openvdb::GridBase::Ptr readPointGrid(const GridSource& source, std::vector<std::string>& warnings);

}  // namespace igeo
