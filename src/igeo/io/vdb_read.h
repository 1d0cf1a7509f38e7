/// VDB files in: which grid to take.
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
    std::string file;  ///< as named, for messages
    std::string name;  ///< unique in the file: the second of two grids `psi` is `psi[1]`
    bool isLevelSetClass = false;            ///< the file says so
    std::vector<std::string> warnings = {};  ///< of the file, in sentences
};

/// What a file says of one of its grids.
struct GridEntry {
    std::string name;       ///< unique in the file, as in LoadedGrid
    std::string type;       ///< of its values: float, vec3s, mask, ...; "unknown type ..."
    std::string gridClass;  ///< as OpenVDB names it: level set, fog volume, unknown, ...
    std::optional<std::uint64_t> activeVoxels;  ///< none where the file does not say
    bool surface, weight, obstacle;             ///< what its type and class allow it to be
};

/// Reads one scalar grid: the one named, else the only one of class level set, else the only float
/// or double grid of class unknown. Float, double (rounded to float) and half floats, half grids
/// where OpenVDB has them (13); any file format that OpenVDB reads, with a warning for a newer one.
/// Other grids of the file may be of types that OpenVDB does not know.
/// @throws Error  Io when the file cannot be opened; BadInput when it is not a VDB file, is cut
/// off,
///         holds no such grid, none that fits or several (the message lists them), or when the grid
///         is a fog volume or no scalar
/// @param entries receives all grids of the file, in its order, also where none of them is usable;
///                null: not wanted
LoadedGrid readLevelSetGrid(const GridSource& source, std::vector<GridEntry>* entries = nullptr);

/// Reads one scalar grid of any class, for a weight: the one named, else the only float or double
/// grid that is no level set (a weight may lie beside its surface), else the only one.
/// @throws Error  as readLevelSetGrid, but for the fog volume
LoadedGrid readScalarGrid(const GridSource& source);

/// A grid that says which places no path may enter, as read.
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

/// The grid of points (PointDataGrid) that is named, or the only one.
/// @throws Error  as readScalarGrid
openvdb::GridBase::Ptr readPointGrid(const GridSource& source, std::vector<std::string>& warnings);

}  // namespace igeo
