// The core nodes around the foot points of a leaf's nodes, against a search node by node.
#include <igeo/march/detail/jet_extend_corners.h>
#include <support/analytic_band.h>
#include <support/catch.h>

#include <cstdio>
#include <map>

namespace igeo {

TEST_CASE("LeafCorners: every node of a leaf once, those outside the core with their corners") {
    std::size_t bytes = 0, nodes = 0;
    for (const double h : {1.8, 4.5}) {  // cells beyond the numbers around a leaf too
        const Band band = test::sphereBand({0.31, -0.17, 0.43}, 15, h);
        std::size_t wrong = 0, unlike = 0;
        for (LeafIndex l = 0; l < band.leaves.size(); ++l) {
            LeafNumbers<2> numbers;
            numbers.fill(band, l);
            LeafCorners found;
            jet::findCorners(band, l, numbers, found);
            bytes += sizeof(found) + found.nodes.size() * sizeof(std::uint32_t) +
                     found.most.size() + found.slots.size() * sizeof(CornerSlot);
            const LeafNodes& leaf = band.leaves[l].band;
            nodes += leaf.count;
            std::vector<bool> seen(leaf.count);
            REQUIRE(found.nodes.size() == leaf.count);
            REQUIRE(found.coreCount == band.leaves[l].core.count);
            const CornerSlot* slots = found.slots.data();
            for (std::size_t n = 0; n < leaf.count; ++n) {
                const std::uint32_t place = found.nodes[n] >> 16, at = found.nodes[n] & 0xffff;
                const NodeIndex i = leaf.firstNode + place;
                wrong += seen[place] || leaf.numberOf(at) != i;
                seen[place] = true;
                if (n < found.coreCount) {
                    wrong += band.leaves[l].core.node(at) != band.leaves[l].core.firstNode + n;
                    continue;
                }
                const std::size_t lane = (n - found.coreCount) % 8,
                                  most = found.most[(n - found.coreCount) / 8];
                std::map<unsigned, NodeIndex> corners, expected;
                for (std::size_t s = 0; s < most; ++s)
                    if (slots[s].node[lane] != kNoNode)
                        corners[slots[s].corner[lane]] = slots[s].node[lane];
                const Vec3f foot = band.footOf(i),
                            whole{float(floorToInt(foot.x)), float(floorToInt(foot.y)),
                                  float(floorToInt(foot.z))};
                band.forCornersOfFoot(
                    &BandLeaf::core, i, [&](NodeIndex j, float, const Vec3f& from) {
                        const Vec3f corner = foot - whole - from;
                        expected[unsigned(4 * corner.x + 2 * corner.y + corner.z + 0.5f)] = j;
                    });
                unlike += corners != expected;
                if (lane == 7) slots += most;
            }
        }
        CHECK(wrong == 0);
        CHECK(unlike == 0);
    }
    std::printf("corners of leaves: %.1f bytes per node\n", double(bytes) / double(nodes));
}

}  // namespace igeo
