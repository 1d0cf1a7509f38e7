// Edges of up to a right angle: distances lead over blades and through grooves, as on their faces
// laid flat.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/random_surface.h>
#include <support/shapes.h>
#include <support/sweep.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

/// A part whose outline has an acute corner, in voxels.
struct AcutePart {
    Sweep sweep;
    std::vector<std::vector<unsigned>> ends;  ///< triangles of the outline's corners
    double edge, beyond;  ///< lengths of the outline: the corner, and the next one
};

/// A solid that narrows to an edge.
AcutePart blade(double degrees) {
    constexpr double kHigh = 14;
    const double half = kHigh * std::tan(degrees * M_PI / 360), side = std::hypot(half, kHigh);
    return {{"blade", {{-half, -kHigh}, {0, 0}, {half, -kHigh}}}, {{0, 1, 2}}, side, 2 * side};
}
/// The same in air, in the top of a block.
AcutePart groove(double degrees) {
    constexpr double kLong = 14, kDeep = 9, kLow = 24;
    const double half = kDeep * std::tan(degrees * M_PI / 360), side = std::hypot(half, kDeep);
    return {{"groove",
             {{-kLong, 0},
              {-half, 0},
              {0, -kDeep},
              {half, 0},
              {kLong, 0},
              {kLong, -kLow},
              {-kLong, -kLow}}},
            {{0, 1, 2}, {0, 2, 6}, {2, 5, 6}, {2, 4, 5}, {2, 3, 4}},
            kLong - half + side,
            kLong - half + 2 * side};
}

/// Its voxels: along its edge and upright, along its edge and turned by 45 degrees, or in general
/// position.
openvdb::math::Transform::Ptr placed(int place) {
    if (place >= 6) {
        Random random(static_cast<unsigned>(place));
        const Vec3d axis = random.direction();
        return rotatedTransform(1, axis, random.between(0, 360), Vec3d(0.013, 0.327, -0.211));
    }
    auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    if (place % 2) transform->postRotate(M_PI / 4, openvdb::math::Y_AXIS);
    transform->postTranslate(Vec3d(0.17 * place, 0.327, 0.211 + 0.13 * place));
    return transform;
}
constexpr int kPlaces = 10;
const openvdb::math::Transform& asItIs() {
    static const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    return *transform;
}

/// A slot or rib, `wide` across and leaning, or one that widens away from its mouth: two acute
/// edges beside each other.
/// @param high  of the rib; < 0: the depth of the slot
/// @param dx0, dx1  by how much its left and right faces lean
Sweep leaning(double wide, double high, double dx0, double dx1) {
    constexpr double kLong = 8;
    const double half = wide / 2, low = std::min(high, 0.0) - 6;
    return {"leaning",
            {{-kLong, 0},
             {-half, 0},
             {-half + dx0, high},
             {half + dx1, high},
             {half, 0},
             {kLong, 0},
             {kLong, low},
             {-kLong, low}}};
}

/// Points of its faces and ends, one unit apart, each moved by up to a third of that.
PointCloud cloudOf(const AcutePart& part, const openvdb::math::Transform& place, unsigned seed) {
    Random random(seed);
    PointCloud cloud{"acute", {}, {}};
    const auto add = [&](double x, double y, double z) {
        cloud.points.push_back(fromVdb(place.indexToWorld(Vec3d(x, y, z))));
    };
    const auto forLattice = [&](double width, double height, const auto& visit) {
        const int nu = std::max(1, int(std::lround(width))),
                  nv = std::max(1, int(std::lround(height)));
        for (int u = 0; u < nu; ++u)
            for (int v = 0; v < nv; ++v)
                visit((u + 0.5 + random.between(-0.33, 0.33)) * width / nu,
                      (v + 0.5 + random.between(-0.33, 0.33)) * height / nv);
    };
    const auto& outline = part.sweep.outline;
    double before = 0;
    Vec3d low(kInfinity), high(-kInfinity);
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const auto &a = outline[k], &b = outline[(k + 1) % outline.size()];
        const double side = std::hypot(b[0] - a[0], b[1] - a[1]);
        forLattice(side, Sweep::kWidth, [&](double u, double y) {
            const auto [x, z] = part.sweep.at(before + u);
            add(x, y, z);
        });
        before += side;
        low = openvdb::math::minComponent(low, Vec3d(a[0], 0, a[1]));
        high = openvdb::math::maxComponent(high, Vec3d(a[0], 0, a[1]));
    }
    const Shape shape = part.sweep.shape();
    for (const double y : {0.0, Sweep::kWidth})
        forLattice(high.x() - low.x(), high.z() - low.z(), [&](double u, double v) {
            if (shape.sdf(Vec3d(low.x() + u, Sweep::kWidth / 2, low.z() + v)) < 0)
                add(low.x() + u, y, low.z() + v);
        });
    return cloud;
}

struct EdgeErrors {
    double low = 0, high = 0;                       ///< per edge crossed, voxels
    std::size_t count = 0, unreached = 0, off = 0;  ///< by more than 0.5
};

/// Against the straight line on the faces laid flat.
/// @param place  of the part in the world
void addErrors(const AcutePart& part, const Surface& surface, const openvdb::math::Transform& place,
               unsigned seed, EdgeErrors& e) {
    constexpr double kMiddle = Sweep::kWidth / 2, kAround = Sweep::kWidth - 6;  // around an end
    const auto on = [&](double s, double y) {
        const auto [x, z] = part.sweep.at(s);
        return fromVdb(place.indexToWorld(Vec3d(x, y, z)));
    };
    const GeodesicSolver solver(surface);
    Random random(seed);
    for (int k = 0; k < 2; ++k) {
        const double s = part.edge - random.between(0.5, 8);
        const Distance d = solver.distance({on(s, kMiddle)});
        for (int j = 0; j < 40; ++j) {
            const double at = part.edge + random.between(0.3, 10), across = random.between(-6, 6),
                         exact = std::hypot(at - s, across);
            if (std::abs(at - part.beyond) < 0.5 || exact > kAround) continue;
            ++e.count;
            const double error =
                (d.at(on(at, kMiddle + across)) - exact) / (at > part.beyond ? 2 : 1);
            if (!(error < kInfinity)) {
                ++e.unreached;
                continue;
            }
            e.off += std::abs(error) > 0.5;
            e.low = std::min(e.low, error), e.high = std::max(e.high, error);
        }
    }
}

/// Over all places, and prints them.
/// @param addTo  adds the errors of the part in a place
template <typename AddTo>
EdgeErrors errorsOf(const AcutePart& part, int degrees, const char* form, const AddTo& addTo) {
    EdgeErrors e;
    for (int place = 0; place < kPlaces; ++place)
        addTo(*placed(place), static_cast<unsigned>(degrees + place), e);
    std::printf("%s of %d degrees, %s: %.2f to %.2f voxels per edge, %zu unreached of %zu\n",
                part.sweep.name.c_str(), degrees, form, e.low, e.high, e.unreached, e.count);
    CHECK(e.count > 600);
    return e;
}

}  // namespace

TEST_CASE("acute edges: fronts go over blades and through grooves of exact level sets") {
    for (const auto& make : {blade, groove})
        for (int degrees = 20; degrees <= 85; degrees += 5) {
            const AcutePart part = make(degrees);
            const EdgeErrors e =
                errorsOf(part, degrees, "exact", [&](const auto& voxels, unsigned seed, auto& all) {
                    addErrors(part, Surface(*makeLevelSet(part.sweep.shape(), voxels, 3)), asItIs(),
                              seed, all);
                });
            CHECK(e.unreached <= 1);
            // Measured 0.47 and 0.94 voxels, below 35 degrees 1.0 and 2.05: there the faces are
            // closer than two voxels up to three voxels from the edge. 24 without fans.
            CHECK(e.high < (degrees < 35 ? 1.5 : 0.71));
            CHECK(e.low > (degrees < 35 ? -3.1 : -1.4));
        }
}

TEST_CASE("acute edges: fronts go over two of them that are as near as two voxels") {
    // Between the edges of a narrow mouth no difference of psi is that of one edge.
    constexpr double kMiddle = Sweep::kWidth / 2;
    EdgeErrors e;
    Random random(7);
    for (int n = 0; n < 40; ++n) {
        const double wide = random.between(2, 4), lean = random.between(-3.4, 3.4),
                     flare = random.between(0.5, 2), high = n % 2 ? 6 : -6;
        const bool isDovetail = n % 4 < 2;
        const Sweep part =
            leaning(wide, high, isDovetail ? -flare : lean, isDovetail ? flare : lean);
        const auto voxels = n % 3 ? placed(6 + n) : placed(0);
        voxels->postTranslate(
            Vec3d(random.between(0, 1), random.between(0, 1), random.between(0, 1)));
        const GeodesicSolver solver{Surface(*makeLevelSet(part.shape(), *voxels, 3))};
        // Over the mouth, on its faces laid flat.
        const double mouth = std::hypot(part.outline[2][0] - part.outline[1][0], high),
                     begin = 8 - wide / 2, end = begin + mouth;
        const auto on = [&](double s, double y) {
            const auto [x, z] = part.at(s);
            return fromVdb(Vec3d(x, y, z));
        };
        for (int k = 0; k < 4; ++k) {
            const double s = random.between(begin - 4, begin + 4);
            if (std::abs(s - begin) < 0.5) continue;
            const Distance d = solver.distance({on(s, kMiddle)});
            for (int j = 0; j < 100; ++j) {
                const double to = random.between(begin - 4, end - 1), y = random.between(-6, 6);
                ++e.count;
                const double error = d.at(on(to, kMiddle + y)) - std::hypot(to - s, y);
                e.unreached += !(error < kInfinity);
                e.off += std::abs(error) > 0.5;
                e.low = std::min(e.low, error), e.high = std::max(e.high, error);
            }
        }
    }
    std::printf("leaning slots and ribs: %.2f to %.2f voxels, %zu of %zu off, %zu unreached\n",
                e.low, e.high, e.off, e.count, e.unreached);
    CHECK(e.count > 12000);
    CHECK(e.unreached == 0);
    // Measured -0.42, 1.16 and 3; 26 and 536 off without normals from edges.
    CHECK(e.low > -0.63);
    CHECK(e.high < 1.74);
    CHECK(e.off <= 4);
}

TEST_CASE("acute edges: fronts go over blades and through grooves of conversions") {
    for (const auto& make : {blade, groove})
        for (int degrees = 60; degrees <= 85; degrees += 5) {
            const AcutePart part = make(degrees);
            const EdgeErrors e = errorsOf(
                part, degrees, "converted", [&](const auto& voxels, unsigned seed, auto& all) {
                    addErrors(part, Surface(*converted(part.sweep, part.ends, voxels)), asItIs(),
                              seed, all);
                });
            CHECK(e.unreached == 0);
            CHECK(e.high < 0.84);  // measured 0.56; 24 without fans
            CHECK(e.low > -2.3);   // measured 1.53: the conversion fills the bottom of grooves
        }
}

TEST_CASE("acute edges: fronts go over blades and through grooves of points") {
    std::size_t off = 0, count = 0;
    for (const auto& make : {blade, groove})
        for (int degrees = 40; degrees <= 90; degrees += 10) {
            const AcutePart part = make(degrees);
            const EdgeErrors e =
                errorsOf(part, degrees, "points", [&](const auto& place, unsigned seed, auto& all) {
                    addErrors(part, Surface(cloudOf(part, place, seed), {.size = 1}), place, seed,
                              all);
                });
            CHECK(e.unreached == 0);
            // Measured 0.49 and 1.03. Where fits rounded edges, other points of these parts gave 15
            // and 4.5, and targets were not reached.
            CHECK(e.high < 0.74);
            CHECK(e.low > -1.55);
            off += e.off, count += e.count;
        }
    std::printf("acute edges of points: %zu of %zu off by more than 0.5\n", off, count);
    CHECK(double(off) < 0.0018 * double(count));  // measured 0.0012; 0.32 there
}

}  // namespace igeo::test
