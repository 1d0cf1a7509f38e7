#include <igeo/base/parallel.h>
#include <igeo/results/surface_files.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/expect_error.h>
#include <support/march_cases.h>
#include <support/meshed.h>
#include <support/openvdb.h>
#include <support/random_surface.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace igeo::test {
namespace {

double volumeOf(const SurfaceMesh& mesh) {
    double volume = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        volume += dot(mesh.position[a], cross(mesh.position[b], mesh.position[c])) / 6;
    return volume;
}

Vec3d areaVector(const SurfaceMesh& mesh, const SurfaceMesh::Triangle& t) {
    return cross(mesh.position[t[1]] - mesh.position[t[0]],
                 mesh.position[t[2]] - mesh.position[t[0]]);
}

}  // namespace

TEST_CASE("surfaceMesh: closed surfaces give closed meshes of their genus") {
    struct Case {
        Shape shape;
        openvdb::Vec3d seed;
        int euler;
    };
    const Case cases[] = {
        {sphere(kCenter, 0.4), kCenter + openvdb::Vec3d(0.4, 0, 0), 2},
        {torus(kCenter, 0.3, 0.12), kCenter + openvdb::Vec3d(0.42, 0, 0), 0},
        {twoSpheres({0.25, 0.5, 0.5}, 0.15, {0.75, 0.5, 0.5}, 0.2), {0.1, 0.5, 0.5}, 4},
        {trefoilTube(kCenter, 0.12, 0.06), kCenter, 0},
        {box(kCenter, {0.3, 0.2, 0.1}), kCenter + openvdb::Vec3d(0.3, 0, 0), 2},
        {thinSheet(kCenter, 0.4, 0.3, 0.04), kCenter, 2}};
    for (const Case& c : cases) {
        INFO(c.shape.name);
        const Topology t = topologyOf(meshed(c.shape, 0.02, {c.seed}).mesh);
        CHECK(t.closed());
        CHECK(t.sameWay == 0);
        CHECK(t.euler == c.euler);
    }
}

TEST_CASE("sampleDistances: distances and labels are those of sampleField") {
    const Meshed m = meshed(trefoilTube(kCenter, 0.12, 0.06), 0.02, {kCenter});
    SurfaceMesh mesh = surfaceMesh(m.levelSet, m.band), full = mesh;
    sampleDistances(mesh, m.field);
    sampleField(full, m.field);
    REQUIRE(mesh.distance.size() == mesh.position.size());
    CHECK(mesh.distance == full.distance);
    CHECK(mesh.label == full.label);
    CHECK(mesh.gradient.empty());
}

TEST_CASE("sampleDistances: from the core alone, distances are those of the field on the band") {
    const std::vector<openvdb::Vec3d> seeds{kCenter + openvdb::Vec3d(0.42, 0, 0),
                                            kCenter + openvdb::Vec3d(-0.1, 0.29, 0.12)};
    JetOptions onCore;
    onCore.extend = false;
    for (const Shape& shape : {torus(kCenter, 0.3, 0.12), box(kCenter, {0.42, 0.29, 0.12})}) {
        INFO(shape.name);
        const Meshed whole = meshed(shape, 0.02, seeds), m = meshed(shape, 0.02, seeds, onCore);
        REQUIRE(m.field.core);
        SurfaceMesh mesh = m.mesh;
        sampleDistances(mesh, m.field);
        double worst = 0, sum = 0;
        for (std::size_t i = 0; i < mesh.position.size(); ++i) {
            const double off = std::abs(mesh.distance[i] - whole.mesh.distance[i]);
            worst = std::max(worst, off), sum += off;
        }
        CHECK(worst <= 0.05);  // voxels
        CHECK(sum / double(mesh.position.size()) <= 1e-3);
    }
}

TEST_CASE("surfaceMesh: surfaces by chance give closed meshes") {
    const auto unit = openvdb::math::Transform::createLinearTransform(1);
    for (const unsigned seed : {3u, 7u, 21u})
        for (const double blend : {0.0, 3.0}) {
            INFO("surface " << seed << ", blend " << blend);
            const Topology t =
                topologyOf(meshed(randomLevelSet(seed, blend, *unit), {{0, 0, 0}}).mesh);
            CHECK(t.closed());
            CHECK(t.sameWay == 0);
            CHECK(t.euler % 2 == 0);
        }
}

TEST_CASE("surfaceMesh: vertices on S, triangles and normals outward, area and volume right") {
    const int n = 50;
    const double r = 0.4 * n;
    const Meshed m = meshed(sphere(kCenter, 0.4), 1.0 / n, {kCenter});
    const Vec3d center(n / 2.0, n / 2.0, n / 2.0);
    double off = 0, tilt = 0, least = 1;
    for (std::size_t i = 0; i < m.mesh.position.size(); ++i) {
        const Vec3d radial = m.mesh.position[i] - center;
        off = std::max(off, std::abs(length(radial) - r));
        tilt = std::max(tilt, length(cross(normalized(radial), Vec3d(m.mesh.normal[i]))));
    }
    for (const auto& t : m.mesh.triangles)
        for (const std::uint32_t v : t)
            least = std::min(least, dot(normalized(areaVector(m.mesh, t)),
                                        normalized(m.mesh.position[v] - center)));
    // Trilinear interpolation of psi errs by at most 1/8 of its Laplacian, 2 / r.
    CHECK(off <= (1 + 1 / (r * r)) / (4 * r) + 1e-6);
    CHECK(tilt <= 0.00074);  // measured 0.00049
    // No edge is longer than a cell's diagonal, so no vertex is seen at more than sqrt(3) / r.
    CHECK(least >= std::cos(2 * std::sqrt(3.0) / r));
    // Triangles lie below their corners by 1 / (2 r) at most, with corners 1 from their middle.
    const double below = 1 / (4 * r) + 1 / (2 * r);
    CHECK(meshArea(m.mesh) == Approx(4 * M_PI * r * r).epsilon(2 * below / r));
    CHECK(volumeOf(m.mesh) == Approx(4 * M_PI / 3 * r * r * r).epsilon(3 * below / r));
}

TEST_CASE("surfaceMesh: quadrilaterals are cut along the better diagonal") {
    const Meshed m = meshed(torus(kCenter, 0.3, 0.12), 0.02, {kCenter});
    const auto& p = m.mesh.position;
    auto worse = [&](const SurfaceMesh::Triangle& s, const SurfaceMesh::Triangle& t) {
        double least = 1;
        for (const auto& v : {s, t}) {
            double sides = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d e = p[v[(k + 1) % 3]] - p[v[k]];
                sides += dot(e, e);
            }
            least = std::min(least, length(areaVector(m.mesh, v)) / sides);
        }
        return least;
    };
    std::size_t worst = 0;
    for (std::size_t k = 0; k < m.mesh.triangles.size(); k += 2) {
        // Both triangles of a quadrilateral (a, b, c, d): (a, b, c), (a, c, d).
        const auto [a, b, c] = m.mesh.triangles[k];
        const std::uint32_t d = m.mesh.triangles[k + 1][2];
        REQUIRE(m.mesh.triangles[k + 1] == SurfaceMesh::Triangle{a, c, d});
        // Quadrilaterals on S are nearly flat: the two measures of area agree to 1 %.
        if (worse({a, b, c}, {a, c, d}) < 0.99 * worse({b, c, d}, {b, d, a})) ++worst;
    }
    CHECK(worst == 0);
}

TEST_CASE("surfaceMesh: distances are the field's, labels the nearest seed's") {
    const openvdb::Vec3d u = genericDirection(0), v = genericDirection(1);
    const Meshed m = meshed(sphere(kCenter, 0.4), 0.02, {kCenter + 0.4 * u, kCenter + 0.4 * v});
    std::size_t wrong = 0, near = 0;
    for (std::size_t i = 0; i < m.mesh.position.size(); ++i) {
        const Vec3d p = m.mesh.position[i];
        CHECK(m.mesh.distance[i] ==
              Approx(sampleDistance(m.field, p, Vec3d(m.mesh.normal[i]))).margin(1e-3));
        const double d0 = length(p - m.field.seeds[0].pIndex),
                     d1 = length(p - m.field.seeds[1].pIndex);
        // Within half a voxel of the border it may be either.
        if (std::abs(d0 - d1) < 0.5)
            ++near;
        else if (m.mesh.label[i] != (d0 < d1 ? 0 : 1))
            ++wrong;
    }
    CHECK(wrong == 0);
    CHECK(near < m.mesh.position.size() / 20);
}

TEST_CASE("surfaceMesh: what is not reached") {
    const Meshed m =
        meshed(twoSpheres({0.25, 0.5, 0.5}, 0.15, {0.75, 0.5, 0.5}, 0.2), 0.02, {{0.1, 0.5, 0.5}});
    for (std::size_t i = 0; i < m.mesh.position.size(); ++i) {
        const bool reached = m.world(m.mesh.position[i]).x() < 0.5;
        CHECK((m.mesh.distance[i] < kInfinity) == reached);
        CHECK(m.mesh.label[i] == (reached ? 0 : kNoLabel));
    }
    const Ply ply = parsePly(surfacePly(m.mesh, m.band.transform, ramp));
    for (std::size_t i = 0; i < m.mesh.position.size(); ++i)
        if (!(m.mesh.distance[i] < kInfinity)) {
            CHECK(ply.value("vertex", i, "distance") == -1);
            CHECK(ply.value("vertex", i, "label") == -1);
            CHECK(ply.value("vertex", i, "t") == 1);
            CHECK(ply.value("vertex", i, "red") == 128);
            CHECK(ply.value("vertex", i, "green") == 128);
        }
}

TEST_CASE("surfaceMesh: an open surface ends near its edge, without a wall") {
    const double size = 0.8, dx = 0.02;
    const openvdb::Vec3d normal = GENERATE(openvdb::Vec3d(0, 0, 1), openvdb::Vec3d(1, 2, 3));
    const Meshed m = meshed(planePatch(kCenter, normal, size), dx, {kCenter});
    const Topology t = topologyOf(m.mesh);
    CHECK(t.edgesByTriangles.rbegin()->first == 2);
    CHECK(t.rimLoops == 1);
    CHECK(t.euler == 1);
    for (const Vec3d& p : m.mesh.position)
        CHECK(std::abs((m.world(p) - kCenter).dot(normal.unit())) < 1e-4 * dx);
    // Crossed edges have both ends in the square; the cells around them may be cut.
    const double area = meshArea(m.mesh) * dx * dx;
    CHECK(area < (size + 2 * dx) * (size + 2 * dx));
    CHECK(area > (size - 4 * dx) * (size - 4 * dx));
}

TEST_CASE("surfaceMesh: the class of the grid and its place in space do not matter") {
    const auto grid = torusGrid();
    const openvdb::Vec3d seed = grid->indexToWorld(
        openvdb::Vec3d(torusPoints()[0].x, torusPoints()[0].y, torusPoints()[0].z));
    const Meshed m = meshed(grid, {seed});
    const auto plain = grid->deepCopy();
    plain->setGridClass(openvdb::GRID_UNKNOWN);
    CHECK(meshed(plain, {seed}).mesh.triangles == m.mesh.triangles);

    // Far out, single precision would not tell vertices from each other.
    const std::int32_t far = 1 << 27;
    const auto shifted = mapVoxels(*grid, [&](const Ijk& c) { return c + Ijk{far, -far, far}; });
    const double dx = grid->voxelSize().x();
    const Meshed there = meshed(shifted, {seed + dx * openvdb::Vec3d(far, -far, far)});
    REQUIRE(there.mesh.triangles.size() == m.mesh.triangles.size());
    double worst = 0;
    for (std::size_t i = 0; i < m.mesh.position.size(); ++i)
        worst = std::max(
            worst, length(there.mesh.position[i] - m.mesh.position[i] - Vec3d(far, -far, far)));
    // Each lies within 1e-6 of psi = 0, though perhaps not on the same normal: single precision
    // places them on it to 1e-6 of the torus' width.
    CHECK(worst <= 5.5e-06);  // measured 3.6e-06
}

TEST_CASE("surfaceMesh: the same bytes for any number of threads") {
    const Shape shape = torus(kCenter, 0.3, 0.12);
    std::string first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const Meshed m = meshed(shape, 0.01, {kCenter + openvdb::Vec3d(0.42, 0, 0)});
        const std::string bytes =
            surfacePly(m.mesh, m.band.transform, ramp) + surfaceObj(m.mesh, m.band.transform, ramp);
        if (first.empty()) first = bytes;
        CHECK(bytes == first);
    }
}

TEST_CASE("surfaceMesh can be stopped") {
    struct Stop : Progress {
        bool cancelled() const override { return true; }
    } stop;
    const Meshed m = meshed(sphere(kCenter, 0.4), 0.05, {kCenter});
    expectError(Error::Kind::Cancelled, {}, [&] { surfaceMesh(m.levelSet, m.field, stop); });
}

TEST_CASE("meshEdges: each edge once, numbered for its triangles") {
    const Meshed m = meshed(sphere(kCenter, 0.4), 0.05, {kCenter});
    const MeshEdges edges = meshEdges(m.mesh);
    CHECK(2 * edges.ends.size() == 3 * m.mesh.triangles.size());
    for (std::size_t t = 0; t < m.mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = m.mesh.triangles[t][k], b = m.mesh.triangles[t][(k + 1) % 3];
            const auto ends = edges.ends[edges.ofTriangle[t][k]];
            CHECK(ends == std::array{std::min(a, b), std::max(a, b)});
        }
}

TEST_CASE("meshEdges: an edge of four triangles becomes two") {
    SurfaceMesh mesh;
    mesh.position.resize(6);
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}};
    const MeshEdges edges = meshEdges(mesh);
    CHECK(edges.ends.size() == 2 + 8);
    CHECK(edges.ofTriangle[0][0] == edges.ofTriangle[1][0]);
    CHECK(edges.ofTriangle[2][0] == edges.ofTriangle[3][0]);
    CHECK(edges.ofTriangle[0][0] != edges.ofTriangle[2][0]);
    // Two triangles that run along an edge one way are not joined by it.
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
    CHECK(meshEdges(mesh).ends.size() == 6);
}

TEST_CASE("surfacePly and surfaceObj: world units, outward, also in a mirror") {
    const openvdb::Vec3d middle(3, -2, 1);
    auto transform = rotatedTransform(0.05, {1, 2, 3}, 40, {7, 8, 9});
    if (GENERATE(false, true)) transform->preScale(openvdb::Vec3d(1, 1, -1));
    const Meshed m = meshed(sphere(middle, 0.8), *transform, {middle + openvdb::Vec3d(0.8, 0, 0)});
    const Ply ply = parsePly(surfacePly(m.mesh, m.band.transform, ramp));
    CHECK(ply.properties.at("vertex") ==
          std::vector<std::string>{"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue",
                                   "distance", "quality", "label", "s", "t", "texture_u",
                                   "texture_v"});
    const auto& vertices = ply.rows.at("vertex");
    const auto& faces = ply.rows.at("face");
    REQUIRE(vertices.size() == m.mesh.position.size());
    REQUIRE(faces.size() == m.mesh.triangles.size());
    auto position = [&](std::size_t i) {
        return openvdb::Vec3d(vertices[i][0], vertices[i][1], vertices[i][2]);
    };
    const double largest = *std::max_element(m.mesh.distance.begin(), m.mesh.distance.end());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const openvdb::Vec3d radial = position(i) - middle;
        CHECK(radial.length() == Approx(0.8).epsilon(0.0015));  // measured 0.00098
        CHECK(radial.unit().dot({vertices[i][3], vertices[i][4], vertices[i][5]}) > 0.99);
        const double share = m.mesh.distance[i] / largest;
        CHECK(vertices[i][6] == std::floor(255 * share + 0.5));
        CHECK(vertices[i][7] == 64);
        CHECK(vertices[i][9] == Approx(0.05 * m.mesh.distance[i]));
        CHECK(vertices[i][10] == vertices[i][9]);
        CHECK(vertices[i][11] == 0);
        for (const std::size_t u : {12u, 14u}) {
            CHECK(vertices[i][u] == Approx(share).margin(1e-6));
            CHECK(vertices[i][u + 1] == 0);
        }
    }
    for (const auto& f : faces) {
        REQUIRE(f.size() == 3);
        const auto a = position(std::size_t(f[0])), b = position(std::size_t(f[1])),
                   c = position(std::size_t(f[2]));
        CHECK((b - a).cross(c - a).dot(a - middle) > 0);
    }

    std::istringstream obj(surfaceObj(m.mesh, m.band.transform, ramp));
    std::size_t v = 0, f = 0;
    for (std::string line; std::getline(obj, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            openvdb::Vec3d p, color;
            words >> p.x() >> p.y() >> p.z() >> color.x() >> color.y() >> color.z();
            REQUIRE(words);
            const Vec3d exact = m.band.transform.worldFromIndex(m.mesh.position[v]);
            CHECK((p - openvdb::Vec3d(exact.x, exact.y, exact.z)).length() < 1e-10);
            CHECK(color.x() ==
                  Approx(m.mesh.distance[v] / largest).margin(7.6e-5));  // measured 5e-05
            ++v;
        } else if (kind == "f") {
            std::size_t a, b, c;
            words >> a >> b >> c;
            CHECK(std::vector<double>{a - 1.0, b - 1.0, c - 1.0} == faces[f]);
            ++f;
        }
    }
    CHECK(v == vertices.size());
    CHECK(f == faces.size());
}

}  // namespace igeo::test
