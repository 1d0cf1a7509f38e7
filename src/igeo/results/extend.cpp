#include <igeo/results/extend.h>

#include <igeo/base/parallel.h>
#include <igeo/march/signed_field.h>
#include <igeo/surface/detail/leaf_block.h>

namespace igeo {

void extendDistance(openvdb::FloatGrid& distance, const LevelSet& levelSet, const Field& field,
                    Progress& progress) {
    const Band& band = *field.band;
    using Leaf = LeafBlock::Leaf;
    const double dx = band.transform.dx;
    std::vector<const Leaf*> source;
    levelSet.psi->constTree().getNodes(source);
    // One thread makes the topology; all threads fill in the values.
    std::vector<Leaf*> target;
    for (const Leaf* leaf : source) target.push_back(distance.tree().touchLeaf(leaf->origin()));

    parallelFor(source.size(), 16, progress, [&](std::size_t begin, std::size_t end) {
        LeafBlock block;
        const LeafBlock::Accessor psi(levelSet.psi->constTree());
        for (std::size_t l = begin; l < end; ++l) {
            block.gather(psi, source[l]->origin(), dx);
            for (auto it = source[l]->cbeginValueOn(); it; ++it) {
                const auto o = it.pos();
                const openvdb::Coord c = it.getCoord();
                if (band.nodeAt({c.x(), c.y(), c.z()}) != kNoNode) continue;
                const int x = int(o >> 6), y = int(o >> 3 & 7), z = int(o & 7);
                const double value = block.at(x, y, z);
                const Vec3d n = normalized(psiGradient(PsiDifferences(block, x, y, z), value));
                const Vec3d foot = Vec3d(Ijk{c.x(), c.y(), c.z()}) - value * n;
                const double d = sampleDistance(field, foot, n);
                if (d < kInfinity) target[l]->setValueOn(o, float(d * dx * signAt(field, foot)));
            }
        }
    });
    for (const Leaf* leaf : source)
        if (distance.tree().probeConstLeaf(leaf->origin())->isEmpty())
            distance.tree().addTile(1, leaf->origin(), distance.background(), false);
}

}  // namespace igeo
