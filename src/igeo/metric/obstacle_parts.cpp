#include <igeo/band/surface_point.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>
#include <igeo/metric/obstacles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

namespace igeo {

namespace {

using openvdb::Coord;
using PartVoxels = openvdb::MaskTree::RootNodeType;

/// The connected parts of a set of voxels. A tile counts as one voxel that is larger.
class VoxelParts {
public:
    static constexpr std::uint32_t kNone = std::uint32_t(-1);

    explicit VoxelParts(const PartVoxels& voxels) : sets_(number(voxels)) {
        for (const auto& [origin, block] : blocks_)
            block.leaf ? joinLeaf(block) : joinTile(origin, block);
    }
    /// The number of the voxel's part, below `size`; kNone outside of all.
    std::uint32_t at(const Coord& voxel) {
        const std::uint32_t unit = unitAt(voxel);
        return unit == kNone ? kNone : sets_.first(unit);
    }
    /// Visits voxels and tiles: visit(part, position, number of voxels).
    template <typename Visit>
    void forAll(const Visit& visit) {
        for (const auto& [origin, block] : blocks_) {
            const double half = 0.5 * (block.size - 1);
            if (!block.leaf)
                visit(sets_.first(block.first),
                      Vec3d(origin.x() + half, origin.y() + half, origin.z() + half),
                      std::size_t(block.size) * block.size * block.size);
            else
                for (auto it = block.leaf->cbeginValueOn(); it; ++it) {
                    const Coord c = it.getCoord();
                    visit(sets_.first(block.first + it.pos()), Vec3d(c.x(), c.y(), c.z()), 1);
                }
        }
    }
    std::size_t size() const { return units_; }

private:
    using Leaf = PartVoxels::LeafNodeType;
    struct Block {
        int size;
        const Leaf* leaf;     ///< null: a tile
        std::uint32_t first;  ///< the number of its first voxel
    };

    std::size_t number(const PartVoxels& voxels) {
        auto add = [&](const Coord& origin, int size, const Leaf* leaf) {
            blocks_.insert({origin, {size, leaf, std::uint32_t(units_)}});
            units_ += leaf ? Leaf::SIZE : 1;
            hasTiles_ |= !leaf;
        };
        std::vector<const Leaf*> leaves;
        voxels.getNodes(leaves);
        for (const Leaf* leaf : leaves) add(leaf->origin(), Leaf::DIM, leaf);
        auto addTiles = [&](const auto& node) {
            for (auto tile = node.cbeginValueOn(); tile; ++tile)
                add(tile.getCoord(), std::decay_t<decltype(node)>::ChildNodeType::DIM, nullptr);
        };
        addTiles(voxels);
        for (auto upper = voxels.cbeginChildOn(); upper; ++upper) {
            addTiles(*upper);
            for (auto lower = upper->cbeginChildOn(); lower; ++lower) addTiles(*lower);
        }
        return units_;
    }
    std::uint32_t unitAt(const Coord& voxel) const {
        for (const int size : {8, 128, 4096}) {
            const auto found = blocks_.find(voxel & ~(size - 1));
            if (found != blocks_.end() && found->second.size == size) {
                const Block& block = found->second;
                if (!block.leaf) return block.first;
                const auto offset = Leaf::coordToOffset(voxel);
                return block.leaf->isValueOn(offset) ? block.first + offset : kNone;
            }
            if (!hasTiles_) break;
        }
        return kNone;
    }
    void joinLeaf(const Block& block) {
        for (auto it = block.leaf->cbeginValueOn(); it; ++it) {
            const Coord voxel = it.getCoord();
            auto joins = [&](int x, int y, int z) {
                const Coord next = voxel.offsetBy(x, y, z);
                std::uint32_t unit = kNone;
                if ((next & ~(int(Leaf::DIM) - 1)) != block.leaf->origin())
                    unit = unitAt(next);
                else if (const auto offset = Leaf::coordToOffset(next);
                         block.leaf->isValueOn(offset))
                    unit = block.first + offset;
                if (unit != kNone) sets_.join(block.first + it.pos(), unit);
                return unit != kNone;
            };
            // Of two neighbors the first one joins both; a tile may miss voxels beside it.
            joins(0, 0, 1);
            if (hasTiles_) joins(0, 0, -1);
            for (int column = hasTiles_ ? 0 : 5; column < 9; ++column)
                if (const int x = column / 3 - 1, y = column % 3 - 1;
                    (x != 0 || y != 0) && !joins(x, y, 0))
                    joins(x, y, -1), joins(x, y, 1);
        }
    }
    /// With the tiles beside it that are as large or larger; smaller ones and voxels join it.
    void joinTile(const Coord& origin, const Block& block) {
        const std::array<int, 3> steps{-1, 0, block.size};
        for (const int x : steps)
            for (const int y : steps)
                for (const int z : steps)
                    if (const std::uint32_t unit = unitAt(origin.offsetBy(x, y, z)); unit != kNone)
                        sets_.join(block.first, unit);
    }

    std::size_t units_ = 0;
    bool hasTiles_ = false;
    std::unordered_map<Coord, Block> blocks_;  ///< by origin
    DisjointSets sets_;
};

/// The voxels in which a level set is negative.
std::shared_ptr<const PartVoxels> negativeVoxels(const openvdb::FloatGrid& grid) {
    const auto negative = std::make_shared<PartVoxels>();
    for (auto it = grid.cbeginValueAll(); it; ++it)
        if (*it < 0) negative->addTile(it.getLevel(), it.getCoord(), true, true);
    return negative;
}

/// A grid, and which of its parts hold points of S.
struct PartedGrid {
    PartedGrid(std::shared_ptr<const PartVoxels> itsVoxels, const IndexMap& toGrid, double around,
               double across)
        : voxels(std::move(itsVoxels)),
          parts(*voxels),
          map(toGrid),
          toBand(toGrid.inverse()),
          reach(around),
          along(across),
          met(parts.size()) {}

    /// The parts that may block at a point of S.
    void mark(const Vec3d& p, const Vec3d& normal) {
        const Vec3d at = map(p), across = map.direction(normal);
        const double up = along / length(across);
        const Vec3d extent{reach + up * std::abs(across.x), reach + up * std::abs(across.y),
                           reach + up * std::abs(across.z)};
        const Ijk low = -floorToIjk(extent - at), high = floorToIjk(extent + at);
        for (int x = low.x; x <= high.x; ++x)
            for (int y = low.y; y <= high.y; ++y)
                for (int z = low.z; z <= high.z; ++z)
                    if (const auto part = parts.at({x, y, z}); part != VoxelParts::kNone)
                        met[part] = 1;
    }
    /// Marks the parts with a voxel that S passes.
    void markVoxels(const Band& band, const Obstacles& all) {
        constexpr double kNear = 1.5;  // voxels; larger voxels hold foot points
        parts.forAll([&](std::uint32_t part, const Vec3d& at, std::size_t) {
            if (met[part]) return;
            Vec3d p = toBand(at);
            const NodeIndex i = band.nodeAt(roundToIjk(p));
            if (i == kNoNode || std::abs(band.psi[i]) > kNear) return;
            const Vec3d normal(band.normal[i]);
            if (!projectToSurface(band, p, normal)) p = band.footPoint(i);
            if (all.block(p, p, normal)) mark(p, normal);
        });
    }
    bool allMet() {
        bool all = true;
        parts.forAll([&](std::uint32_t part, const Vec3d&, std::size_t) { all &= met[part] > 0; });
        return all;
    }
    void tell(const Similarity& transform, ObstacleSet::Parts& found) {
        std::map<std::uint32_t, ObstacleSet::Parts::Part> sums;
        parts.forAll([&](std::uint32_t part, const Vec3d& at, std::size_t count) {
            ObstacleSet::Parts::Part& sum = sums[part];
            sum.position += double(count) * at;
            sum.voxels += count;
        });
        found.all += sums.size();
        for (auto& [part, sum] : sums)
            if (!met[part]) {
                sum.position =
                    transform.worldFromIndex(toBand((1 / double(sum.voxels)) * sum.position));
                found.off.push_back(sum);
            }
    }

    std::shared_ptr<const PartVoxels> voxels;
    VoxelParts parts;
    IndexMap map, toBand;
    double reach, along;  ///< how far from S voxels block, on all sides and along its normal
    std::vector<std::uint8_t> met;
};

}  // namespace

ObstacleSet::Parts ObstacleSet::parts(const Band& band, Progress& progress) const {
    // As in block(): of masks grown cubes within 0.6 voxels of S, of level sets the corners of the
    // cell around a point.
    constexpr double kHalf = 0.6, kAlong = 0.6, kCorner = 1;
    std::vector<PartedGrid> grids;
    for (const MaskBody& body : masks_) grids.emplace_back(body.blocked, body.map, kHalf, kAlong);
    for (const LevelSetBody& body : levelSets_)
        if (!(body.grid->background() < 0))
            grids.emplace_back(negativeVoxels(*body.grid), body.map, kCorner, 0.0);
    bool isKnown = true;
    for (PartedGrid& grid : grids) {
        progress.throwIfCancelled();
        grid.markVoxels(band, *this);
        isKnown &= grid.allMet();
    }
    if (!isKnown) {
        std::vector<std::uint8_t> blocked(band.size());
        parallelFor(band.size(), 1024, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3d p = band.footPoint(NodeIndex(i));
                blocked[i] = mayBeNear(p, 1) && block(p, p, Vec3d(band.normal[i]));
            }
        });
        for (NodeIndex i = 0; i < band.size(); ++i)
            if (blocked[i])
                for (PartedGrid& grid : grids) grid.mark(band.footPoint(i), Vec3d(band.normal[i]));
    }
    Parts found;
    for (PartedGrid& grid : grids) grid.tell(transform_, found);
    std::stable_sort(found.off.begin(), found.off.end(),
                     [](const auto& a, const auto& b) { return a.voxels > b.voxels; });
    return found;
}

}  // namespace igeo
