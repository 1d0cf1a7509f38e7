#include <igeo/surface/detail/orient_normals.h>
#include <support/catch.h>
#include <support/clouds.h>

#include <cmath>

namespace igeo::test {
namespace {

/// Exact normals, every other one turned at random, and what became of them.
std::vector<Vec3d> oriented(const PointCloud& cloud, const PointTree& tree, Orientation& result) {
    std::mt19937 random(3);
    std::vector<Vec3d> normals;
    for (std::size_t i = 0; i < tree.size(); ++i)
        normals.push_back((random() % 2 ? 1.0 : -1.0) * Vec3d(cloud.normals[tree.inputIndex(i)]));
    result = orientNormals(tree, normals);
    for (std::size_t i = 0; i < normals.size(); ++i) normals[i] *= double(result.sign[i]);
    return normals;
}

}  // namespace

TEST_CASE("Normals of closed surfaces turn outward, each piece by itself") {
    CloudOptions options;
    options.normals = true;
    const PointCloud cloud = joinedClouds(sphereCloud(1000, 1, {}, options),
                                          torusCloud(4000, 2, 0.6, {6, 0, 0}, options));
    const PointTree tree(cloud.points);
    Orientation result;
    const std::vector<Vec3d> normals = oriented(cloud, tree, result);
    CHECK(result.pieces == 2);
    CHECK(seamsOf(tree, normals).share == 0);
    for (std::size_t i = 0; i < tree.size(); ++i)
        REQUIRE(dot(normals[i], Vec3d(cloud.normals[tree.inputIndex(i)])) > 0);
}

TEST_CASE("Sheets that face each other are turned apart") {
    // A spacing and a quarter apart: neighborhoods go across.
    CloudOptions options;
    options.normals = true;
    const PointCloud lower = squareCloud(20, 1, options);
    const PointCloud cloud = joinedClouds(lower, movedCloud(lower, [](const Vec3d& p) {
                                              return p + Vec3d{0, 0, 1.25};
                                          }));
    const PointTree tree(cloud.points);
    Orientation result;
    const std::vector<Vec3d> normals = oriented(cloud, tree, result);
    CHECK(result.pieces == 1);
    for (std::size_t i = 0; i < tree.size(); ++i) REQUIRE(normals[i].z * (tree[i].z - 0.625) > 0);
}

TEST_CASE("A one-sided surface has a seam across") {
    PointCloud strip{"strip", {}, {}};
    for (int i = 0; i < 200; ++i)
        for (int j = -5; j <= 5; ++j) {
            const double u = 2 * std::acos(-1.0) * i / 200, v = 0.03 * j;
            const double r = 1 + v * std::cos(u / 2);
            strip.points.push_back({r * std::cos(u), r * std::sin(u), v * std::sin(u / 2)});
            const Vec3d across{std::cos(u / 2) * std::cos(u), std::cos(u / 2) * std::sin(u),
                               std::sin(u / 2)};
            strip.normals.push_back(
                Vec3f(normalized(cross(across, Vec3d{-std::sin(u), std::cos(u), 0}))));
        }
    const PointTree tree(strip.points);
    Orientation result;
    const Seams seams = seamsOf(tree, oriented(strip, tree, result));
    // Across 11 points; two columns of them and more have neighbors beyond it.
    CHECK(seams.share > 20.0 / 2200);
    CHECK(seams.share < 0.03);    // measured 0.02
    CHECK(seams.longest > 0.29);  // of a strip 0.3 wide
    CHECK(seams.longest < 0.48);  // measured 0.32
}

}  // namespace igeo::test
