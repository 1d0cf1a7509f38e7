// Fronts at the corners of cells, separated side by side, against the same pair by pair.
#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_corners.h>
#include <support/analytic_band.h>
#include <support/catch.h>

#include <cmath>
#include <cstdio>
#include <random>

namespace igeo {
namespace {

/// The corners of one node: on a surface that bends, of fronts that spread, narrow or meet.
struct Corners {
    Vec3f normal;
    std::size_t count = 0;
    std::array<float, JetCorners::kMax> weight;
    std::array<Vec3f, JetCorners::kMax> chord, other, g;
    std::array<float, JetCorners::kMax> u;
};

Vec3f unit(const Vec3f& v) { return (1 / length(v)) * v; }

Corners randomCorners(std::mt19937& random) {
    std::uniform_real_distribution<float> one(-1, 1);
    auto anywhere = [&] { return Vec3f{one(random), one(random), one(random)}; };
    Corners c;
    c.normal = unit(anywhere());
    c.count = 2 + random() % 7;
    const float bend = 0.3f * std::abs(one(random)), sign = random() % 2 ? 1.0f : -1.0f;
    // Two sources or foci, in the plane of the node; one of them is far in half of the cases.
    const float far = 4 + 20 * std::abs(one(random));
    const std::array<Vec3f, 2> middle{
        far * unit(cross(c.normal, anywhere())),
        (random() % 2 ? far : 1e4f) * unit(cross(c.normal, anywhere()))};
    const bool two = random() % 3 == 0;
    for (std::size_t k = 0; k < c.count; ++k) {
        const Vec3f from = 1.2f * anywhere(), along = from - dot(from, c.normal) * c.normal;
        c.weight[k] = 0.02f + std::abs(one(random));
        c.other[k] = unit(c.normal - bend * along + 0.05f * anywhere());
        c.chord[k] = -1.0f * along + 0.05f * one(random) * c.normal;
        const Vec3f ray = along - middle[two ? k % 2 : 0],
                    g = sign * ray - sign * dot(ray, c.other[k]) * c.other[k];
        c.g[k] = unit(g);
        c.u[k] = sign * length(ray) + 0.01f * one(random);
    }
    return c;
}

}  // namespace

TEST_CASE("Corners of a cell are of one front side by side where they are pair by pair") {
    std::mt19937 random(8);
    std::size_t cases = 0, spreading = 0, one = 0, close = 0, differ = 0;
    for (const bool faceted : {false, true})
        for (int round = 0; round < 5000; ++round) {
            std::array<Corners, Lanes::kNodes> nodes;
            JetCorners corners{};
            for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
                const Corners& c = nodes[lane] = randomCorners(random);
                corners.nx[lane] = c.normal.x, corners.ny[lane] = c.normal.y;
                corners.nz[lane] = c.normal.z;
                corners.count[lane] = std::uint32_t(c.count);
                for (std::size_t k = 0; k < c.count; ++k) {
                    JetCorners::Corner& to = corners.corner[k];
                    to.weight[lane] = c.weight[k], to.u[lane] = c.u[k], to.mean[lane] = 1;
                    to.x[lane] = c.chord[k].x, to.y[lane] = c.chord[k].y;
                    to.z[lane] = c.chord[k].z;
                    to.mx[lane] = c.other[k].x, to.my[lane] = c.other[k].y;
                    to.mz[lane] = c.other[k].z;
                    to.gx[lane] = c.g[k].x, to.gy[lane] = c.g[k].y, to.gz[lane] = c.g[k].z;
                }
            }
            CarriedJets jets;
            carryFromCorners(corners, faceted, jets);
            for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
                const Corners& c = nodes[lane];
                const TangentFrame frame(c.normal, faceted);
                const Vec3f mean{jets.gx[lane], jets.gy[lane], jets.gz[lane]};
                JetNeighbors all;
                float least = 1;
                for (std::size_t k = 0; k < c.count; ++k) {
                    all.add(flattened(frame, c.chord[k], c.other[k], dot(c.normal, c.other[k]),
                                      c.g[k], double(c.u[k])));
                    least = std::min(least, dot(mean, c.g[k]));
                }
                const bool isClose = least >= jet::kClose, similar = least >= jet::kSameFront;
                const bool spreads = isClose || (similar && jet::spreads(all)),
                           oneFront =
                               isClose || (similar && jet::ofOneFront(all) && !jet::nearFocus(all));
                ++cases, spreading += spreads, one += oneFront, close += isClose;
                differ += spreads != jets.spreads[lane] || oneFront != jets.oneFront[lane];
            }
        }
    std::printf("%zu nodes: %zu spread, %zu of one front, %zu close, %zu differ\n", cases,
                spreading, one, close, differ);
    // All kinds occur.
    CHECK(spreading > cases / 20);
    CHECK(one > spreading + cases / 100);
    CHECK(close > 0);
    CHECK(cases - one > cases / 20);
    // Beside a threshold the two may round to different sides of it.
    CHECK(differ <= 3);
}

/// A cube of 24 voxels with random holes, and as much that is not core.
Band bandWithHoles() {
    std::mt19937 random(7);
    std::bernoulli_distribution isNode(0.97);
    std::vector<Ijk> voxels;
    for (int k = 0; k < 24 * 24 * 24; ++k)
        if (isNode(random)) voxels.push_back({k / 576 - 12, k / 24 % 24 - 12, k % 24 - 12});
    Band band = test::bandOfVoxels(voxels);
    for (std::size_t k = 0; k < band.size(); ++k) {
        band.psi[k] = k % 3 ? 2.0f : 0.0f;
        band.normal[k] = {0, 0, 1};
    }
    band.numberCore();
    return band;
}

TEST_CASE("findCorners finds what Band::neighbor finds, where all corners are nodes") {
    const Band band = bandWithHoles();
    const bool eight = eightAtATime();
    std::size_t whole = 0, differ = 0;
    for (NodeIndex first = 0; first + Lanes::kNodes <= band.size(); first += Lanes::kNodes) {
        // Up to two leaves away.
        const Ijk low{int(first % 29) - 14, int(first % 31) - 15, int(first % 37) - 18};
        CellPlaces cells;
        for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
            const auto [l, at] = band.placeOf(first + NodeIndex(lane));
            cells.leaf[lane] = l;
            cells.x[lane] = int(at >> 6) + low.x;
            cells.y[lane] = int(at >> 3 & 7) + low.y;
            cells.z[lane] = int(at & 7) + low.z;
        }
        for (const bool isEight : {true, false}) {
            eightAtATime() = isEight && eight;
            CellPoints points;
            findCorners(band, cells, 0x7f, points);
            for (std::size_t lane = 0; lane < Lanes::kNodes; ++lane) {
                std::array<NodeIndex, 8> expected;
                bool all = lane < 7;
                for (int k = 0; k < 8; ++k) {
                    const NodeIndex i = first + NodeIndex(lane);
                    const auto [l, at] = band.placeOf(i);
                    const Ijk step = low + Ijk{k >> 2, k >> 1 & 1, k & 1};
                    all &= band.neighbor(i, step) != kNoNode;
                    expected[std::size_t(k)] = band.neighbor(&BandLeaf::core, l, at, step);
                }
                whole += all;
                for (std::size_t k = 0; k < 8; ++k)
                    differ += points.node[k][lane] != (all ? expected[k] : kNoNode);
            }
        }
    }
    eightAtATime() = eight;
    CHECK(differ == 0);
    CHECK(whole > band.size() / 10);
}

}  // namespace igeo
