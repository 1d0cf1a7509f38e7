#include <igeo/base/parallel.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/vdb_read.h>
#include <support/exact.h>
#include <support/shapes.h>
#include <support/torus_geodesics.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "commands.h"
#include "extracted_mesh.h"
#include "points_csv.h"

namespace igeo::test {
namespace {

const openvdb::Vec3d kHalfBox(0.303, 0.257, 0.352);

/// The point of the box nearest to one that is almost on it.
openvdb::Vec3d onBox(const openvdb::Vec3d& p) {
    openvdb::Vec3d q = p - kCenter;
    int axis = 0;  // of the nearest face
    for (int a = 0; a < 3; ++a) {
        q[a] = std::clamp(q[a], -kHalfBox[a], kHalfBox[a]);
        if (kHalfBox[a] - std::abs(q[a]) < kHalfBox[axis] - std::abs(q[axis])) axis = a;
    }
    q[axis] = std::copysign(kHalfBox[axis], q[axis]);
    return kCenter + q;
}

openvdb::Vec3d vec(const Vec3d& p) { return {p.x, p.y, p.z}; }

void printVertex(const TriangleMesh& mesh, std::size_t k) {
    const Vec3d& p = mesh.points.at(k);
    std::printf("{\"vertices\": %zu, \"vertex\": %zu, \"at\": [%.12g, %.12g, %.12g]}\n",
                mesh.points.size(), k, p.x, p.y, p.z);
}

}  // namespace

void benchExact(const Arguments& args) {
    PointsCsv csv = readPoints(args.text("points"));
    const openvdb::Vec3d seed = vec(args.point("seed"));
    std::function<double(const openvdb::Vec3d&)> exact;  // any thread
    if (args.text("shape") == "sphere")
        exact = [&](const auto& p) { return geodesicOnSphere(kCenter, 0.4, seed, p); };
    else if (args.text("shape") == "torus")
        exact = [truth = TorusGeodesics(kCenter, 0.3, 0.12, seed)](const auto& p) {
            return truth.distance(p);
        };
    else if (args.text("shape") == "box")
        exact = [&](const auto& p) {
            return geodesicOnBox(kCenter, kHalfBox, onBox(seed), onBox(p));
        };
    else
        throw std::runtime_error("no shape '" + args.text("shape") + "'");
    parallelFor(csv.points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) csv.distance[k] = exact(vec(csv.points[k]));
    });
    writePoints(args.text("out"), csv);
    std::printf("{\"points\": %zu}\n", csv.points.size());
}

void benchVertex(const Arguments& args) {
    if (args.has("mesh")) {
        const TriangleMesh mesh = readMesh(args.text("mesh"));
        printVertex(mesh, std::size_t(args.number("share", 0) * double(mesh.points.size())));
        return;
    }
    const TriangleMesh mesh = extractedMesh(*readLevelSetGrid({args.text("sdf"), ""}).grid);
    printVertex(mesh, nearestVertex(mesh, args.point("seed")));
}

}  // namespace igeo::test
