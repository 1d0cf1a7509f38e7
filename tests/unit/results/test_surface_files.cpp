// Surfaces for other programs: what is not in the tests of surfacePly and surfaceObj.
#include <igeo/io/detail/ply_reader.h>
#include <igeo/results/surface_files.h>
#include <support/catch.h>
#include <support/meshed.h>

#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

namespace igeo::test {
namespace {

const openvdb::Vec3d kAway(3, -2, 1);
constexpr double kDx = 0.05, kRadius = 0.8;

/// Two spheres, of which one is reached.
Meshed solved() {
    return meshed(twoSpheres(kAway, kRadius, kAway + openvdb::Vec3d(3, 0, 0), 0.5), kDx,
                  {kAway + openvdb::Vec3d(kRadius, 0, 0)});
}

std::uint32_t wordAt(const std::string& bytes, std::size_t at) {
    std::uint32_t word;  // the tests run on little-endian machines
    std::memcpy(&word, bytes.data() + at, 4);
    return word;
}

/// A .glb file taken apart.
struct Glb {
    explicit Glb(const std::string& bytes) {
        REQUIRE(wordAt(bytes, 0) == 0x46546c67);
        REQUIRE(wordAt(bytes, 8) == bytes.size());
        const std::size_t length = wordAt(bytes, 12);
        REQUIRE(length % 4 == 0);
        json = nlohmann::json::parse(bytes.substr(20, length));
        REQUIRE(wordAt(bytes, 20 + length) == json["buffers"][0]["byteLength"]);
        buffer = bytes.substr(28 + length);
    }
    float number(const char* attribute, std::size_t vertex, std::size_t component) const {
        const auto& accessor =
            json["accessors"]
                [json["meshes"][0]["primitives"][0]["attributes"][attribute].get<std::size_t>()];
        const std::size_t width = accessor["type"] == "VEC3"   ? 3
                                  : accessor["type"] == "VEC2" ? 2
                                                               : 1;
        const std::size_t at =
            json["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"];
        float value;
        std::memcpy(&value, buffer.data() + at + 4 * (width * vertex + component), 4);
        return value;
    }
    nlohmann::json json;
    std::string buffer;
};

}  // namespace

TEST_CASE("sampleField: gradients point away from the seed and have length 1") {
    const Meshed m = solved();
    const Vec3d center = m.band.transform.indexFromWorld({kAway.x(), kAway.y(), kAway.z()});
    double tilt = 0;
    for (std::size_t v = 0; v < m.mesh.position.size(); ++v) {
        const Vec3d g(m.mesh.gradient[v]);
        if (!(m.mesh.distance[v] < kInfinity)) {
            CHECK(g == Vec3d{});
            continue;
        }
        const Vec3d n = normalized(m.mesh.position[v] - center), seed{1, 0, 0};
        const double angle = std::acos(std::clamp(dot(n, seed), -1.0, 1.0));
        // At the seed and where fronts meet there is none.
        if (angle * kRadius < 2 * kDx || (M_PI - angle) * kRadius < 2 * kDx) continue;
        CHECK(length(g) == Approx(1).margin(1e-6));
        tilt = std::max(tilt, length(g + normalized(tangential(seed, n))));
    }
    CHECK(tilt < 0.0099);  // measured 0.0066
}

TEST_CASE("surfaceGlb: attributes as glTF has them") {
    const Meshed m = solved();
    const Similarity& t = m.band.transform;
    const Glb glb(surfaceGlb(m.mesh, t, ramp));
    const std::size_t n = m.mesh.position.size();
    const auto& accessors = glb.json["accessors"];
    double largest = 0;
    for (const double d : m.mesh.distance)
        if (d < kInfinity) largest = std::max(largest, kDx * d);
    Vec3d low{1e9, 1e9, 1e9};
    for (std::size_t v = 0; v < n; ++v) {
        const Vec3d p = t.worldFromIndex(m.mesh.position[v]);
        const bool isReached = m.mesh.distance[v] < kInfinity;
        const double d = isReached ? kDx * m.mesh.distance[v] : -1;
        for (int k = 0; k < 3; ++k) {
            REQUIRE(glb.number("POSITION", v, std::size_t(k)) == float(p[k]));
            low[k] = std::min(low[k], double(float(p[k])));
        }
        REQUIRE(glb.number("_DISTANCE", v, 0) == float(d));
        REQUIRE(glb.number("_LABEL", v, 0) == (isReached ? 0 : -1));
        REQUIRE(glb.number("TEXCOORD_0", v, 1) == (isReached ? 0 : 1));
        REQUIRE(glb.number("TEXCOORD_0", v, 0) ==
                Approx(isReached ? d / largest : 0).margin(6e-8));  // half a unit of a float
        REQUIRE(glb.number("COLOR_0", v, 1) == (isReached ? 0.25f : 0.5f));
        REQUIRE(accessors[0]["count"] == n);
    }
    for (int k = 0; k < 3; ++k)
        CHECK(float(accessors[0]["min"][std::size_t(k)].get<double>()) == float(low[k]));
    CHECK(accessors.back()["count"] == 3 * m.mesh.triangles.size());
    CHECK(!glb.json["nodes"][0].contains("rotation"));
    for (const Vec3d& up : {Vec3d{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
        const nlohmann::json q = Glb(surfaceGlb(m.mesh, t, ramp, up)).json["nodes"][0]["rotation"];
        // v + 2 r x (r x v + w v)
        const Vec3d r{q[0].get<double>(), q[1].get<double>(), q[2].get<double>()};
        const Vec3d turned = up + 2.0 * cross(r, cross(r, up) + q[3].get<double>() * up);
        CHECK(length(turned - Vec3d{0, 1, 0}) < 1e-15);
        CHECK(dot(r, r) + q[3].get<double>() * q[3].get<double>() == Approx(1));
    }
}

TEST_CASE("surfaces far from the origin keep their shape") {
    const Meshed m = solved();
    Similarity t = m.band.transform;
    CHECK(surfacePly(m.mesh, t, ramp).find("property float x") != std::string::npos);
    CHECK(!Glb(surfaceGlb(m.mesh, t, ramp)).json["nodes"][0].contains("translation"));
    t.origin = {5.2e6, -4.1e6, 300};
    const igeo::Ply ply = readPlyPoints("far.ply", surfacePly(m.mesh, t, ramp));
    double off = 0;  // voxels
    for (std::size_t v = 0; v < m.mesh.position.size(); ++v)
        off = std::max(off, length(ply.points[v] - t.worldFromIndex(m.mesh.position[v])) / kDx);
    CHECK(off == 0);
    for (const Vec3d& up : {Vec3d{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}}) {
        const Glb glb(surfaceGlb(m.mesh, t, ramp, up));
        const nlohmann::json& node = glb.json["nodes"][0];
        REQUIRE(node.contains("translation"));
        const auto numberOf = [&](const char* name, int k) {
            return node[name][std::size_t(k)].get<double>();
        };
        off = 0;
        for (std::size_t v = 0; v < m.mesh.position.size(); ++v) {
            Vec3d p, place;
            for (int k = 0; k < 3; ++k) {
                p[k] = double(glb.number("POSITION", v, std::size_t(k)));
                place[k] = numberOf("translation", k);
            }
            if (node.contains("rotation")) {
                const Vec3d r{numberOf("rotation", 0), numberOf("rotation", 1),
                              numberOf("rotation", 2)};
                // Back by the inverse: the world as it was.
                place += 2.0 * cross(r, cross(r, place) - numberOf("rotation", 3) * place);
            }
            off = std::max(off, length(place + p - t.worldFromIndex(m.mesh.position[v])) / kDx);
        }
        std::printf("a surface far from the origin: .glb off by %.2g voxels\n", off);
        CHECK(off < 3.6e-6);  // measured 2.4e-6
    }
}

}  // namespace igeo::test
