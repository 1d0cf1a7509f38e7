// Walls and slots of a few voxels between faces that lie in one plane: distances lead around them,
// as on the part laid out flat.
#include <igeo/geodesic_solver.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/path/trace.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/mesh_shapes.h>
#include <support/openvdb.h>
#include <support/random_surface.h>
#include <support/shapes.h>
#include <support/sweep.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

/// A part, and its outline across y: a strip of faces that is as wide as the part, or as the wall.
/// Lengths in voxels.
struct WallPart {
    std::string name;
    std::vector<Block> blocks;
    std::vector<std::array<double, 2>> outline;  ///< corners (x, z)
    double low, high;                            ///< where the strip begins and ends in y
    Vec3d seed;                                  ///< on the first face
    double around = kInfinity;                   ///< length of the outline where it is closed
};

/// A wall on a plate, from end to end.
WallPart rib(double t) {
    const double h = t / 2;
    return {"rib",
            {{{-12, -12, -5}, {12, 12, 0}}, {{-h, -12, 0}, {h, 12, 7}}},
            {{-12, 0}, {-h, 0}, {-h, 7}, {h, 7}, {h, 0}, {12, 0}},
            -12,
            12,
            {-5.3, 0.7, 0}};
}
/// The air of it: a slot in a block.
WallPart slot(double t) {
    const double h = t / 2;
    return {"slot",
            {{{-12, -12, -11}, {12, 12, 0}}, {{-h, -12, -7}, {h, 12, 0}, true}},
            {{-12, 0}, {-h, 0}, {-h, -7}, {h, -7}, {h, 0}, {12, 0}},
            -12,
            12,
            {-5.3, 0.7, 0}};
}
/// A wall between two blocks, its upper edge flush with their tops.
WallPart web(double t) {
    const double h = t / 2;
    return {"web",
            {{{-9, -16, -10}, {9, -8, 0}}, {{-9, 8, -10}, {9, 16, 0}}, {{-h, -8, -10}, {h, 8, 0}}},
            {{-h, -10}, {-h, 0}, {h, 0}, {h, -10}, {-h, -10}},
            -8,
            8,
            {-h, 0.7, -3.2},
            20 + 2 * t};
}

/// Its voxels, turned and moved: three turns by multiples of 45 degrees, and others at random.
openvdb::math::Transform::Ptr turned(int turn, double dx = 1) {
    if (turn < 3)
        return rotatedTransform(dx, Vec3d(0.3 + 0.4 * turn, 0.5 - 0.7 * turn, 0.8), 45.0 * turn,
                                Vec3d(0.013, 0.327, -0.211));
    Random random(static_cast<unsigned>(turn));
    const Vec3d axis = random.direction();
    const double degrees = random.between(0, 360);
    Vec3d offset;
    for (int k = 0; k < 3; ++k) offset[k] = random.between(0, 1);
    return rotatedTransform(dx, axis, degrees, offset);
}

/// Where the strip that the outline sweeps holds a point: how far along the outline, and how many
/// edges before it.
struct OnStrip {
    double s = 0, off = kInfinity;
    int face = 0;

    OnStrip(const WallPart& part, const Vec3d& p) {
        double before = 0;
        for (std::size_t k = 0; k + 1 < part.outline.size(); ++k) {
            const double ax = part.outline[k][0], az = part.outline[k][1],
                         dx = part.outline[k + 1][0] - ax, dz = part.outline[k + 1][1] - az,
                         side = std::hypot(dx, dz);
            const double along =
                std::clamp(((p.x() - ax) * dx + (p.z() - az) * dz) / side, 0.0, side);
            const double r =
                std::hypot(p.x() - ax - along * dx / side, p.z() - az - along * dz / side);
            if (r < off) *this = {before + along, r, int(k)};
            before += side;
        }
    }

private:
    OnStrip(double sAt, double r, int f) : s(sAt), off(r), face(f) {}
};

struct StripErrors {
    double low = 0, high = 0;  ///< per edge crossed (one at least), voxels
    std::size_t count = 0, unreached = 0;
    double longestStep = 0;
};

/// Against the straight line on the strip laid out flat, where no path around its ends is shorter.
StripErrors errorsOf(const WallPart& part, const Distance& d) {
    StripErrors e;
    const Band& band = d.band();
    const Field& field = d.field();
    const Vec3d seed = seedOf(d);
    const OnStrip from(part, seed);
    for (NodeIndex i = 0; i < band.size(); ++i) {
        if (!band.inCore(i)) continue;
        const Vec3d p = worldOf(band, band.footPoint(i));
        const OnStrip at(part, p);
        const double along = std::abs(at.s - from.s);
        const double exact = std::hypot(std::min(along, part.around - along), p.y() - seed.y());
        const double overLow = p.y() + seed.y() - 2 * part.low,
                     overHigh = 2 * part.high - p.y() - seed.y();
        // A path that leaves the strip at an end and comes back is as long as to there and back.
        if (at.off > 0.3 || exact > std::min(overLow, overHigh)) continue;
        ++e.count;
        if (!(field.distance[i] < kInfinity)) {
            ++e.unreached;
            continue;
        }
        int edges = std::abs(at.face - from.face);
        if (part.around < kInfinity) edges = std::min(edges, int(part.outline.size()) - 1 - edges);
        edges = std::max(edges, 1);
        const double error = (field.distance[i] - exact) / edges;
        e.low = std::min(e.low, error), e.high = std::max(e.high, error);
    }
    std::vector<SurfacePoint> targets;
    for (NodeIndex i = 0; i < band.size(); i += 97)
        if (field.distance[i] < kInfinity)
            targets.push_back(nearestSurfacePoint(band, band.footPoint(i)));
    for (const Path& path : tracePaths(field, targets))
        for (std::size_t k = 1; k < path.vertices.size(); ++k)
            e.longestStep = std::max(e.longestStep,
                                     length(path.vertices[k].pIndex - path.vertices[k - 1].pIndex));
    return e;
}

}  // namespace

TEST_CASE("thin walls: fronts go around ribs, slots and webs between faces of one plane") {
    for (const auto& make : {rib, slot, web})
        for (const double t : {2.0, 2.3, 2.6, 3.3, 4.0})
            for (const int turn : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 103}) {
                const WallPart part = make(t);
                const GeodesicSolver solver(
                    Surface(*makeLevelSet(partOf(part.blocks), *turned(turn), 3)));
                const StripErrors e = errorsOf(part, solver.distance({fromVdb(part.seed)}));
                std::printf(
                    "%s of %.1f voxels, turn %d: %.2f to %.2f voxels per edge, steps up to "
                    "%.2f, %zu unreached of %zu\n",
                    part.name.c_str(), t, turn, e.low, e.high, e.longestStep, e.unreached, e.count);
                CHECK(e.count > 250);
                CHECK(e.unreached == 0);
                // Measured 0.17, and 0.24 over 120 turns; 0.43 by normals that mix faces, 4.5
                // through a wall.
                CHECK(e.low > -0.36);
                CHECK(e.high < 0.5);         // measured 0.49; 0.76 by neighbors alone
                CHECK(e.longestStep < 2.6);  // measured 1.75
            }
}

/// Whether the surface of a part passes within 0.3 of a point.
bool isNearSurface(const Shape& part, const Vec3d& p) {
    constexpr double kOff = 0.3;
    const double here = part.sdf(p);
    if (!(std::abs(here) < kOff)) return false;
    for (int k = 0; k < 27; ++k) {
        const Vec3d step(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
        if (step != Vec3d(0) && (part.sdf(p + kOff * step.unit()) < 0) != (here < 0)) return true;
    }
    return false;
}

TEST_CASE("thin walls: fronts pass where a fin meets a ball at an acute angle") {
    // Against level sets of a third of the voxel size.
    std::vector<double> off;
    std::size_t unreached = 0;
    for (const double low : {7.5, 8.5, 9.5, 10.5, 11.5})
        for (int turn = 0; turn < 3; ++turn) {
            Shape part = sphere(Vec3d(0), 12);
            const Shape fin = partOf({{{0, -9, low}, {26, 9, low + 2.3}}});
            part.sdf = [ball = part.sdf, fin = fin.sdf](const Vec3d& p) {
                return std::min(ball(p), fin(p));
            };
            part.bounds.expand(fin.bounds);
            const auto distances = [&](double dx) {
                return GeodesicSolver(Surface(*makeLevelSet(part, *turned(turn, dx), 3)))
                    .distance({fromVdb(Vec3d(-12, 0.3, 0))});
            };
            const Distance coarse = distances(1), fine = distances(1.0 / 3);
            const Band& band = coarse.band();
            for (NodeIndex i = 0; i < band.size(); ++i) {
                if (!band.inCore(i)) continue;
                const Vec3d p = worldOf(band, band.footPoint(i));
                // At edges the foot points of coarse voxels are off by a part of a voxel. Inside of
                // hollow edges the sdf is no distance.
                const double exact = isNearSurface(part, p) ? fine.at(fromVdb(p)) : kInfinity;
                const double found = coarse.field().distance[i];
                if (!(exact < kInfinity)) continue;
                unreached += !(found < kInfinity);
                off.push_back(found - exact);
            }
        }
    std::sort(off.begin(), off.end());
    const std::size_t n = off.size();
    std::printf("%zu nodes, %zu unreached, off by %.2f (1 %%), %.2f (95 %%), %.2f (98 %%)\n", n,
                unreached, off[n / 100], off[n * 95 / 100], off[n * 98 / 100]);
    CHECK(n > 30000);
    CHECK(unreached < 317);          // measured 215; 317 with kKept = 0
    CHECK(off[n / 100] > -0.9);      // measured -0.62
    CHECK(off[n * 98 / 100] < 1.7);  // measured 1.57
}

TEST_CASE("thin walls: paths end at seeds, curves and groups along the surface") {
    constexpr double kLong = 14, kDeep = 16, kMiddle = Sweep::kWidth / 2;
    enum Kind { Point, Along, Group, Across };
    struct PathErrors {
        double shorter = 0, off = 0;  ///< than exact, from the surface; voxels
        std::size_t lost = 0;
    };
    const auto errorsOf = [&](const Sweep& part, double wall, double around, Kind kind, int turn,
                              bool asMesh, PathErrors& e) {
        // The shape turned on the voxels, or its voxels.
        const auto place = turned(turn);
        const auto at = [&](double x, double y, double z) {
            return fromVdb(asMesh ? place->indexToWorld(Vec3d(x, y, z)) : Vec3d(x, y, z));
        };
        const auto on = [&](double s, double y) {
            const auto [x, z] = part.at(s);
            return at(x, y, z);
        };
        const auto surface = [&] {
            if (asMesh) return Surface(prismMesh(part.outline, Sweep::kWidth, at), {.size = 1});
            return Surface(*makeLevelSet(part.shape(), *place, 3));
        };
        const GeodesicSolver solver(surface());
        Random random(7);
        for (int k = 0; k < 4; ++k) {
            const double a = random.between(0.2, 2.5), s = wall - a;
            Seeds seeds;
            if (kind == Point) seeds.points = {on(s, kMiddle)};
            if (kind == Along) seeds.curves = {{{on(s, kMiddle - 5), on(s, kMiddle + 5)}}};
            if (kind == Across) seeds.curves = {{{on(s - 4, kMiddle), on(s, kMiddle)}}};
            if (kind == Group) seeds.groups.resize(1);
            for (int j = -10; kind == Group && j <= 10; ++j)
                seeds.groups[0].points.push_back(on(s, kMiddle + 0.5 * j));
            std::vector<igeo::Vec3d> targets;
            std::vector<double> exact;
            for (int j = 0; j < 10; ++j) {
                const double b = random.between(0.2, 2.5), across = random.between(-2, 2);
                targets.push_back(on(wall + around + b, kMiddle + across));
                exact.push_back(
                    std::hypot(a + around + b, kind == Point || kind == Across ? across : 0));
            }
            const std::vector<Polyline> paths =
                solver.distance(seeds, {.targets = targets}).paths();
            for (std::size_t j = 0; j < paths.size(); ++j) {
                const auto& p = paths[j].points;
                e.lost += paths[j].status != PathStatus::Reached;
                e.shorter = std::max(e.shorter, exact[j] - paths[j].length);
                for (std::size_t v = 1; v < p.size(); ++v)
                    for (const double t : {0.25, 0.5, 0.75}) {
                        const igeo::Vec3d onChord = p[v - 1] + t * (p[v] - p[v - 1]);
                        const Vec3d q(onChord.x, onChord.y, onChord.z);
                        e.off = std::max(e.off, part.off(asMesh ? place->worldToIndex(q) : q));
                    }
            }
        }
    };
    for (const bool asMesh : {true, false})
        for (const double t : {0.5, 1.0, 2.0, 3.0})
            for (const double high : {1.5, 3.0, 6.0}) {
                if (!asMesh && (t < 2 || high < 2)) continue;  // not resolved
                const double h = t / 2, down = std::min(high, 3.0);
                const auto walled = [&](double z) -> std::vector<std::array<double, 2>> {
                    return {{-kLong, 0}, {-h, 0},    {-h, z},         {h, z},
                            {h, 0},      {kLong, 0}, {kLong, -kDeep}, {-kLong, -kDeep}};
                };
                const Sweep aRib{"rib", walled(high)}, aSlot{"slot", walled(-high)},
                    aPlate{"plate", {{-h, -kDeep}, {-h, high}, {h, high}, {h, -kDeep}}};
                for (const Sweep& part : {aRib, aSlot, aPlate}) {
                    const bool isPlate = part.name == "plate";
                    PathErrors e;
                    for (const Kind kind : {Point, Along, Group, Across})
                        for (int turn = 0; turn < 3; ++turn)
                            errorsOf(part, isPlate ? kDeep + high - down : kLong - h,
                                     isPlate ? 2 * down + t : 2 * high + t, kind, turn, asMesh, e);
                    std::printf(
                        "paths at a %s of %.1f x %.1f voxels, %s: up to %.2f voxels short, %.4f "
                        "off, %zu lost\n",
                        part.name.c_str(), t, high, asMesh ? "mesh" : "level set", e.shorter, e.off,
                        e.lost);
                    CHECK(e.lost == 0);
                    // Measured 0.48 and 1.72 voxels on level sets, over four edges that they round;
                    // 1.02 and 12 through the wall.
                    CHECK(e.off < (asMesh ? 1e-3 : 0.72));
                    CHECK(e.shorter < (asMesh ? 1e-3 : 2.6));
                }
            }
}

TEST_CASE("thin walls: distances near points, curves and groups beside a wall of a level set") {
    // Seeds on the ground up to 4 voxels from a wall, or on its first face; targets from there to 4
    // voxels beyond the wall, but not on its edges.
    constexpr double kLong = 14, kDeep = 16, kMiddle = Sweep::kWidth / 2;
    enum Kind { Point, Along, Group };
    double low = 0, most = 0;
    std::size_t count = 0, off = 0;
    for (const double t : {2.0, 2.6, 3.0})
        for (const double high : {2.0, 3.0, -2.0, -3.0, 0.0})
            for (const int turn : {0, 1, 2, 3, 4, 5, 6, 7, 29, 62, 131}) {
                // A rib, a slot or, without height, the edge of a plate.
                const double h = t / 2, up = std::abs(high);
                Sweep part{"wall",
                           {{-kLong, 0},
                            {-h, 0},
                            {-h, high},
                            {h, high},
                            {h, 0},
                            {kLong, 0},
                            {kLong, -kDeep},
                            {-kLong, -kDeep}}};
                std::vector<double> edges{kLong - h, kLong - h + up, kLong - h + up + t,
                                          kLong - h + 2 * up + t};
                if (high == 0) {
                    part.outline = {{-h, -kDeep}, {-h, 0}, {h, 0}, {h, -kDeep}};
                    edges = {kDeep, kDeep + t};
                }
                const auto faceOf = [&](double s) {
                    return std::upper_bound(edges.begin(), edges.end(), s) - edges.begin();
                };
                const auto on = [&](double s, double y) {
                    const auto [x, z] = part.at(s);
                    return fromVdb(Vec3d(x, y, z));
                };
                const GeodesicSolver solver(Surface(*makeLevelSet(part.shape(), *turned(turn), 3)));
                // Here all voxels that show a wall lie in one plane of the lattice.
                const int rounds = t == 3 && high == -2 && turn == 3 ? 40 : 3;
                for (const Kind kind : {Point, Along, Group}) {
                    Random random(static_cast<unsigned>(7 + turn));
                    for (int k = 0; k < 4 * rounds; ++k) {
                        // Rounds that had the largest errors.
                        if (k % 4 == 0 && k > 0)
                            random = Random(static_cast<unsigned>(7 + turn + 1000 * (k / 4 + 2)));
                        const double s = k % 4 == 3 && high != 0
                                             ? edges[0] + random.between(0.2, up - 0.2)
                                             : edges[0] - random.between(0.2, 4);
                        Seeds seeds;
                        if (kind == Point) seeds.points = {on(s, kMiddle)};
                        if (kind == Along)
                            seeds.curves = {{{on(s, kMiddle - 5), on(s, kMiddle + 5)}}};
                        if (kind == Group) seeds.groups.resize(1);
                        for (int j = -10; kind == Group && j <= 10; ++j)
                            seeds.groups[0].points.push_back(on(s, kMiddle + 0.5 * j));
                        const Distance d = solver.distance(seeds);
                        for (int j = 0; j < 40; ++j) {
                            const double at = random.between(s, edges.back() + 4),
                                         across = random.between(-2, 2);
                            if (std::any_of(edges.begin(), edges.end(),
                                            [&](double e) { return std::abs(at - e) < 0.15; }))
                                continue;
                            const auto crossed =
                                std::max<std::ptrdiff_t>(faceOf(at) - faceOf(s), 1);
                            const double error = (d.at(on(at, kMiddle + across)) -
                                                  std::hypot(at - s, kind == Point ? across : 0)) /
                                                 double(crossed);
                            low = std::min(low, error), most = std::max(most, error);
                            ++count, off += std::abs(error) > 0.5;
                        }
                    }
                }
            }
    std::printf("beside a wall: %.2f to %.2f voxels per edge, %zu of %zu off by more than 0.5\n",
                low, most, off, count);
    CHECK(count > 40000);
    // Measured 0.42; 0.59 by links that cut corners, 0.70 where a seed saw a face through the
    // corner before it, 0.81 where a neighbor over a sharp edge was taken for one on a bend, 0.68
    // where normals of narrow faces mixed in the next one, 1.09 through the foot of a rib, 0.61
    // where a plane fitted by chance.
    CHECK(low > -0.63);
    // Measured 0.38; 0.75 without discs over faces whose normals turn beside an edge, 1.18 where
    // the nearest segment of a curve lay over an edge and one further along did not, 0.61 where the
    // disc of one point of a group was left for its fronts.
    CHECK(most < 0.48);
    // Measured 0; 0.000006 by links that cut corners, 0.00006 where a seed saw a face through the
    // corner before it, 0.00012 where normals beside edges mixed faces, 0.00005 where those of
    // narrow faces did.
    CHECK(double(off) < 0.00001 * double(count));
}

namespace {

/// Of a part with eight corners, of which the second to the fifth are those of a slot or a rib.
std::vector<std::vector<unsigned>> endsOf(const Sweep& part) {
    if (part.outline[2][1] < 0) return {{0, 1, 2, 7}, {2, 3, 6, 7}, {3, 4, 5, 6}};
    return {{0, 5, 6, 7}, {1, 2, 3, 4}};
}

}  // namespace

TEST_CASE("thin walls: level sets converted from a mesh, over hollow edges") {
    constexpr double kLong = 14, kDeep = 16, kMiddle = Sweep::kWidth / 2;
    for (const bool isSlot : {true, false})
        for (const double t : {2.7, 3.0, 3.5}) {
            double low = 0, most = 0;
            std::size_t count = 0, off = 0;
            for (const double high : {4.0, 9.0})
                for (int turn = 0; turn < 8; ++turn) {
                    const double h = t / 2, z = isSlot ? -high : high;
                    const Sweep part{isSlot ? "slot" : "rib",
                                     {{-kLong, 0},
                                      {-h, 0},
                                      {-h, z},
                                      {h, z},
                                      {h, 0},
                                      {kLong, 0},
                                      {kLong, -kDeep},
                                      {-kLong, -kDeep}}};
                    const std::array<double, 4> edges{kLong - h, kLong - h + high,
                                                      kLong - h + high + t,
                                                      kLong - h + 2 * high + t};
                    const auto faceOf = [&](double s) {
                        return std::upper_bound(edges.begin(), edges.end(), s) - edges.begin();
                    };
                    const auto on = [&](double s, double y) {
                        const auto [x, height] = part.at(s);
                        return fromVdb(Vec3d(x, y, height));
                    };
                    const GeodesicSolver solver(
                        Surface(*converted(part, endsOf(part), *turned(turn))));
                    Random random(static_cast<unsigned>(7 + turn));
                    for (const double s : {edges[0] - 6, edges[0] + high / 2}) {
                        const Distance d = solver.distance({on(s, kMiddle)});
                        for (int j = 0; j < 60; ++j) {
                            const double at = random.between(s, edges.back() + 8),
                                         across = random.between(-6, 6);
                            if (std::any_of(edges.begin(), edges.end(),
                                            [&](double e) { return std::abs(at - e) < 0.5; }))
                                continue;
                            const double exact = std::hypot(at - s, across);
                            if (exact > 2 * kMiddle - 6) continue;  // around the end
                            const auto crossed =
                                std::max<std::ptrdiff_t>(faceOf(at) - faceOf(s), 1);
                            const double error =
                                (d.at(on(at, kMiddle + across)) - exact) / double(crossed);
                            low = std::min(low, error), most = std::max(most, error);
                            ++count, off += std::abs(error) > 0.5;
                        }
                    }
                }
            std::printf(
                "converted %s of %.1f voxels: %.2f to %.2f voxels per edge, %zu of %zu off "
                "by more than 0.5\n",
                isSlot ? "slot" : "rib", t, low, most, off, count);
            CHECK(count > 1000);
            CHECK(low > -0.96);                          // measured 0.64; 0.89 with rounded edges
            CHECK(most < 0.5);                           // measured 0.42, beside an edge
            CHECK(double(off) < 0.011 * double(count));  // measured 0.0074; 0.18 with rounded edges
        }
}

}  // namespace igeo::test
