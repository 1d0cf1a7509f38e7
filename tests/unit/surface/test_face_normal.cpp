// Next to edges of plane faces nodes have the normal of their face, not a mixture.
#include <igeo/surface/detail/face_normal.h>
#include <igeo/surface/level_set_band.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <vector>

namespace igeo::test {
namespace {

/// The block of the leaf at the origin, with a signed distance at its voxels.
LeafBlock blockOf(const std::function<double(const Vec3d&)>& psi,
                  const std::function<bool(int, int, int)>& isMissing = {}) {
    const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(3);
    for (int x = -1; x <= 8; ++x)
        for (int y = -1; y <= 8; ++y)
            for (int z = -1; z <= 8; ++z)
                if (!isMissing || !isMissing(x, y, z))
                    grid->tree().setValueOn(openvdb::Coord(x, y, z), float(psi(Vec3d(x, y, z))));
    LeafBlock block;
    block.gather(LeafBlock::Accessor(grid->constTree()), openvdb::Coord(0, 0, 0), 1);
    return block;
}

/// Solid below two planes, above neither (a ridge), or below either (a groove).
struct TwoPlanes {
    Vec3d a, b;  ///< unit normals
    bool isRidge;
    Vec3d through{3.6, 3.4, 3.7};

    double psi(const Vec3d& p) const {
        const double one = dot(a, p - through), other = dot(b, p - through);
        // Where the edge is the nearest point of S.
        const double cosine = dot(a, b), side = isRidge ? 1 : -1;
        if (side * (one - cosine * other) > 0 && side * (other - cosine * one) > 0)
            return side * length(fromEdge(p));
        return isRidge ? std::max(one, other) : std::min(one, other);
    }
    Vec3d fromEdge(const Vec3d& p) const {
        const Vec3d along = normalized(cross(a, b));
        return (p - through) - dot(along, p - through) * along;
    }
};

TwoPlanes planes(double bendInDegrees, bool isRidge) {
    const Vec3d a = normalized(Vec3d{0.5, -0.7, 0.6}), t = normalized(cross(a, {0.3, 0.5, 0.2}));
    const double bend = bendInDegrees * M_PI / 180;
    return {a, std::cos(bend) * a + std::sin(bend) * t, isRidge};
}

double degreesBetween(const Vec3d& a, const Vec3d& b) {
    return std::acos(std::clamp(dot(normalized(a), normalized(b)), -1.0, 1.0)) * 180 / M_PI;
}

}  // namespace

TEST_CASE("Face normals: beside an edge those of the face, and none where the edge is nearest") {
    std::size_t faces = 0, right = 0, edges = 0, false15 = 0;
    double footOff = 0;  // voxels, where the edge is nearest
    for (const bool isRidge : {true, false})
        for (const double bend : {40.0, 60.0, 90.0, 120.0}) {
            const TwoPlanes s = planes(bend, isRidge);
            const LeafBlock block = blockOf([&](const Vec3d& p) { return s.psi(p); });
            for (int x = 0; x < 8; ++x)
                for (int y = 0; y < 8; ++y)
                    for (int z = 0; z < 8; ++z) {
                        const Vec3d p(x, y, z);
                        const double psi = s.psi(p);
                        if (std::abs(psi) > 1.7) continue;
                        const double one = dot(s.a, p - s.through), other = dot(s.b, p - s.through);
                        const bool ofOne = psi == one, ofOther = psi == other;
                        const auto found = faceNormal(block, x, y, z);
                        if (ofOne || ofOther) {
                            ++faces;
                            right +=
                                found && degreesBetween(Vec3d(*found), ofOne ? s.a : s.b) < 0.01;
                        } else {
                            ++edges;
                            if (!found) continue;
                            const Vec3d n = (psi < 0 ? -1 : 1) * normalized(s.fromEdge(p));
                            false15 += degreesBetween(Vec3d(*found), n) > 15;
                            footOff = std::max(footOff, std::abs(psi) * length(Vec3d(*found) - n));
                        }
                    }
        }
    std::printf(
        "face normals: %zu of %zu at faces, %zu of %zu at edges off by over 15 degrees, "
        "foot points by up to %.3f voxels\n",
        right, faces, false15, edges, footOff);
    CHECK(faces > 1000);
    CHECK(edges > 100);
    CHECK(double(right) > 0.92 * double(faces));  // measured 0.949
    CHECK(false15 <= 6);                          // measured 4
    CHECK(footOff < 0.39);                        // measured 0.26
}

TEST_CASE("Face normals: where a sphere bends within voxels, none") {
    // The band asks only where the length of central differences is off by more than 0.03.
    std::size_t voxels = 0, found = 0;
    for (const double radius : {1.5, 2.0, 2.5, 3.0}) {
        const Vec3d center{3.6, 3.4, 3.7};
        const LeafBlock block =
            blockOf([&](const Vec3d& p) { return length(p - center) - radius; });
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int z = 0; z < 8; ++z) {
                    const double slope = length(PsiDifferences(block, x, y, z).central());
                    if (std::abs(block.at(x, y, z)) > 1 || std::abs(slope - 1) < 0.03) continue;
                    ++voxels;
                    found += faceNormal(block, x, y, z).has_value();
                }
    }
    CHECK(voxels > 100);
    CHECK(found == 0);
}

TEST_CASE("Face normals: the same bits by four and by eight, also where voxels are missing") {
    const TwoPlanes s = planes(70, true);
    const LeafBlock block =
        blockOf([&](const Vec3d& p) { return s.psi(p); },
                [](int x, int y, int z) { return (7 * x + 5 * y + 3 * z) % 13 == 0; });
    const bool eight = eightAtATime();
    std::size_t found = 0;
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z) {
                eightAtATime() = false;
                const auto byFour = faceNormal(block, x, y, z);
                eightAtATime() = eight;
                const auto byEight = faceNormal(block, x, y, z);
                REQUIRE(byFour.has_value() == byEight.has_value());
                if (!byFour) continue;
                ++found;
                REQUIRE(*byFour == *byEight);
                REQUIRE(std::abs(length(*byFour) - 1) < 1e-6f);
            }
    CHECK(found > 200);
}

TEST_CASE("Face normals: the core of a turned slot two voxels deep has them") {
    const Shape slot = partOf({{{-12, -9, -9}, {12, 9, 0}}, {{-1.5, -9, -2}, {1.5, 9, 0}, true}});
    std::size_t nodes = 0, right = 0;
    for (int turn = 0; turn < 20; ++turn) {
        const auto place = rotatedTransform(1, openvdb::Vec3d(0.3, 0.5 - 0.1 * turn, 0.8),
                                            20.0 + 17 * turn, openvdb::Vec3d(0.013, 0.327, -0.211));
        const Band band =
            bandFromLevelSet(checkedLevelSet(makeLevelSet(slot, *place, 3)), std::sqrt(3.0));
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const openvdb::Vec3d p = worldOf(band, Vec3d(band.ijk(i)));
            // Nodes of the walls and the floor of the slot, away from its ends, where a face is
            // nearest.
            if (!band.inCore(i) || std::abs(p.y()) > 6) continue;
            const double toWall = 1.5 - std::abs(p.x()), toFloor = p.z() + 2;
            const bool ofWall = std::abs(toWall) < 0.9 && p.z() < 0 && toFloor > std::abs(toWall),
                       ofFloor = std::abs(toFloor) < 0.9 && toWall > std::abs(toFloor);
            if (!ofWall && !ofFloor) continue;
            const openvdb::Vec3d n =
                ofWall ? openvdb::Vec3d(p.x() < 0 ? 1 : -1, 0, 0) : openvdb::Vec3d(0, 0, 1);
            const Vec3d found = band.transform.worldFromIndexDirection(Vec3d(band.normal[i]));
            ++nodes;
            right += degreesBetween(found, Vec3d(n.x(), n.y(), n.z())) < 2;
        }
    }
    std::printf("face normals: %zu of %zu nodes in a slot\n", right, nodes);
    CHECK(nodes > 1000);
    // Measured 0.84; 0.43 by differences to one side of kinks.
    CHECK(double(right) > 0.76 * double(nodes));
}

}  // namespace igeo::test
