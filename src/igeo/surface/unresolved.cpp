#include <igeo/surface/unresolved.h>

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/leaf_block.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace igeo {

namespace {

/// Voxels. No link leads through walls of 1.2 voxels, some through those of 1.0: measured.
constexpr double kResolved = 1.1;
/// Cosine of normals across a wall or gap; those of faces that meet in an edge of more than 26
/// degrees are less opposite.
constexpr float kParallel = -0.9f;
/// Voxels. In narrower gaps a conversion by OpenVDB may give voxels the sign of the inside:
/// measured.
constexpr double kOpenGap = 2.3;
/// Cosine of normals across such a gap, also between round parts.
constexpr float kAcrossGap = -0.7f;
/// Voxels. Values that OpenVDB lowers beside bends contradict others by up to 0.35.
constexpr float kContradiction = 0.4f;
/// Within this many steps of a contradiction, S is considered affected.
constexpr int kBeside = 2;
/// Cosine of normals within kBeside steps of a fold that was closed: it parts two sides. Those at
/// hollow edges of unions are less opposite.
constexpr float kFolded = -0.5f;
/// Nodes. In grooves that narrow to nothing psi parts single nodes from all others.
constexpr std::size_t kLargestIsland = 8;
/// Closer voxels have a foot point in any direction.
constexpr float kLeastPsi = 0.25f;

/// Balls around the neighbors of a voxel that contain no point of S. None is larger than psi at the
/// voxel allows: where a conversion has made a neighbor too deep, that neighbor is wrong.
class EmptyBalls {
public:
    EmptyBalls(const LeafBlock& psi, int x, int y, int z) {
        const auto here = float(std::abs(psi.at(x, y, z)));
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dz = -1; dz <= 1; ++dz) {
                    const auto value = float(std::abs(psi.at(x + dx, y + dy, z + dz)));
                    const Vec3f center(Ijk{dx, dy, dz});
                    if ((dx | dy | dz) && !std::isnan(value))
                        ball_[count_++] = {center, std::min(value, here + length(center))};
                }
    }
    struct Ball {
        Vec3f center;  ///< relative to the voxel
        float radius;
    };
    /// The ball in which a point is deepest, or to which it is nearest.
    struct Deepest {
        Ball ball{};
        float depth = -float(kInfinity);
    };
    Deepest at(const Vec3f& p) const {
        Deepest deepest;
        for (std::size_t k = 0; k < count_; ++k)
            if (const float depth = ball_[k].radius - length(p - ball_[k].center);
                depth > deepest.depth)
                deepest = {ball_[k], depth};
        return deepest;
    }
    /// The least depth of points at a distance from the voxel, found by steps out of the deepest
    /// ball.
    float leastDepth(Vec3f direction, float distance) const {
        constexpr int kSteps = 10;
        float least = float(kInfinity);
        for (int k = 0; k < kSteps; ++k) {
            const Vec3f p = distance * direction;
            const Deepest deepest = at(p);
            least = std::min(least, deepest.depth);
            if (least < kContradiction) break;
            const Vec3f out = normalized(p - deepest.ball.center);
            direction = normalized(p + (deepest.depth / 2) * out);
        }
        return least;
    }

private:
    std::array<Ball, 26> ball_;
    std::size_t count_ = 0;
};

/// Whether a sheet nearly parallel to that of node i is within two voxels along an axis.
bool hasParallel(const Band& band, NodeIndex i) {
    for (int face = 0; face < 6; ++face)
        for (const int steps : {1, 2}) {
            const NodeIndex j = band.neighbor(i, steps * Band::faceStep(face));
            if (j != kNoNode &&
                (dot(band.normal[i], band.normal[j]) < kParallel || band.stacked(i, j)))
                return true;
        }
    return false;
}

}  // namespace

double facingShare(const Band& band) {
    std::size_t facing = 0;
    for (NodeIndex i = 0; i < band.size(); ++i)
        facing += (band.facing[i] & Band::kFacing) && band.inCore(i) && hasParallel(band, i);
    return band.coreSize() > 0 ? double(facing) / double(band.coreSize()) : 0;
}

double reachAt(const Band& band, NodeIndex i) {
    double least = kInfinity;
    band.forBox(&BandLeaf::band, i, {}, 2, [&](NodeIndex j, const Ijk&) {
        if (dot(band.normal[i], band.normal[j]) < Band::kOtherSheet)
            least = std::min(least, length(band.footPoint(j) - band.footPoint(i)) / 2);
    });
    return least;
}

namespace {

/// Whether psi at a voxel, at least kLeastPsi and not smooth there, is a distance to no surface.
/// @param foot  the foot point by differences of psi
bool contradictsItself(const LeafBlock& psi, int x, int y, int z, const Vec3f& foot) {
    const float distance = float(std::abs(psi.at(x, y, z)));
    const EmptyBalls balls(psi, x, y, z);
    if (balls.leastDepth(normalized(foot), distance) < kContradiction) return false;
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz)
                if ((dx | dy | dz) &&
                    balls.leastDepth(normalized(Vec3f(Ijk{dx, dy, dz})), distance) < kContradiction)
                    return false;
    return true;
}

/// Whether normals around a voxel are as opposite as those of the sides of a fold. The lesser of
/// two level sets is one of their union, but no distance to it beside hollow edges.
bool isInFold(const Band& band, LeafIndex l, unsigned at) {
    std::array<Vec3f, 125> normals;
    std::size_t count = 0;
    bool found = false;
    band.forBox(&BandLeaf::band, l, at, {}, kBeside, [&](NodeIndex j, const Ijk&) {
        const Vec3f normal = band.normal[j];
        for (std::size_t k = 0; k < count; ++k) found |= dot(normal, normals[k]) < kFolded;
        normals[count++] = normal;
    });
    return found;
}

void markBeside(const Band& band, LeafIndex l, unsigned at, std::vector<std::uint8_t>& closed) {
    band.forBox(&BandLeaf::core, l, at, {}, kBeside, [&](NodeIndex core, const Ijk&) {
        std::atomic_ref(closed[core]).store(1, std::memory_order_relaxed);
    });
}

/// Whether a core node belongs to an island: no link leads out of its part of the core, which is
/// small and has other nodes beside it.
bool isOnIsland(const Band& band, NodeIndex node) {
    std::array<NodeIndex, kLargestIsland + 1> part{node};
    std::size_t size = 1;
    bool alone = true;
    for (std::size_t k = 0; k < size && size < part.size(); ++k) {
        const NodeIndex i = part[k];
        const std::uint32_t severed = band.severedSteps(i);
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int x, int y, int z) {
            if (!band.inCore(j) || size == part.size()) return;
            const Vec3f chord = band.footOf(i) - band.footOf(j) - Vec3f(Ijk{x, y, z});
            const float cosine = dot(band.normal[i], band.normal[j]);
            const bool linked = !(severed & SeveredLinks::bit(x, y, z)) &&
                                onOneSheet(chord, band.normal[i], band.normal[j], cosine);
            alone &= linked;
            if (linked && std::find(part.begin(), part.begin() + size, j) == part.begin() + size)
                part[size++] = j;
        });
    }
    return size < part.size() && !alone;
}

/// What faces a core node within two steps.
struct FacingSheets {
    bool thin = false;  ///< one nearly parallel, closer than voxels resolve
    bool gap = false;   ///< one outside, as close as in gaps that a conversion may close
};

FacingSheets facingSheets(const Band& band, NodeIndex i) {
    FacingSheets found;
    band.forBox(&BandLeaf::band, i, {}, 2, [&](NodeIndex j, const Ijk&) {
        const float cosine = dot(band.normal[i], band.normal[j]);
        if (cosine >= kAcrossGap) return;
        const Vec3d across = band.footPoint(j) - band.footPoint(i);
        const double apart = length(across);
        found.thin |= cosine < kParallel && apart < kResolved;
        found.gap |= apart < kOpenGap && dot(across, Vec3d(band.normal[i])) > 0;
    });
    return found;
}

double shareOf(const std::vector<std::uint8_t>& marked) {
    const auto count = std::count(marked.begin(), marked.end(), std::uint8_t(1));
    return double(count) / double(std::max<std::size_t>(marked.size(), 1));
}

}  // namespace

Unresolved unresolvedOf(const LevelSet& levelSet, const Band& band) {
    std::vector<std::uint8_t> thin(band.coreSize()), closed(thin), cutOff(thin), gap(thin);
    parallelFor(band.leaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        LeafBlock block;
        const LeafBlock::Accessor psi(levelSet.psi->constTree());
        for (auto l = LeafIndex(begin); l < end; ++l) {
            const BandLeaf& leaf = band.leaves[l];
            bool gathered = false;
            auto isClosed = [&](NodeIndex i, unsigned at) {
                if (!gathered)
                    block.gather(psi, {leaf.origin.x, leaf.origin.y, leaf.origin.z},
                                 band.transform.dx);
                gathered = true;
                return contradictsItself(block, int(at >> 6), int(at >> 3 & 7), int(at & 7),
                                         band.footOf(i));
            };
            const LeafNodes& nodes = leaf.band;
            for (NodeIndex i = nodes.firstNode; i < nodes.firstNode + nodes.count; ++i) {
                const std::uint8_t marks = band.facing[i];
                if (!marks) continue;
                const unsigned at = band.placeOf(i).offset;
                if (const NodeIndex k = leaf.core.node(at); k != kNoNode) {
                    if (marks & Band::kFacing) {
                        const FacingSheets sheets = facingSheets(band, i);
                        thin[k] = sheets.thin;
                        gap[k] = sheets.gap;
                    }
                    if (marks & (Band::kFacing | Band::kSevered)) cutOff[k] = isOnIsland(band, i);
                }
                if (marks & Band::kKink && std::abs(band.psi[i]) >= kLeastPsi && isClosed(i, at) &&
                    isInFold(band, l, at))
                    markBeside(band, l, at, closed);
            }
        }
    });
    Unresolved unresolved;
    unresolved.thin = shareOf(thin);
    unresolved.closed = shareOf(closed);
    unresolved.cutOff = shareOf(cutOff);
    unresolved.halfPrecision = levelSet.stats.halfPrecision;
    if (levelSet.stats.conversionUndone || levelSet.stats.halfPrecision)
        unresolved.gap = shareOf(gap);
    return unresolved;
}

namespace {

/// The share of the Euler characteristic of a union of voxels, times eight, that belongs to the
/// corner of eight voxels, by which of these are in the union: a corner belongs to one such corner,
/// an edge to two, a face to four and a voxel to eight.
std::array<int, 256> eulerTable() {
    std::array<int, 256> table{};
    for (unsigned in = 0; in < 256; ++in) {
        int edges = 0, faces = 0;
        for (unsigned axis = 1; axis <= 4; axis *= 2)
            for (unsigned k = 0; k < 8; ++k) {
                if (k & axis) continue;
                faces += (in >> k & 1) || (in >> (k | axis) & 1);
            }
        for (unsigned axis = 1; axis <= 4; axis *= 2)
            for (const unsigned side : {0u, axis}) {
                bool any = false;
                for (unsigned k = 0; k < 8; ++k) any |= (k & axis) == side && (in >> k & 1);
                edges += any;
            }
        const int voxels = std::popcount(in);
        table[in] = in == 0 ? 0 : 8 - 4 * edges + 2 * faces - voxels;
    }
    return table;
}

/// The corners at which a node alone is on one side of S, and the voxel across is exactly as deep
/// as the band: all other corners between both sides have eight nodes.
int lonelyCorners(const Band& band, NodeIndex i) {
    constexpr float kOn = 1e-3f;  // voxels
    int count = 0;
    if (std::abs(band.psi[i]) > kOn) return count;
    for (unsigned at = 0; at < 8; ++at) {
        bool isAlone = true;
        for (unsigned k = 1; k < 8 && isAlone; ++k) {
            const auto step = [&](unsigned axis) { return !(k & axis) ? 0 : at & axis ? 1 : -1; };
            const NodeIndex j = band.neighbor(i, step(1), step(2), step(4));
            isAlone =
                k == 7 ? j == kNoNode : j != kNoNode && (band.psi[j] < 0) != (band.psi[i] < 0);
        }
        count += isAlone;
    }
    return count;
}

}  // namespace

int eulerOnVoxels(const Band& band) {
    static const std::array<int, 256> table = eulerTable();
    std::atomic<std::int64_t> sum{0};
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        std::int64_t part = 0;
        for (auto i = NodeIndex(begin); i < end; ++i) {
            unsigned in = 0, count = 0;
            band.forCorners(&BandLeaf::band, i, {}, [&](NodeIndex j, unsigned k) {
                ++count;
                in |= unsigned(band.psi[j] < 0) << k;
            });
            if (count == 8) part += table[in];
            part += lonelyCorners(band, i) * table[band.psi[i] < 0 ? 1 : 254];
        }
        sum += part;
    });
    // The Euler characteristic of a surface is twice that of the body that it bounds.
    return int(sum / 4);
}

Unresolved unresolvedOf(const MeshFacts& facts, const Band& band) {
    Unresolved unresolved;
    unresolved.facing = facingShare(band);
    unresolved.cutOff = band.cutOff;
    if (facts.closed && facts.crossingPairs == 0)
        unresolved.eulerDifference = eulerOnVoxels(band) - facts.euler;
    return unresolved;
}

std::vector<std::string> unresolvedWarnings(const Unresolved& unresolved) {
    // Smaller shares occur next to sharp edges, and where a conversion has rounded bends.
    constexpr double kClosed = 0.001, kThin = 0.005, kCutOff = 0.001, kFacing = 0.02, kGap = 0.001;
    // Beside the necks of conversions whose last step is not undone fewer gaps show.
    constexpr double kGapInHalf = 0.0003;
    std::vector<std::string> warnings;
    auto warn = [&](const std::optional<double>& share, double much, const char* sentence) {
        if (!share || *share < much) return false;
        warnings.push_back(fmt::format(fmt::runtime(sentence), percent(*share)));
        return true;
    };
    if (!warn(unresolved.closed, kClosed,
              "psi contradicts itself next to {} of the surface: where folds or gaps of up to two "
              "voxels were closed when the level set was made, distances across them come out too "
              "short; smaller voxels, or the mesh itself, keep them open"))
        warn(unresolved.gap, unresolved.halfPrecision ? kGapInHalf : kGap,
             unresolved.halfPrecision
                 ? "gaps are narrower than 2.3 voxels on {} of the surface, and values in half "
                   "precision do not show whether OpenVDB made it from a mesh: such a conversion "
                   "closes parts of such gaps, and then fronts cross them and distances come out "
                   "too short; smaller voxels, or the mesh itself, keep them open"
                 : "gaps are narrower than 2.3 voxels on {} of the surface: OpenVDB's conversion "
                   "from a mesh closes parts of such gaps, and then fronts cross them and "
                   "distances come out too short; smaller voxels, or the mesh itself, keep them "
                   "open");
    warn(unresolved.thin, kThin,
         "walls or gaps are thinner than 1.1 voxels on {} of the surface: fronts may cross "
         "them, and distances come out too short; smaller voxels separate their sides");
    if (!warn(unresolved.cutOff, kCutOff,
              "{} of the surface lies in walls or grooves narrower than the voxels can show, "
              "and no path leads there: take smaller voxels"))
        warn(unresolved.facing, kFacing,
             "sheets face each other within two voxels on {} of the surface: distances are "
             "less accurate there; info gives the voxel size that separates them");
    if (const int difference = unresolved.eulerDifference.value_or(0)) {
        const double facing = unresolved.facing.value_or(0);
        warnings.push_back(fmt::format(
            "the voxels show tunnels or gaps otherwise than the mesh has them (Euler "
            "characteristic off by {}): they are about as narrow as voxels{}, and distances "
            "through them are off by parts of a voxel; take smaller voxels",
            std::abs(difference),
            facing > 0 ? ", as is " + percent(facing) +
                             " of the surface, where sheets face each other within two"
                       : ""));
    }
    return warnings;
}

}  // namespace igeo
