#include <igeo/band/surface_point.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/base/parallel.h>
#include <igeo/metric/obstacles.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace igeo {

namespace {

/// The connected parts of active voxels. A tile counts as one voxel that is larger.
struct VoxelParts {
    using Tree = openvdb::Int32Tree;

    /// Numbers the voxels in place of their values.
    explicit VoxelParts(Tree& voxels) : numbers(voxels) {
        voxels.prune();
        std::uint32_t count = 0;
        for (auto it = voxels.beginValueOn(); it; ++it) it.setValue(int(count++));
        sets = DisjointSets(count);
        const bool hasTiles = voxels.hasActiveTiles();
        for (auto it = voxels.cbeginValueOn(); it; ++it) {
            const openvdb::CoordBBox box = it.getBoundingBox();
            const int size = box.dim().x(), number = *it;
            auto joins = [&](int x, int y, int z) {
                int other = 0;
                const bool isOn = numbers.probeValue(box.min().offsetBy(x, y, z), other);
                if (isOn) sets.join(std::uint32_t(number), std::uint32_t(other));
                return isOn;
            };
            // Of two voxels the first one looks for the other, of a voxel and a tile the smaller
            // one. A neighbor joins those above and below itself.
            for (const int x : {-1, 0, size})
                for (const int y : {-1, 0, size})
                    if ((x >= 0 || hasTiles) && (!joins(x, y, 0) || size > 1 || (x == 0 && y == 0)))
                        joins(x, y, -1), joins(x, y, size);
        }
        for (auto it = voxels.cbeginValueOn(); it; ++it) {
            const openvdb::CoordBBox box = it.getBoundingBox();
            const openvdb::Vec3d center = box.getCenter();
            ObstacleSet::Parts::Part& part = off[sets.first(std::uint32_t(*it))];
            part.position += double(box.volume()) * Vec3d(center.x(), center.y(), center.z());
            part.voxels += box.volume();
        }
    }
    /// Visits the parts with voxels whose centers lie in the box p +- extent.
    template <typename Visit>
    void forNear(const Vec3d& p, const Vec3d& extent, const Visit& visit) {
        const Ijk low = -floorToIjk(extent - p), high = floorToIjk(extent + p);
        int number = 0;
        for (const auto& c : openvdb::CoordBBox(low.x, low.y, low.z, high.x, high.y, high.z))
            if (numbers.probeValue(c, number)) visit(sets.first(std::uint32_t(number)));
    }

    openvdb::tree::ValueAccessor<const Tree, false> numbers;
    DisjointSets sets{0};
    /// Those not known to meet S; positions are sums in the index space of the tree.
    std::map<std::uint32_t, ObstacleSet::Parts::Part> off;
};

}  // namespace

ObstacleSet::Parts ObstacleSet::parts(const Band& band, Progress& progress) const {
    Parts found;
    std::vector<std::uint8_t> blocked;  // the foot points, once a grid needs them
    auto add = [&](VoxelParts::Tree& voxels, const IndexMap& map, double around, double along) {
        VoxelParts parts(voxels);
        found.all += parts.off.size();
        progress.throwIfCancelled();
        // The parts that may block at a point of S meet it.
        auto markAt = [&](const Vec3d& p, const Vec3d& normal) {
            const Vec3d across = map.direction(normal), up = (along / length(across)) * across;
            parts.forNear(
                map(p), {around + std::abs(up.x), around + std::abs(up.y), around + std::abs(up.z)},
                [&](std::uint32_t part) { parts.off.erase(part); });
        };
        // Single voxels between the foot points: larger ones hold foot points.
        forVoxels([&](const Vec3d& center) {
            const NodeIndex i = band.nodeAt(roundToIjk(center));
            if (i == kNoNode || std::abs(band.psi[i]) > 1.5) return;
            bool isOff = false;
            parts.forNear(map(center), {0.25, 0.25, 0.25},
                          [&](std::uint32_t part) { isOff = parts.off.count(part) > 0; });
            if (!isOff) return;
            const Vec3d normal(band.normal[i]);
            Vec3d p = center;
            if (!projectToSurface(band, p, normal)) p = band.footPoint(i);
            if (block(p, p, normal)) markAt(p, normal);
        });
        if (parts.off.empty()) return;
        if (blocked.empty()) {
            blocked.resize(band.size());
            parallelFor(band.size(), 1024, progress, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const Vec3d p = band.footPoint(NodeIndex(i));
                    blocked[i] = contains(p, Vec3d(band.normal[i]));
                }
            });
        }
        for (NodeIndex i = 0; i < band.size(); ++i)
            if (blocked[i]) markAt(band.footPoint(i), Vec3d(band.normal[i]));
        for (auto& [first, part] : parts.off) {
            const Vec3d mean = (1 / double(part.voxels)) * part.position;
            found.off.push_back({transform_.worldFromIndex(map.inverse()(mean)), part.voxels});
        }
    };
    // As in block(): of masks grown cubes within 0.6 voxels of S, of level sets the corners of the
    // cell around a point.
    for (const MaskBody& body : masks_) {
        VoxelParts::Tree voxels;
        voxels.root().topologyUnion(*body.blocked);
        add(voxels, body.map, 0.6, 0.6);
    }
    for (const LevelSetBody& body : levelSets_) {
        if (body.grid->background() < 0) continue;
        VoxelParts::Tree voxels;
        openvdb::tree::ValueAccessor<VoxelParts::Tree, false> negative(voxels);
        for (auto it = body.grid->cbeginValueAll(); it; ++it)
            if (*it < 0) negative.addTile(it.getLevel(), it.getCoord(), 0, true);
        add(voxels, body.map, 1, 0);
    }
    std::stable_sort(found.off.begin(), found.off.end(),
                     [](const auto& a, const auto& b) { return a.voxels > b.voxels; });
    return found;
}

}  // namespace igeo
