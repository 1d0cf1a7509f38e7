#include <igeo/results/detail/level_set_mesh.h>

#include <igeo/band/band.h>
#include <igeo/base/parallel.h>
#include <igeo/results/detail/cell_sheets.h>
#include <igeo/surface/level_set.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace igeo {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;
using Quad = QuadMesh::Quad;
using Mask = std::array<std::uint64_t, 8>;  ///< as LeafNodes::mask

openvdb::Coord coordOf(const Ijk& v) { return {v.x, v.y, v.z}; }
Ijk cornerOf(unsigned k) { return {int(k >> 2), int(k >> 1 & 1), int(k & 1)}; }

/// psi at the 9^3 voxels of the cells whose lowest voxel is in a leaf, voxel units. Inactive voxels
/// have the values of the tree, for their signs.
class CellBlock {
public:
    /// @return whether the sign changes
    bool gather(const Accessor& psi, const Ijk& origin, double scale) {
        for (unsigned k = 0; k < 8; ++k) {
            const openvdb::Coord at = coordOf(origin + 8 * cornerOf(k));
            if (const Leaf* leaf = psi.probeConstLeaf(at))
                copyLeaf(*leaf, cornerOf(k), scale);
            else
                fill(cornerOf(k), float(psi.getValue(at) * scale));
        }
        unsigned all = 0x1ff, any = 0;
        for (const unsigned row : inside_) all &= row, any |= row;
        return any != 0 && all != 0x1ff;
    }
    /// Which voxels of the row (x, y, 0) to (x, y, 8) have psi < 0.
    unsigned inside(int x, int y) const { return inside_[std::size_t(9 * x + y)]; }
    unsigned active(int x, int y) const { return active_[std::size_t(9 * x + y)]; }
    /// psi at the corners of a cell.
    std::array<float, 8> corners(int x, int y, int z) const {
        const float* v = &values_[std::size_t(81 * x + 9 * y + z)];
        return {v[0], v[1], v[9], v[10], v[81], v[82], v[90], v[91]};
    }

private:
    static int count(int step) { return step ? 1 : 8; }

    void copyLeaf(const Leaf& leaf, const Ijk& step, double scale) {
        const float* from = leaf.buffer().data();
        for (int x = 0; x < count(step.x); ++x) {
            const auto slice = leaf.valueMask().getWord<openvdb::Index64>(openvdb::Index(x));
            for (int y = 0; y < count(step.y); ++y)
                copyRow(from + 64 * x + 8 * y, unsigned(slice >> 8 * y & 0xff),
                        9 * (x + 8 * step.x) + y + 8 * step.y, step.z, scale);
        }
    }
    void copyRow(const float* from, unsigned active, int row, int stepZ, double scale) {
        float* to = &values_[std::size_t(9 * row + 8 * stepZ)];
        unsigned inside = 0;
        for (int z = 0; z < count(stepZ); ++z) {
            to[z] = float(double(from[z]) * scale);
            inside |= unsigned(to[z] < 0) << z;
        }
        put(row, stepZ, inside, active);
    }
    void fill(const Ijk& step, float value) {
        for (int x = 8 * step.x; x < 8 * step.x + count(step.x); ++x)
            for (int y = 8 * step.y; y < 8 * step.y + count(step.y); ++y) {
                std::fill_n(&values_[std::size_t(81 * x + 9 * y + 8 * step.z)], count(step.z),
                            value);
                put(9 * x + y, step.z, value < 0 ? 0xff : 0, 0);
            }
    }
    void put(int row, int stepZ, unsigned inside, unsigned active) {
        auto set = [&](std::uint16_t& bits, unsigned now) {
            bits = std::uint16_t(stepZ ? (bits & 0xffu) | (now & 1) << 8 : (bits & 0x100u) | now);
        };
        set(inside_[std::size_t(row)], inside);
        set(active_[std::size_t(row)], active);
    }

    std::array<float, 729> values_;
    std::array<std::uint16_t, 81> inside_{}, active_{};
};

/// psi in a cell, as a polynomial of the place in it.
struct Trilinear {
    double c, x, y, z, xy, xz, yz, xyz;

    explicit Trilinear(const std::array<float, 8>& v)
        : c(double(v[0])),
          x(double(v[4]) - c),
          y(double(v[2]) - c),
          z(double(v[1]) - c),
          xy(double(v[6]) - double(v[4]) - y),
          xz(double(v[5]) - double(v[4]) - z),
          yz(double(v[3]) - double(v[2]) - z),
          xyz(double(v[7]) - double(v[6]) - (double(v[5]) - double(v[4])) - yz) {}

    /// Moves a place along grad psi to psi = 0, as projectToSurface does.
    /// @return whether it came there within the cell
    bool project(Vec3d& place) const {
        constexpr double kTolerance = 1e-6;
        Vec3d p = place;
        for (int iteration = 0; iteration < 20; ++iteration) {
            if (!(std::min({p.x, p.y, p.z}) >= 0 && std::max({p.x, p.y, p.z}) < 1)) return false;
            const Vec3d g{x + xy * p.y + p.z * (xz + xyz * p.y),
                          y + yz * p.z + p.x * (xy + xyz * p.z),
                          z + xz * p.x + p.y * (yz + xyz * p.x)};
            const double psi = c + g.x * p.x + p.y * (y + yz * p.z) + z * p.z, g2 = dot(g, g);
            if (std::abs(psi) <= kTolerance) {
                place = p;
                return true;
            }
            if (g2 < 1e-4) return false;
            // No step longer than a voxel: one would leave the cell in any case.
            p -= (psi / g2) * g;
        }
        return false;
    }
};

/// The cells that S passes through, whose lowest voxel is in one leaf.
struct CellLeaf {
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

/// Finds the cells of a leaf, with their vertices.
class CellFinder {
public:
    CellFinder(const LevelSet& levelSet, const Band& band)
        : accessor_(levelSet.psi->constTree()),
          tree_(levelSet.psi->constTree()),
          band_(band),
          dx_(levelSet.transform.dx) {}

    void find(CellLeaf& leaf) {
        if (!block_.gather(accessor_, leaf.origin, 1 / dx_)) return;
        leaf_ = &leaf;
        further_.clear();
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                unsigned all = 0x1ff, any = 0;
                for (unsigned k = 0; k < 8; k += 2) {
                    const unsigned row = block_.inside(x + int(k >> 2), y + int(k >> 1 & 1));
                    all &= row, any |= row;
                }
                if (any == 0 || all == 0x1ff) continue;
                findEdges(x, y);
                unsigned crossed = (any | any >> 1) & ~(all & all >> 1) & 0xff;
                leaf.cells.mask[std::size_t(x)] |= std::uint64_t(crossed) << 8 * y;
                for (; crossed; crossed &= crossed - 1) addCell({x, y, std::countr_zero(crossed)});
            }
        leaf.points.insert(leaf.points.end(), further_.begin(), further_.end());
    }

private:
    void findEdges(int x, int y) {
        const unsigned at = block_.inside(x + 1, y + 1), onX = block_.inside(x, y + 1),
                       onY = block_.inside(x + 1, y);
        auto put = [&](std::size_t axis, unsigned low, unsigned high) {
            leaf_->up[axis][std::size_t(x)] |= std::uint64_t(low & ~high & 0xff) << 8 * y;
            leaf_->down[axis][std::size_t(x)] |= std::uint64_t(~low & high & 0xff) << 8 * y;
        };
        put(0, onX >> 1, at >> 1);
        put(1, onY >> 1, at >> 1);
        put(2, at, at >> 1);
    }

    /// The bits of a cell's corners in rows.
    template <typename Row>
    static unsigned cornerBits(const Ijk& cell, const Row& row) {
        unsigned bits = 0;
        for (int k = 0; k < 4; ++k)
            bits |= (row(cell.x + k / 2, cell.y + k % 2) >> cell.z & 3u) << 2 * k;
        return bits;
    }

    void addCell(const Ijk& cell) {
        const std::array<float, 8> psi = block_.corners(cell.x, cell.y, cell.z);
        const unsigned inside = cornerBits(cell, [&](int x, int y) { return block_.inside(x, y); }),
                       active = cornerBits(cell, [&](int x, int y) { return block_.active(x, y); });
        const CellSheets& usual = CellSheets::of(inside);
        if (isWall(psi, active, usual)) {
            leaf_->walls[std::size_t(cell.x)] |= std::uint64_t(1) << (8 * cell.y + cell.z);
            leaf_->hasWalls = true;
        }
        if (usual.count == 1 && !usual.twice) return addVertices(cell, psi, active, usual);
        const CellSheets sheets(inside, partedFaces(leaf_->origin + cell, usual.twice));
        if (sheets.count > 1)
            leaf_->several.push_back(
                {Band::offsetOf(cell.x, cell.y, cell.z), sheets, std::uint32_t(further_.size())});
        addVertices(cell, psi, active, sheets);
    }

    /// The faces on whose other side one sheet crosses twice as well: without a part there, four
    /// quadrilaterals would share an edge.
    unsigned partedFaces(const Ijk& cell, unsigned twice) const {
        unsigned parted = 0;
        for (int f = 0; f < 6; ++f) {
            if (!(twice >> f & 1)) continue;
            Ijk beside = cell;
            beside[f / 2] += f % 2 ? 1 : -1;
            unsigned inside = 0;
            for (unsigned k = 0; k < 8; ++k)
                inside |= unsigned(tree_.getValue(coordOf(beside + cornerOf(k))) < 0) << k;
            if (CellSheets::of(inside).twice >> (f ^ 1) & 1) parted |= 1u << f;
        }
        return parted;
    }

    /// Whether the sign of psi changes in the cell without a surface: over an edge that leaves the
    /// volume, or along which psi jumps by twice what a distance may (as at the rim of a widened
    /// level set).
    static bool isWall(const std::array<float, 8>& psi, unsigned active, const CellSheets& sheets) {
        constexpr float kMost = 2;
        for (std::size_t e = 0; e < sheets.edges; ++e) {
            const auto [axis, k, sheet] = sheets.edge[e];
            const unsigned j = k | CellSheets::bitOf(axis);
            if (!(active >> k & active >> j & 1) || !(std::abs(psi[k] - psi[j]) <= kMost))
                return true;
        }
        return false;
    }

    void addVertices(const Ijk& cell, const std::array<float, 8>& psi, unsigned active,
                     const CellSheets& sheets) {
        std::array<Vec3d, 4> sum{};
        std::array<int, 4> count{};
        for (std::size_t e = 0; e < sheets.edges; ++e) {
            const auto [axis, k, sheet] = sheets.edge[e];
            const double a = double(psi[k]), b = double(psi[k | CellSheets::bitOf(axis)]);
            Vec3d p(cornerOf(k));
            p[axis] = a / (a - b);
            sum[sheet] += p;
            ++count[sheet];
        }
        for (std::size_t s = 0; s < sheets.count; ++s) {
            const Vec3d p = onSurface(cell, sum[s] * (1.0 / count[s]), psi, active == 0xff);
            (s == 0 ? leaf_->points : further_).push_back(p);
        }
    }

    /// A place in a cell, moved onto S; index space.
    Vec3d onSurface(const Ijk& cell, Vec3d place, const std::array<float, 8>& psi,
                    bool complete) const {
        const Vec3d low(leaf_->origin + cell), from = low + place;
        if (complete && !band_.triangles && Trilinear(psi).project(place)) return low + place;
        // Beyond a voxel the projection is on another sheet.
        Vec3d p = from;
        return projectToSurface(band_, p) && length(p - from) < 1 ? p : from;
    }

    const Accessor accessor_;
    const openvdb::FloatTree& tree_;
    const Band& band_;
    double dx_;
    CellBlock block_;
    CellLeaf* leaf_ = nullptr;
    std::vector<Vec3d> further_;
};

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
        parallelFor(all_.size(), 16, [&](std::size_t begin, std::size_t end) {
            CellFinder finder(levelSet, band);
            for (std::size_t l = begin; l < end; ++l) finder.find(all_[l]);
        });
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
        for (int x = 0; x < 8; ++x)
            for (int axis = 0; axis < 3; ++axis) {
                const std::uint64_t up = leaf.up[std::size_t(axis)][std::size_t(x)];
                for (std::uint64_t bits = up | leaf.down[std::size_t(axis)][std::size_t(x)]; bits;
                     bits &= bits - 1) {
                    const int bit = std::countr_zero(bits);
                    Quad q;
                    if (!cornersAround(around, axis, {x, bit >> 3, bit & 7}, q)) continue;
                    if (!(up >> bit & 1)) std::swap(q[1], q[3]);
                    quads.push_back(q);
                }
            }
    }
    /// The vertices in the four cells around the edge, counter-clockwise seen from its upper end;
    /// false at walls.
    static bool cornersAround(const Around& around, int axis, const Ijk& lowest, Quad& q) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (std::size_t k = 0; k < 4; ++k) {
            const bool inB = k == 1 || k == 2, inC = k >= 2;
            Ijk cell = lowest;
            cell[b] += inB, cell[c] += inC;
            const CellLeaf* leaf =
                around[std::size_t((cell.x >> 3) << 2 | (cell.y >> 3) << 1 | cell.z >> 3)];
            const unsigned at = Band::offsetOf(cell.x, cell.y, cell.z);
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
