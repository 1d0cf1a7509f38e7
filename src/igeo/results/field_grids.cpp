#include <igeo/results/field_grids.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <bit>
#include <memory>

namespace igeo {

namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

/// Sets value(i) at every node i that is wanted. One thread makes the leaves; all threads fill
/// them.
template <typename GridT, typename Wanted, typename ValueAt>
void fill(GridT& grid, const Band& band, const Wanted& wanted, const ValueAt& valueAt) {
    using Leaf = typename GridT::TreeType::LeafNodeType;
    const auto background = grid.background();
    std::vector<Leaf*> leaves(band.leaves.size(), nullptr);
    parallelFor(leaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& from = band.leaves[l];
            band.forNodes(LeafIndex(l), [&](NodeIndex i, unsigned at) {
                if (!wanted(i)) return;
                if (!leaves[l])
                    leaves[l] = new Leaf(
                        openvdb::Coord(from.origin.x, from.origin.y, from.origin.z), background);
                leaves[l]->setValueOn(openvdb::Index(at), valueAt(i));
            });
        }
    });
    for (Leaf* leaf : leaves)
        if (leaf) grid.tree().addLeaf(leaf);
}

auto reached(const Field& field) {
    return [&field](NodeIndex i) { return field.distance[i] < kInfinity; };
}

template <typename GridT>
typename GridT::Ptr makeGrid(const typename GridT::ValueType& background,
                             const openvdb::math::Transform& transform, const std::string& name) {
    auto grid = GridT::create(background);
    grid->setTransform(transform.copy());
    grid->setName(name);
    return grid;
}

/// A leaf with the reached nodes set. Its background is known only after all leaves.
std::unique_ptr<FloatLeaf> distanceLeaf(const Band& band, LeafIndex l,
                                        std::span<const NodeJet> jets, Extent& extent) {
    if (std::none_of(jets.begin(), jets.end(),
                     [](const NodeJet& s) { return s.distance < kInfinity; }))
        return {};
    const BandLeaf& from = band.leaves[l];
    auto leaf = std::make_unique<FloatLeaf>(
        openvdb::Coord(from.origin.x, from.origin.y, from.origin.z), 0.0f);
    float* const values = leaf->buffer().data();
    band.forNodes(l, [&](NodeIndex i, unsigned at) {
        const double d = jets[i - from.band.firstNode].distance;
        if (!(d < kInfinity)) return;
        values[at] = float(band.transform.dx * d);
        leaf->getValueMask().setOn(at);
        ++extent.reached;
        extent.maxDistance = std::max(extent.maxDistance, d);
    });
    return leaf;
}

/// Sets the inactive voxels of a leaf. OpenVDB's iterator is not inlined.
void fillInactive(FloatLeaf& leaf, float value) {
    float* const values = leaf.buffer().data();
    for (openvdb::Index x = 0; x < 8; ++x)
        for (auto off = ~leaf.valueMask().getWord<openvdb::Index64>(x); off; off &= off - 1)
            values[64 * x + openvdb::Index(std::countr_zero(off))] = value;
}

openvdb::FloatGrid::Ptr distanceGridByLeaf(const Field& field,
                                           const openvdb::math::Transform& transform,
                                           const std::string& name, Extent& extent) {
    const Band& band = *field.band;
    std::vector<std::unique_ptr<FloatLeaf>> leaves(band.leaves.size());
    std::vector<Extent> extents(leaves.size());
    forLeaves(field, [&](LeafIndex l, std::span<const NodeJet> jets) {
        leaves[l] = distanceLeaf(band, l, jets, extents[l]);
    });
    extent = {band.size()};
    for (const Extent& e : extents) {
        extent.reached += e.reached;
        extent.maxDistance = std::max(extent.maxDistance, e.maxDistance);
    }
    const auto background = float(extent.maxDistance * band.transform.dx);
    parallelFor(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            if (leaves[l]) fillInactive(*leaves[l], background);
    });
    auto grid = makeGrid<openvdb::FloatGrid>(background, transform, name);
    for (auto& leaf : leaves)
        if (leaf) grid->tree().addLeaf(leaf.release());
    return grid;
}

}  // namespace

openvdb::FloatGrid::Ptr distanceGrid(const Field& field, const openvdb::math::Transform& transform,
                                     const std::string& name, Extent* extent) {
    Extent found{field.band->size(), field.reached, field.maxDistance};
    if (field.core) {
        const auto grid = distanceGridByLeaf(field, transform, name, found);
        if (extent) *extent = found;
        return grid;
    }
    if (extent) *extent = found;
    const Band& band = *field.band;
    const double dx = band.transform.dx;
    auto grid = makeGrid<openvdb::FloatGrid>(float(field.maxDistance * dx), transform, name);
    fill(*grid, band, reached(field), [&](NodeIndex i) {
        const bool negative = !field.sign.empty() && field.sign[i] < 0;
        return float((negative ? -dx : dx) * field.distance[i]);
    });
    return grid;
}

openvdb::Vec3SGrid::Ptr gradientGrid(const Field& field, const openvdb::math::Transform& transform,
                                     const std::string& name) {
    const Band& band = *field.band;
    auto grid = makeGrid<openvdb::Vec3SGrid>({}, transform, name);
    grid->setVectorType(openvdb::VEC_COVARIANT);
    fill(*grid, band, reached(field), [&](NodeIndex i) {
        const Vec3d g = band.transform.worldFromIndexDirection(Vec3d(field.gradient[i]));
        return openvdb::Vec3s(float(g.x), float(g.y), float(g.z));
    });
    return grid;
}

openvdb::FloatGrid::Ptr labelGrid(const Field& field, const openvdb::math::Transform& transform,
                                  const std::string& name) {
    constexpr std::size_t kMostSeeds = 1 << 24;
    if (field.sourceCount() > kMostSeeds)
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("labels of {} seeds; a grid of labels counts up to {}",
                                field.sourceCount(), kMostSeeds),
                    "leave the labels out, or give fewer seeds");
    auto grid = makeGrid<openvdb::FloatGrid>(-1, transform, name);
    fill(*grid, *field.band, reached(field),
         [&](NodeIndex i) { return field.label.empty() ? 0 : float(field.label[i]); });
    return grid;
}

openvdb::FloatGrid::Ptr weightGrid(const Band& band, const Metric& metric,
                                   const openvdb::math::Transform& transform,
                                   const std::string& name) {
    auto grid = makeGrid<openvdb::FloatGrid>(1, transform, name);
    auto open = [&](NodeIndex i) { return !metric.inside(i); };
    fill(*grid, band, open, [&](NodeIndex i) { return float(metric.at(i)); });
    return grid;
}

std::vector<openvdb::FloatGrid::Ptr> curvatureGrids(const Band& band, const Curvature& curvature,
                                                    const openvdb::math::Transform& transform,
                                                    const std::string& psi) {
    const double perUnit = 1 / band.transform.dx;
    std::vector<openvdb::FloatGrid::Ptr> grids;
    auto add = [&](const char* what, const auto& value) {
        grids.push_back(makeGrid<openvdb::FloatGrid>(0, transform, psi + "_curvature_" + what));
        fill(
            *grids.back(), band, [](NodeIndex) { return true; }, value);
    };
    const auto &k1 = curvature.k1, &k2 = curvature.k2;
    add("mean", [&](NodeIndex i) { return float((k1[i] + k2[i]) / 2 * perUnit); });
    add("gaussian", [&](NodeIndex i) { return float(k1[i] * k2[i] * perUnit * perUnit); });
    add("max", [&](NodeIndex i) { return float(k1[i] * perUnit); });
    add("min", [&](NodeIndex i) { return float(k2[i] * perUnit); });
    return grids;
}

openvdb::Vec3SGrid::Ptr colorGrid(const Field& field, const ColorMap& colors,
                                  const openvdb::math::Transform& transform,
                                  const std::string& name) {
    constexpr float kUnreached = 0.45f;
    auto grid = makeGrid<openvdb::Vec3SGrid>(openvdb::Vec3s(kUnreached), transform, name);
    const double scale = field.maxDistance > 0 ? 1 / field.maxDistance : 0;
    fill(*grid, *field.band, reached(field), [&](NodeIndex i) {
        const Vec3f c(colors(field.distance[i] * scale));
        return openvdb::Vec3s(c.x, c.y, c.z);
    });
    return grid;
}

openvdb::FloatGrid::Ptr unreliableGrid(const Band& band, const std::vector<float>& unreliability,
                                       const openvdb::math::Transform& transform,
                                       const std::string& name) {
    auto grid = makeGrid<openvdb::FloatGrid>(0, transform, name);
    fill(
        *grid, band, [&](NodeIndex i) { return unreliability[i] > 0; },
        [&](NodeIndex i) { return unreliability[i]; });
    return grid;
}

openvdb::Vec3SGrid::Ptr logMapGrid(const Band& band, const LogMap& map,
                                   const openvdb::math::Transform& transform,
                                   const std::string& name) {
    const auto dx = float(band.transform.dx);
    auto grid = makeGrid<openvdb::Vec3SGrid>({}, transform, name);
    grid->setVectorType(openvdb::VEC_INVARIANT);
    auto known = [&](NodeIndex i) { return !std::isnan(map.position[i].x); };
    fill(*grid, band, known, [&](NodeIndex i) {
        return openvdb::Vec3s(dx * map.position[i].x, dx * map.position[i].y, 0);
    });
    return grid;
}

}  // namespace igeo
