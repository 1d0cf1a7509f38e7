#include <igeo/geodesic_solver.h>

#include <fmt/core.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/results/detail/column_name.h>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// A signed distance needs curves or regions, and no other seeds.
void requireSigned(const Seeds& seeds) {
    if (!seeds.points.empty() || !seeds.groups.empty() || seeds.samples > 0 ||
        seeds.curves.empty() == seeds.regions.empty())
        throw Error(Kind::InvalidArgument,
                    "a signed distance needs closed curves or regions, and seeds of one kind only",
                    "give either curves or regions, and no other seed");
}

/// Voxels: up to this start double precision resolves differences of 1e-4.
constexpr double kLatestStart = 1e12;

/// @param start  world units times weight
void requireStart(double start, double dx, const std::string& what) {
    if (start >= 0 && start / dx <= kLatestStart) return;
    throw Error(Kind::InvalidArgument,
                fmt::format("{} starts at {:.6g}; allowed are 0 to {:.4g}, 1e12 voxels", what,
                            start, kLatestStart * dx),
                "give a smaller start value, or leave out what starts so late");
}

void requireStarts(const Seeds& seeds, double dx) {
    for (std::size_t k = 0; k < seeds.points.size(); ++k)
        requireStart(seeds.points[k].start, dx, "seed " + std::to_string(k));
    for (const SeedGroup& group : seeds.groups)
        for (const Seed& seed : group.points)
            requireStart(seed.start, dx, "a seed of group " + group.name);
    for (std::size_t k = 0; k < seeds.curves.size(); ++k)
        requireStart(seeds.curves[k].start, dx, "seed curve " + std::to_string(k));
}

}  // namespace

void Seeds::requireUsable(double dx) const {
    if (empty())
        throw Error(Kind::InvalidArgument, "there is no seed", "give a point, a curve or a region");
    if (isSigned) requireSigned(*this);
    requireStarts(*this, dx);
}

std::vector<Seeds> Seeds::sources() const {
    std::vector<Seeds> all;
    auto add = [&](const auto& fill) {
        all.emplace_back();
        all.back().isSigned = isSigned;
        fill(all.back());
    };
    auto nameThe = [&](Seeds& seeds, std::size_t place) {
        if (place < names.size()) seeds.names = {names[place]};
    };
    for (const Seed& p : points) add([&](Seeds& s) { s.points = {p}; });
    for (const SeedGroup& g : groups) add([&](Seeds& s) { s.groups = {g}; });
    for (std::size_t k = 0; k < curves.size(); ++k)
        add([&](Seeds& s) { s.curves = {curves[k]}, nameThe(s, k); });
    for (std::size_t k = 0; k < regions.size(); ++k)
        add([&](Seeds& s) { s.regions = {regions[k]}, nameThe(s, curves.size() + k); });
    return all;
}

std::vector<VertexColumn> GeodesicSolver::atVertices(const std::vector<Seeds>& seeds,
                                                     const MarchLimits& limits,
                                                     Progress& progress) const {
    const VertexReader reader(requireMesh(surface()), surface().transform());
    MarchLimits each = limits;
    if (!each.stopAtTargets) each.targets.clear();
    std::vector<std::string> names;
    for (const Seeds& s : seeds) names.push_back(s.groups.empty() ? "" : s.groups.front().name);
    names = distanceColumns(names);
    std::vector<VertexColumn> columns(seeds.size());
    CancelOnly quiet(progress);
    Steps steps(progress, "columns", seeds.size());
    parallelFor(seeds.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            columns[k] = {names[k],
                          reader.read(distance(seeds[k], each, quiet).field(), quiet).distance};
            steps.add(1);
        }
    });
    return columns;
}

}  // namespace igeo
