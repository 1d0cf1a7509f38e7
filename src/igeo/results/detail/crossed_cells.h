/// The cells between voxels that psi = 0 of a level set passes through. Internal to
/// level_set_mesh.cpp.
#pragma once

#include <igeo/band/band_leaf.h>
#include <igeo/results/detail/cell_sheets.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace igeo {

struct Band;
struct LevelSet;

/// The cells that S passes through, whose lowest voxel is in one leaf.
struct CellLeaf {
    using Mask = std::array<std::uint64_t, 8>;  ///< as LeafNodes::mask
    /// A cell of several sheets: the first is numbered in `cells`, the others follow its cells.
    struct Several {
        unsigned offset;
        CellSheets sheets;
        std::uint32_t next;  ///< number of its second vertex; in the leaf
    };
    Ijk origin;
    LeafNodes cells;
    std::vector<Several> several;  ///< by offset
    std::vector<Vec3d> points;     ///< of cells, then of further sheets
    Mask walls{};                  ///< cells at the edge of the volume
    /// Per axis: the crossed edges from the corner of a cell across from its lowest along both
    /// other axes, by the side that is outside.
    std::array<Mask, 3> up{}, down{};
    bool hasWalls = false;
};

/// Finds the cells of leaves whose origin is set, with their vertices. In parallel.
/// @param band  as levelSetMesh() has it
void findCells(const LevelSet& levelSet, const Band& band, std::span<CellLeaf> leaves);

}  // namespace igeo
