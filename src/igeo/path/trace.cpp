#include <igeo/path/trace.h>

#include <igeo/band/detail/chord.h>
#include <igeo/band/detail/mesh_ways.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/mesh_read.h>
#include <igeo/path/detail/curve_on_triangles.h>
#include <igeo/path/detail/descent_step.h>
#include <igeo/path/detail/other_ways.h>
#include <igeo/path/straighten.h>

#include <algorithm>

namespace igeo {

const char* toString(PathStatus status) {
    switch (status) {
        case PathStatus::Reached:
            return "reached";
        case PathStatus::Unreachable:
            return "unreachable";
        case PathStatus::OffSurface:
            return "off surface";
        case PathStatus::Stalled:
            break;
    }
    return "stalled";
}

namespace {

class Tracer {
public:
    /// @param byNodes  the path goes from node to node of a mesh, without gradients
    Tracer(const Field& field, const TraceOptions& options, bool byNodes = false)
        : band_(*field.band), field_(field), options_(options), byNodes_(byNodes) {}

    Path trace(const SurfacePoint& target);

private:
    /// Whether a path may pass through a node and continue from it: the value of each node came
    /// from a lower one.
    bool walkable(NodeIndex i) const;
    /// Whether S joins p with the foot point of a node nearby.
    bool isOnSheet(const Vec3d& p, NodeIndex i) const;
    /// The node that gives the shortest path from p of those that no obstacle hides.
    /// @param here  the distance at p
    NodeIndex nodeAhead(const Vec3d& p, double here) const;
    NodeIndex lowestNeighbor(NodeIndex i) const;
    /// The node that gives the shortest path of those lower than d up to three steps away, by
    /// walks on a mesh: a march solves some nodes over two links, or over a straight line.
    NodeIndex lowestByWalk(const Vec3d& p, double d) const;
    /// The normal at p of the sheet of the path.
    Vec3d normalAt(const Vec3d& p) const;
    void append(Path& path, const Vec3d& p, double d) const;
    /// Adds points of S along the chord from the path's end to p, where the distance is d, so that
    /// the path cuts no edge in between.
    void appendBetween(Path& path, const Vec3d& p, double d) const;
    /// The current point of a path.
    struct State {
        Vec3d p;
        double d;
        const SurfacePoint* seed;  ///< that a straight line joins with it, or nullptr
        double step;
        NodeIndex node;  ///< while the path goes from node to node, else kNoNode
    };
    /// Goes along a straight line on a mesh to the node or seed that gives the shortest path, where
    /// sheets cross or fold within a voxel.
    /// @return false where there are no such lines
    bool followLine(Path& path, State& at);
    /// The seed of a region that contains the target, so that the path has no length; or nullptr.
    const SurfacePoint* regionAround(const Arrival& arrival) const;
    /// The seed whose straight line to p is as long as the distance d there, or nullptr.
    const SurfacePoint* straightAhead(const Vec3d& p, double d) const;
    /// 1 with a tensor.
    double weightAt(const Vec3d& p) const {
        const Metric& metric = *field_.metric;
        if (!metric.weighted() || metric.anisotropic()) return 1;
        return metric.at(SurfaceCell(band_, metric, p, sheetNormal_));
    }
    void finishAtSeed(Path& path, const SurfacePoint& seed) const;
    /// The node nearest to p that a path may pass through, or kNoNode.
    NodeIndex nodeBeside(const Vec3d& p) const;
    /// A step of a rough path; false where it does not lead down.
    bool stepFromNode(State& at) const;
    /// A step along the gradient; where that does not lead down (cut loci, creases), to the next
    /// node. The distance falls in both cases, so the path ends.
    /// @return false where no neighbor is lower
    bool advance(State& at) const;

    const Band& band_;
    const Field& field_;
    const TraceOptions& options_;
    const bool byNodes_;
    Vec3d sheetNormal_;  ///< of the sheet of the path: another one may face it in a cell
};

Vec3d Tracer::normalAt(const Vec3d& p) const {
    return SurfaceCell(band_, *field_.metric, p, sheetNormal_).normal;
}

bool Tracer::walkable(NodeIndex i) const {
    // Voxels farther out would move the path sideways to their foot points.
    return (field_.atFootPoints ? band_.inCore(i) : std::abs(band_.psi[i]) <= 1) &&
           field_.at(i).distance < kInfinity;
}

bool Tracer::isOnSheet(const Vec3d& p, NodeIndex i) const {
    return !band_.triangles || !(band_.facing[i] & Band::kBesideSevered) ||
           followsSurface(band_, p, band_.footPoint(i));
}

NodeIndex Tracer::nodeAhead(const Vec3d& p, double here) const {
    // Farther off, a chord may cut the edge or cross the wall between.
    constexpr double kFar = 2;  // voxels
    // A distance that falls by more than the length of the chord is that behind a wall.
    constexpr double kSteep = 1.25, kRoom = 0.5;  // kRoom: voxels
    const double weight = weightAt(p);
    const Ijk middle = roundToIjk(p);
    auto forNodes = [&](const auto& visit) {
        for (int x = -2; x <= 2; ++x)
            for (int y = -2; y <= 2; ++y)
                for (int z = -2; z <= 2; ++z) {
                    const NodeIndex j = band_.nodeAt(middle + Ijk{x, y, z});
                    if (j != kNoNode && walkable(j) &&
                        dot(Vec3f(sheetNormal_), band_.normal[j]) >= Band::kOtherSheet &&
                        !field_.metric->blocked(band_, p, sheetNormal_, j) && isOnSheet(p, j))
                        visit(j, length(band_.footPoint(j) - p));
                }
    };
    NodeIndex nearest = kNoNode, best = kNoNode;
    double least = kInfinity;
    forNodes([&](NodeIndex j, double chord) {
        if (chord < least) least = chord, nearest = j;
    });
    least = kInfinity;
    forNodes([&](NodeIndex j, double chord) {
        if (j != nearest && (chord > kFar || !band_.joined(nearest, j))) return;
        const double cost = field_.metric->at(j), d = field_.at(j).distance + cost * chord;
        if (!field_.metric->anisotropic() &&
            here - d > std::max(cost, weight) * ((kSteep - 1) * chord + kRoom))
            return;
        if (d < least) least = d, best = j;
    });
    return best;
}

NodeIndex Tracer::lowestNeighbor(NodeIndex i) const {
    NodeIndex best = i;
    double least = field_.at(i).distance;
    auto isLower = [&](NodeIndex j) { return walkable(j) && field_.at(j).distance < least; };
    auto take = [&](NodeIndex j) { best = j, least = field_.at(j).distance; };
    band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        if (isLower(j) && dot(band_.normal[i], band_.normal[j]) >= Band::kOtherSheet &&
            !band_.severed(i, j) && !field_.metric->blocked(band_, i, j))
            take(j);
    });
    band_.forBridges(i, [&](const Bridge& b) {
        if (isLower(b.to) && !field_.metric->blocked(band_, i, b.to)) take(b.to);
    });
    return best == i ? kNoNode : best;
}

NodeIndex Tracer::lowestByWalk(const Vec3d& p, double d) const {
    constexpr int kReach = 3;
    constexpr double kLongest = 6;  // voxels
    const Metric& metric = *field_.metric;
    const auto at = footPlace(*band_.triangles, p, sheetNormal_);
    std::vector<std::pair<double, NodeIndex>> lower;
    const Ijk middle = roundToIjk(p);
    for (int x = -kReach; x <= kReach; ++x)
        for (int y = -kReach; y <= kReach; ++y)
            for (int z = -kReach; z <= kReach; ++z) {
                const NodeIndex j = band_.nodeAt(middle + Ijk{x, y, z});
                if (j == kNoNode || !walkable(j) || !(field_.at(j).distance < d) ||
                    metric.blocked(band_, p, sheetNormal_, j))
                    continue;
                lower.emplace_back(
                    field_.at(j).distance + metric.at(j) * length(band_.footPoint(j) - p), j);
            }
    std::sort(lower.begin(), lower.end());
    ShortWalk walk(*band_.triangles);
    NodeIndex best = kNoNode;
    double least = kInfinity;
    for (const auto& [bound, j] : lower) {
        if (bound > least) break;
        const auto to = band_.footPlace(j);
        const double walked =
            walk.tightLength({at.triangle, at.point}, {to.triangle, to.point}, kLongest);
        const double whole = field_.at(j).distance + metric.at(j) * walked;
        if (whole < least) least = whole, best = j;
    }
    return best;
}

void Tracer::append(Path& path, const Vec3d& p, double d) const {
    if (!path.vertices.empty()) {
        const Vec3d& last = path.vertices.back().pIndex;
        path.length += length(p - last);
        path.weightedLength += segmentCost(band_, *field_.metric, last, p, sheetNormal_);
    }
    path.vertices.push_back({p, path.length, d});
}

void Tracer::appendBetween(Path& path, const Vec3d& p, double d) const {
    const PathVertex from = path.vertices.back();
    // A bridge may lead around a wall.
    if (band_.triangles && !followsSurface(band_, from.pIndex, p)) return;
    const double chord = length(p - from.pIndex);
    const int segments = int(std::ceil(chord / options_.maxStep));
    for (int k = 1; k < segments; ++k) {
        const double t = double(k) / segments;
        const Vec3d onChord = from.pIndex + t * (p - from.pIndex);
        Vec3d q = onChord;
        if (projectToSurface(band_, q) && length(q - onChord) < chord / 2)
            append(path, q, from.distance + t * (d - from.distance));
    }
}

const SurfacePoint* Tracer::straightAhead(const Vec3d& p, double d) const {
    // Beside a seed on a folded or thin surface, and in a start disc made long by a tensor, where
    // the front bends more sharply than a cell resolves.
    constexpr double kRise = 1, kAgree = 0.02;
    const bool isotropic = !field_.metric->anisotropic();
    const TangentFrame frame{Vec3f(sheetNormal_)};
    const SurfacePoint* ahead = nullptr;
    const double here = weightAt(p);
    auto look = [&](const SurfacePoint& s) {
        const double cost = costToSeed(field_, s, p, sheetNormal_, here);
        if (ahead || !(std::abs(d - s.start - cost) <= kAgree * cost)) return;
        const Vec3d end = s.nearestTo(p);
        const bool near =
            isotropic
                ? length(end - p) < field_.startRadius
                : std::abs(dot(sheetNormal_, end - p)) <= kRise &&
                      cost <= field_.startRadius * field_.metric->inPlane(frame, s.node).largest();
        if (near && !field_.metric->blocked(p, end, sheetNormal_) && followsSurface(band_, p, end))
            ahead = &s;
    };
    if (isotropic)
        field_.seedsNear.forNear(p, [&](std::size_t k) { look(field_.seeds[k]); });
    else
        for (const SurfacePoint& s : field_.seeds) look(s);
    return ahead;
}

const SurfacePoint* Tracer::regionAround(const Arrival& arrival) const {
    if (arrival.distance > 0 || arrival.seed) return nullptr;
    const bool isRegion =
        std::any_of(field_.regions.begin(), field_.regions.end(),
                    [&](const Field::Region& region) { return region.source == arrival.source; });
    const auto first = std::find(field_.source.begin(), field_.source.end(), arrival.source);
    return isRegion ? &field_.seeds[std::size_t(first - field_.source.begin())] : nullptr;
}

void Tracer::finishAtSeed(Path& path, const SurfacePoint& seed) const {
    const Vec3d from = path.vertices.back().pIndex, end = seed.nearestTo(from), line = end - from;
    double d = path.vertices.back().distance;
    const int segments = std::max(1, int(std::ceil(length(line) / options_.maxStep)));
    for (int k = 1; k < segments; ++k) {
        Vec3d p = from + (double(k) / segments) * line;
        projectToSurface(band_, p, Vec3d(band_.normal[seed.node]));
        // In a groove a point of the line may be projected to the wall behind the last point.
        d = std::min(d, seed.start + costToSeed(field_, seed, p, sheetNormal_, weightAt(p)));
        append(path, p, d);
    }
    append(path, end, seed.start);
    path.seed = std::size_t(&seed - field_.seeds.data());
    path.status = PathStatus::Reached;
}

NodeIndex Tracer::nodeBeside(const Vec3d& p) const {
    NodeIndex nearest = kNoNode;
    double least = kInfinity;
    for (const NodeIndex i : cellAt(band_, p).node) {
        if (i == kNoNode || !walkable(i) ||
            dot(Vec3f(sheetNormal_), band_.normal[i]) < Band::kOtherSheet)
            continue;
        if (const double far = length(band_.footPoint(i) - p); far < least)
            least = far, nearest = i;
    }
    return nearest;
}

bool Tracer::stepFromNode(State& at) const {
    constexpr double kStep = 2, kOff = 1;  // voxels
    const NodeIndex from = nodeBeside(at.p);
    if (from == kNoNode) return false;
    const Vec3d ahead = at.p - kStep * normalized(Vec3d(field_.at(from).gradient));
    Vec3d p = ahead;
    if (!projectToSurface(band_, p, sheetNormal_) || length(p - ahead) > kOff) return false;
    const NodeIndex to = nodeBeside(p);
    if (to == kNoNode) return false;
    const NodeJet jet = field_.at(to);
    const double d = jet.distance + dot(Vec3d(jet.gradient), p - band_.footPoint(to));
    if (!(d < at.d)) return false;
    at = {p, d, nullptr, at.step, kNoNode};
    field_.seedsNear.forNear(p, [&](std::size_t k) {
        if (!at.seed && length(field_.seeds[k].nearestTo(p) - p) < field_.startRadius)
            at.seed = arrivalAt(field_, p, sheetNormal_).seed;
    });
    return true;
}

bool Tracer::advance(State& at) const {
    constexpr double kFall = 1e-4;  // voxels
    if (options_.rough && at.node == kNoNode && stepFromNode(at)) return true;
    Vec3d next = at.p;
    Arrival there;
    const StepLimits limits{options_.minStep, options_.maxStep, options_.tolerance};
    if (!byNodes_ && stepDown(field_, limits, sheetNormal_, next, at.step))
        there = arrivalAt(field_, next, sheetNormal_);
    if (there.distance < at.d - kFall * field_.metric->at(cellAt(band_, at.p))) {
        at = {next, there.distance, there.seed, at.step, kNoNode};
        return true;
    }
    if (byNodes_ && at.node == kNoNode)
        at.node = lowestByWalk(at.p, at.d);
    else
        at.node = at.node == kNoNode ? nodeAhead(at.p, at.d) : lowestNeighbor(at.node);
    if (at.node == kNoNode && band_.triangles) at.node = lowestByWalk(at.p, at.d);
    return at.node != kNoNode;
}

bool Tracer::followLine(Path& path, State& at) {
    // Voxels. kLater: at nodes, and at points, which have their values from between nodes.
    constexpr double kFall = 1e-4, kLater = 0.1, kLaterAtPoint = 1;
    const Metric& metric = *field_.metric;
    if (!band_.ways || !field_.atFootPoints || metric.anisotropic() || metric.obstacles ||
        !hasWays(band_, cellAt(band_, at.p), field_.evenCosts))
        return false;
    const double here = weightAt(at.p);
    const std::vector<Seen> seen =
        seenFrom(field_, footPlace(*band_.triangles, at.p, sheetNormal_), here,
                 /*withCrossings=*/true);
    const Seen* best = nullptr;
    double least = kInfinity;
    for (const Seen& s : seen) {
        const double d = s.distance();
        if (d < least && s.jet.distance < at.d - kFall * here) least = d, best = &s;
    }
    // The front may have come over links.
    const double later = at.node != kNoNode ? kLater : kLaterAtPoint;
    if (!best || least > at.d + later * here) return false;
    double done = 0;
    for (const Vec3d& p : best->crossings) {
        done += length(p - path.vertices.back().pIndex);
        const double share = std::min(1.0, done / std::max(best->line.length, 1e-9));
        append(path, p, at.d + share * (best->jet.distance - at.d));
    }
    if (best->seed) {
        append(path, best->seed->pIndex, best->seed->start);
        path.seed = std::size_t(best->seed - field_.seeds.data());
        path.status = PathStatus::Reached;
        return true;
    }
    at = {band_.footPoint(best->node), best->jet.distance, nullptr, options_.maxStep / 4,
          best->node};
    sheetNormal_ = Vec3d(band_.normal[best->node]);
    append(path, at.p, at.d);
    return true;
}

Path Tracer::trace(const SurfacePoint& target) {
    Path path;
    path.target = target;
    if (target.offSurface) {
        path.status = PathStatus::OffSurface;
        return path;
    }
    sheetNormal_ = Vec3d(band_.normal[target.node]);
    const Arrival arrival = arrivalAt(field_, target.pIndex, sheetNormal_);
    if (!(arrival.distance < kInfinity) || arrival.distance > field_.greatest) return path;
    path.distance = arrival.distance;
    State at{target.pIndex, arrival.distance, arrival.seed, options_.maxStep / 4, kNoNode};
    append(path, at.p, at.d);
    if (const SurfacePoint* seed = regionAround(arrival)) {
        path.seed = std::size_t(seed - field_.seeds.data());
        path.status = PathStatus::Reached;
        return path;
    }
    path.status = PathStatus::Stalled;
    while (true) {
        if (followLine(path, at)) {
            if (path.status == PathStatus::Reached) return path;
            continue;
        }
        if (!at.seed) at.seed = straightAhead(at.p, at.d);
        if (const SurfacePoint* seed = at.seed) {
            finishAtSeed(path, *seed);
            return path;
        }
        if (!advance(at)) return path;
        if (at.node != kNoNode) {
            at.p = band_.footPoint(at.node);
            sheetNormal_ = Vec3d(band_.normal[at.node]);
            projectToSurface(band_, at.p, sheetNormal_);
            const double d = field_.at(at.node).distance;
            at.seed = straightAhead(band_.footPoint(at.node), d);
            if (!at.seed) at.seed = arrivalAt(field_, at.p, sheetNormal_).seed;
            // Values at points may be lower than those of the nodes around them.
            at.d = std::min(at.d, d);
            appendBetween(path, at.p, at.d);
            at.step = options_.maxStep / 4;
        }
        if (const Vec3d n = normalAt(at.p); n != Vec3d{}) sheetNormal_ = n;
        append(path, at.p, at.d);
    }
}

/// A path that is so much longer than its distance may lead around the wrong side.
constexpr double kLonger = 1.005;

}  // namespace

Path tracePath(const Field& field, const SurfacePoint& target, const TraceOptions& options) {
    auto traced = [&](bool byNodes) {
        Path path = Tracer(field, options, byNodes).trace(target);
        if (options.rough) return path;
        if (field.band->triangles && !path.vertices.empty()) layOnTriangles(field, path);
        if (hasExactCurves(field)) straighten(field, path);
        return path;
    };
    Path path = traced(false);
    auto isLong = [&] { return path.length > kLonger * path.distance; };
    if (options.rough || !hasExactCurves(field) || path.status != PathStatus::Reached || !isLong())
        return path;
    // Where a mesh is thin a gradient may lead to the other side, from where paths are longer.
    // A curve shorter than the distance has left the mesh: links lead through walls.
    const Path other = traced(true);
    if (other.status == PathStatus::Reached && other.length < path.length &&
        kLonger * other.length >= path.distance)
        path = other;
    if (!isLong()) return path;
    return shorterWay(field, path, kLonger * path.distance);
}

std::vector<Path> tracePaths(const Field& field, const std::vector<SurfacePoint>& targets,
                             const TraceOptions& options, Progress& progress) {
    std::vector<Path> paths(targets.size());
    Steps steps(progress, "trace", targets.size());
    parallelFor(targets.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !steps.cancelled(); ++k) {
            paths[k] = tracePath(field, targets[k], options);
            steps.add(1);
        }
    });
    progress.throwIfCancelled();
    return paths;
}

}  // namespace igeo
