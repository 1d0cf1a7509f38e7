// Bands of clouds: which voxels, and with what.
#include <igeo/base/parallel.h>
#include <igeo/surface/point_band.h>
#include <support/catch.h>
#include <support/clouds.h>
#include <support/expect_error.h>

#include <cmath>

namespace igeo::test {
namespace {

using Kind = Error::Kind;
constexpr PointBandKind kFits = PointBandKind::Fits, kBalls = PointBandKind::Balls;
const double kRoot3 = std::sqrt(3.0);

bool sameBytes(const Band& a, const Band& b) {
    if (a.size() != b.size() || a.leaves.size() != b.leaves.size()) return false;
    for (std::size_t l = 0; l < a.leaves.size(); ++l)
        if (a.leaves[l].origin != b.leaves[l].origin ||
            a.leaves[l].band.mask != b.leaves[l].band.mask ||
            a.leaves[l].core.mask != b.leaves[l].core.mask)
            return false;
    return a.psi == b.psi && a.foot == b.foot && a.normal == b.normal && a.facing == b.facing;
}

}  // namespace

TEST_CASE("The band of fits holds the voxels near the surface, all of them, and no others") {
    const Vec3d center{0.31, -0.2, 0.1};
    const PointSurface surface(sphereCloud(3000, 1, center));
    const double spacing = surface.density().spacing;
    for (const double dx : {spacing / 4, spacing, 2 * spacing}) {
        const Band band = bandFromPoints(surface, kFits, dx, kRoot3);
        CHECK(band.transform.dx == dx);
        // What quadrics miss: r^4 / 8 at three spacings.
        const double off = std::pow(3 * spacing, 4) / 8 / dx + 1e-5;
        std::size_t expected = 0;
        const int reach = int(1.5 / dx) + 2;
        for (int x = -reach; x <= reach; ++x)
            for (int y = -reach; y <= reach; ++y)
                for (int z = -reach; z <= reach; ++z) {
                    const Vec3d r = Vec3d(x, y, z) - (1 / dx) * center;
                    const double psi = length(r) - 1 / dx;
                    if (std::abs(psi) < kRoot3 - off) {
                        ++expected;
                        REQUIRE(band.nodeAt({x, y, z}) != kNoNode);
                    }
                }
        CHECK(band.size() >= expected);
        CHECK(double(band.size()) <= double(expected) * (1 + 4 * off));
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const Vec3d x = Vec3d(band.ijk(i)) - (1 / dx) * center;
            REQUIRE(std::abs(band.psi[i] - (length(x) - 1 / dx)) < off);
            REQUIRE(dot(Vec3d(band.normal[i]), normalized(x)) > 0.99);
        }
        // As many core voxels as a level set has, 0.55 edges to either side: the mean over
        // directions of 1.1 max(|n_x|, |n_y|, |n_z|), 0.914.
        const double area = 4 * std::acos(-1.0) / (dx * dx);
        CHECK(double(band.coreSize()) == Approx(0.914 * area).epsilon(0.011));  // measured 0.007
        for (const std::uint8_t facing : band.facing) REQUIRE(facing == 0);
    }
}

TEST_CASE("The band of balls is the union of the balls") {
    PointCloud cloud = squareCloud(15, 1);
    cloud = movedCloud(cloud, [](const Vec3d& p) {
        return Vec3d{p.x, 0.8 * p.y - 0.6 * p.z, 0.6 * p.y + 0.8 * p.z};
    });
    const PointSurface surface(cloud);
    const double dx = 0.6, h = defaultBandWidth(surface.density(), kBalls, dx);
    CHECK(h == Approx(std::sqrt(3 + std::pow(surface.density().spacing99 / dx, 2))));
    const Band band = bandFromPoints(surface, kBalls, dx, h);
    std::size_t nodes = 0;
    for (int x = -10; x <= 40; ++x)
        for (int y = -10; y <= 40; ++y)
            for (int z = -10; z <= 40; ++z) {
                const Vec3d p = dx * Vec3d(x, y, z);
                Vec3d nearest = cloud.points[0];
                for (const Vec3d& q : cloud.points)
                    if (length(q - p) < length(nearest - p)) nearest = q;
                const NodeIndex i = band.nodeAt({x, y, z});
                REQUIRE((i != kNoNode) == (length(nearest - p) < h * dx));
                if (i == kNoNode) continue;
                ++nodes;
                CHECK(length(dx * band.footPoint(i) - nearest) < 1.4e-07);  // measured 8.9e-08
                // The height over the plane of the square.
                const double height = dot(Vec3d{0, -0.6, 0.8}, p) / dx;
                CHECK(std::abs(std::abs(band.psi[i]) - std::abs(height)) <
                      1.5e-07);  // measured 9.5e-08
            }
    CHECK(nodes == band.size());
}

TEST_CASE("An open hemisphere does not leak over its rim") {
    PointCloud cloud{"hemisphere", {}, {}};
    for (const Vec3d& p : sphereCloud(8000, 1, {}).points)
        if (p.z > 0) cloud.points.push_back(p);
    double lowest = 1;
    for (const Vec3d& p : cloud.points) lowest = std::min(lowest, p.z);
    const PointSurface surface(cloud);
    const double s = surface.density().spacing;
    const Band band = bandFromPoints(surface, kFits, s / 2, kRoot3);
    std::vector<char> around(36);
    for (NodeIndex i = 0; i < band.size(); ++i) {
        const Vec3d foot = s / 2 * band.footPoint(i);
        // The hull is taken in tangent planes, in which the equator is straight up to (3 s)^3.
        REQUIRE(foot.z >= lowest - std::pow(3 * s, 3));
        if (foot.z < s) around[std::size_t(18 + std::atan2(foot.y, foot.x) * 17.99 / 3.1416)] = 1;
    }
    // And it comes within a spacing of the rim all around.
    for (const char reached : around) CHECK(reached);
}

TEST_CASE("Bands of clouds have the same bytes for any order of points and number of threads") {
    CloudOptions options;
    options.noise = 0.1;
    const PointCloud cloud = torusCloud(3000, 1, 0.4, {}, options);
    const PointSurface surface(cloud), shuffled(shuffledCloud(cloud, 8));
    const double dx = surface.density().spacing;
    for (const PointBandKind kind : {kFits, kBalls}) {
        const double h = defaultBandWidth(surface.density(), kind, dx);
        const Band band = bandFromPoints(surface, kind, dx, h);
        CHECK(sameBytes(band, bandFromPoints(shuffled, kind, dx, h)));
        for (const int threads : {1, 3}) {
            const ThreadLimit limit(threads);
            CHECK(sameBytes(band, bandFromPoints(PointSurface(cloud), kind, dx, h)));
        }
        // The comparison notices one bit.
        Band other = band;
        other.psi[7] = std::nextafter(other.psi[7], 9.0f);
        CHECK(!sameBytes(band, other));
    }
}

TEST_CASE("Sheets that face each other are marked") {
    CloudOptions options;
    options.normals = true;
    const PointCloud upper = movedCloud(squareCloud(20, 1, options), [](const Vec3d& p) {
        return p + Vec3d{0, 0, 1.5};
    });
    PointCloud lower = squareCloud(20, 1, options);
    for (Vec3f& n : lower.normals) n = -n;
    const PointSurface surface(joinedClouds(lower, upper));
    const Band band = bandFromPoints(surface, kFits, 0.5, kRoot3);
    // Between them is the medial axis at z = 1.5 voxels: no voxel of one sheet is linked with one
    // of the other.
    std::size_t across = 0;
    for (NodeIndex i = 0; i < band.size(); ++i)
        for (int side = 0; side < 6; ++side) {
            const NodeIndex j = band.neighbor(i, Band::faceStep(side));
            if (j == kNoNode || band.normal[i].z * band.normal[j].z > 0) continue;
            ++across;
            REQUIRE(!band.linked(i, j));
        }
    CHECK(across > 100);
}

TEST_CASE("M&S (14) for points: between what overlaps and what joins sheets") {
    CloudOptions options;
    options.normals = true;
    for (const double gap : {8.0, 1.5}) {
        const PointCloud upper = movedCloud(squareCloud(20, 1, options), [=](const Vec3d& p) {
            return p + Vec3d{0, 0, gap};
        });
        PointCloud lower = squareCloud(20, 1, options);
        for (Vec3f& n : lower.normals) n = -n;
        const PointSurface surface(joinedClouds(lower, upper));
        for (const PointBandKind kind : {kFits, kBalls}) {
            const double dx = 0.5;
            const BandBounds bounds = bandBounds(surface, kind, dx);
            CHECK(bounds.lower == defaultBandWidth(surface.density(), kind, dx));
            const double half = gap / 2 / dx;
            CHECK(bounds.resolved == (half > bounds.lower));
            // Balls between jittered points end up to a third of a spacing beside the sheet's
            // nearest point.
            if (bounds.resolved) CHECK(bounds.upper == Approx(half).epsilon(0.1));
        }
    }
}

TEST_CASE("Voxels and widths that do not fit the points are refused with what would") {
    const PointSurface surface(sphereCloud(2000, 1, {}));
    const double s = surface.density().spacing;
    auto refused = [&](PointBandKind kind, double dx, double h,
                       const std::vector<std::string>& phrases) {
        expectError(Kind::InvalidArgument, phrases, [&] { bandFromPoints(surface, kind, dx, h); });
    };
    refused(kFits, s / 9, kRoot3, {"sphere", "too fine", "(median)", "voxel size"});
    refused(kFits, 0, kRoot3, {"too fine"});
    refused(kFits, std::nan(""), kRoot3, {"too fine"});
    refused(kFits, 0.26, kRoot3, {"too coarse", "0.25 and less"});
    refused(kFits, s, 0.8, {"has holes", "0.866 voxels"});
    refused(kBalls, s, 0.9, {"has holes", "widen the band"});
    refused(kBalls, s, kInfinity, {"band"});
    CHECK_NOTHROW(bandFromPoints(surface, kFits, s / 7.9, 0.87));

    const Vec3d far{1e10, 0, 0};
    const PointSurface away(
        movedCloud(sphereCloud(2000, 1, {}), [&](const Vec3d& p) { return p + far; }));
    expectError(Kind::BadInput, {"voxels from the origin"},
                [&] { bandFromPoints(away, kFits, 0.02, kRoot3); });

    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Kind::Cancelled, {}, [&] { bandFromPoints(surface, kFits, s, kRoot3, stop); });
    expectError(Kind::Cancelled, {}, [&] { PointSurface again(sphereCloud(2000, 1, {}), stop); });
}

}  // namespace igeo::test
