// Foot points with what jet found there.
#include <igeo/march/godunov.h>
#include <igeo/results/samples.h>
#include <igeo/surface/mesh_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/meshed.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

const openvdb::Vec3d kBall(3, -2, 1);

/// The least distance between two of the points.
double leastGap(std::vector<Vec3d> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec3d& a, const Vec3d& b) { return a.x < b.x; });
    double least = kInfinity;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size() && points[j].x - points[i].x < least; ++j)
            least = std::min(least, length(points[j] - points[i]));
    return least;
}

}  // namespace

TEST_CASE("samplesOf: on a sphere, each foot point of the core once") {
    const double dx = 0.05, r = 0.8;
    const Meshed m = meshed(sphere(kBall, r), dx, {kBall + openvdb::Vec3d(0, 0, r)});
    const Samples s = samplesOf(m.field);
    CHECK(s.position.size() == m.band.coreSize());
    const Vec3d center{kBall.x(), kBall.y(), kBall.z()}, seed{0, 0, 1};
    double off = 0, error = 0, tilt = 0;
    for (std::size_t k = 0; k < s.position.size(); ++k) {
        const Vec3d n = normalized(s.position[k] - center);
        const double angle = std::acos(std::clamp(dot(n, seed), -1.0, 1.0));
        off = std::max(off, std::abs(length(s.position[k] - center) - r) / dx);
        error = std::max(error, std::abs(s.distance[k] - r * angle));
        CHECK(s.label[k] == 0);
        CHECK(dot(Vec3d(s.normal[k]), n) > 0.999);
        if (s.distance[k] > 0) CHECK(length(s.gradient[k]) == Approx(1).margin(1e-5));
        if (angle > 0.3 && angle < 2.8)
            tilt = std::max(tilt, length(Vec3d(s.gradient[k]) + normalized(tangential(seed, n))));
    }
    CHECK(off < 1.2e-7);    // measured 7.9e-8
    CHECK(error < 6.3e-4);  // measured 4.1e-4
    CHECK(tilt < 0.0115);   // measured 0.0077
    CHECK(leastGap(s.position) > 1e-5 * dx);
}

TEST_CASE("samplesOf: a box has no foot point twice, and godunov none", "[mesh]") {
    const TriangleMesh mesh = boxMesh({1, 0.6, 0.4});
    const double dx = 0.05;
    const Band band = bandFromMesh(mesh, dx, std::sqrt(3.0));
    const std::vector<SurfacePoint> seeds{nearestSurfacePoint(band, {10, 6, 8})};
    const Samples s = samplesOf(marchJet(band, nullptr, seeds));
    CHECK(s.position.size() > 900);
    CHECK(s.position.size() <= band.coreSize());
    CHECK(leastGap(s.position) > 1e-5 * dx);
    expectError(Error::Kind::InvalidArgument, {"jet", "godunov"},
                [&] { samplesOf(marchGodunov(band, nullptr, seeds)); });
}

TEST_CASE("samples: the files") {
    Samples s;
    s.position = {{0.1, 2, 3}, {4, 5, 6}};
    s.normal = {{0, 0, 1}, {1, 0, 0}};
    s.distance = {1.0 / 3, kInfinity};
    s.gradient = {{1, 0, 0}, {}};
    s.label = {2, -1};
    CHECK(samplesCsv(s) ==
          "x,y,z,nx,ny,nz,distance,gx,gy,gz,label\n"
          "0.1,2,3,0,0,1,0.3333333333333333,1,0,0,2\n"
          "4,5,6,1,0,0,inf,0,0,0,-1\n");
    const std::string npz = samplesNpz(s);
    for (const char* part : {"position.npy", "gradient.npy", "(2, 3)", "(2,)"})
        CHECK(npz.find(part) != std::string::npos);
    const std::string ply = samplesPly(s);
    CHECK(ply.find("element vertex 2\n") != std::string::npos);
    CHECK(ply.find("element face") == std::string::npos);
}

}  // namespace igeo::test
