#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/march/detail/selling_reduction.h>

#include <algorithm>

namespace igeo {

namespace {

/// The core as a lattice around a node: its columns along the axis nearest to the normal.
class Columns {
public:
    explicit Columns(const Vec3f& n) {
        const Vec3f m{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
        up_ = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
        for (int k = 0; k < 2; ++k) {
            const int axis = axisOf(k);
            along_[std::size_t(k)][axis] = 1;
            along_[std::size_t(k)][up_] = double(-n[axis] / n[up_]);
        }
    }
    /// The metric of the lattice, its vectors laid on the tangent plane.
    Form2 form(const Place& place) const {
        const Vec2f a = flat(place, 0), b = flat(place, 1);
        return {dot(a, a), dot(a, b), dot(b, b)};
    }
    Vec2i columnOf(const Ijk& step) const { return {step[axisOf(0)], step[axisOf(1)]}; }

private:
    int axisOf(int k) const { return (up_ + 1 + k) % 3; }
    Vec2f flat(const Place& place, int k) const {
        return place.stretch.way(place.frame.flat(Vec3f(along_[std::size_t(k)])));
    }
    int up_;
    std::array<Vec3d, 2> along_;
};

/// Whom a node sees at the twelve offsets +-e_k, +-(e_k - e_l) of its superbase.
using Forward = std::array<NodeIndex, 12>;

/// From a core node over links to a column, nearest to the straight line; kNoNode where there is
/// no way, or an obstacle on the chord.
NodeIndex walk(const JetCore& core, NodeIndex from, const Columns& columns, Vec2i offset) {
    const int steps = std::max(std::abs(offset.x), std::abs(offset.y));
    auto along = [&](int whole, int k) {  // whole k / steps, rounded; the same in both directions
        const int doubled = 2 * std::abs(whole) * k + steps;
        return (whole < 0 ? -1 : 1) * (doubled / (2 * steps));
    };
    NodeIndex at = from;
    bool clear = core.nodes[from].sight == Metric::Clear;
    for (int k = 1; k <= steps; ++k) {
        const Vec2i move{along(offset.x, k) - along(offset.x, k - 1),
                         along(offset.y, k) - along(offset.y, k - 1)};
        NodeIndex next = kNoNode;
        float least = float(kInfinity);
        core.forLinks(at, [&](NodeIndex j, const Ijk& step, const Vec3f&, float) {
            const Vec2i column = columns.columnOf(step);
            if (column.x != move.x || column.y != move.y) return;
            const Vec3f& foot = core.nodes[j].foot;
            if (const float off = dot(foot, foot); off < least) least = off, next = j;
        });
        if (next == kNoNode) return kNoNode;
        at = next;
        clear &= core.nodes[at].sight == Metric::Clear;
    }
    const JetCore::Node &a = core.nodes[from], &b = core.nodes[at];
    // No link of the way comes near an obstacle: nor does the chord.
    if (!clear &&
        core.metric.blocked(core.footOf(a), core.footOf(b), Vec3d(normalized(a.normal + b.normal))))
        return kNoNode;
    return at;
}

Forward stencilOf(const JetCore& core, NodeIndex i) {
    const Columns columns(core.nodes[i].normal);
    const Superbase e = obtuseSuperbase(columns.form(core.placeOf(i)));
    Forward found;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k)
        for (const Vec2i offset : {e[k], e[k] - e[(k + 1) % 3]})
            for (const Vec2i way : {offset, -offset}) found[n++] = walk(core, i, columns, way);
    return found;
}

}  // namespace

void JetCore::buildStencils() {
    const std::size_t n = nodes.size();
    std::vector<Forward> forward(n);
    parallelFor(n, 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) forward[i] = stencilOf(*this, NodeIndex(i));
    });
    // Who looks at whom, the other way round.
    std::vector<std::uint32_t> firstBack(n + 1);
    for (const Forward& f : forward)
        for (const NodeIndex j : f)
            if (j != kNoNode) ++firstBack[j + 1];
    for (std::size_t i = 0; i < n; ++i) firstBack[i + 1] += firstBack[i];
    std::vector<NodeIndex> back(firstBack[n]);
    std::vector<std::uint32_t> fill(firstBack.begin(), firstBack.end() - 1);
    for (std::size_t i = 0; i < n; ++i)
        for (const NodeIndex j : forward[i])
            if (j != kNoNode) back[fill[j]++] = NodeIndex(i);
    // Both, and the links: where a walk fails fronts still pass.
    auto collect = [&](NodeIndex i, std::array<NodeIndex, kMaxStencil>& list) {
        std::size_t count = 0;
        auto add = [&](NodeIndex j) {
            if (j != kNoNode && j != i && count < kMaxStencil &&
                std::find(list.begin(), list.begin() + std::ptrdiff_t(count), j) ==
                    list.begin() + std::ptrdiff_t(count))
                list[count++] = j;
        };
        for (const NodeIndex j : forward[i]) add(j);
        forLinks(i, [&](NodeIndex j, const Ijk&, const Vec3f&, float) { add(j); });
        for (std::size_t k = firstBack[i]; k < firstBack[i + 1]; ++k) add(back[k]);
        return count;
    };
    stencilFirst.assign(n + 1, 0);
    parallelFor(n, 256, [&](std::size_t begin, std::size_t end) {
        std::array<NodeIndex, kMaxStencil> list;
        for (std::size_t i = begin; i < end; ++i)
            stencilFirst[i + 1] = std::uint32_t(collect(NodeIndex(i), list));
    });
    for (std::size_t i = 0; i < n; ++i) stencilFirst[i + 1] += stencilFirst[i];
    stencil.resize(stencilFirst[n]);
    parallelFor(n, 256, [&](std::size_t begin, std::size_t end) {
        std::array<NodeIndex, kMaxStencil> list;
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t count = collect(NodeIndex(i), list);
            std::copy_n(list.begin(), count, stencil.begin() + stencilFirst[i]);
        }
    });
}

}  // namespace igeo
