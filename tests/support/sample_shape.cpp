// Sampling of shapes.h: space is cut into blocks, blocks into leaves, and what lies farther from
// the surface than the layer is skipped by the distance at its middle.
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "shapes.h"

namespace igeo::test {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr int kBlockSize = 128;  // the cube of an internal node: leaves of two blocks never mix

template <typename TreeT>
class Sampler {
public:
    using LeafT = typename TreeT::LeafNodeType;
    using ValueT = typename TreeT::ValueType;
    using Leaves = std::vector<std::unique_ptr<LeafT>>;

    Sampler(const Shape& shape, const openvdb::math::Transform& transform, double halfWidth)
        : shape_(shape), transform_(transform), halfWidth_(halfWidth) {}

    /// Origins of the blocks that may hold active voxels.
    std::vector<Coord> blocks() const {
        const openvdb::BBoxd padded(shape_.bounds.min() - Vec3d(halfWidth_),
                                    shape_.bounds.max() + Vec3d(halfWidth_));
        const CoordBBox box(transform_.worldToIndexNodeCentered(padded));
        constexpr int kMask = ~(kBlockSize - 1);
        const Coord first = box.min() & kMask;
        std::vector<Coord> origins;
        for (int i = first.x(); i <= box.max().x(); i += kBlockSize)
            for (int j = first.y(); j <= box.max().y(); j += kBlockSize)
                for (int k = first.z(); k <= box.max().z(); k += kBlockSize)
                    if (mayTouch({i, j, k}, kBlockSize)) origins.emplace_back(i, j, k);
        return origins;
    }

    Leaves sampleBlock(const Coord& origin) const {
        constexpr int kDim = static_cast<int>(LeafT::DIM);
        Leaves leaves;
        for (int i = 0; i < kBlockSize; i += kDim)
            for (int j = 0; j < kBlockSize; j += kDim)
                for (int k = 0; k < kBlockSize; k += kDim) {
                    const Coord leafOrigin = origin.offsetBy(i, j, k);
                    if (!mayTouch(leafOrigin, kDim)) continue;
                    auto leaf = sampleLeaf(leafOrigin);
                    if (!leaf->isEmpty()) leaves.push_back(std::move(leaf));
                }
        return leaves;
    }

private:
    /// Whether the cube of `size` voxels from `origin` may hold active voxels.
    bool mayTouch(const Coord& origin, int size) const {
        const double half = 0.5 * (size - 1);
        const Vec3d middle = origin.asVec3d() + Vec3d(half);
        const Vec3d pWorld = transform_.indexToWorld(middle);
        double radius = 0;  // of the cube's voxel centers: the longest of the four half diagonals
        for (const Vec3d& corner :
             {Vec3d(1, 1, 1), Vec3d(-1, 1, 1), Vec3d(1, -1, 1), Vec3d(1, 1, -1)}) {
            const Vec3d diagonal = transform_.indexToWorld(middle + half * corner) - pWorld;
            radius = std::max(radius, diagonal.length());
        }
        radius *= 1 + 1e-9;  // rounding must not cost a voxel
        return std::abs(shape_.sdf(pWorld)) <= halfWidth_ + radius &&
               (!shape_.domain || shape_.domain(pWorld) <= radius);
    }

    std::unique_ptr<LeafT> sampleLeaf(const Coord& origin) const {
        auto leaf = std::make_unique<LeafT>(origin, static_cast<ValueT>(halfWidth_), false);
        for (openvdb::Index n = 0; n < LeafT::SIZE; ++n) {
            const Vec3d pWorld = transform_.indexToWorld(leaf->offsetToGlobalCoord(n));
            const double psi = shape_.sdf(pWorld);
            if (std::abs(psi) < halfWidth_ && (!shape_.domain || shape_.domain(pWorld) < 0))
                leaf->setValueOn(n, static_cast<ValueT>(psi));
            else if (psi < 0)
                leaf->setValueOff(n, static_cast<ValueT>(-halfWidth_));
        }
        return leaf;
    }

    const Shape& shape_;
    const openvdb::math::Transform& transform_;
    const double halfWidth_;
};

template <typename GridT>
typename GridT::Ptr sample(const Shape& shape, const openvdb::math::Transform& transform,
                           double halfWidthVoxels, const std::string& name) {
    using SamplerT = Sampler<typename GridT::TreeType>;
    const double halfWidth = halfWidthVoxels * transform.voxelSize().x();
    const SamplerT sampler(shape, transform, halfWidth);
    const std::vector<Coord> blocks = sampler.blocks();
    std::vector<typename SamplerT::Leaves> leavesOfBlock(blocks.size());
    tbb::parallel_for(std::size_t{0}, blocks.size(),
                      [&](std::size_t b) { leavesOfBlock[b] = sampler.sampleBlock(blocks[b]); });

    auto grid = GridT::create(static_cast<typename GridT::ValueType>(halfWidth));
    grid->setTransform(transform.copy());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName(name);
    for (auto& leaves : leavesOfBlock)
        for (auto& leaf : leaves) grid->tree().addLeaf(leaf.release());
    if (shape.closed) openvdb::tools::signedFloodFill(grid->tree());
    return grid;
}

}  // namespace

openvdb::FloatGrid::Ptr makeLevelSet(const Shape& shape, const openvdb::math::Transform& transform,
                                     double halfWidthVoxels, const std::string& name) {
    return sample<openvdb::FloatGrid>(shape, transform, halfWidthVoxels, name);
}

openvdb::FloatGrid::Ptr makeLevelSet(const Shape& shape, double dx, double halfWidthVoxels,
                                     const std::string& name) {
    return makeLevelSet(shape, *openvdb::math::Transform::createLinearTransform(dx),
                        halfWidthVoxels, name);
}

openvdb::DoubleGrid::Ptr makeDoubleLevelSet(const Shape& shape,
                                            const openvdb::math::Transform& transform,
                                            double halfWidthVoxels, const std::string& name) {
    return sample<openvdb::DoubleGrid>(shape, transform, halfWidthVoxels, name);
}

}  // namespace igeo::test
