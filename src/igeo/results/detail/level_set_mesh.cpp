#include <igeo/results/detail/level_set_mesh.h>

#include <igeo/band/band.h>
#include <igeo/base/parallel.h>
#include <igeo/results/detail/crossed_cells.h>
#include <igeo/surface/level_set.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <unordered_map>
#include <utility>

namespace igeo {

namespace {

using Quad = QuadMesh::Quad;

struct OriginHash {
    std::size_t operator()(const Ijk& o) const {
        std::uint64_t hash = 0;
        for (int a = 0; a < 3; ++a)
            hash = (hash ^ std::uint64_t(std::uint32_t(o[a]))) * 0x9e3779b97f4a7c15u;
        return std::size_t(hash ^ hash >> 32);
    }
};

/// All leaves with cells, and their numbers by origin.
class CellLeaves {
public:
    CellLeaves(const LevelSet& levelSet, const Band& band) {
        const openvdb::FloatTree& tree = levelSet.psi->constTree();
        all_.reserve(2 * tree.leafCount());
        for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
            const openvdb::Coord o = leaf->origin();
            add({o.x(), o.y(), o.z()});
        }
        // Cells at the rim of the volume may have their lowest voxel beside it.
        for (std::size_t l = 0, known = all_.size(); l < known; ++l)
            for (unsigned k = 1; k < 8; ++k) add(all_[l].origin - 8 * cornerOf(k));
        findCells(levelSet, band, all_);
        std::uint32_t next = 0;
        for (CellLeaf& leaf : all_) {
            leaf.cells.number(next);
            for (CellLeaf::Several& cell : leaf.several) cell.next += next + leaf.cells.count;
            next += std::uint32_t(leaf.points.size());
            hasWalls_ = hasWalls_ || leaf.hasWalls;
        }
    }

    bool hasWalls() const { return hasWalls_; }
    std::vector<Vec3d> points() const {
        std::vector<Vec3d> points;
        for (const CellLeaf& leaf : all_)
            points.insert(points.end(), leaf.points.begin(), leaf.points.end());
        return points;
    }
    std::vector<Quad> quads() const {
        std::vector<std::vector<Quad>> parts(all_.size());
        parallelFor(all_.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t l = begin; l < end; ++l)
                if (all_[l].cells.count > 0) addQuads(l, parts[l]);
        });
        std::vector<Quad> quads;
        for (const auto& part : parts) quads.insert(quads.end(), part.begin(), part.end());
        return quads;
    }

private:
    void add(const Ijk& origin) {
        if (!numbers_.try_emplace(origin, std::uint32_t(all_.size())).second) return;
        all_.emplace_back();
        all_.back().origin = origin;
    }

    /// A leaf and those beyond it: at step (a, b, c) number 4 a + 2 b + c, null where there is
    /// none.
    using Around = std::array<const CellLeaf*, 8>;

    void addQuads(std::size_t l, std::vector<Quad>& quads) const {
        Around around{};
        for (unsigned k = 0; k < 8; ++k) {
            const auto at = numbers_.find(all_[l].origin + 8 * cornerOf(k));
            if (at != numbers_.end()) around[k] = &all_[at->second];
        }
        const CellLeaf& leaf = all_[l];
        const bool plain = !leaf.hasWalls && leaf.several.empty();
        for (int x = 0; x < 8; ++x)
            for (int axis = 0; axis < 3; ++axis) {
                const std::uint64_t up = leaf.up[std::size_t(axis)][std::size_t(x)];
                for (std::uint64_t bits = up | leaf.down[std::size_t(axis)][std::size_t(x)]; bits;
                     bits &= bits - 1) {
                    const int bit = std::countr_zero(bits);
                    const Ijk lowest{x, bit >> 3, bit & 7};
                    Quad q;
                    if (plain && lowest[(axis + 1) % 3] < 7 && lowest[(axis + 2) % 3] < 7)
                        q = cornersWithin(leaf, axis, lowest);
                    else if (!cornersAround(around, axis, lowest, q))
                        continue;
                    if (!(up >> bit & 1)) std::swap(q[1], q[3]);
                    quads.push_back(q);
                }
            }
    }
    /// The vertices in the four cells around the edge as cornersAround has them, all in a leaf of
    /// single sheets.
    static Quad cornersWithin(const CellLeaf& leaf, int axis, const Ijk& lowest) {
        const unsigned at = Band::offsetOf(lowest.x, lowest.y, lowest.z),
                       b = 64u >> 3 * ((axis + 1) % 3), c = 64u >> 3 * ((axis + 2) % 3);
        return {leaf.cells.numberOf(at), leaf.cells.numberOf(at + b),
                leaf.cells.numberOf(at + b + c), leaf.cells.numberOf(at + c)};
    }
    /// The vertices in the four cells around the edge, counter-clockwise seen from its upper end;
    /// false at walls.
    static bool cornersAround(const Around& around, int axis, const Ijk& lowest, Quad& q) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        struct Step {
            int offset;
            unsigned leaf;
        };
        auto stepAlong = [&](int along) {
            const int stride = 64 >> 3 * along;
            return lowest[along] < 7 ? Step{stride, 0}
                                     : Step{-7 * stride, CellSheets::bitOf(along)};
        };
        const Step toB = stepAlong(b), toC = stepAlong(c);
        for (std::size_t k = 0; k < 4; ++k) {
            const bool inB = k == 1 || k == 2, inC = k >= 2;
            const CellLeaf* leaf = around[(inB ? toB.leaf : 0) | (inC ? toC.leaf : 0)];
            const unsigned at = Band::offsetOf(lowest.x, lowest.y, lowest.z) +
                                unsigned((inB ? toB.offset : 0) + (inC ? toC.offset : 0));
            if (!leaf || leaf->walls[at >> 6] >> (at & 63) & 1) return false;
            q[k] = leaf->cells.numberOf(at);
            if (leaf->several.empty()) continue;
            const unsigned corner =
                (inB ? 0 : CellSheets::bitOf(b)) | (inC ? 0 : CellSheets::bitOf(c));
            const auto several = std::lower_bound(
                leaf->several.begin(), leaf->several.end(), at,
                [](const CellLeaf::Several& s, unsigned offset) { return s.offset < offset; });
            if (several == leaf->several.end() || several->offset != at) continue;
            const unsigned sheet = several->sheets.sheet[CellSheets::edgeOf(axis, corner)];
            if (sheet > 0) q[k] = several->next + sheet - 1;
        }
        return true;
    }

    std::vector<CellLeaf> all_;
    std::unordered_map<Ijk, std::uint32_t, OriginHash> numbers_;
    bool hasWalls_ = false;
};

void dropUnused(QuadMesh& mesh) {
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(mesh.points.size(), kUnused);
    for (const Quad& q : mesh.quads)
        for (const std::uint32_t v : q) number[v] = 0;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] == kUnused) continue;
        mesh.points[count] = mesh.points[i];
        number[i] = count++;
    }
    mesh.points.resize(count);
    for (Quad& q : mesh.quads)
        for (std::uint32_t& v : q) v = number[v];
}

}  // namespace

QuadMesh levelSetMesh(const LevelSet& levelSet, const Band& band) {
    const CellLeaves leaves(levelSet, band);
    QuadMesh mesh{leaves.points(), leaves.quads()};
    if (leaves.hasWalls()) dropUnused(mesh);
    return mesh;
}

}  // namespace igeo
