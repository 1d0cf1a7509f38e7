// Distance matrices: exact on the plane, and as their writers put them.
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/results/detail/column_name.h>
#include <igeo/results/distance_matrix.h>
#include <igeo/surface/mesh_band.h>
#include <support/analytic_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/march_cases.h>
#include <support/mesh_shapes.h>
#include <support/random_surface.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include <thread>

namespace igeo::test {
namespace {

std::vector<SurfacePoint> points(const Band& band, const std::vector<Vec3d>& asked) {
    std::vector<SurfacePoint> p;
    for (const Vec3d& a : asked) p.push_back(nearestSurfacePoint(band, a));
    return p;
}

const std::vector<Vec3d> kPlaces{{0.3, 0.2, 0}, {17.1, 3.3, 0}, {9.4, -14.2, 0}, {-18, 11.7, 0}};

Band plane() { return planeBand({0.1, -0.2, 1}, 0.3, {-22, -18, -9}, {22, 18, 9}, 2); }

/// Two planes, eight voxels apart.
Band twoPlanes() {
    const auto psi = [](const Vec3d& p) { return std::abs(p.z) < 4 ? p.z : p.z - 8; };
    return analyticBand(
        psi,
        [](const Vec3d&) {
            return Vec3d{0, 0, 1};
        },
        {-9, -9, -3}, {9, 9, 11}, 2);
}

}  // namespace

TEST_CASE("columns: names that every format can store, no two alike") {
    CHECK(distanceColumns({"V 1", "V_1", "", "\u00e9", "\u00fc", "a-b.c", "V_1_0"}) ==
          std::vector<std::string>{"distance_V_1_0_", "distance_V_1_1", "distance_2",
                                   "distance___3", "distance___4", "distance_a-b.c",
                                   "distance_V_1_0"});
}

TEST_CASE("distances: straight lines on a plane, symmetric, 0 on the diagonal") {
    const Band band = plane();
    const auto p = points(band, kPlaces);
    const DistanceMatrix m = distances(band, {}, p);
    REQUIRE(m.distance.size() == 16);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            // jet is exact on a plane up to single precision over some 30 steps.
            CHECK(m.at(i, j) ==
                  Approx(length(p[i].pIndex - p[j].pIndex)).margin(0.00013));  // measured 8.4e-05
            CHECK(m.at(i, j) == m.at(j, i));
            if (i == j) CHECK(m.at(i, j) == 0);
        }
    CHECK(m.asymmetry < 8.1e-06);  // measured 5.3e-06
}

TEST_CASE("distances: rows are marches of their own, and symmetry is made of both") {
    const Band band = sphereBand({0.3, -0.2, 0.1}, 15, 2);
    auto p = points(band, {{9, 3, 12}, {-14, 4, 2}, {1, -13, -8}, {1, 2, -14}});
    const DistanceMatrix m = distances(band, {}, {p[0], p[1]}, {p[2], p[3], p[1]});
    REQUIRE(m.distance.size() == 6);
    CHECK(m.asymmetry == 0);
    const auto sampled = [&](std::size_t from, std::size_t to) {
        return sampleDistance(marchJet(band, {}, {p[from]}), p[to].pIndex);
    };
    CHECK(m.at(0, 0) == sampled(0, 2));
    CHECK(m.at(0, 1) == sampled(0, 3));
    CHECK(m.at(1, 1) == sampled(1, 3));
    CHECK(m.at(1, 2) == 0);

    const DistanceMatrix all = distances(band, {}, p);
    double asymmetry = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const double there = sampled(i, j), back = sampled(j, i), mean = (there + back) / 2;
            CHECK(all.at(i, j) == Approx(mean).epsilon(1e-12));
            asymmetry = std::max(asymmetry, std::abs(there - back) / mean);
        }
    CHECK(all.asymmetry == Approx(asymmetry).epsilon(1e-9));
    CHECK(all.asymmetry > 0);

    // Starts are for fields, not for distances between points.
    for (SurfacePoint& s : p) s.start = 5;
    CHECK(distances(band, {}, p).distance == all.distance);
}

TEST_CASE("distanceRows: parts one after another are the whole, bit by bit and in world units") {
    Band band = sphereBand({0.3, -0.2, 0.1}, 12, 2);
    const auto p = points(band, {{9, 3, 12}, {-14, 4, 2}, {1, -13, -8}, {1, 2, -14}, {12, 0, 0}});
    const DistanceMatrix voxels = distances(band, {}, p);
    band.transform.dx = 0.1;
    for (const bool between : {true, false}) {
        const auto targets = between ? std::vector<SurfacePoint>{} : std::vector{p[3], p[0]};
        const DistanceMatrix whole = distances(band, {}, p, targets);
        DistanceMatrix joined = distanceRows(band, {}, p, targets, 0, 2);
        for (const auto& [first, end] : {std::pair<std::size_t, std::size_t>{2, 2}, {2, 5}}) {
            const DistanceMatrix part = distanceRows(band, {}, p, targets, first, end);
            CHECK(part.firstRow == first);
            CHECK(part.rows() == end - first);
            CHECK(std::isnan(part.asymmetry) == between);
            if (first < end) CHECK(part.at(4, 1) == part.distance[2 * part.targets.size() + 1]);
            joined.distance.insert(joined.distance.end(), part.distance.begin(),
                                   part.distance.end());
        }
        if (between) makeSymmetric(joined);
        CHECK(joined.distance == whole.distance);
        CHECK(joined.asymmetry == whole.asymmetry);
        CHECK((whole.asymmetry > 0) == between);
        if (between) CHECK(whole.at(0, 1) == Approx(0.1 * voxels.at(0, 1)).epsilon(1e-15));
    }
}

TEST_CASE("distances: many rows beside creases and thin walls are those of single marches") {
    const ThreadLimit two(2);
    const Band sharp = bandOf(randomLevelSet(3, 0, openvdb::math::Transform()), kHalfWidth),
               thin = bandFromMesh(plateWithTunnel(6.3), 0.9, kHalfWidth),
               slab = bandFromMesh(boxMesh({30, 20, 0.8}), 1, kHalfWidth);
    for (const Band* band : {&sharp, &thin, &slab}) {
        std::vector<SurfacePoint> seeds, targets;
        const auto count = NodeIndex(band->size());
        for (NodeIndex k = 0; k < 8; ++k)
            seeds.push_back(nearestSurfacePoint(*band, band->footPoint(k * (count / 8))));
        for (NodeIndex i = 0; i < count; i += 29)
            targets.push_back(nearestSurfacePoint(*band, band->footPoint(i)));
        const DistanceMatrix m = distances(*band, {}, seeds, targets);
        std::size_t differ = 0, finite = 0;
        for (std::size_t s = 0; s < seeds.size(); ++s) {
            // A march of its own finds rims and links as it goes.
            const Field field = marchJet(*band, {}, {seeds[s]});
            for (std::size_t t = 0; t < targets.size(); ++t) {
                const Vec3d normal(band->normal[targets[t].node]);
                differ += m.at(s, t) !=
                          band->transform.dx * sampleDistance(field, targets[t].pIndex, normal);
                finite += m.at(s, t) < kInfinity;
            }
        }
        CHECK(differ == 0);
        CHECK(finite > m.distance.size() / 2);
    }
}

TEST_CASE("distances: infinite between pieces; a constant weight scales") {
    const Band band = twoPlanes();
    const auto p = points(band, {{1, 2, 0}, {-4, 3, 0}, {1, 2, 8}});
    const DistanceMatrix m = distances(band, {}, p);
    CHECK(m.at(0, 1) < kInfinity);
    CHECK(m.at(0, 2) == kInfinity);
    CHECK(m.at(2, 1) == kInfinity);
    CHECK(m.at(2, 2) == 0);
    CHECK(m.asymmetry < 5.1e-08);  // measured 3.4e-08
    const auto weight = std::make_shared<Metric>();
    weight->weight.assign(band.size(), 3.0f);
    CHECK(distances(band, weight, p).at(0, 1) == Approx(3 * m.at(0, 1)).epsilon(1e-5));
}

TEST_CASE("makeSymmetric: counts pairs that have a path in one direction only") {
    DistanceMatrix m;
    m.seeds.resize(3), m.targets.resize(3);
    m.distance = {0, 4, kInfinity, 6, 0, kInfinity, 3, kInfinity, 0};
    makeSymmetric(m);
    CHECK(m.distance == std::vector<double>{0, 5, 3, 5, 0, kInfinity, 3, kInfinity, 0});
    CHECK(m.oneWay == 1);
    CHECK(oneWayWarning(m).starts_with("1 of 3 pairs"));
    m.distance[2] = m.distance[6] = kInfinity;
    makeSymmetric(m);
    CHECK(m.oneWay == 0);
    CHECK(oneWayWarning(m).empty());
}

TEST_CASE("distances: the same bits on any number of threads; refuses to do without seeds") {
    const Band band = sphereBand({0.3, -0.2, 0.1}, 12, 2);
    std::vector<Vec3d> asked;
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 9; ++k) {
        const double x = normal(random), y = normal(random), z = normal(random);
        asked.push_back(12.0 * normalized(Vec3d{x, y, z}));
    }
    const auto p = points(band, asked);
    const auto with = [&](int threads) {
        const ThreadLimit limit(threads);
        return distances(band, {}, p).distance;
    };
    const auto one = with(1);
    CHECK(with(2) == one);
    CHECK(with(7) == one);
    expectError(Error::Kind::InvalidArgument, {"seed"}, [&] { distances(band, {}, {}, p); });
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    expectError(Error::Kind::Cancelled, {}, [&] { distances(band, {}, p, {}, stop); });
}

TEST_CASE("distances: groups are one row and one column, by their nearest points") {
    const Band band = plane();
    auto p = points(band, kPlaces);
    p[1].joined = true;  // {0, 1}, {2, 3}
    p[3].joined = true;
    const DistanceMatrix m = distances(band, {}, p);
    REQUIRE(m.rows() == 2);
    REQUIRE(m.distance.size() == 4);
    CHECK(m.seeds[0].points == 2);
    double least = kInfinity;
    for (const std::size_t i : {0u, 1u})
        for (const std::size_t j : {2u, 3u})
            least = std::min(least, length(p[i].pIndex - p[j].pIndex));
    CHECK(m.at(0, 1) == Approx(least).margin(9.2e-5));  // measured 6.1e-05
    CHECK(m.at(1, 0) == m.at(0, 1));
    CHECK(m.at(0, 0) == 0);
    // To points: the nearest of the group counts.
    const DistanceMatrix across = distances(band, {}, {p[0], p[1]}, points(band, kPlaces));
    REQUIRE(across.distance.size() == 4);
    CHECK(across.at(0, 0) == 0);
    CHECK(across.at(0, 1) == 0);
    CHECK(across.at(0, 2) == Approx(least).margin(9.2e-5));  // measured 6.1e-05
}

TEST_CASE("matrixCsv: a row per target, inf, numbers that read back") {
    DistanceMatrix m;
    m.seeds.resize(2), m.targets.resize(3);
    m.seeds[1].name = "V1, left";
    m.targets[0].point.position = {0.1, -2, 1e-9};
    m.targets[2] = {"", {}, 5};
    m.distance = {0, 1.0 / 3, kInfinity, 2, 1e-300, 4};
    std::istringstream text(matrixCsv(m));
    std::string line;
    std::getline(text, line);
    CHECK(line == "target,x,y,z,distance_0,distance_V1__left");
    for (std::size_t t = 0; t < 3; ++t) {
        std::getline(text, line);
        std::istringstream row(line);
        std::string cell;
        std::getline(row, cell, ',');
        CHECK(cell == std::to_string(t));
        for (int k = 0; k < 3; ++k) {
            std::getline(row, cell, ',');
            if (t == 2)
                CHECK(cell == "nan");
            else
                CHECK(std::stod(cell) == m.targets[t].point.position[k]);
        }
        for (std::size_t s = 0; s < 2; ++s) {
            std::getline(row, cell, ',');
            CHECK(std::stod(cell) == m.at(s, t));
        }
    }
    CHECK(!std::getline(text, line));
    CHECK(matrixCsv(m).find(",inf,4\n") != std::string::npos);
}

TEST_CASE("matrixNpy: NumPy's format") {
    DistanceMatrix m;
    m.seeds.resize(2), m.targets.resize(3);
    m.distance = {0, 1.0 / 3, kInfinity, 2, 1e-300, 4};
    const std::string bytes = matrixNpy(m);
    REQUIRE(bytes.size() > 10);
    CHECK(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t header = std::size_t(static_cast<unsigned char>(bytes[8])) +
                               256 * std::size_t(static_cast<unsigned char>(bytes[9]));
    CHECK((10 + header) % 64 == 0);
    REQUIRE(bytes.size() == 10 + header + 6 * 8);
    const std::string text = bytes.substr(10, header);
    CHECK(text.rfind("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", 0) == 0);
    CHECK(text.back() == '\n');
    // The tests run on little-endian machines.
    for (std::size_t k = 0; k < 6; ++k) {
        double value;
        std::memcpy(&value, bytes.data() + 10 + header + 8 * k, 8);
        CHECK(value == m.distance[k]);
    }
}

TEST_CASE("parallelFor: while a thread waits for an inner loop it begins no outer turn") {
    // Loops of OpenVDB know nothing of ours.
    const bool foreign = GENERATE(false, true);
    static thread_local int depth = 0;
    std::atomic<bool> twice{false};
    const ThreadLimit limit(8);
    // With three threads and more, whatever the machine: one may wait for a second and find work
    // of a third.
    tbb::task_arena(8).execute([&] {
        parallelFor(64, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                if (++depth > 1) twice = true;
                auto turn = [](std::size_t b) {
                    std::this_thread::sleep_for(std::chrono::microseconds(100 + 300 * (b % 3)));
                };
                if (foreign)
                    tbb::parallel_for(std::size_t(0), std::size_t(8), turn);
                else
                    parallelFor(8, 1, [&](std::size_t b, std::size_t) { turn(b); });
                --depth;
            }
        });
    });
    CHECK(!twice);
}

}  // namespace igeo::test
