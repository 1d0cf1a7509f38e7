/// What one would use without this project: OpenVDB's mesh of a level set and a geodesic distance
/// on it. One line of JSON on stdout, with the mesh, what each stage took and the peak memory.
///
///     igeo_peer --sdf FILE.vdb | --mesh FILE --seed x,y,z
///               --method heat|heat-id|heat-10|marching|dijkstra|exact|none [--points OUT.csv]
///               [--samples N] [--threads 1] [--further 0]
///     igeo_peer --method list     the methods of this build
///     igeo_peer --method oracle --mesh FILE --seed x,y,z --points IN.csv[,IN.csv...]
///
/// The seed is the vertex nearest to x,y,z. --points writes x,y,z,distance at vertices, all or an
/// even choice of about N. `oracle` reads such files and writes the exact distance on the mesh into
/// their copies IN.csv.exact.
///
/// Stages: read (the file), surface (extraction), setup (whatever serves all seeds, the method's
/// own mesh included), first (distances from the seed), further (from another one).
#include <igeo/base/parallel.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/vdb_read.h>

#include <map>
#include <sstream>
#include <stdexcept>

#include "bench/extracted_mesh.h"
#include "bench/stages.h"
#include "heap.h"
#include "peer.h"
#include "support/arguments.h"

namespace igeo::test {
namespace {

using Maker = std::unique_ptr<Peer> (*)(const TriangleMesh&);

const std::map<std::string, Maker>& makers() {
    static const std::map<std::string, Maker> all{
        {"heat", heatMethod},          {"heat-id", heatMethodIntrinsicDelaunay},
        {"heat-10", heatMethodTuned},  {"marching", fastMarching},
        {"exact", exactOnMesh},
#ifdef IGEO_PEERS_VTK
        {"dijkstra", dijkstraOnEdges},
#endif
    };
    return all;
}

Maker makerOf(const std::string& method) {
    const auto found = makers().find(method);
    if (found == makers().end())
        throw std::runtime_error("no --method " + method + " in this build");
    return found->second;
}

TriangleMesh readSurface(const Arguments& args, Stages& stages) {
    if (args.has("mesh")) {
        TriangleMesh mesh = readMesh(args.text("mesh"));
        stages.finished("read");
        stages.finished("surface");
        return mesh;
    }
    const auto psi = readLevelSetGrid({args.text("sdf"), ""}).grid;
    stages.finished("read");
    TriangleMesh mesh = extractedMesh(*psi);
    stages.finished("surface");
    return mesh;
}

/// No path leads to other components, whatever a method says there.
void leaveOutOthers(const TriangleMesh& mesh, std::size_t seed, std::vector<double>& distance) {
    const MeshTopology topology = meshTopology(mesh);
    std::vector<std::uint32_t> component(mesh.points.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t v : mesh.triangles[t]) component[v] = topology.component[t];
    for (std::size_t v = 0; v < distance.size(); ++v)
        if (component[v] != component[seed]) distance[v] = kInfinity;
}

void writeSamples(const std::string& file, const TriangleMesh& mesh,
                  const std::vector<double>& distance, double samples) {
    PointsCsv csv;
    const std::size_t stride = strideFor(mesh.points.size(), samples);
    for (std::size_t k = 0; k < mesh.points.size(); k += stride)
        csv.add(mesh.points[k], distance[k]);
    writePoints(file, csv);
}

void solve(const Arguments& args) {
    const ThreadLimit limit(int(args.number("threads", 1)));
    const std::string method = args.text("method");
    const Maker make = method == "none" ? nullptr : makerOf(method);
    Stages stages;
    const TriangleMesh mesh = readSurface(args, stages);
    const std::size_t seed = nearestVertex(mesh, args.point("seed"));
    std::vector<double> distance(mesh.points.size(), kInfinity);
    double peak = peakMemory();
    if (make) {
        stages.restart();
        const auto peer = make(mesh);
        stages.finished("setup");
        distance = peer->distances(seed);
        stages.finished("first");
        peak = peakMemory();
        if (args.number("further", 1) > 0) {
            peer->distances(mesh.points.size() / 3);
            stages.finished("further");
        }
    }
    leaveOutOthers(mesh, seed, distance);
    if (args.has("points"))
        writeSamples(args.text("points"), mesh, distance, args.number("samples", 0));
    std::printf(
        "{\"method\": \"%s\", \"vertices\": %zu, \"triangles\": %zu, %s, "
        "\"peakBytes\": %.0f}\n",
        method.c_str(), mesh.points.size(), mesh.triangles.size(), stages.json().c_str(), peak);
}

void list() {
    std::string names;
    for (const auto& [name, make] : makers())
        names += (names.empty() ? "\"" : ", \"") + name + "\"";
    std::printf("{\"methods\": [%s]}\n", names.c_str());
}

void oracle(const Arguments& args) {
    const TriangleMesh mesh = readMesh(args.text("mesh"));
    std::vector<std::string> files;
    std::vector<PointsCsv> points;
    std::istringstream list(args.text("points"));
    for (std::string file; std::getline(list, file, ',');) {
        files.push_back(file);
        points.push_back(readPoints(file));
    }
    std::vector<PointsCsv*> all;
    for (PointsCsv& csv : points) all.push_back(&csv);
    exactAtPoints(mesh, args.point("seed"), all);
    for (std::size_t k = 0; k < files.size(); ++k) writePoints(files[k] + ".exact", points[k]);
    std::printf("{\"method\": \"oracle\", \"vertices\": %zu, \"triangles\": %zu}\n",
                mesh.points.size(), mesh.triangles.size());
}

}  // namespace
}  // namespace igeo::test

int main(int argc, char** argv) try {
    useLargePages();
    const igeo::test::Arguments args(argc, argv, 1);
    const std::string method = args.text("method");
    method == "list"     ? igeo::test::list()
    : method == "oracle" ? igeo::test::oracle(args)
                         : igeo::test::solve(args);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "igeo_peer: %s\n", error.what());
    return 2;
}
