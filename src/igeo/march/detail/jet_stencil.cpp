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
    Form2 form(const LocalFrame& local) const {
        const Vec2f a = flat(local, 0), b = flat(local, 1);
        return {dot(a, a), dot(a, b), dot(b, b)};
    }
    Vec2i columnOf(const Ijk& step) const { return {step[axisOf(0)], step[axisOf(1)]}; }

private:
    int axisOf(int k) const { return (up_ + 1 + k) % 3; }
    Vec2f flat(const LocalFrame& local, int k) const {
        return local.stretch.vector(local.frame.flat(Vec3f(along_[std::size_t(k)])));
    }
    int up_;
    std::array<Vec3d, 2> along_;
};

/// The nodes at the twelve offsets +-e_k, +-(e_k - e_l) of a node's superbase.
using Forward = std::array<NodeIndex, 12>;

/// The part of a step to an offset that follows step k - 1 of `steps` straight ones, rounded; the
/// same in both directions.
int moveAlong(int whole, int k, int steps) {
    auto at = [&](int step) {  // whole step / steps
        return (whole < 0 ? -1 : 1) * ((2 * std::abs(whole) * step + steps) / (2 * steps));
    };
    return at(k) - at(k - 1);
}

/// The node linked to another in the column at `move`, nearest to S; kNoNode where there is none.
NodeIndex linkedInColumn(const JetCore& core, NodeIndex from, const Columns& columns, Vec2i move) {
    NodeIndex next = kNoNode;
    float least = float(kInfinity);
    forLinks(core, from, [&](NodeIndex j, const Ijk& step, const Vec3f&, float) {
        const Vec2i column = columns.columnOf(step);
        if (column.x != move.x || column.y != move.y) return;
        const Vec3f& foot = core.nodes[j].foot;
        if (const float off = dot(foot, foot); off < least) least = off, next = j;
    });
    return next;
}

/// From a core node over links to a column, nearest to the straight line; kNoNode where links do
/// not lead there, or an obstacle lies on the chord, or a rim.
NodeIndex walk(const JetCore& core, NodeIndex from, const Columns& columns, Vec2i offset) {
    const int steps = std::max(std::abs(offset.x), std::abs(offset.y));
    NodeIndex at = from;
    bool clear = core.nodes[from].obstacleState == Metric::Clear;
    bool besideRim = core.rims.isBesideOpen(core, from);
    for (int k = 1; k <= steps; ++k) {
        at = linkedInColumn(core, at, columns,
                            {moveAlong(offset.x, k, steps), moveAlong(offset.y, k, steps)});
        if (at == kNoNode) return kNoNode;
        clear &= core.nodes[at].obstacleState == Metric::Clear;
        besideRim = besideRim || core.rims.isBesideOpen(core, at);
    }
    const JetNode &a = core.nodes[from], &b = core.nodes[at];
    // Around a corner of a rim the links go on, but no chord does.
    if (besideRim && steps > 1 && leadsOverRim(core.band, core.footOf(a), core.footOf(b)))
        return kNoNode;
    // Where no link of the walk comes near an obstacle, neither does the chord.
    if (!clear &&
        core.metric.blocked(core.footOf(a), core.footOf(b), Vec3d(normalized(a.normal + b.normal))))
        return kNoNode;
    return at;
}

Forward forwardOf(const JetCore& core, NodeIndex i) {
    const Columns columns(core.nodes[i].normal);
    const Superbase e = obtuseSuperbase(columns.form(core.localFrame(i)));
    Forward found;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k)
        for (const Vec2i offset : {e[k], e[k] - e[(k + 1) % 3]})
            for (const Vec2i o : {offset, -offset}) found[n++] = walk(core, i, columns, o);
    return found;
}

/// Per node the nodes that have it in their forward list.
struct Backward {
    std::vector<std::uint32_t> begin;
    std::vector<NodeIndex> node;  ///< those of node i from begin[i] to begin[i + 1]

    explicit Backward(const std::vector<Forward>& forward) : begin(forward.size() + 1) {
        for (const Forward& f : forward)
            for (const NodeIndex j : f)
                if (j != kNoNode) ++begin[j + 1];
        for (std::size_t i = 0; i < forward.size(); ++i) begin[i + 1] += begin[i];
        node.resize(begin.back());
        std::vector<std::uint32_t> fill(begin.begin(), begin.end() - 1);
        for (std::size_t i = 0; i < forward.size(); ++i)
            for (const NodeIndex j : forward[i])
                if (j != kNoNode) node[fill[j]++] = NodeIndex(i);
    }
};

/// The neighbors of one node, each once.
struct NeighborList {
    std::array<NodeIndex, JetLinks::kMax> node;
    std::size_t count = 0;

    void add(NodeIndex j) {
        const auto end = node.begin() + std::ptrdiff_t(count);
        if (count < node.size() && std::find(node.begin(), end, j) == end) node[count++] = j;
    }
};

/// Both directions, and the links: where a walk fails fronts still pass.
NeighborList neighborsOf(const JetCore& core, NodeIndex i, const std::vector<Forward>& forward,
                         const Backward& backward) {
    NeighborList list;
    auto add = [&](NodeIndex j) {
        if (j != kNoNode && j != i) list.add(j);
    };
    for (const NodeIndex j : forward[i]) add(j);
    forLinks(core, i, [&](NodeIndex j, const Ijk&, const Vec3f&, float) { add(j); });
    for (std::size_t k = backward.begin[i]; k < backward.begin[i + 1]; ++k) add(backward.node[k]);
    return list;
}

}  // namespace

JetStencil buildStencil(const JetCore& core) {
    const std::size_t n = core.nodes.size();
    auto forNodes = [&](const auto& visit) {
        parallelFor(n, 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) visit(NodeIndex(i));
        });
    };
    std::vector<Forward> forward(n);
    forNodes([&](NodeIndex i) { forward[i] = forwardOf(core, i); });
    const Backward backward(forward);
    JetStencil stencil;
    stencil.begin.assign(n + 1, 0);
    forNodes([&](NodeIndex i) {
        stencil.begin[i + 1] = std::uint32_t(neighborsOf(core, i, forward, backward).count);
    });
    for (std::size_t i = 0; i < n; ++i) stencil.begin[i + 1] += stencil.begin[i];
    stencil.node.resize(stencil.begin[n]);
    forNodes([&](NodeIndex i) {
        const NeighborList list = neighborsOf(core, i, forward, backward);
        std::copy_n(list.node.begin(), list.count, stencil.node.begin() + stencil.begin[i]);
    });
    return stencil;
}

}  // namespace igeo
