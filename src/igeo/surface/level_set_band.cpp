#include <igeo/surface/level_set_band.h>

#include <fmt/core.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/leaf_filler.h>
#include <igeo/surface/detail/wall_links.h>
#include <igeo/surface/level_set_check.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cstdint>

namespace igeo {

namespace {

using Leaf = LeafBlock::Leaf;

bool meets(const Leaf& leaf, const std::vector<Ball>& region) {
    const openvdb::Coord o = leaf.origin();
    const Vec3d low(o.x(), o.y(), o.z());
    return std::any_of(region.begin(), region.end(), [&](const Ball& ball) {
        Vec3d r;  // from the nearest point of the leaf
        for (int a = 0; a < 3; ++a)
            r[a] = ball.center[a] - std::clamp(ball.center[a], low[a], low[a] + 7);
        return length(r) <= ball.radius;
    });
}

/// Leaves of the band: those of the level set that hold a voxel with |psi| < h, in tree order.
std::vector<BandLeaf> bandLeaves(const std::vector<const Leaf*>& source, double hWorld,
                                 std::vector<const Leaf*>& kept) {
    using Mask = decltype(LeafNodes::mask);
    std::vector<Mask> masks(source.size());
    parallelFor(source.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            markWithin(source[l]->buffer().data(), hWorld, masks[l]);
            for (std::size_t x = 0; x < 8; ++x)
                masks[l][x] &= source[l]->valueMask().getWord<openvdb::Index64>(openvdb::Index(x));
        }
    });
    for (std::size_t l = 0; l < source.size(); ++l)
        if (masks[l] != Mask{}) kept.push_back(source[l]);
    std::vector<BandLeaf> leaves(kept.size());
    for (std::size_t l = 0, k = 0; l < source.size(); ++l) {
        if (masks[l] == Mask{}) continue;
        const openvdb::Coord o = source[l]->origin();
        leaves[k].origin = {o.x(), o.y(), o.z()};
        leaves[k++].band.mask = masks[l];
    }
    return leaves;
}

}  // namespace

Band bandFromLevelSet(const LevelSet& levelSet, double h, const std::vector<Ball>& region,
                      Progress& progress) {
    if (!(h > 0) || h > levelSet.stats.halfWidth + 1e-3)
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("a band of {:g} voxels does not fit a level set that is {:g} "
                                "voxels wide on each side",
                                h, levelSet.stats.halfWidth),
                    "widen the level set first");
    progress.update("band", 0);
    std::vector<const Leaf*> source, kept;
    levelSet.psi->constTree().getNodes(source);
    if (!region.empty())
        source.erase(std::remove_if(source.begin(), source.end(),
                                    [&](const Leaf* l) { return !meets(*l, region); }),
                     source.end());

    Band band;
    band.transform = levelSet.transform;
    band.h = h;
    const double dx = band.transform.dx;
    band.leaves = bandLeaves(source, h * dx, kept);
    band.buildTopology(/*withFeet=*/false);

    Marks marks(kept.size());
    Steps steps(progress, "band", kept.size(), 0.2, 0.8);
    parallelFor(kept.size(), 32, progress, [&](std::size_t begin, std::size_t end) {
        fillLeaves(levelSet.psi->constTree(), LeafIndex(begin), end - begin, band, marks);
        steps.add(end - begin);
    });
    parallelFor(marks.kinks.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            for (const NodeIndex i : marks.kinks[l]) band.markKink(i);
    });
    band.sever(turnToEdges(band, marks.fans));
    band.sever(linksThroughWalls(band, levelSet, marks.meetings));
    parallelFor(marks.fans.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) addFans(band, marks.fans[l], marks.rims[l]);
    });
    std::vector<NodeIndex> rim;
    for (const auto& part : marks.rims) rim.insert(rim.end(), part.begin(), part.end());
    band.numberCore(rim);
    return band;
}

openvdb::math::Transform::Ptr gridTransform(const Similarity& t) {
    openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
    // Rows are the images of the axes.
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) matrix[a][b] = t.dx * t.axis[std::size_t(a)][b];
        matrix[3][a] = t.origin[a];
    }
    return openvdb::math::Transform::createLinearTransform(matrix);
}

LevelSet levelSetFromBand(const Band& band, bool closed, const std::string& file,
                          const std::string& name, Progress& progress) {
    constexpr double kMostlySmooth = 0.95;
    openvdb::initialize();
    const Similarity& t = band.transform;
    LoadedGrid loaded;
    const openvdb::FloatGrid::Ptr psi = openvdb::FloatGrid::create(float(band.h * t.dx));
    loaded.grid = psi;
    loaded.file = file;
    loaded.name = name;
    loaded.isLevelSetClass = true;
    openvdb::FloatGrid& grid = *psi;
    grid.setTransform(gridTransform(t));
    grid.setName(name);
    grid.setGridClass(openvdb::GRID_LEVEL_SET);
    // Topology by one thread, values by all.
    std::vector<LeafBlock::Leaf*> leaves;
    for (const BandLeaf& leaf : band.leaves)
        leaves.push_back(
            grid.tree().touchLeaf(openvdb::Coord(leaf.origin.x, leaf.origin.y, leaf.origin.z)));
    parallelFor(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            band.forNodes(LeafIndex(l), [&](NodeIndex i, unsigned at) {
                leaves[l]->setValueOn(at, float(band.psi[i] * t.dx));
            });
        }
    });
    if (closed) openvdb::tools::signedFloodFill(grid.tree());
    LevelSet made = describeLevelSet(std::move(loaded), progress);
    if (made.stats.gradientShare < kMostlySmooth)
        made.warnings.push_back(fmt::format(
            "some results need {} as a level set, which is no exact distance on {:.0f} % "
            "of its voxels, next to thin parts and sharp edges; smaller voxels show "
            "these",
            name, 100 * (1 - made.stats.gradientShare)));
    return made;
}

}  // namespace igeo
