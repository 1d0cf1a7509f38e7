#include <igeo/metric/obstacles.h>

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/nearest_on_triangle.h>
#include <igeo/metric/vertex_weights.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;
using openvdb::Coord;
using openvdb::CoordBBox;

/// How much the cube of a mask's voxel grows on all sides: more than rounding and the turn of
/// normals between neighbors, less than an intended opening. Mask voxels.
constexpr double kFat = 0.1;
/// How far above and below S a mask blocks: half a voxel, and a margin for the 10 % by which psi
/// may be off in the core. Mask voxels.
constexpr double kReach = 0.6;
/// S deviates from a chord of length L by L^2 / (8 R); R is 2 voxels at the sharpest bends.
constexpr double kBulge = 1.0 / 16, kMostBulge = 1;
/// How far around the vertices, edges and triangles of a part of a mesh paths are blocked, and the
/// step between sampled points of a segment: the first is more than half of the second. Voxels.
constexpr double kPatchFat = 0.2, kPatchStep = 0.25;
/// How far from a triangle a point of it may be by rounding. Voxels.
constexpr double kOn = 1e-6;
/// Width of a cell of `near_`: a query within 5 voxels of a point reads 2 to 3 per axis.
constexpr double kCell = 8;

using VoxelSet = openvdb::MaskTree::RootNodeType;

Vec3d absolute(const Vec3d& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }
bool isFinite(const Vec3d& v) { return std::isfinite(v.x + v.y + v.z); }

/// Orders the ends, so that a segment and its reverse give the same result to the last bit.
bool before(const Vec3d& a, const Vec3d& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// Whether the parallelogram of points center + s u + t v with |s|, |t| <= 1 meets boxes of one
/// size with sides along the axes; both include their boundary.
///
/// By separating axes: the centers of the boxes that it meets fill a zonotope, the sum of the
/// segments +-u, +-v and the half sides, whose faces are spanned by two of these five.
class Parallelogram {
public:
    Parallelogram(const Vec3d& center, const Vec3d& u, const Vec3d& v, const Vec3d& halfSize)
        : extent(absolute(u) + absolute(v) + halfSize), center_(center), normal_{cross(u, v),
                                                                                 {0, -u.z, u.y},
                                                                                 {u.z, 0, -u.x},
                                                                                 {-u.y, u.x, 0},
                                                                                 {0, -v.z, v.y},
                                                                                 {v.z, 0, -v.x},
                                                                                 {-v.y, v.x, 0}} {
        for (std::size_t k = 0; k < normal_.size(); ++k)
            reach_[k] = std::abs(dot(u, normal_[k])) + std::abs(dot(v, normal_[k])) +
                        dot(halfSize, absolute(normal_[k]));
    }
    bool meetsBoxAt(const Vec3d& p) const {
        const Vec3d d = p - center_;
        for (int a = 0; a < 3; ++a)
            if (std::abs(d[a]) > extent[a]) return false;
        for (std::size_t k = 0; k < normal_.size(); ++k)
            if (std::abs(dot(d, normal_[k])) > reach_[k]) return false;
        return true;
    }

    const Vec3d extent;  ///< half sides of the box around all centers that it meets

private:
    Vec3d center_;
    std::array<Vec3d, 7> normal_;
    std::array<double, 7> reach_{};
};

/// Whether `test(voxel)` holds for some active voxel of the box [low, high]. By leaves: most boxes
/// lie in one or two.
template <typename Test>
bool anyActive(const VoxelSet& voxels, const Ijk& low, const Ijk& high, const Test& test) {
    for (int X = low.x & ~7; X <= high.x; X += 8)
        for (int Y = low.y & ~7; Y <= high.y; Y += 8)
            for (int Z = low.z & ~7; Z <= high.z; Z += 8) {
                const Coord origin(X, Y, Z);
                const auto* leaf = voxels.probeConstLeaf(origin);
                if (!leaf && !voxels.isValueOn(origin)) continue;
                for (int x = std::max(X, low.x); x <= std::min(X + 7, high.x); ++x)
                    for (int y = std::max(Y, low.y); y <= std::min(Y + 7, high.y); ++y)
                        for (int z = std::max(Z, low.z); z <= std::min(Z + 7, high.z); ++z)
                            if ((!leaf || leaf->isValueOn(Coord(x, y, z))) && test(Ijk{x, y, z}))
                                return true;
            }
    return false;
}

bool levelSetBlocks(const openvdb::FloatGrid& grid, const IndexMap& map, const Vec3d& a,
                    const Vec3d& b) {
    const openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> values(grid.constTree());
    const Vec3d from = map(a), along = map.direction(b - a);
    const int steps = int(std::ceil(4 * length(along)));
    for (int k = 0; k <= steps; ++k) {
        const Vec3d p = from + (steps ? double(k) / steps : 0.0) * along;
        if (openvdb::tools::BoxSampler::sample(values, openvdb::Vec3d(p.x, p.y, p.z)) < 0)
            return true;
    }
    return false;
}

/// Whether the strip center +-u +-v meets a grown cube of the mask.
bool stripMeets(const VoxelSet& mask, const Vec3d& center, const Vec3d& u, const Vec3d& v) {
    constexpr double kHalf = 0.5 + kFat;
    const Parallelogram strip(center, u, v, {kHalf, kHalf, kHalf});
    const Ijk low = -floorToIjk(strip.extent - center), high = floorToIjk(strip.extent + center);
    return anyActive(mask, low, high,
                     [&](const Ijk& voxel) { return strip.meetsBoxAt(Vec3d(voxel)); });
}

bool maskBlocks(const VoxelSet& mask, const IndexMap& map, const Vec3d& a, const Vec3d& b,
                const Vec3d& normal) {
    const Vec3d from = map(a), along = map.direction(b - a), across = map.direction(normal);
    const double bulge = std::min(kBulge * dot(b - a, b - a), kMostBulge);
    const double perNormal = length(across);
    const Vec3d v = perNormal > 0 ? (kReach / perNormal + bulge) * across : Vec3d{};
    // The box of a long strip consists mostly of other voxels, so the strip is cut.
    const int pieces = 1 + int(length(along) / 3);
    const Vec3d step = (1.0 / pieces) * along;
    for (int k = 0; k < pieces; ++k)
        if (stripMeets(mask, from + (k + 0.5) * step, 0.5 * step, v)) return true;
    return false;
}

/// Per point of a mesh whether a vertex there has `true`.
std::vector<bool> pointsWith(const TriangleMesh& mesh, const std::vector<bool>& ofVertex) {
    std::vector<bool> with;
    for (const double value :
         valuesAtPoints(mesh, std::vector<double>(ofVertex.begin(), ofVertex.end())))
        with.push_back(value > 0);
    return with;
}

using Ends = std::pair<std::uint32_t, std::uint32_t>;

/// The edges between two points inside, but those between two triangles inside or at the rim of the
/// mesh; and the other points inside, as edges from a point to itself.
std::vector<Ends> linesOf(const TriangleMesh& mesh, const std::vector<bool>& inside) {
    struct Sides {
        std::size_t inside = 0, all = 0;
    };
    std::map<Ends, Sides> edges;
    std::vector<bool> isLone(inside.size());
    for (const TriangleMesh::Triangle& t : mesh.triangles)
        for (const std::uint32_t p : t) isLone[p] = inside[p];
    for (const TriangleMesh::Triangle& t : mesh.triangles) {
        const bool whole = inside[t[0]] && inside[t[1]] && inside[t[2]];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            if (!inside[a] || !inside[b]) continue;
            isLone[a] = isLone[b] = false;
            Sides& sides = edges[std::minmax(a, b)];
            sides.inside += whole, ++sides.all;
        }
    }
    std::vector<Ends> lines;
    for (const auto& [ends, sides] : edges)
        if (sides.inside < sides.all) lines.push_back(ends);
    for (std::uint32_t p = 0; p < inside.size(); ++p)
        if (isLone[p]) lines.emplace_back(p, p);
    return lines;
}

class EitherObstacle final : public Obstacles {
public:
    EitherObstacle(std::shared_ptr<const Obstacles> a, std::shared_ptr<const Obstacles> b)
        : a_(std::move(a)), b_(std::move(b)) {}
    bool block(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const override {
        return a_->block(a, b, normal) || b_->block(a, b, normal);
    }
    bool mayBeNear(const Vec3d& p, double radius) const override {
        return a_->mayBeNear(p, radius) || b_->mayBeNear(p, radius);
    }

private:
    std::shared_ptr<const Obstacles> a_, b_;
};

}  // namespace

ObstacleSet::ObstacleSet(const Similarity& transform)
    : transform_(transform), near_(std::make_shared<VoxelSet>()) {}

void ObstacleSet::addSphere(const Vec3d& centerWorld, double radiusWorld) {
    if (!isFinite(centerWorld) || !(radiusWorld > 0) || !std::isfinite(radiusWorld))
        throw Error(
            Kind::InvalidArgument,
            fmt::format("a sphere about {} of radius {:g}; the center must be finite, the radius "
                        "positive and finite",
                        textOf(centerWorld, 9), radiusWorld));
    spheres_.push_back({transform_.indexFromWorld(centerWorld), radiusWorld / transform_.dx});
}

void ObstacleSet::addBox(const Vec3d& low, const Vec3d& high) {
    if (!isFinite(low) || !isFinite(high) || low.x > high.x || low.y > high.y || low.z > high.z)
        throw Error(Kind::InvalidArgument, "a box from " + textOf(low, 9) + " to " +
                                               textOf(high, 9) +
                                               "; the first corner must be the lower one in every "
                                               "coordinate, and both finite");
    boxes_.push_back(
        {transform_.indexFromWorld(0.5 * (low + high)), (0.5 / transform_.dx) * (high - low)});
}

void ObstacleSet::addGrid(const ObstacleGrid& source) {
    const std::string where = " (" + source.file + ", grid '" + source.name + "')";
    const IndexMap map = indexMap(transform_, source.grid->transform(), where);
    const std::size_t count = levelSets_.size() + masks_.size();
    if (const auto mask = openvdb::gridConstPtrCast<openvdb::MaskGrid>(source.grid)) {
        addMask(*mask, map, [](bool) { return true; });
    } else if (const auto bools = openvdb::gridConstPtrCast<openvdb::BoolGrid>(source.grid)) {
        addMask(*bools, map, [](bool value) { return value; });
    } else if (const auto values = openvdb::gridConstPtrCast<openvdb::FloatGrid>(source.grid)) {
        for (auto it = values->cbeginValueOn(); it; ++it)
            if (std::isnan(*it))
                throw Error(Kind::BadInput, "the obstacle holds values that are NaN" + where,
                            "rebuild it from its source");
        if (values->getGridClass() == openvdb::GRID_LEVEL_SET)
            addLevelSet(values, map);
        else
            addMask(*values, map, [](float value) { return value > 0.5f; });
    }
    if (levelSets_.size() + masks_.size() == count)
        throw Error(Kind::BadInput, "the obstacle blocks nothing" + where,
                    "a level set blocks where it is negative, a mask in its active voxels, any "
                    "other grid in active voxels that are true or above 0.5");
}

/// Whether a segment passes over a part of a mesh, or within kPatchFat of it. Where the segment
/// leaves S, as the chord of a bend or of a sharp edge, the part is searched for along the
/// segment's normal and, of the nearest triangle, along its own.
bool ObstacleSet::patchBlocks(const Patch& patch, const Vec3d& a, const Vec3d& b,
                              const Vec3d& normal) {
    if (patch.isRegion) return patch.parts->nearest(a, kOn).triangle != SurfaceTriangles::kNone;
    constexpr double kAcross = 0.1;  // on a face beside that of the part it is 0 or less
    const Vec3d along = b - a;
    const double chord = length(along), bulge = std::min(kBulge * chord * chord, kMostBulge),
                 reach = kReach + bulge, most = std::max(reach, chord);
    const auto isAlong = [&](const Vec3d& off, const Vec3d& n, double within) {
        const double up = dot(off, n);
        return std::abs(up) <= within && length(off - up * n) <= kPatchFat;
    };
    const int steps = int(std::ceil(chord / kPatchStep));
    for (int k = 0; k <= steps; ++k) {
        const Vec3d p = a + (steps ? double(k) / steps : 0.0) * along;
        const auto isAbove = [&](const SurfaceTriangles::Place& place) {
            const double cosine = dot(patch.normal[place.triangle], normal),
                         // The edge of two faces that meet at 60 degrees or more is no farther.
                edge = chord * std::sqrt(std::max(1 - cosine * cosine, 0.0));
            // The other side of a thin wall lies below.
            const bool isOther = cosine <= Band::kOtherSheet;
            return isAlong(place.point - p, normal, isOther ? bulge + kFat : std::max(reach, edge));
        };
        if (patch.parts->any(p, most + kPatchFat, isAbove)) return true;
        const auto place = patch.parts->nearest(p, reach + kPatchFat);
        if (place.triangle == SurfaceTriangles::kNone) continue;
        const Vec3d& own = patch.normal[place.triangle];
        if (dot(own, normal) > kAcross && isAlong(place.point - p, own, reach)) return true;
    }
    return false;
}

void ObstacleSet::addVertices(const TriangleMesh& mesh, const std::vector<bool>& blocked) {
    addParts(mesh, blocked, false);
}

void ObstacleSet::addVertexRegion(const TriangleMesh& mesh, const std::vector<bool>& inside) {
    addParts(mesh, inside, true);
    for (const auto& [from, to] : linesOf(mesh, pointsWith(mesh, inside)))
        lines_.push_back({transform_.indexFromWorld(mesh.points[from]),
                          transform_.indexFromWorld(mesh.points[to])});
}

void ObstacleSet::addParts(const TriangleMesh& mesh, const std::vector<bool>& blocked,
                           bool isRegion) {
    const std::vector<bool> atPoint = pointsWith(mesh, blocked);
    std::vector<Vec3d> points;
    for (const Vec3d& p : mesh.points) points.push_back(transform_.indexFromWorld(p));
    TriangleMesh oriented = mesh;
    orientConsistently(oriented);
    std::vector<SurfaceTriangles::Triangle> parts;
    std::vector<Vec3d> normals;
    bool any = false;
    for (const TriangleMesh::Triangle& t : oriented.triangles) {
        std::vector<std::uint32_t> corners;
        for (const std::uint32_t c : t)
            if (atPoint[c]) corners.push_back(c);
        any |= !corners.empty();
        if (corners.size() < (isRegion ? 3 : 1)) continue;
        // Edges and points become triangles without area.
        corners.resize(3, corners.back());
        parts.push_back({corners[0], corners[1], corners[2]});
        const Vec3d& first = points[t[0]];
        normals.push_back(normalized(cross(points[t[1]] - first, points[t[2]] - first)));
    }
    if (!any)
        throw Error(Kind::BadInput,
                    fmt::format("the {} no vertex of '{}'",
                                isRegion ? "region has" : "obstacle blocks", mesh.file),
                    fmt::format("a vertex is {} by a value that is not 0, or by the value that is "
                                "named",
                                isRegion ? "inside" : "blocked"));
    if (!parts.empty()) addPatch(std::move(points), std::move(parts), std::move(normals), isRegion);
}

void ObstacleSet::addTriangles(const SurfaceTriangles& mesh, const std::vector<bool>& blocked) {
    std::vector<SurfaceTriangles::Triangle> parts;
    std::vector<Vec3d> normals;
    for (std::size_t t = 0; t < mesh.size(); ++t)
        if (blocked[t]) parts.push_back(mesh[t]), normals.push_back(mesh.normal(t));
    addPatch(mesh.points(), std::move(parts), std::move(normals), false);
}

void ObstacleSet::addPatch(std::vector<Vec3d> points, std::vector<SurfaceTriangles::Triangle> parts,
                           std::vector<Vec3d> normals, bool isRegion) {
    for (const SurfaceTriangles::Triangle& t : parts) {
        const Vec3d &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
        const double grown = kReach + kMostBulge + kPatchFat;
        Vec3d low = a, high = a;
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min({a[k], b[k], c[k]}) - grown;
            high[k] = std::max({a[k], b[k], c[k]}) + grown;
        }
        markNear(low, high);
    }
    std::vector<std::array<std::uint32_t, 3>> alone(
        parts.size(), {SurfaceTriangles::kNone, SurfaceTriangles::kNone, SurfaceTriangles::kNone});
    patches_.push_back(
        {std::make_shared<SurfaceTriangles>(std::move(points), std::move(parts), std::move(alone)),
         std::move(normals), isRegion});
}

void ObstacleSet::addLevelSet(const openvdb::FloatGrid::ConstPtr& grid, const IndexMap& map) {
    const IndexMap toBand = map.inverse();
    bool any = grid->background() < 0;
    everywhere_ |= any;
    // Negative values interpolate to negative ones up to the next voxel.
    const auto mark = [&](const CoordBBox& voxels) {
        markNear(toBand, voxels, 1);
        any = true;
    };
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf)
        for (auto it = leaf->cbeginValueAll(); it; ++it)
            if (*it < 0) {
                mark(leaf->getNodeBoundingBox());
                break;
            }
    auto tile = grid->cbeginValueAll();
    for (tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1); tile; ++tile)
        if (*tile < 0) mark(tile.getBoundingBox());
    if (any) levelSets_.push_back({grid, map});
}

template <typename Grid, typename IsBlocked>
void ObstacleSet::addMask(const Grid& grid, const IndexMap& map, const IsBlocked& isBlocked) {
    const IndexMap toBand = map.inverse();
    const auto blocked = std::make_shared<VoxelSet>();
    for (auto it = grid.cbeginValueOn(); it; ++it) {
        if (!isBlocked(*it)) continue;
        blocked->addTile(it.getLevel(), it.getCoord(), true, true);
        markNear(toBand, it.getBoundingBox(), 0.5 + kFat + kReach);
    }
    if (!blocked->empty()) masks_.push_back({blocked, map});
}

/// Marks the cells around a box of voxels grown by `grown` on all sides and by the largest bulge.
void ObstacleSet::markNear(const IndexMap& toBand, const CoordBBox& voxels, double grown) {
    const Coord &low = voxels.min(), &high = voxels.max();
    const Vec3d center = toBand(0.5 * Vec3d(low.x() + double(high.x()), low.y() + double(high.y()),
                                            low.z() + double(high.z())));
    Vec3d extent{kMostBulge, kMostBulge, kMostBulge};
    for (std::size_t a = 0; a < 3; ++a)
        extent += (0.5 * (high[a] - low[a]) + grown) * absolute(toBand.axis[a]);
    markNear(center - extent, center + extent);
}

void ObstacleSet::markNear(const Vec3d& from, const Vec3d& to) {
    const Ijk first = floorToIjk(from * (1 / kCell)), last = floorToIjk(to * (1 / kCell));
    near_->fill({{first.x, first.y, first.z}, {last.x, last.y, last.z}}, true, true);
}

bool ObstacleSet::gridMayBeNear(const Vec3d& p, double radius) const {
    if (everywhere_) return true;
    if (near_->empty()) return false;
    const Vec3d around(radius, radius, radius);
    const Ijk low = floorToIjk((p - around) * (1 / kCell)),
              high = floorToIjk((p + around) * (1 / kCell));
    return anyActive(*near_, low, high, [](const Ijk&) { return true; });
}

bool ObstacleSet::mayBeNear(const Vec3d& p, double radius) const {
    for (const Sphere& s : spheres_)
        if (length(p - s.center) <= s.radius + radius) return true;
    for (const Box& box : boxes_) {
        const Vec3d d = absolute(transform_.worldFromIndexDirection(p - box.center)) - box.halfSize;
        if (length(Vec3d{std::max(d.x, 0.0), std::max(d.y, 0.0), std::max(d.z, 0.0)}) <= radius)
            return true;
    }
    return gridMayBeNear(p, radius);
}

bool ObstacleSet::block(const Vec3d& oneEnd, const Vec3d& otherEnd, const Vec3d& normal) const {
    const bool swap = before(otherEnd, oneEnd);
    const Vec3d &a = swap ? otherEnd : oneEnd, &b = swap ? oneEnd : otherEnd;
    const Vec3d middle = 0.5 * (a + b);
    for (const Sphere& s : spheres_)
        if (distanceToSegment(s.center, a, b) <= s.radius) return true;
    for (const Box& box : boxes_) {
        const Vec3d center = transform_.worldFromIndexDirection(middle - box.center),
                    half = transform_.worldFromIndexDirection(0.5 * (b - a));
        if (Parallelogram(center, half, {}, box.halfSize).meetsBoxAt({})) return true;
    }
    if (!gridMayBeNear(middle, 0.5 * length(b - a))) return false;
    for (const LevelSetBody& body : levelSets_)
        if (levelSetBlocks(*body.grid, body.map, a, b)) return true;
    for (const MaskBody& body : masks_)
        if (maskBlocks(*body.blocked, body.map, a, b, normal)) return true;
    for (const auto& patch : patches_)
        if (patchBlocks(patch, a, b, normal)) return true;
    return false;
}

void ObstacleSet::forLines(const std::function<void(const Line&)>& visit) const {
    for (const Line& line : lines_) visit(line);
}

void ObstacleSet::forVoxels(const std::function<void(const Vec3d&)>& visit) const {
    auto visitAll = [&](const IndexMap& toBand, auto voxels, const auto& isInside) {
        for (; voxels; ++voxels) {
            const Coord at = voxels.getCoord();
            if (isInside(*voxels)) visit(toBand(Vec3d(at.x(), at.y(), at.z())));
        }
    };
    for (const MaskBody& body : masks_) {
        const IndexMap toBand = body.map.inverse();
        std::vector<const VoxelSet::LeafNodeType*> leaves;
        body.blocked->getNodes(leaves);
        for (const auto* leaf : leaves)
            visitAll(toBand, leaf->cbeginValueOn(), [](bool) { return true; });
    }
    for (const LevelSetBody& body : levelSets_) {
        const IndexMap toBand = body.map.inverse();
        for (auto leaf = body.grid->tree().cbeginLeaf(); leaf; ++leaf)
            visitAll(toBand, leaf->cbeginValueAll(), [](float value) { return value < 0; });
    }
}

std::shared_ptr<const Obstacles> either(std::shared_ptr<const Obstacles> a,
                                        std::shared_ptr<const Obstacles> b) {
    if (!a || !b) return a ? a : b;
    return std::make_shared<EitherObstacle>(std::move(a), std::move(b));
}

}  // namespace igeo
