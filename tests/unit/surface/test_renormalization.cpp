// The last step of OpenVDB's conversion of meshes: how it is recognized, and undone.
#include <igeo/base/detail/registers.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/renormalization.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/MeshToVolume.h>
#include <support/catch.h>
#include <support/shapes.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace igeo::test {
namespace {

using Grid = openvdb::FloatGrid;
using openvdb::Vec3s;
using openvdb::tools::DISABLE_RENORMALIZATION;

struct Mesh {
    std::vector<Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
};

/// A torus with bumps: hollow and round places of all directions. World size 3.
Mesh bumpyTorus() {
    constexpr unsigned kAround = 240, kTube = 120;
    Mesh mesh;
    for (unsigned i = 0; i < kAround; ++i)
        for (unsigned j = 0; j < kTube; ++j) {
            const double u = 2 * M_PI * i / kAround, v = 2 * M_PI * j / kTube,
                         r = 0.4 * (1 + 0.12 * std::cos(7 * u) * std::cos(3 * v + u)),
                         R = 1 + r * std::cos(v);
            mesh.points.emplace_back(R * std::cos(u), R * std::sin(u), r * std::sin(v));
            const unsigned i1 = (i + 1) % kAround, j1 = (j + 1) % kTube;
            mesh.quads.emplace_back(i * kTube + j, i1 * kTube + j, i1 * kTube + j1, i * kTube + j1);
        }
    return mesh;
}

Mesh box(const openvdb::Vec3d& half) {
    Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.points.emplace_back(k & 1 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(),
                                 k & 4 ? half.z() : -half.z());
    mesh.quads = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    return mesh;
}

/// @param unit  world size of 1 in the mesh
Grid::Ptr converted(const Mesh& mesh, double voxels, double unit = 1, int flags = 0) {
    const double dx = unit / voxels;
    const auto transform = openvdb::math::Transform::createLinearTransform(dx);
    transform->postTranslate(unit * openvdb::Vec3d(0.1234, 0.567, -0.89));
    std::vector<Vec3s> points;
    for (const Vec3s& p : mesh.points)
        points.emplace_back(transform->worldToIndex(openvdb::Vec3d(p) * unit));
    const openvdb::tools::QuadAndTriangleDataAdapter<Vec3s, openvdb::Vec4I> adapter(points,
                                                                                    mesh.quads);
    return openvdb::tools::meshToVolume<Grid>(adapter, *transform, 3, 3, flags);
}

/// OffExact of psi at |psi| < 1.5, in voxels.
struct OffExact {
    double mean = 0, rms = 0;
    OffExact(const Grid& psi, const Grid& exact) {
        const double dx = exact.transform().voxelSize()[0];
        std::size_t count = 0;
        const auto values = psi.getConstAccessor();
        for (auto it = exact.cbeginValueOn(); it; ++it) {
            if (std::abs(*it) > 1.5 * dx || !values.isValueOn(it.getCoord())) continue;
            const double error = (double(values.getValue(it.getCoord())) - double(*it)) / dx;
            ++count, mean += error, rms += error * error;
        }
        mean /= double(count), rms = std::sqrt(rms / double(count));
    }
};

}  // namespace

TEST_CASE("isRenormalized: level sets by meshToVolume, of any size") {
    const Mesh torus = bumpyTorus();
    for (const double unit : {1.0, 1e-3, 0.0217, 1e9})
        for (const double voxels : {17.0, 32.0, 43.21}) {
            CAPTURE(unit, voxels);
            CHECK(isRenormalized(*converted(torus, voxels, unit)));
            CHECK(!isRenormalized(*converted(torus, voxels, unit, DISABLE_RENORMALIZATION)));
        }
    CHECK(isRenormalized(*converted(box({1, 0.7, 0.51}), 30)));
}

TEST_CASE("isRenormalized: no other level sets") {
    using openvdb::tools::createLevelSetSphere;
    CHECK(!isRenormalized(*makeLevelSet(sphere(kOffLattice, 1), 0.05, 3)));
    CHECK(!isRenormalized(*makeLevelSet(torus(kOffLattice, 1, 0.4), 0.0311, 3)));
    for (const float dx : {0.05f, 1 / 32.0f, 0.0123f})
        CHECK(!isRenormalized(*createLevelSetSphere<Grid>(1, {0.1f, 0.2f, 0.3f}, dx)));
    // Distances of few bits.
    for (const double voxels : {32.0, 30.0}) {
        const Mesh cube = box({1, 0.75, 0.5});
        CHECK(!isRenormalized(*converted(cube, voxels, 1, DISABLE_RENORMALIZATION)));
        CHECK(!isRenormalized(*converted(cube, voxels, 64, DISABLE_RENORMALIZATION)));
    }
    const Grid::Ptr psi = converted(bumpyTorus(), 30);
    Grid::Ptr half = psi->deepCopy();
    for (auto it = half->beginValueOn(); it; ++it) it.setValue(float(openvdb::math::half(*it)));
    CHECK(!isRenormalized(*half));
    CHECK(isInHalfPrecision(*half));
    CHECK(!isInHalfPrecision(*psi));
    CHECK(!isInHalfPrecision(*makeLevelSet(sphere(kOffLattice, 1), 0.05, 3)));
    // A box between voxels, of few values.
    CHECK(!isInHalfPrecision(*makeLevelSet(igeo::test::box({}, {0.5, 0.75, 1}), 0.0625, 3)));
    // The step is not the last one.
    Grid::Ptr filtered = psi->deepCopy();
    openvdb::tools::LevelSetFilter<Grid>(*filtered).gaussian();
    CHECK(!isRenormalized(*filtered));
    // Nothing to look at.
    CHECK(!isRenormalized(*Grid::create(1)));
}

TEST_CASE("isRenormalized: no distances that were computed in single precision") {
    // A root less a radius: multiples of the last place of the root.
    const auto torus = [](const Vec3s& p, float r) {
        const float across = std::hypot(p.x(), p.y()) - 2 * r;
        return std::sqrt(across * across + p.z() * p.z()) - r;
    };
    const auto capsule = [](const Vec3s& p, float r) {
        const float along = p.x() - std::clamp(p.x(), -r, r);
        return std::sqrt(along * along + p.y() * p.y() + p.z() * p.z()) - r;
    };
    const auto ball = [](const Vec3s& p, float r) { return p.length() - r; };
    int count = 0;
    for (const float dx : {0.1f, 0.05f, 1.0f, 0.01f, 0.0711f, 37.0f})
        for (const float voxels : {3.0f, 4.0f, 5.0f, 6.5f, 8.0f, 10.0f, 12.0f})
            for (const Vec3s& off : {Vec3s(0.1f, 0.2f, 0.3f), Vec3s(0.123f, 0.417f, 0.33f)}) {
                CAPTURE(dx, voxels, off.x());
                const float r = voxels * dx;
                auto check = [&](int reach, const auto& psi) {
                    const Grid::Ptr grid = Grid::create(3 * dx);
                    grid->setTransform(openvdb::math::Transform::createLinearTransform(dx));
                    const openvdb::CoordBBox box(openvdb::Coord(-reach), openvdb::Coord(reach));
                    for (auto at = box.begin(); at; ++at) {
                        const Vec3s p((*at).asVec3s() + off);
                        const float value = psi(p * dx, r);
                        if (std::abs(value) < 3 * dx) grid->tree().setValueOn(*at, value);
                    }
                    CHECK(!isRenormalized(*grid));
                    ++count;
                };
                const int around = int(voxels) + 5;
                check(around + 2 * int(voxels) + 2, torus);
                check(around + int(voxels) + 1, capsule);
                check(around, ball);
            }
    std::printf("isRenormalized: %d distances in single precision\n", count);
}

TEST_CASE("undoRenormalization: psi is nearly what it was before the step") {
    const Mesh torus = bumpyTorus();
    for (const double voxels : {20.0, 40.0}) {
        const Grid::Ptr exact = converted(torus, voxels, 1, DISABLE_RENORMALIZATION),
                        psi = converted(torus, voxels);
        const OffExact before(*psi, *exact);
        CHECK(undoRenormalization(*psi, 1 / voxels).lowered == 0);
        const OffExact after(*psi, *exact);
        CHECK(std::abs(after.mean) < 0.32 * std::abs(before.mean));  // measured 0.21, 0.10
        CHECK(after.rms < 0.85 * before.rms);                        // measured 0.80, 0.70
    }
}

TEST_CASE("undoRenormalization: voxels so small that 1e-7 is a part of one") {
    // A box is round everywhere: the step takes 1e-7 away, and nothing else.
    const Mesh cube = box({1, 0.7, 0.51});
    const double unit = 6e-4, voxels = 30;
    const Grid::Ptr exact = converted(cube, voxels, unit, DISABLE_RENORMALIZATION),
                    psi = converted(cube, voxels, unit);
    const double shift = 1e-7 * voxels / unit;
    CHECK(OffExact(*psi, *exact).mean < -0.9 * shift);
    const float background = psi->background();
    undoRenormalization(*psi, unit / voxels);
    const OffExact after(*psi, *exact);
    CHECK(std::abs(after.mean) < 0.1 * shift);
    for (auto it = psi->cbeginValueOff(); it; ++it)
        if (std::abs(*it) != background) FAIL_CHECK(it.getCoord());
}

TEST_CASE("undoRenormalization: the same bits on any number of threads, in any registers") {
    const Mesh torus = bumpyTorus();
    const Grid::Ptr one = converted(torus, 30), many = one->deepCopy(), four = one->deepCopy();
    {
        const ThreadLimit limit(1);
        undoRenormalization(*one, 1 / 30.0);
    }
    undoRenormalization(*many, 1 / 30.0);
    const bool eight = eightAtATime();
    eightAtATime() = false;
    undoRenormalization(*four, 1 / 30.0);
    eightAtATime() = eight;
    for (const Grid::Ptr& other : {many, four})
        for (auto it = one->cbeginValueOn(); it; ++it)
            if (other->tree().getValue(it.getCoord()) != *it) FAIL_CHECK(it.getCoord());
}

}  // namespace igeo::test
