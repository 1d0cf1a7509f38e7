#include <igeo/base/point_tree.h>
#include <support/catch.h>
#include <support/clouds.h>

#include <algorithm>

namespace igeo::test {
namespace {

std::vector<PointTree::Found> nearestOfAll(const PointTree& tree, const Vec3d& p,
                                           std::size_t count) {
    std::vector<PointTree::Found> all;
    for (std::size_t i = 0; i < tree.size(); ++i) {
        const Vec3d r = p - tree[i];
        all.push_back({dot(r, r), PointTree::Index(i)});
    }
    std::sort(all.begin(), all.end());
    all.resize(std::min(count, all.size()));
    return all;
}

}  // namespace

TEST_CASE("A tree finds the nearest points that a search through all finds") {
    // Lattices have many equal distances; there the lower number goes first.
    PointCloud lattice{"lattice", {}, {}};
    for (int i = 0; i < 1000; ++i) lattice.points.push_back(Vec3d(i % 10, i / 10 % 10, i / 100));
    for (std::size_t count : {1u, 2u, 7u, 8u, 9u, 63u, 64u, 65u, 1000u})
        for (PointCloud cloud : {sphereCloud(1000, 1, {}), lattice}) {
            cloud.points.resize(count);
            const PointTree tree(cloud.points);
            std::vector<PointTree::Found> found;
            for (const Vec3d& p : {Vec3d{0.2, 0.1, 0.3}, Vec3d{4, 5, 6}, Vec3d{-20, 3, 1}, tree[0]})
                for (std::size_t k : {1u, 13u, 100u}) {
                    INFO(count << " points, " << k << " wanted");
                    tree.nearest(p, k, found);
                    const auto expected = nearestOfAll(tree, p, k);
                    REQUIRE(found.size() == expected.size());
                    for (std::size_t i = 0; i < found.size(); ++i) {
                        CHECK(found[i].point == expected[i].point);
                        CHECK(found[i].squared == expected[i].squared);
                    }
                    CHECK(tree.nearest(p).point == expected[0].point);
                    // Within a distance that the last one is at, and one that it is not.
                    const double last = std::sqrt(expected.back().squared);
                    for (const double within : {last * (1 + 1e-12), last * (1 - 1e-12), 0.0}) {
                        std::size_t near = 0;
                        for (const PointTree::Found& f : expected)
                            near += f.squared <= within * within;
                        tree.nearest(p, k, found, within);
                        CHECK(found.size() == near);
                    }
                }
        }
}

TEST_CASE("A tree finds all points whose reach a position is within") {
    PointTree tree(torusCloud(500, 2, 1, {}).points);
    std::vector<double> reach(tree.size());
    for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = 0.1 * double(i % 13);
    tree.setReach(reach);
    for (const Vec3d& p : {Vec3d{2, 0, 1}, Vec3d{0, 0, 0}, Vec3d{-1, 2.5, 0.2}})
        for (double more : {0.0, 0.25}) {
            std::vector<PointTree::Index> expected, found;
            for (std::size_t i = 0; i < tree.size(); ++i)
                if (length(p - tree[i]) < reach[i] + more) expected.push_back(PointTree::Index(i));
            tree.forReaching(p, more, [&](PointTree::Index i) { found.push_back(i); });
            CHECK(found == expected);
        }
}

TEST_CASE("The order of a tree depends on where the points are alone") {
    const PointCloud cloud = sphereCloud(3000, 1, {});
    const PointCloud shuffled = shuffledCloud(cloud, 5);
    const PointTree a(cloud.points), b(shuffled.points);
    for (std::size_t i = 0; i < a.size(); ++i) {
        REQUIRE(a[i] == b[i]);
        REQUIRE(cloud.points[a.inputIndex(i)] == a[i]);
        REQUIRE(shuffled.points[b.inputIndex(i)] == a[i]);
    }
}

}  // namespace igeo::test
