#include <igeo/field_grids.h>

#include <igeo/parallel.h>

namespace igeo {

namespace {

/// Sets value(i) at every reached node i. Leaves are made and added by one thread, filled by all.
template <typename GridT, typename ValueAt>
void fill(GridT& grid, const Band& band, const Field& field, const ValueAt& valueAt) {
    using Leaf = typename GridT::TreeType::LeafNodeType;
    const auto background = grid.background();
    std::vector<Leaf*> leaves(band.leaves.size(), nullptr);
    parallelFor(leaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            const BandLeaf& from = band.leaves[l];
            for (NodeIndex i = from.band.first; i < from.band.first + from.band.count; ++i) {
                if (!(field.distance[i] < kInfinity)) continue;
                if (!leaves[l])
                    leaves[l] = new Leaf(
                        openvdb::Coord(from.origin.x, from.origin.y, from.origin.z), background);
                leaves[l]->setValueOn(openvdb::Index(band.offset[i]), valueAt(i));
            }
        }
    });
    for (Leaf* leaf : leaves)
        if (leaf) grid.tree().addLeaf(leaf);
}

}  // namespace

openvdb::FloatGrid::Ptr distanceGrid(const Band& band, const Field& field,
                                     const openvdb::math::Transform& transform,
                                     const std::string& name) {
    const double dx = band.transform.dx;
    auto grid = openvdb::FloatGrid::create(float(field.maxDistance * dx));
    grid->setTransform(transform.copy());
    grid->setName(name);
    fill(*grid, band, field, [&](NodeIndex i) { return float(field.distance[i] * dx); });
    return grid;
}

openvdb::Vec3SGrid::Ptr gradientGrid(const Band& band, const Field& field,
                                     const std::vector<Vec3f>& gradient,
                                     const openvdb::math::Transform& transform,
                                     const std::string& name) {
    auto grid = openvdb::Vec3SGrid::create();
    grid->setTransform(transform.copy());
    grid->setName(name);
    grid->setVectorType(openvdb::VEC_COVARIANT);
    fill(*grid, band, field, [&](NodeIndex i) {
        const Vec3d g = band.transform.worldFromIndexDirection(Vec3d(gradient[i]));
        return openvdb::Vec3s(float(g.x), float(g.y), float(g.z));
    });
    return grid;
}

}  // namespace igeo
