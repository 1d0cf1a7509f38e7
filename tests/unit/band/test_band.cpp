#include <igeo/band/band.h>
#include <support/analytic_band.h>
#include <support/catch.h>

#include <random>
#include <set>
#include <tuple>

namespace igeo::test {
namespace {

/// Voxels of the box of `size` from `low`, each with probability `density`.
std::vector<Ijk> randomVoxels(const Ijk& low, int size, double density, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<Ijk> voxels;
    for (int x = 0; x < size; ++x)
        for (int y = 0; y < size; ++y)
            for (int z = 0; z < size; ++z)
                if (unit(random) < density) voxels.push_back(low + Ijk{x, y, z});
    return voxels;
}

constexpr int kFar = 1 << 30;

}  // namespace

TEST_CASE("Band: nodeAt finds the voxels of the band and no others") {
    for (const Ijk& low :
         {Ijk{-13, -9, -20}, Ijk{kFar - 15, -kFar, kFar / 3}, Ijk{-kFar, kFar - 20, -kFar + 5}}) {
        const auto voxels = randomVoxels(low, 30, 0.2, 1);
        const Band band = bandOfVoxels(voxels);
        REQUIRE(band.size() == voxels.size());
        std::set<std::tuple<int, int, int>> present;
        std::set<NodeIndex> nodes;
        for (const Ijk& v : voxels) {
            present.insert({v.x, v.y, v.z});
            const NodeIndex i = band.nodeAt(v);
            REQUIRE(i < band.size());
            REQUIRE(band.ijk(i) == v);
            nodes.insert(i);
        }
        CHECK(nodes.size() == voxels.size());
        for (int x = -9; x < 39; ++x)
            for (int y = -9; y < 39; ++y)
                for (int z = -9; z < 39; ++z) {
                    const Ijk v = low + Ijk{x, y, z};
                    if (!present.count({v.x, v.y, v.z}) && band.nodeAt(v) != kNoNode)
                        FAIL("node at a voxel outside the band");
                }
    }
}

TEST_CASE("Band: neighbor agrees with nodeAt across leaf borders") {
    for (const Ijk& low :
         {Ijk{-12, -12, -12}, Ijk{kFar - 12, -kFar - 12, 5}, Ijk{-kFar, kFar, -kFar}}) {
        // Sparse enough that leaves are missing, dense enough that most steps find a node.
        auto voxels = randomVoxels(low, 24, 0.4, 2);
        voxels.erase(std::remove_if(voxels.begin(), voxels.end(),
                                    [&](const Ijk& v) {
                                        return (v.x - low.x) / 8 == 1 && (v.y - low.y) / 8 == 1;
                                    }),
                     voxels.end());
        const Band band = bandOfVoxels(voxels);
        std::mt19937 random(3);
        std::uniform_int_distribution<NodeIndex> node(0, NodeIndex(band.size() - 1));
        std::uniform_int_distribution<int> step(-8, 8);
        std::size_t found = 0;
        for (int trial = 0; trial < 200000; ++trial) {
            const NodeIndex i = node(random);
            Ijk d{step(random), step(random), step(random)};
            if (trial % 2) d = {d.x / 4, d.y / 4, d.z / 4};
            if (trial % 7 == 0) d.y *= 3;  // beyond the leaves next to it
            const NodeIndex j = band.neighbor(i, d.x, d.y, d.z);
            if (j != band.nodeAt(band.ijk(i) + d)) FAIL("neighbor and nodeAt differ");
            found += j != kNoNode;
        }
        CHECK(found > 50000);
    }
}

TEST_CASE(
    "Band: forNeighbors and forCorners visit what neighbor finds, in the order of the steps") {
    Band band = bandOfVoxels(randomVoxels({-12, -12, -12}, 24, 0.4, 7));
    // A core of its own numbers: every other node.
    for (std::size_t k = 0; k < band.size(); ++k) {
        band.psi[k] = k % 2 ? 2.0f : 0.0f;
        band.normal[k] = {0, 0, 1};
    }
    band.numberCore();
    REQUIRE(band.coreSize() == (band.size() + 1) / 2);
    using Found = std::vector<std::tuple<NodeIndex, int, int, int>>;
    for (const auto nodes : {&BandLeaf::band, &BandLeaf::core})
        for (NodeIndex i = 0; i < band.size(); ++i) {
            const auto [l, at] = band.placeOf(i);
            Found expected, seen;
            for (int k = 0; k < 27; ++k) {
                const Ijk step{k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1};
                const NodeIndex j = band.neighbor(nodes, l, at, step);
                if (k != 13 && j != kNoNode) expected.emplace_back(j, step.x, step.y, step.z);
            }
            band.forNeighbors(nodes, l, at, [&](NodeIndex j, int dx, int dy, int dz) {
                seen.emplace_back(j, dx, dy, dz);
            });
            REQUIRE(seen == expected);

            const Ijk low{int(i % 5) - 3, int(i % 7) - 4, int(i % 3) - 2};
            expected.clear(), seen.clear();
            for (int k = 0; k < 8; ++k) {
                const NodeIndex j =
                    band.neighbor(nodes, l, at, low + Ijk{k >> 2, k >> 1 & 1, k & 1});
                if (j != kNoNode) expected.emplace_back(j, k, 0, 0);
            }
            band.forCorners(nodes, l, at, low,
                            [&](NodeIndex j, unsigned k) { seen.emplace_back(j, int(k), 0, 0); });
            REQUIRE(seen == expected);
        }
}

TEST_CASE("Band: the core is closed and in one piece") {
    for (const Band& band : {sphereBand({0.3, -0.4, 0.2}, 11.7, 1.8),
                             planeBand({1, 2, 4}, 0.37, {-9, -9, -9}, {9, 9, 9}, 1.8)}) {
        std::size_t crossings = 0, count = 0;
        NodeIndex start = kNoNode;
        for (NodeIndex i = 0; i < band.size(); ++i) {
            if (band.inCore(i)) start = i, ++count;
            for (int side = 1; side < 6; side += 2) {
                const NodeIndex j = band.neighbor(i, Band::faceStep(side));
                if (j == kNoNode || std::signbit(band.psi[i]) == std::signbit(band.psi[j]))
                    continue;
                ++crossings;
                // Nothing passes S but where the core is.
                if (!band.inCore(i) && !band.inCore(j)) FAIL("a crossing beside the core");
            }
        }
        CHECK(crossings > 300);
        CHECK(count == band.coreSize());
        std::vector<bool> seen(band.size());
        std::vector<NodeIndex> stack{start};
        seen[start] = true;
        while (!stack.empty()) {
            const NodeIndex i = stack.back();
            stack.pop_back();
            --count;
            for (int k = 0; k < 27; ++k) {
                const NodeIndex j = band.neighbor(i, k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
                if (j == kNoNode || seen[j] || !band.inCore(j)) continue;
                seen[j] = true;
                stack.push_back(j);
            }
        }
        CHECK(count == 0);
    }
}

TEST_CASE("Band: nodes are numbered leaf by leaf, by offset") {
    const Band band = bandOfVoxels(randomVoxels({-7, 3, -21}, 25, 0.3, 4));
    for (std::size_t k = 1; k < band.size(); ++k) {
        const Band::Place at = band.placeOf(NodeIndex(k)), before = band.placeOf(NodeIndex(k - 1));
        const bool ordered =
            at.leaf == before.leaf ? at.offset > before.offset : at.leaf == before.leaf + 1;
        if (!ordered) FAIL("node " << k << " is out of order");
    }
    std::size_t count = 0;
    for (const BandLeaf& leaf : band.leaves) {
        CHECK(leaf.band.firstNode == count);
        count += leaf.band.count;
    }
    CHECK(count == band.size());
    CHECK(band.memUsage() >= 31 * band.size());
}

TEST_CASE("Band: an empty band has no nodes anywhere") {
    const Band fresh;
    CHECK(fresh.nodeAt({0, 0, 0}) == kNoNode);
    const Band built = bandOfVoxels({});
    CHECK(built.size() == 0);
    CHECK(built.nodeAt({0, 0, 0}) == kNoNode);
    CHECK(!samplePsi(built, {0, 0, 0}).valid);
}

TEST_CASE("cellAt: weights are trilinear") {
    const Band band = bandOfVoxels(randomVoxels({-4, -4, -4}, 8, 1, 5));
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-3.9, 2.9);
    for (int trial = 0; trial < 1000; ++trial) {
        const Vec3d p{unit(random), unit(random), unit(random)};
        const BandCell cell = cellAt(band, p);
        REQUIRE(cell.complete);
        double sum = 0;
        Vec3d mean{};
        for (std::size_t k = 0; k < 8; ++k) {
            REQUIRE(cell.weight[k] >= 0);
            sum += cell.weight[k];
            mean += cell.weight[k] * Vec3d(band.ijk(cell.node[k]));
        }
        // Sums of eight products of numbers up to 4.
        REQUIRE(std::abs(sum - 1) < 1e-15);
        REQUIRE(length(mean - p) < 1e-14);
    }
    // On a voxel all the weight is there.
    const BandCell at = cellAt(band, {-2, 1, 0});
    CHECK(at.weight[0] == 1);
    CHECK(band.ijk(at.node[0]) == Ijk{-2, 1, 0});
    // The last voxel's cell reaches out of the band.
    const BandCell edge = cellAt(band, {3, 3, 3});
    CHECK(!edge.complete);
    CHECK(edge.node[7] == kNoNode);
}

TEST_CASE("samplePsi: exact for a linear psi, value and gradient") {
    const Vec3d n = normalized(Vec3d{0.3, -0.5, 0.8});
    const Band band = planeBand(n, -0.2, {-9, -9, -9}, {9, 9, 9}, 3);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-8, 8);
    int valid = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        const Vec3d p{unit(random), unit(random), unit(random)};
        const PsiSample s = samplePsi(band, p);
        if (!s.valid) {
            // All corners are at most sqrt(3) away from p: this close, none is missing.
            REQUIRE(std::abs(dot(n, p) + 0.2) > 3 - std::sqrt(3.0));
            continue;
        }
        ++valid;
        // psi is stored as float: half a unit in the last place of numbers below 4, 1.2e-7; the
        // gradient takes differences of two.
        REQUIRE(std::abs(s.psi - (dot(n, p) + 0.2)) < 1.3e-7);
        REQUIRE(length(s.gradient - n) < 2.6e-7);  // measured 1.7e-7
    }
    CHECK(valid > 1000);
}

TEST_CASE("projectToSurface: one Newton step on a plane, along the normal") {
    const Vec3d n = normalized(Vec3d{1, 2, -0.7});
    const Band band = planeBand(n, 0.4, {-12, -12, -12}, {12, 12, 12}, 4);
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(-6, 6);
    for (int trial = 0; trial < 1000; ++trial) {
        Vec3d p{unit(random), unit(random), unit(random)};
        const double psi = dot(n, p) - 0.4;
        if (std::abs(psi) > 2) continue;
        const Vec3d expected = p - psi * n;
        REQUIRE(projectToSurface(band, p));
        // Stops within 1e-6; the direction is off by the gradient's rounding over 2 voxels.
        REQUIRE(length(p - expected) < 2.2e-7);  // measured 1.5e-7
    }
}

TEST_CASE("projectToSurface: lands on the sphere, to second order") {
    const Vec3d center{0.3, -0.2, 0.1};
    const double radius = GENERATE(10.0, 20.0, 40.0);
    const Band band = sphereBand(center, radius, 3);
    std::mt19937 random(9);
    double off = 0;
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 1000; ++trial) {
        const Vec3d u = normalized(Vec3d{normal(random), normal(random), normal(random)});
        Vec3d p = center + (radius + 1) * u;
        REQUIRE(projectToSurface(band, p));
        REQUIRE(std::abs(samplePsi(band, p).psi) <= 1e-6);
        off = std::max(off, std::abs(length(p - center) - radius));
    }
    INFO("radius " << radius << ": " << off);
    // Measured: 0.028 / R^2. The mean of psi alone would be off by 1 / (4 R).
    CHECK(off < 0.042 / (radius * radius));
}

TEST_CASE("projectToSurface: says so and leaves the point where it cannot settle") {
    const Band band = planeBand({0, 0, 1}, 0, {-8, -8, -8}, {8, 8, 8}, 2);
    for (const Vec3d& outside : {Vec3d{0, 0, 5}, Vec3d{20, 0, 0}, Vec3d{0, 0, -1e9}}) {
        Vec3d p = outside;
        CHECK(!projectToSurface(band, p));
        CHECK(p == outside);
    }
    // psi without a gradient.
    Band flat = bandOfVoxels(randomVoxels({0, 0, 0}, 4, 1, 10));
    std::fill(flat.psi.begin(), flat.psi.end(), 0.5f);
    std::fill(flat.normal.begin(), flat.normal.end(), Vec3f{});
    Vec3d p{1.5, 1.5, 1.5};
    CHECK(!projectToSurface(flat, p));
    CHECK(p == Vec3d{1.5, 1.5, 1.5});
}

TEST_CASE("Band: linked cuts between sheets that face each other") {
    // A slab 2 voxels thick: psi = |z| - 1, normals up above and down below.
    const auto psi = [](const Vec3d& p) { return std::abs(p.z) - 1; };
    const auto normal = [](const Vec3d& p) { return Vec3d{0, 0, p.z >= 0 ? 1.0 : -1.0}; };
    const Band slab = analyticBand(psi, normal, {0, 0, -5}, {9, 9, 5}, 3);
    for (std::size_t k = 0; k < slab.size(); ++k) {
        const auto i = NodeIndex(k);
        const NodeIndex above = slab.neighbor(i, 0, 0, 1), beside = slab.neighbor(i, 1, 0, 0);
        if (above != kNoNode) {
            const bool acrossMiddle = slab.ijk(i).z == -1;
            CHECK(slab.linked(i, above) == !acrossMiddle);
            CHECK(slab.linked(above, i) == !acrossMiddle);
        }
        if (beside != kNoNode) CHECK(slab.linked(i, beside));
    }
    // A right-angled crease is no second sheet.
    const auto corner = [](const Vec3d& p) { return std::max(p.x, p.z); };
    const auto side = [](const Vec3d& p) { return p.x > p.z ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1}; };
    const Band crease = analyticBand(corner, side, {-6, 0, -6}, {6, 6, 6}, 2);
    for (std::size_t k = 0; k < crease.size(); ++k) CHECK(crease.facing[k] == 0);
}

namespace {

Band plane(double h) { return planeBand({0, 0, 1}, 0.1, {-12, -12, -4}, {12, 12, 4}, h); }

/// The links across x = cut where y < end.
std::vector<Link> linksAcross(const Band& band, double cut, int end) {
    std::vector<Link> links;
    for (NodeIndex i = 0; i < band.size(); ++i)
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            const Ijk a = band.ijk(i), b = band.ijk(j);
            if (a.x < cut && b.x > cut && std::max(a.y, b.y) < end) links.emplace_back(i, j);
        });
    return links;
}

/// The plane z = 0 with these links severed.
Band slitPlane(double cut, int end) {
    Band band = plane(1.8);
    band.sever(linksAcross(band, cut, end));
    return band;
}

}  // namespace

TEST_CASE("Band: severed links part neighbors in both directions, and nothing else") {
    const Band band = slitPlane(2.5, 0);
    auto at = [&](int x, int y) { return band.nodeAt({x, y, 0}); };
    CHECK(band.severed(at(2, -3), at(3, -3)));
    CHECK(band.severed(at(3, -2), at(2, -3)));
    CHECK_FALSE(band.linked(at(2, -3), at(3, -4)));
    CHECK_FALSE(band.severed(at(2, 0), at(3, -1)));
    CHECK(band.linked(at(2, 0), at(3, 0)));
    CHECK(band.linked(at(1, -3), at(2, -3)));
    CHECK(band.severedSteps(at(1, -3)) == 0);
    // Over two steps: through a node that is linked with both.
    CHECK_FALSE(band.joined(at(2, -5), at(3, -5)));
    CHECK_FALSE(band.joined(at(1, -5), at(3, -5)));
    CHECK_FALSE(band.joined(at(2, -5), at(4, -6)));
    CHECK(band.joined(at(0, -5), at(2, -5)));
    CHECK(band.joined(at(2, -1), at(3, -1)));
    CHECK(band.joined(at(2, -1), at(4, 1)));
}

TEST_CASE("Band: links may be severed in parts, in any order, and mark the same nodes") {
    Band whole = plane(3.5);
    whole.numberCore();
    Band parts = whole;
    whole.sever(linksAcross(whole, 2.5, 0));
    parts.sever(linksAcross(parts, 2.5, -4));
    for (const auto& [i, j] : linksAcross(parts, 2.5, 0)) parts.sever({{j, i}, {i, j}});
    whole.markBesideSevered();
    parts.markBesideSevered();
    CHECK((parts.facing == whole.facing));
    for (NodeIndex i = 0; i < whole.size(); ++i)
        CHECK(parts.severedSteps(i) == whole.severedSteps(i));
}

TEST_CASE("dropFacingCorners: leaves the corners joined with the nearest") {
    const Band band = slitPlane(2.5, 0);
    for (const double x : {2.3, 2.7}) {
        BandCell cell = cellAt(band, {x, -5.6, 0.1});
        dropFacingCorners(band, cell);
        CHECK_FALSE(cell.complete);
        for (const NodeIndex i : cell.node)
            if (i != kNoNode) CHECK((band.ijk(i).x > 2.5) == (x > 2.5));
    }
    BandCell beyond = cellAt(band, {2.3, 2.4, 0.1});
    dropFacingCorners(band, beyond);
    CHECK(beyond.complete);
}

}  // namespace igeo::test
