#include <igeo/surface/detail/psi_signs.h>

#include <igeo/base/parallel.h>
#include <igeo/surface/detail/leaf_block.h>

#include <cmath>
#include <limits>

namespace igeo {

namespace {

/// By more than this many voxels no distance differs from voxel to voxel.
constexpr double kMostStep = 1.25;

/// Neighbors of six from which a voxel with the wrong sign differs by more; one may be wrong too.
constexpr int kLeastSteps = 4;

/// Whether a step from a voxel to the next along z, within a leaf, is too long.
bool hasLongStepAlongZ(const float* values, float most) {
    Registers<4>::Integers tooLong{};
    for (const float* row = values; row < values + 512; row += 8) {
        const auto first = loadLanes<4>(row), last = loadLanes<4>(row + 4);
        tooLong |= absolute(loadLanes<4>(row + 1) - first) > most;
        tooLong |= absolute(__builtin_shufflevector(last, last, 1, 2, 3, 3) - last) > most;
    }
    return any(tooLong);
}

/// Whether so many steps from a voxel may be too long: all that leave its leaf count.
bool mayHaveWrongSign(const float* values, unsigned at, float most) {
    int steps = 0;
    for (const unsigned stride : {1u, 8u, 64u}) {
        const unsigned place = at / stride & 7;
        steps += place == 0 || std::abs(values[at] - values[at - stride]) > most;
        steps += place == 7 || std::abs(values[at] - values[at + stride]) > most;
    }
    return steps >= kLeastSteps;
}

/// Whether a voxel has the sign of the other side: most of its neighbors differ from it by more
/// than a distance can, and with the other sign no two do.
bool hasWrongSign(LeafBlock::Accessor& psi, const openvdb::Coord& at, float value, float most) {
    constexpr int kLeft = 1;
    int now = 0, turned = 0;
    for (int face = 0; face < 6; ++face) {
        openvdb::Coord next = at;
        next[face / 2] += face % 2 ? 1 : -1;
        float other;
        if (!psi.probeValue(next, other)) continue;
        now += std::abs(value - other) > most;
        turned += std::abs(value + other) > most;
    }
    return now >= kLeastSteps && turned <= kLeft;
}

}  // namespace

bool isInsideOut(PsiLeaves leaves) {
    for (std::size_t a = 0; a < 3; ++a)
        for (const int side : {-1, 1}) {
            int farthest = std::numeric_limits<int>::min();
            bool inside = false;
            for (const auto* leaf : leaves) {
                if (leaf->isEmpty() || side * leaf->origin()[a] + 7 < farthest) continue;
                for (auto it = leaf->cbeginValueOn(); it; ++it) {
                    const int here = side * it.getCoord()[a];
                    if (here < farthest) continue;
                    inside = (here > farthest || inside) && *it < 0;
                    farthest = here;
                }
            }
            if (!inside) return false;
        }
    return true;
}

std::vector<openvdb::Coord> wrongSigns(const openvdb::FloatGrid& psi, PsiLeaves leaves, double dx) {
    std::vector<std::vector<openvdb::Coord>> found(leaves.size());
    const auto most = float(kMostStep * dx);
    parallelFor(leaves.size(), 256, [&](std::size_t begin, std::size_t end) {
        LeafBlock::Accessor around(psi.constTree());
        for (std::size_t l = begin; l < end; ++l) {
            const float* values = leaves[l]->buffer().data();
            if (!hasLongStepAlongZ(values, most)) continue;  // most leaves
            for (auto it = leaves[l]->cbeginValueOn(); it; ++it)
                if (mayHaveWrongSign(values, it.pos(), most) &&
                    hasWrongSign(around, it.getCoord(), *it, most))
                    found[l].push_back(it.getCoord());
        }
    });
    std::vector<openvdb::Coord> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace igeo
