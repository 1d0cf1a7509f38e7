#include <igeo/results/detail/crossed_cells.h>

#include <igeo/band/band.h>
#include <igeo/base/detail/four_doubles.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/level_set.h>

#include <bit>
#include <cmath>

namespace igeo {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

openvdb::Coord coordOf(const Ijk& v) { return {v.x, v.y, v.z}; }

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
        if (stepZ) {
            *to = float(double(*from) * scale);
            inside = *to < 0;
        }
        for (int z = stepZ ? 8 : 0; z < 8; z += 4) {
            using Four = Registers<4>::Vector;
            const Four scaled = __builtin_convertvector(
                __builtin_convertvector(loadAs<Four>(from + z), FourDoubles) * scale, Four);
            storeLanes(scaled, to + z);
            inside |= bitsOf<4>(scaled < 0) << z;
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

    /// Moves a place along grad psi to psi = 0.
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

/// Cells of one sheet, whose corners are all active, side by side.
struct FourCells {
    std::size_t count = 0;
    std::array<std::array<float, 4>, 8> psi{};  ///< per corner
    std::array<Ijk, 4> cell;                    ///< in the leaf
    std::array<std::size_t, 4> point;           ///< number of the vertex

    void add(const Ijk& itsCell, const std::array<float, 8>& itsPsi, std::size_t itsPoint) {
        for (std::size_t k = 0; k < 8; ++k) psi[k][count] = itsPsi[k];
        cell[count] = itsCell, point[count++] = itsPoint;
    }
    bool full() const { return count == cell.size(); }
};

/// Places in cells, each a register per axis.
struct FourPlaces {
    std::array<std::array<double, 4>, 3> mean;    ///< of the points where edges are crossed
    std::array<std::array<double, 4>, 3> onZero;  ///< the mean, moved to psi = 0
    unsigned moved;                               ///< bits: where it came there within the cell
    unsigned steep;                               ///< bits: where psi may jump as at a wall

    Vec3d at(const std::array<std::array<double, 4>, 3>& of, std::size_t lane) const {
        return {of[0][lane], of[1][lane], of[2][lane]};
    }
};

/// What Trilinear and CellFinder do, with the same bits.
class CellLanes {
    using V = FourDoubles;

    /// The mean of the points where edges are crossed.
    IGEO_INLINE static FourVectors meanOf(const V (&psi)[8]) {
        const V one = V{} + 1;
        V sum[3] = {}, count{};
        for (int axis = 0; axis < 3; ++axis)
            for (unsigned k = 0; k < 8; ++k) {
                const unsigned bit = CellSheets::bitOf(axis);
                if (k & bit) continue;
                const V &a = psi[k], &b = psi[k | bit];
                const auto crossed = (a < 0) ^ (b < 0);
                const V counted = crossed ? one : V{};
                for (int other = 0; other < 3; ++other)
                    if (other == axis)
                        sum[axis] += crossed ? a / (a - b) : V{};
                    else if (k & CellSheets::bitOf(other))
                        sum[other] += counted;
                count += counted;
            }
        return FourVectors{sum[0], sum[1], sum[2]} * (1 / count);
    }
    /// @return where it came to psi = 0
    IGEO_INLINE static FourFlags project(const V (&v)[8], FourVectors& p) {
        constexpr double kTolerance = 1e-6;
        const V c = v[0], x = v[4] - c, y = v[2] - c, z = v[1] - c, xy = v[6] - v[4] - y,
                xz = v[5] - v[4] - z, yz = v[3] - v[2] - z, xyz = v[7] - v[6] - (v[5] - v[4]) - yz;
        FourFlags moved{}, moving = ~moved;
        for (int iteration = 0; iteration < 20; ++iteration) {
            moving &= (p.x >= 0) & (p.y >= 0) & (p.z >= 0) & (p.x < 1) & (p.y < 1) & (p.z < 1);
            const FourVectors g{x + xy * p.y + p.z * (xz + xyz * p.y),
                                y + yz * p.z + p.x * (xy + xyz * p.z),
                                z + xz * p.x + p.y * (yz + xyz * p.x)};
            const V psi = c + g.x * p.x + p.y * (y + yz * p.z) + z * p.z, g2 = dot(g, g);
            const FourFlags there = moving & ((psi < 0 ? -psi : psi) <= kTolerance);
            moved |= there;
            moving &= ~there & (g2 >= 1e-4);
            if (!bitsOf(moving)) break;
            const FourVectors next = p - g * (psi / g2);
            p = {moving ? next.x : p.x, moving ? next.y : p.y, moving ? next.z : p.z};
        }
        return moved;
    }
    IGEO_INLINE static void store(const FourVectors& p, std::array<std::array<double, 4>, 3>& to) {
        storeLanes(p.x, &to[0]);
        storeLanes(p.y, &to[1]);
        storeLanes(p.z, &to[2]);
    }

public:
    IGEO_INLINE static void place(const FourCells& cells, FourPlaces& to) {
        using Four = Registers<4>::Vector;
        constexpr float kSteep = 1.9f;
        Four low = loadAs<Four>(&cells.psi[0]), high = low;
        V psi[8];
        for (std::size_t k = 0; k < 8; ++k) {
            const Four here = loadAs<Four>(&cells.psi[k]);
            low = here < low ? here : low, high = here > high ? here : high;
            psi[k] = __builtin_convertvector(here, V);
        }
        to.steep = bitsOf<4>(~(high - low <= kSteep));
        FourVectors p = meanOf(psi);
        store(p, to.mean);
        to.moved = bitsOf(project(psi, p));
        store(p, to.onZero);
    }
};
void placeByTwo(const FourCells& cells, FourPlaces& to) { CellLanes::place(cells, to); }
#ifdef IGEO_AVX2
IGEO_AVX2 void placeByFour(const FourCells& cells, FourPlaces& to) { CellLanes::place(cells, to); }
#endif

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
                unsigned crossed = (any | any >> 1) & ~(all & all >> 1) & 0xff, active = 0x1ff;
                for (int k = 0; k < 4; ++k) active &= block_.active(x + k / 2, y + k % 2);
                leaf_->cells.mask[std::size_t(x)] |= std::uint64_t(crossed) << 8 * y;
                for (; crossed; crossed &= crossed - 1) {
                    const int z = std::countr_zero(crossed);
                    addCell({x, y, z}, (active & active >> 1) >> z & 1);
                }
            }
        placeFour();
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

    unsigned insideOf(const Ijk& cell) const {
        return cornerBits(cell, [&](int x, int y) { return block_.inside(x, y); });
    }
    void addWall(const Ijk& cell) {
        leaf_->walls[std::size_t(cell.x)] |= std::uint64_t(1) << (8 * cell.y + cell.z);
        leaf_->hasWalls = true;
    }

    /// Finds the vertices of the cells that wait.
    void placeFour() {
        FourPlaces places;
#ifdef IGEO_AVX2
        (eightAtATime() ? placeByFour : placeByTwo)(four_, places);
#else
        placeByTwo(four_, places);
#endif
        for (std::size_t lane = 0; lane < four_.count; ++lane) {
            const Ijk& cell = four_.cell[lane];
            const Vec3d low(leaf_->origin + cell);
            leaf_->points[four_.point[lane]] =
                places.moved >> lane & 1 ? low + places.at(places.onZero, lane)
                                         : ontoSurface(band_, low + places.at(places.mean, lane));
            if (places.steep >> lane & 1 && isWall(block_.corners(cell.x, cell.y, cell.z), 0xff,
                                                   CellSheets::of(insideOf(cell))))
                addWall(cell);
        }
        four_.count = 0;
    }

    /// @param complete  whether all corners are active
    void addCell(const Ijk& cell, bool complete) {
        const std::array<float, 8> psi = block_.corners(cell.x, cell.y, cell.z);
        const unsigned inside = insideOf(cell);
        const CellSheets& usual = CellSheets::of(inside);
        if (complete && usual.count == 1 && !usual.twice && !band_.triangles) {
            four_.add(cell, psi, leaf_->points.size());
            leaf_->points.emplace_back();
            if (four_.full()) placeFour();
            return;
        }
        const unsigned active = cornerBits(cell, [&](int x, int y) { return block_.active(x, y); });
        if (isWall(psi, active, usual)) addWall(cell);
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
        return ontoSurface(band_, from);
    }

    const Accessor accessor_;
    const openvdb::FloatTree& tree_;
    const Band& band_;
    double dx_;
    CellBlock block_;
    CellLeaf* leaf_ = nullptr;
    FourCells four_;  ///< which wait for their vertices
    std::vector<Vec3d> further_;
};

}  // namespace

void findCells(const LevelSet& levelSet, const Band& band, std::span<CellLeaf> leaves) {
    parallelFor(leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
        CellFinder finder(levelSet, band);
        for (std::size_t l = begin; l < end; ++l) finder.find(leaves[l]);
    });
}

}  // namespace igeo
