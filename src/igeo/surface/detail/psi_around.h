/// psi around one leaf, gathered with a wide margin. Internal.
#pragma once

#include <igeo/surface/detail/leaf_block.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace igeo {

/// The trilinear interpolant of psi around a leaf, in voxels; NaN beside inactive voxels.
class PsiAround {
public:
    PsiAround(const openvdb::FloatTree& psi, double dx) : psi_(psi), inVoxels_{1 / dx} {}

    /// Gathers the voxels around the leaf at this origin.
    void moveTo(const Ijk& origin) {
        low_ = origin - Ijk{kMargin, kMargin, kMargin};
        value_.fill(kMissingVoxel);
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) gather(origin, {x, y, z});
    }
    double at(const Vec3d& p) const {
        const Vec3d fromLow = p - Vec3d(low_);
        if (std::min({fromLow.x, fromLow.y, fromLow.z}) >= 0 &&
            std::max({fromLow.x, fromLow.y, fromLow.z}) < kEdge - 1) {
            const Ijk v{int(fromLow.x), int(fromLow.y), int(fromLow.z)};
            return interpolate(&value_[indexOf(v)], kSteps, fromLow - Vec3d(v));
        }
        const Ijk cell = floorToIjk(p);
        return atFar(cell, p - Vec3d(cell));
    }

    /// At points side by side, as they lie from low().
    template <int Width>
    IGEO_INLINE auto at(const VectorLanes<Width>& p) const {
        using V = typename Registers<Width>::Vector;
        using Integers = typename Registers<Width>::Integers;
        const V zero{}, end = zero + (kEdge - 1);
        if (any((p.x < zero) | (p.y < zero) | (p.z < zero) | (p.x >= end) | (p.y >= end) |
                (p.z >= end)))
            return atEach<Width>(p);
        const Integers x = __builtin_convertvector(p.x, Integers),
                       y = __builtin_convertvector(p.y, Integers),
                       z = __builtin_convertvector(p.z, Integers),
                       cell = (x * kEdge + y) * kEdge + z;
        const V tx = p.x - __builtin_convertvector(x, V), ty = p.y - __builtin_convertvector(y, V),
                tz = p.z - __builtin_convertvector(z, V);
        V across[2];
        for (std::size_t k = 0; k < 2; ++k) {
            // The corners of a face of each cell.
            V corner[4];
            float face[Width][4];
            for (int lane = 0; lane < Width; ++lane) {
                const float* low = &value_[std::size_t(cell[lane]) + k * kSteps[0]];
                std::memcpy(face[lane], low, 2 * sizeof(float));
                std::memcpy(face[lane] + 2, low + kSteps[1], 2 * sizeof(float));
            }
            loadFours<Width>([&](int lane) { return face[lane]; }, corner);
            const V first = corner[0] + tz * (corner[1] - corner[0]),
                    second = corner[2] + tz * (corner[3] - corner[2]);
            across[k] = first + ty * (second - first);
        }
        return across[0] + tx * (across[1] - across[0]);
    }
    const Ijk& low() const { return low_; }

    /// A voxel at most kMargin away from the leaf, whose first voxel is (0, 0, 0).
    float voxel(const Ijk& v) const { return value_[indexOf(v + Ijk{kMargin, kMargin, kMargin})]; }

private:
    static constexpr int kMargin = 4;  ///< of four: most chords, and what is looked at beside them
    static constexpr int kEdge = 8 + 2 * kMargin;
    static constexpr CellSteps kSteps{std::size_t(kEdge * kEdge), std::size_t(kEdge), 1};

    static constexpr std::size_t indexOf(const Ijk& v) {
        return std::size_t((v.x * kEdge + v.y) * kEdge + v.z);
    }
    /// The same, one by one: some may lie far from the leaf.
    template <int Width>
    IGEO_INLINE auto atEach(const VectorLanes<Width>& p) const {
        typename Registers<Width>::Vector values;
        for (int lane = 0; lane < Width; ++lane)
            values[lane] = float(at(Vec3d(low_) + Vec3d{p.x[lane], p.y[lane], p.z[lane]}));
        return values;
    }
    /// Far from the leaf.
    double atFar(const Ijk& cell, const Vec3d& t) const {
        std::array<float, 8> corner;
        for (std::size_t k = 0; k < 8; ++k) {
            const openvdb::Coord ijk(cell.x + int(k >> 2), cell.y + int(k >> 1 & 1),
                                     cell.z + int(k & 1));
            float value;
            corner[k] = psi_.probeValue(ijk, value) ? inVoxels_.scaled(value) : kMissingVoxel;
        }
        return interpolate(corner.data(), {4, 2, 1}, t);
    }
    /// Copies what the block holds of the leaf s leaves away.
    void gather(const Ijk& origin, const Ijk& s) {
        // Voxels of that leaf, as [first, last) along each axis.
        auto first = [](int step) { return step < 0 ? 8 - kMargin : 0; };
        auto last = [](int step) { return step > 0 ? kMargin : 8; };
        const LeafBlock::Leaf* leaf = psi_.probeConstLeaf(
            openvdb::Coord(origin.x + 8 * s.x, origin.y + 8 * s.y, origin.z + 8 * s.z));
        if (!leaf) return;
        for (int x = first(s.x); x < last(s.x); ++x)
            for (int y = first(s.y); y < last(s.y); ++y) {
                const unsigned row =
                    leaf->valueMask().getWord<std::uint8_t>(openvdb::Index(x << 3 | y));
                for (int z = first(s.z); z < last(s.z); z += 4)
                    if (const unsigned active = row >> z & 15)
                        copyLanes<4>(inVoxels_, leaf->buffer().data() + (x << 6 | y << 3 | z),
                                     active, kMissingVoxel,
                                     &value_[indexOf(Ijk{x, y, z} + 8 * s +
                                                     Ijk{kMargin, kMargin, kMargin})]);
            }
    }

    LeafBlock::Accessor psi_;
    PsiInVoxels inVoxels_;
    Ijk low_;
    std::array<float, std::size_t(kEdge* kEdge* kEdge)> value_;
};

}  // namespace igeo
