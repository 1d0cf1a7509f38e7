/// The sheets of a surface in a cell of eight voxels. Internal.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace igeo {

/// Corner (a, b, c) of a cell, at 4 a + 2 b + c.
inline Ijk cornerOf(unsigned k) { return {int(k >> 2), int(k >> 1 & 1), int(k & 1)}; }

/// The corners of a cell are numbered 4 a + 2 b + c for corner (a, b, c); `inside` has a bit for
/// each corner with psi < 0. Faces: -x, +x, -y, +y, -z, +z.
struct CellSheets {
    /// An edge by its axis and its lower corner.
    static constexpr unsigned bitOf(int axis) { return 4u >> axis; }
    static constexpr std::size_t edgeOf(int axis, unsigned corner) {
        return std::size_t(8 * axis) + corner;
    }
    struct Edge {
        std::uint8_t axis, corner, sheet;
    };

    std::array<Edge, 12> edge{};           ///< the crossed ones
    std::size_t edges = 0;                 ///< their count
    std::array<std::uint8_t, 24> sheet{};  ///< the sheet that crosses an edge
    std::uint8_t count = 0;                ///< of sheets
    unsigned twice = 0;                    ///< bits: faces that one sheet crosses twice

    /// @param parted  bits: faces crossed twice on which the corners outside are cut off, instead
    ///                of those inside
    CellSheets(unsigned inside, unsigned parted);

    /// Of a cell without parted faces, from a table.
    static const CellSheets& of(unsigned inside);
};

}  // namespace igeo
