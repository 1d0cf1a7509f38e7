// Edges sharper than a right angle: distances lead over blades and through grooves, as on their
// faces laid flat.
#include <igeo/geodesic_solver.h>
#include <openvdb/tools/MeshToVolume.h>
#include <support/catch.h>
#include <support/errors.h>
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

/// A part whose outline has an acute corner, in voxels.
struct AcutePart {
    Sweep sweep;
    std::vector<openvdb::Vec3I> caps;  ///< triangles of the outline's corners
    double edge, beyond;               ///< lengths of the outline: the corner, and the next one
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

/// As OpenVDB converts its mesh.
openvdb::FloatGrid::Ptr converted(const AcutePart& part, const openvdb::math::Transform& t) {
    const auto n = unsigned(part.sweep.outline.size());
    std::vector<openvdb::Vec3s> points;
    for (const double y : {0.0, Sweep::kWidth})
        for (const auto& [x, z] : part.sweep.outline) points.emplace_back(x, y, z);
    std::vector<openvdb::Vec4I> quads;
    for (unsigned k = 0; k < n; ++k) quads.emplace_back(k, n + k, n + (k + 1) % n, (k + 1) % n);
    std::vector<openvdb::Vec3I> triangles = part.caps;
    for (const auto& c : part.caps) triangles.emplace_back(n + c[2], n + c[1], n + c[0]);
    return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(t, points, triangles, quads);
}

struct EdgeErrors {
    double low = 0, high = 0;  ///< per edge crossed, voxels
    std::size_t count = 0, unreached = 0;
};

/// Against the straight line on the faces laid flat.
void addErrors(const AcutePart& part, const openvdb::FloatGrid& grid, unsigned seed,
               EdgeErrors& e) {
    constexpr double kMiddle = Sweep::kWidth / 2, kAround = Sweep::kWidth - 6;  // around an end
    const auto on = [&](double s, double y) {
        const auto [x, z] = part.sweep.at(s);
        return fromVdb(Vec3d(x, y, z));
    };
    const GeodesicSolver solver((Surface(grid)));
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
            e.low = std::min(e.low, error), e.high = std::max(e.high, error);
        }
    }
}

void print(const AcutePart& part, int degrees, const char* form, const EdgeErrors& e) {
    std::printf("%s of %d degrees, %s: %.2f to %.2f voxels per edge, %zu unreached of %zu\n",
                part.sweep.name.c_str(), degrees, form, e.low, e.high, e.unreached, e.count);
}

}  // namespace

TEST_CASE("acute edges: fronts go over blades and through grooves of exact level sets") {
    for (const auto& make : {blade, groove})
        for (int degrees = 20; degrees <= 85; degrees += 5) {
            const AcutePart part = make(degrees);
            EdgeErrors e;
            for (int place = 0; place < kPlaces; ++place)
                addErrors(part, *makeLevelSet(part.sweep.shape(), *placed(place), 3),
                          static_cast<unsigned>(degrees + place), e);
            print(part, degrees, "exact", e);
            CHECK(e.count > 600);
            CHECK(e.unreached <= 1);
            // Measured 0.47 and 0.94 voxels, below 35 degrees 1.0 and 2.05: there the faces are
            // closer than two voxels up to three voxels from the edge. 24 without fans.
            CHECK(e.high < (degrees < 35 ? 1.5 : 0.71));
            CHECK(e.low > (degrees < 35 ? -3.1 : -1.4));
        }
}

TEST_CASE("acute edges: fronts go over blades and through grooves of conversions") {
    for (const auto& make : {blade, groove})
        for (int degrees = 60; degrees <= 85; degrees += 5) {
            const AcutePart part = make(degrees);
            EdgeErrors e;
            for (int place = 0; place < kPlaces; ++place)
                addErrors(part, *converted(part, *placed(place)),
                          static_cast<unsigned>(degrees + place), e);
            print(part, degrees, "converted", e);
            CHECK(e.count > 600);
            CHECK(e.unreached == 0);
            CHECK(e.high < 0.84);  // measured 0.56; 24 without fans
            CHECK(e.low > -2.3);   // measured 1.53: the conversion fills the bottom of grooves
        }
}

}  // namespace igeo::test
