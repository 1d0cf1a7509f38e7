#include <igeo/trace.h>

#include <igeo/parallel.h>

#include <algorithm>

namespace igeo {

const char* toString(PathStatus status) {
    switch (status) {
        case PathStatus::Reached:
            return "reached";
        case PathStatus::Unreachable:
            return "unreachable";
        case PathStatus::Stalled:
            break;
    }
    return "stalled";
}

namespace {

class Tracer {
public:
    Tracer(const Band& band, const Field& field, const std::vector<Vec3f>& gradient,
           const TraceOptions& options)
        : band_(band), field_(field), gradient_(gradient), options_(options) {}

    Path trace(const SurfacePoint& target);

private:
    /// -grad_S d / |grad_S d|, blended from the corners of the cell; false where it vanishes.
    bool direction(const Vec3d& p, Vec3d& v) const;
    /// One accepted Runge-Kutta step from p, projected; false when the step would be below minStep.
    bool stepAlongGradient(Vec3d& p, double& step) const;
    /// To the foot point of the neighbouring node of least distance below `d`, which becomes `d`;
    /// false if there is none.
    bool stepToNeighbour(Vec3d& p, double& d) const;
    void append(Path& path, const Vec3d& p, double d) const;
    void finishAtSeed(Path& path, const SurfacePoint& seed) const;

    const Band& band_;
    const Field& field_;
    const std::vector<Vec3f>& gradient_;
    const TraceOptions& options_;
};

bool Tracer::direction(const Vec3d& p, Vec3d& v) const {
    BandCell cell = cellAt(band_, p);
    const Vec3d n = dropFacingCorners(band_, cell);
    Vec3d g{};
    for (std::size_t k = 0; k < 8; ++k)
        if (cell.node[k] != kNoNode) g += cell.weight[k] * Vec3d(gradient_[cell.node[k]]);
    g = tangential(g, n);
    const double len = length(g);
    // Half of the front's gradient cancels where fronts meet at 120 degrees: no use beyond that.
    if (!(len > 0.1)) return false;
    v = -(1 / len) * g;
    return true;
}

bool Tracer::stepAlongGradient(Vec3d& p, double& step) const {
    Vec3d k1, k2, k3, k4;
    if (!direction(p, k1)) return false;
    for (; step >= options_.minStep; step /= 2) {
        if (!direction(p + (step / 2) * k1, k2) || !direction(p + (3 * step / 4) * k2, k3))
            continue;
        Vec3d q = p + step * ((2.0 / 9) * k1 + (1.0 / 3) * k2 + (4.0 / 9) * k3);
        if (!direction(q, k4)) continue;
        const double error =
            step * length((-5.0 / 72) * k1 + (1.0 / 12) * k2 + (1.0 / 9) * k3 - (1.0 / 8) * k4);
        const double ratio = error / options_.tolerance;
        if (ratio > 1) continue;
        const Vec3d free = q;
        if (!projectToSurface(band_, q) || length(q - free) > step) continue;
        p = q;
        // Third-order local error: the step that would just meet the tolerance, with a margin.
        const double growth = ratio > 0 ? 0.9 * std::cbrt(1 / ratio) : 2.0;
        step = std::min(step * std::clamp(growth, 0.5, 2.0), options_.maxStep);
        return true;
    }
    return false;
}

bool Tracer::stepToNeighbour(Vec3d& p, double& d) const {
    const NodeIndex here = band_.nodeAt(roundToIjk(p));
    if (here == kNoNode) return false;
    NodeIndex best = kNoNode;
    for (int k = 0; k < 27; ++k) {
        const NodeIndex j = band_.neighbour(here, k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
        // Voxels further out would carry the path sideways to their foot points.
        if (j == kNoNode || !(field_.distance[j] < d) || std::abs(band_.psi[j]) > 1) continue;
        if (best == kNoNode || field_.distance[j] < field_.distance[best]) best = j;
    }
    if (best == kNoNode) return false;
    d = field_.distance[best];
    p = band_.footPoint(best);
    projectToSurface(band_, p);
    return true;
}

void Tracer::append(Path& path, const Vec3d& p, double d) const {
    if (!path.vertices.empty()) path.length += length(p - path.vertices.back().pIndex);
    path.vertices.push_back({p, path.length, d});
}

void Tracer::finishAtSeed(Path& path, const SurfacePoint& seed) const {
    const Vec3d from = path.vertices.back().pIndex, way = seed.pIndex - from;
    const int pieces = std::max(1, int(std::ceil(length(way) / options_.maxStep)));
    for (int k = 1; k < pieces; ++k) {
        Vec3d p = from + (double(k) / pieces) * way;
        projectToSurface(band_, p);
        append(path, p, seed.start + seed.weight * length(seed.pIndex - p));
    }
    append(path, seed.pIndex, seed.start);
    path.seed = std::size_t(&seed - field_.seeds.data());
    path.status = PathStatus::Reached;
}

Path Tracer::trace(const SurfacePoint& target) {
    Path path;
    path.target = target;
    Vec3d p = target.pIndex;
    double d = sampleDistance(band_, field_, p);
    path.distance = d;
    if (!(d < kInfinity)) return path;
    append(path, p, d);
    path.status = PathStatus::Stalled;

    constexpr int kPatience = 8;
    double step = options_.maxStep / 4, least = d;
    // Steps along the gradient since `least` fell: a path that circles goes on from node to node,
    // where `least` falls every time.
    int sinceProgress = 0;
    while (true) {
        if (const SurfacePoint* seed = seedAround(field_, p, d)) {
            finishAtSeed(path, *seed);
            return path;
        }
        if (sinceProgress >= kPatience || !stepAlongGradient(p, step)) {
            if (!stepToNeighbour(p, least)) return path;
            step = options_.maxStep / 4;
            sinceProgress = 0;
        }
        d = sampleDistance(band_, field_, p);
        append(path, p, d);
        sinceProgress = d < least ? 0 : sinceProgress + 1;
        least = std::min(least, d);
    }
}

}  // namespace

Path tracePath(const Band& band, const Field& field, const std::vector<Vec3f>& gradient,
               const SurfacePoint& target, const TraceOptions& options) {
    return Tracer(band, field, gradient, options).trace(target);
}

std::vector<Path> tracePaths(const Band& band, const Field& field,
                             const std::vector<Vec3f>& gradient,
                             const std::vector<SurfacePoint>& targets, const TraceOptions& options,
                             Progress& progress) {
    std::vector<Path> paths(targets.size());
    parallelFor(targets.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !progress.cancelled(); ++k)
            paths[k] = tracePath(band, field, gradient, targets[k], options);
    });
    progress.throwIfCancelled();
    return paths;
}

}  // namespace igeo
