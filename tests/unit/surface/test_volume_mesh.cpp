#include <igeo/surface/volume_mesh.h>
#include <support/catch.h>
#include <support/expect_error.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace igeo {
namespace {

using Kind = Error::Kind;
using Axes = std::array<Vec3d, 3>;
const Axes kPlain{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

/// A function of the world on n^3 voxels.
VoxelVolume volumeOf(std::size_t n, const Axes& axis, const Vec3d& origin,
                     const std::function<double(const Vec3d&)>& f) {
    VoxelVolume v{"f.nii", "test", {n, n, n}, {}, axis, origin};
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t i = 0; i < n; ++i)
                v.values.push_back(float(f(v.worldFromIndex({double(i), double(j), double(k)}))));
    return v;
}

Vec3d middleOf(std::size_t n, const Axes& axis, const Vec3d& origin) {
    return origin + (0.5 * double(n - 1)) * (axis[0] + axis[1] + axis[2]);
}

double enclosed(const TriangleMesh& mesh, const Vec3d& center) {
    double v = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        v += dot(mesh.points[a] - center, cross(mesh.points[b] - center, mesh.points[c] - center)) /
             6;
    return v;
}

TEST_CASE("a ball comes out in the world, whatever the axes of the voxels", "[volume]") {
    constexpr std::size_t n = 31;
    constexpr double kRadius = 9.3;
    const double c = std::cos(0.5), s = std::sin(0.5);
    const Axes mirrored{Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}},
        flat{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 2.5}},
        turned{Vec3d{1.2 * c, 1.2 * s, 0}, Vec3d{-1.2 * s, 1.2 * c, 0}, Vec3d{0, 0, 1.2}},
        sheared{Vec3d{1, 0, 0}, Vec3d{0.4, 1, 0}, Vec3d{0.1, 0.3, 1.2}};
    const Vec3d origin{50, -20, 7};
    for (const Axes& axis : {kPlain, mirrored, flat, turned, sheared}) {
        const Vec3d middle = middleOf(n, axis, origin);
        const VoxelVolume volume =
            volumeOf(n, axis, origin, [&](const Vec3d& p) { return 100 - length(p - middle); });
        const TriangleMesh mesh = volumeMesh(volume, 100 - kRadius);
        double off = 0;
        for (const Vec3d& p : mesh.points)
            off = std::max(off, std::abs(length(p - middle) - kRadius));
        CHECK(off < 0.16);  // measured 0.103, where voxels are 2.5 high
        CHECK(meshTopology(mesh).closed());
        CHECK(meshTopology(mesh).components == 1);
        // Outward, also where the axes are left-handed.
        CHECK(enclosed(mesh, middle) ==
              Approx(4 * M_PI / 3 * std::pow(kRadius, 3)).epsilon(0.042));  // measured 2.8 %
        CHECK(mesh.warnings.empty());
    }
}

TEST_CASE("signed distances, which are less inside, give the same surface turned outward",
          "[volume]") {
    const Vec3d middle = middleOf(25, kPlain, {});
    const VoxelVolume volume =
        volumeOf(25, kPlain, {}, [&](const Vec3d& p) { return length(p - middle) - 8; });
    const TriangleMesh mesh = volumeMesh(volume, 0.0);
    CHECK(meshTopology(mesh).components == 1);
    CHECK(enclosed(mesh, middle) == Approx(4 * M_PI / 3 * 512).epsilon(0.027));  // measured 1.8 %
}

TEST_CASE("values that single precision rounds too much are a warning", "[volume]") {
    const Vec3d middle = middleOf(25, kPlain, {});
    auto warnings = [&](double offset, bool whole) {
        return volumeMesh(volumeOf(25, kPlain, {},
                                   [&](const Vec3d& p) {
                                       const double d = 100 * (length(p - middle) - 8);
                                       return offset + (whole ? std::floor(d) : d);
                                   }),
                          offset)
            .warnings;
    };
    CHECK(warnings(1e5, false).empty());
    REQUIRE(warnings(1e6, false).size() == 1);
    CHECK(warnings(1e6, false).front().find("single precision") != std::string::npos);
    CHECK(warnings(1e6, true).empty());
}

TEST_CASE("a surface through the centers of voxels has no double points", "[volume]") {
    const Vec3d middle{10, 10, 10};
    const VoxelVolume volume = volumeOf(21, kPlain, {}, [&](const Vec3d& p) {
        const Vec3d d = p - middle;
        return 20 - std::abs(d.x) - std::abs(d.y) - std::abs(d.z);
    });
    const TriangleMesh mesh = volumeMesh(volume, 14.0);
    CHECK(meshTopology(mesh).closed());
    CHECK(mesh.dropped == 0);
    CHECK(enclosed(mesh, middle) == Approx(4.0 / 3 * 216).epsilon(0.013));  // measured 0.86 %
}

TEST_CASE("a surface that leaves the volume is open there", "[volume]") {
    const VoxelVolume volume = volumeOf(
        20, kPlain, {}, [](const Vec3d& p) { return 6 - std::hypot(p.x - 9.5, p.y - 9.5); });
    const TriangleMesh mesh = volumeMesh(volume, 0.0);
    const MeshTopology topology = meshTopology(mesh);
    CHECK(topology.components == 1);
    CHECK(topology.boundaryEdges > 60);
    double lowest = 9, highest = 0;
    for (const Vec3d& p : mesh.points) {
        lowest = std::min(lowest, p.z);
        highest = std::max(highest, p.z);
    }
    CHECK(lowest >= 0);
    CHECK(highest <= 19);
    // All but the last half voxel: no lid, and nothing bent.
    CHECK(meshArea(mesh) == Approx(2 * M_PI * 6 * 18).epsilon(0.006));  // measured 0.39 %
}

TEST_CASE("a mask is smoothed and every voxel stays on its side", "[volume]") {
    constexpr std::size_t n = 31;
    const Vec3d middle = middleOf(n, kPlain, {});
    // A plate of one voxel besides: smoothing by averages alone would lose it.
    const auto inside = [&](const Vec3d& p) {
        return length(p - middle) < 12.3 || (p.z == 15 && std::abs(p.y - 15) < 5 && p.x < 29);
    };
    const VoxelVolume volume =
        volumeOf(n, kPlain, {}, [&](const Vec3d& p) { return inside(p) && p.x > 0 ? 255.0 : 0.0; });
    CHECK(rangeOf(volume).isMask);
    const TriangleMesh mesh = volumeMesh(volume, std::nullopt);
    CHECK(meshTopology(mesh).components == 1);
    CHECK(meshTopology(mesh).closed());
    REQUIRE(mesh.warnings.size() == 1);
    CHECK(mesh.warnings[0].find("mask") != std::string::npos);
    double left = 99, off = 0;
    for (const Vec3d& p : mesh.points) {
        left = std::min(left, p.x);
        if (std::abs(p.z - 15) > 3) off = std::max(off, std::abs(length(p - middle) - 12.3));
    }
    CHECK(left < 1);
    CHECK(off < 0.31);  // measured 0.207: voxels are 1 wide
}

TEST_CASE("volumes without a surface are refused", "[volume]") {
    const VoxelVolume constant = volumeOf(5, kPlain, {}, [](const Vec3d&) { return 3; });
    test::expectError(Kind::BadInput, {"f.nii", "all voxels", "3"},
                      [&] { volumeMesh(constant, 3.0); });
    const VoxelVolume ramp = volumeOf(5, kPlain, {}, [](const Vec3d& p) { return p.x; });
    test::expectError(Kind::BadInput, {"f.nii", "from 0 to 4", "iso"},
                      [&] { volumeMesh(ramp, std::nullopt); });
    for (const double iso : {-1.0, 0.0, 5.0})
        test::expectError(Kind::InvalidArgument, {"f.nii", "from 0 to 4"},
                          [&] { volumeMesh(ramp, iso); });
}

}  // namespace
}  // namespace igeo
