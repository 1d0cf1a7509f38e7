#include "bad_inputs.h"

#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Clip.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cmath>
#include <limits>

#include "shapes.h"

namespace igeo::test {
namespace {

using openvdb::FloatGrid;
using openvdb::GridPtrVec;
using openvdb::Vec3d;
using openvdb::math::Transform;

constexpr double kDx = 0.05, kHalfWidth = 3, kRadius = 1;

FloatGrid::Ptr soundSphere(const std::string& name = "psi") {
    return makeLevelSet(sphere(Vec3d(0.0), kRadius), kDx, kHalfWidth, name);
}

GridPtrVec fog() {
    auto grid = soundSphere("density");
    openvdb::tools::sdfToFogVolume(*grid);
    return {grid};
}

GridPtrVec vectors() {
    auto grid = openvdb::Vec3SGrid::create();
    grid->setTransform(Transform::createLinearTransform(kDx));
    grid->setName("velocity");
    grid->sparseFill(openvdb::CoordBBox({0, 0, 0}, {7, 7, 7}), openvdb::Vec3s(0, 0, 1));
    return {grid};
}

GridPtrVec twoLevelSets() { return {soundSphere("psi_a"), soundSphere("psi_b")}; }

GridPtrVec sameName() { return {soundSphere(), soundSphere()}; }

GridPtrVec empty() {
    auto grid = openvdb::createLevelSet<FloatGrid>(kDx, kHalfWidth);
    grid->setName("psi");
    return {grid};
}

GridPtrVec positive() {
    auto grid = soundSphere();
    for (auto value = grid->beginValueAll(); value; ++value) value.setValue(std::abs(*value));
    return {grid};
}

GridPtrVec sphereUnder(const Transform& transform) {
    return {makeLevelSet(sphere(Vec3d(0.0), kRadius), transform, kHalfWidth)};
}

GridPtrVec nonuniform() {
    auto transform = Transform::createLinearTransform(kDx);
    transform->preScale(Vec3d(1, 1, 2));
    return sphereUnder(*transform);
}

GridPtrVec sheared() {
    auto transform = Transform::createLinearTransform(kDx);
    transform->preShear(0.3, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
    return sphereUnder(*transform);
}

GridPtrVec frustum() {
    auto grid = soundSphere();
    const openvdb::BBoxd box(Vec3d(-30.0), Vec3d(30.0));
    grid->setTransform(Transform::createFrustumTransform(box, 0.5, 60, kDx));
    return {grid};
}

/// A sphere with `value` in every hundredth voxel.
GridPtrVec spoiled(float value) {
    auto grid = soundSphere();
    int count = 0;
    for (auto voxel = grid->beginValueOn(); voxel; ++voxel)
        if (count++ % 100 == 0) voxel.setValue(value);
    return {grid};
}

GridPtrVec notANumber() { return spoiled(std::numeric_limits<float>::quiet_NaN()); }

GridPtrVec infinite() { return spoiled(std::numeric_limits<float>::infinity()); }

GridPtrVec noGrids() { return {}; }

GridPtrVec cut() {
    const openvdb::BBoxd half(Vec3d(-2.0), Vec3d(2.0, 2.0, 0.3));
    return {openvdb::tools::clip(*soundSphere(), half)};
}

/// A mesh of the upper half of a sphere, without the disc that would close it.
GridPtrVec hollow() {
    constexpr int kRings = 16, kSides = 64;
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    for (int ring = 0; ring <= kRings; ++ring) {
        const double polar = 0.5 * M_PI * ring / kRings;
        for (int side = 0; side < kSides; ++side) {
            const double angle = 2 * M_PI * side / kSides;
            points.emplace_back(kRadius * std::sin(polar) * std::cos(angle),
                                kRadius * std::sin(polar) * std::sin(angle),
                                kRadius * std::cos(polar));
            if (ring == kRings) continue;
            const int here = ring * kSides + side, beside = ring * kSides + (side + 1) % kSides;
            quads.emplace_back(here, here + kSides, beside + kSides, beside);
        }
    }
    auto grid = openvdb::tools::meshToLevelSet<FloatGrid>(*Transform::createLinearTransform(kDx),
                                                          points, quads, kHalfWidth);
    grid->setName("psi");
    return {grid};
}

/// Distances in voxels, positions in world units: |grad psi| = 100.
GridPtrVec scaledValues() {
    auto grid = makeLevelSet(sphere(Vec3d(0.0), 20), 1.0, kHalfWidth);
    grid->setTransform(Transform::createLinearTransform(0.01));
    return {grid};
}

/// A sound sphere, but its inside holds active tiles, and inactive values are larger than the
/// half-width.
GridPtrVec tiles() {
    auto grid = soundSphere();
    auto value = grid->beginValueOff();
    value.setMaxDepth(FloatGrid::ValueOffIter::LEAF_DEPTH - 1);
    std::vector<openvdb::CoordBBox> inside;
    for (; value; ++value)
        if (*value < 0) inside.push_back(value.getBoundingBox());
    const float background = grid->background();
    openvdb::tools::changeLevelSetBackground(grid->tree(), 10 * background);
    for (const auto& box : inside) grid->sparseFill(box, -background, true);
    return {grid};
}

GridPtrVec integers() {
    auto grid = openvdb::Int32Grid::create(3);
    grid->setTransform(Transform::createLinearTransform(kDx));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("psi");
    const auto exact = soundSphere();
    for (auto voxel = exact->cbeginValueOn(); voxel; ++voxel)
        grid->tree().setValueOn(voxel.getCoord(), static_cast<int>(std::lround(*voxel / kDx)));
    return {grid};
}

}  // namespace

const std::vector<BadInput>& badInputs() {
    static const std::vector<BadInput> kinds{
        {"fog", "only a fog volume, named density", fog},
        {"vector", "only a Vec3S grid, named velocity", vectors},
        {"two-level-sets", "level sets named psi_a and psi_b", twoLevelSets},
        {"same-name", "two level sets, both named psi", sameName},
        {"empty", "level set without active voxels", empty},
        {"positive", "unsigned distance to a sphere", positive},
        {"nonuniform", "voxels twice as long along z", nonuniform},
        {"sheared", "voxels with slanted sides", sheared},
        {"frustum", "voxels of a camera frustum", frustum},
        {"nan", "some active voxels are NaN", notANumber},
        {"inf", "some active voxels are infinite", infinite},
        {"no-grids", "file without grids", noGrids},
        {"cut", "sphere clipped by a box at z = 0.3", cut},
        {"hollow", "meshToLevelSet of an open hemisphere", hollow},
        {"scaled-values", "psi in voxels, voxel size 0.01", scaledValues},
        {"tiles", "sphere with active tiles inside and a large background", tiles},
        {"int", "Int32 grid of rounded distances", integers},
    };
    return kinds;
}

}  // namespace igeo::test
