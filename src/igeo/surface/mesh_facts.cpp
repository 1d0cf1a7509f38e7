#include <igeo/surface/mesh_facts.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/detail/disjoint_sets.h>
#include <igeo/surface/detail/mesh_crossings.h>

namespace igeo {

namespace {

/// Corners of triangles, joined around their points from triangle to triangle: sheets that only
/// touch at a point get separate points.
DisjointSets fansOf(const TriangleMesh& mesh, const MeshTopology& topology) {
    const auto cornerAt = [&](std::size_t t, std::uint32_t point) {
        const auto& [a, b, c] = mesh.triangles[t];
        return std::uint32_t(3 * t + (a == point ? 0 : b == point ? 1 : 2));
    };
    DisjointSets fans(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t u = topology.neighbor[t][k];
            if (u >= mesh.triangles.size()) continue;
            for (const std::size_t end : {k, (k + 1) % 3})
                fans.join(std::uint32_t(3 * t + end), cornerAt(u, mesh.triangles[t][end]));
        }
    return fans;
}

std::size_t countHoles(const TriangleMesh& mesh, const MeshTopology& topology, DisjointSets& fans) {
    if (topology.boundaryEdges == 0) return 0;
    DisjointSets holes(3 * mesh.triangles.size());
    std::vector<bool> atBoundary(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            if (topology.neighbor[t][k] != MeshTopology::kNone) continue;
            const std::uint32_t from = fans.first(std::uint32_t(3 * t + k)),
                                to = fans.first(std::uint32_t(3 * t + (k + 1) % 3));
            holes.join(from, to);
            // Both ends: triangles may be oriented differently.
            atBoundary[from] = atBoundary[to] = true;
        }
    std::size_t count = 0;
    for (std::uint32_t c = 0; c < atBoundary.size(); ++c)
        count += atBoundary[c] && holes.first(c) == c;
    return count;
}

/// Points with several fans, but for those on edges of three triangles or more.
std::size_t countPinches(const TriangleMesh& mesh, const MeshTopology& topology,
                         DisjointSets& fans) {
    constexpr std::uint32_t kUnseen = MeshTopology::kNone;
    std::vector<std::uint32_t> fanOf(mesh.points.size(), kUnseen);
    std::vector<bool> pinched(mesh.points.size()), onMany(mesh.points.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t p = mesh.triangles[t][k],
                                fan = fans.first(std::uint32_t(3 * t + k));
            if (fanOf[p] == kUnseen) fanOf[p] = fan;
            if (fanOf[p] != fan) pinched[p] = true;
            if (topology.neighbor[t][k] == MeshTopology::kMany)
                onMany[p] = onMany[mesh.triangles[t][(k + 1) % 3]] = true;
        }
    std::size_t count = 0;
    for (std::size_t p = 0; p < pinched.size(); ++p) count += pinched[p] && !onMany[p];
    return count;
}

/// Of a closed mesh: points - edges + triangles.
int eulerOf(const TriangleMesh& mesh, DisjointSets& fans) {
    int points = 0;
    for (std::uint32_t c = 0; c < 3 * mesh.triangles.size(); ++c) points += fans.first(c) == c;
    return points - int(mesh.triangles.size() / 2);
}

std::string counted(std::size_t n, const char* one) {
    return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

}  // namespace

MeshFacts meshFacts(const TriangleMesh& mesh, const Progress& progress) {
    const MeshTopology topology = meshTopology(mesh);
    MeshFacts facts;
    facts.points = mesh.points.size();
    facts.triangles = mesh.triangles.size();
    facts.dropped = mesh.dropped;
    facts.repeated = mesh.repeated;
    facts.junctions = mesh.junctions;
    facts.components = topology.components;
    facts.boundaryEdges = topology.boundaryEdges;
    facts.nonManifoldEdges = topology.nonManifoldEdges;
    facts.nonOrientable = topology.nonOrientable;
    DisjointSets fans = fansOf(mesh, topology);
    facts.holes = countHoles(mesh, topology, fans);
    facts.pinches = countPinches(mesh, topology, fans);
    const double contact = TriangleMesh::kSame * length(Box(mesh.points).size());
    MeshCrossings crossings = meshCrossings(mesh, contact, progress);
    facts.crossingPairs = crossings.pairs;
    facts.contacts = std::move(crossings.contacts);
    facts.closed = topology.closed();
    if (facts.closed) facts.euler = eulerOf(mesh, fans);
    return facts;
}

std::string crossingsOf(const MeshFacts& facts) {
    const bool orMore = facts.crossingPairs == kMostCrossingPairs;
    return counted(facts.crossingPairs, "pair") + (orMore ? " or more" : "") + " of faces cross";
}

std::string splitsOf(const MeshFacts& facts) {
    return "edges split at " + counted(facts.junctions, "point") + " in them";
}

std::vector<std::string> meshWarnings(const MeshFacts& facts) {
    std::vector<std::string> warnings;
    if (facts.repeated > 0)
        warnings.push_back(counted(facts.repeated, "triangle") +
                           " repeat others, in the same or the opposite order of corners (as in "
                           "two-sided exports): dropped");
    if (facts.crossingPairs > 0)
        warnings.push_back(crossingsOf(facts) + ": the mesh passes through itself");
    if (facts.pinches > 0)
        warnings.push_back(fmt::format(
            "at {} parts of the mesh meet that share no edge there: no path passes over such a "
            "vertex",
            facts.pinches == 1 ? "a vertex" : fmt::format("{} vertices", facts.pinches)));
    if (facts.nonOrientable > 0)
        warnings.push_back(fmt::format(
            "the mesh has one side only (as a Moebius strip) in {} of {}: godunov cuts it along a "
            "line there, which its paths go around; jet does not",
            facts.nonOrientable, counted(facts.components, "part")));
    return warnings;
}

std::string openness(const MeshFacts& facts) {
    if (facts.boundaryEdges == 0) return {};
    return "open: " + counted(facts.boundaryEdges, "boundary edge") + " in " +
           counted(facts.holes, "hole");
}

}  // namespace igeo
