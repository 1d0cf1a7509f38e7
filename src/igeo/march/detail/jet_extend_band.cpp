#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_extend.h>
#include <igeo/march/detail/jet_extend_corners.h>

// Fields on the core: all of the band, leaf by leaf, or some of its nodes.
namespace igeo {

namespace {

using jet::Extension;

/// Per leaf: whether it or one beside it has a core node of a distance of at least `from`, before
/// rays.
std::vector<std::uint8_t> leavesReached(const CoreJets& jets, double from = -kInfinity) {
    const std::vector<BandLeaf>& leaves = jets.core->band.leaves;
    std::vector<std::uint8_t> reached(leaves.size()), beside(reached);
    for (std::size_t k = 0; k < jets.state.size(); ++k)
        if (jets.accepted(NodeIndex(k)) && jets.marchedValueOf(NodeIndex(k)) >= from)
            reached[jets.core->nodes[k].leaf] = 1;
    for (std::size_t l = 0; l < beside.size(); ++l)
        for (const LeafIndex m : leaves[l].neighbor)
            if (m != kNoLeaf && reached[m]) beside[l] = 1;
    return beside;
}

/// The leaves whose nodes may have a jet; empty: all of them.
std::vector<std::uint8_t> leavesToExtend(const Field& field) {
    if (field.solved == field.core->state.size()) return {};
    return leavesReached(*field.core);
}

/// Calls visit(l, jets) with the jets of the nodes of every leaf: core nodes have their own, the
/// others take those of the core around their foot points. In parallel.
/// @param wanted  per leaf: whether its nodes are extended, or pass as unreached; empty: all
template <typename Visit>
void extendByLeaf(const CoreJets& jets, const std::vector<std::uint8_t>& wanted,
                  const Visit& visit) {
    const std::vector<BandLeaf>& leaves = jets.core->band.leaves;
    const LiftedJets lifted = liftedOf(jets);
    const Extension extension(jets, lifted);
    const Band& band = jets.core->band;
    // Empty for a single march, which finds them leaf by leaf.
    static const std::vector<LeafCorners> kNone;
    const std::vector<LeafCorners>& known =
        jets.core->links.empty()
            ? kNone
            : jets.core->corners.get([&] { return jet::cornersOfLeaves(band); });
    // Nodes that may be where fronts meet are solved side by side, over so many leaves.
    constexpr std::size_t kAtOnce = 16;
    parallelFor(leaves.size(), kAtOnce, [&](std::size_t begin, std::size_t end) {
        LeafNumbers<2> numbers;
        Extension::Group group;
        group.core = &numbers;
        LeafCorners here;
        const auto cornersOf = [&](LeafIndex l) -> const LeafCorners& {
            if (!known.empty()) return known[l];
            numbers.fill(band, l), group.numbered = l;
            jet::findCorners(band, l, numbers, here);
            return here;
        };
        std::vector<NodeJet> found;
        for (std::size_t next; begin < end; begin = next) {
            next = std::min(begin + kAtOnce, end);
            const NodeIndex first = leaves[begin].band.firstNode;
            const LeafNodes& last = leaves[next - 1].band;
            found.assign(last.firstNode + last.count - first, {});
            auto jetsOf = [&](std::size_t l) {
                const LeafNodes& nodes = leaves[l].band;
                return std::span(found).subspan(nodes.firstNode - first, nodes.count);
            };
            for (std::size_t l = begin; l < next; ++l) {
                if (!wanted.empty() && !wanted[l]) continue;
                extension.extendLeaf(LeafIndex(l), cornersOf(LeafIndex(l)), group,
                                     jetsOf(l).data());
            }
            extension.finish(group);
            for (std::size_t l = begin; l < next; ++l) visit(LeafIndex(l), jetsOf(l));
        }
    });
}

}  // namespace

void Field::atCore(std::span<const NodeIndex> nodes, NodeJet* to) const {
    const LiftedJets none;
    Extension(*core, none).at(nodes, to);
}

void Field::at(std::span<const NodeIndex> nodes, NodeJet* to) const {
    if (core) return atCore(nodes, to);
    for (std::size_t k = 0; k < nodes.size(); ++k) to[k] = atBand(nodes[k]);
}

void forLeaves(const Field& field,
               const std::function<void(LeafIndex, std::span<const NodeJet>)>& visit) {
    if (field.core) return extendByLeaf(*field.core, leavesToExtend(field), visit);
    const Band& band = *field.band;
    parallelFor(band.leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<NodeJet> found;
        for (std::size_t l = begin; l < end; ++l) {
            found.clear();
            band.forNodes(LeafIndex(l),
                          [&](NodeIndex i, unsigned) { found.push_back(field.at(i)); });
            visit(LeafIndex(l), found);
        }
    });
}

double largestOnBand(const Field& field) {
    if (!field.core) return field.maxDistance;
    // A foot point lies within a cell of the core node that it takes its jet from.
    constexpr double kMargin = 4;  // voxels
    const double from = field.maxDistance - kMargin * field.metric->largest();
    std::vector<double> largest(field.band->leaves.size());
    extendByLeaf(*field.core, leavesReached(*field.core, from),
                 [&](LeafIndex l, std::span<const NodeJet> found) {
                     for (const NodeJet& s : found)
                         if (s.distance < kInfinity) largest[l] = std::max(largest[l], s.distance);
                 });
    return largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
}

void extendToBand(Field& field) {
    if (!field.core) return;
    const auto wanted = leavesToExtend(field);
    const auto core = std::move(field.core);
    field.core = nullptr;
    const Band& band = *field.band;
    const bool labeled = !core->label.empty();
    resizeByAll(field.distance, band.size());
    resizeByAll(field.gradient, band.size());
    if (labeled) resizeByAll(field.label, band.size());
    extendByLeaf(*core, wanted, [&](LeafIndex l, std::span<const NodeJet> found) {
        NodeIndex i = band.leaves[l].band.firstNode;
        for (const NodeJet& s : found) {
            field.distance[i] = s.distance;
            field.gradient[i] = s.gradient;
            if (labeled) field.label[i] = s.label;
            ++i;
        }
    });
    field.summarize();
}

}  // namespace igeo
