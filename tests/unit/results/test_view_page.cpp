// What a page holds: names as text, numbers as they were but for what packing rounds off.
#include <igeo/base/detail/deflate.h>
#include <igeo/base/parallel.h>
#include <igeo/io/detail/base64.h>
#include <igeo/results/detail/web_text.h>
#include <igeo/results/refined_mesh.h>
#include <igeo/results/view_page.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace igeo::test {
namespace {

using nlohmann::json;

/// A sphere, far from the origin, with the height above its lowest point as distance.
ViewScene sphere(int rounds) {
    const Vec3d center{1000, -2000, 3000};
    const TriangleMesh given = sphereMesh(center, 2, rounds);
    ViewScene scene;
    scene.title = "sphere";
    scene.mesh.triangles = given.triangles;
    scene.mesh.position = given.points;
    for (const Vec3d& p : given.points) {
        scene.mesh.normal.push_back(Vec3f(normalized(p - center)));
        scene.mesh.distance.push_back(p.z - 2998);
        scene.mesh.label.push_back(p.x > 1000);
    }
    return scene;
}

json sceneOf(const std::string& page) {
    const std::string before = "id=\"scene\">";
    const std::size_t begin = page.find(before) + before.size();
    return json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

// As drawing.js does.
std::vector<std::uint32_t> unpackedPlain(const json& text) {
    const std::string bytes =
        inflated(fromBase64(text.get<std::string>()).value(), std::size_t(1) << 30);
    const auto planes = std::size_t(bytes.at(0));
    std::vector<std::uint32_t> numbers((bytes.size() - 1) / planes);
    for (std::size_t k = 0; k + 1 < bytes.size(); ++k)
        numbers[k % numbers.size()] |= std::uint32_t(std::uint8_t(bytes[k + 1]))
                                       << 8 * (k / numbers.size());
    return numbers;
}
std::vector<std::uint32_t> unpacked(const json& text) {
    std::vector<std::uint32_t> numbers = unpackedPlain(text);
    std::uint32_t last = 0;
    for (std::uint32_t& n : numbers) n = last += n >> 1 ^ (n & 1 ? ~0u : 0u);
    return numbers;
}
std::vector<SurfaceMesh::Triangle> unpackedTriangles(const json& fans) {
    const auto middle = unpacked(fans["middle"]), count = unpackedPlain(fans["count"]),
               rim = unpackedPlain(fans["rim"]);
    std::vector<SurfaceMesh::Triangle> triangles;
    std::size_t at = 0;
    for (std::size_t fan = 0; fan < middle.size(); ++fan, ++at)
        for (std::uint32_t k = 0; k < count[fan]; ++k, ++at)
            triangles.push_back(
                {middle[fan], middle[fan] + rim.at(at), middle[fan] + rim.at(at + 1)});
    CHECK(at == rim.size());
    return triangles;
}

/// In one order, each from its least corner on.
std::vector<SurfaceMesh::Triangle> sorted(std::vector<SurfaceMesh::Triangle> triangles) {
    for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

bool canDraw() {
    if (!hasViewer()) markSkipped("igeo was built without three.js");
    return hasViewer();
}

}  // namespace

TEST_CASE("view page: numbers come back to what a page promises") {
    if (!canDraw()) return;
    ViewScene scene = sphere(3);
    scene.mesh.distance[5] = kInfinity;
    scene.blocked.resize(scene.mesh.position.size());
    scene.blocked[6] = 1;
    scene.labelNames = {"a", "b"};
    scene.number.resize(scene.mesh.position.size(), ViewScene::kNoNumber);
    scene.number[7] = 4000000000;
    const json page = sceneOf(viewPage(scene));

    const double side = page["side"], low = page["low"], high = page["high"];
    double off = 0, wrong = 0;
    const auto values = unpacked(page["values"]);
    for (int axis = 0; axis < 3; ++axis) {
        const auto steps = unpacked(page["points"][std::string(1, "xyz"[axis])]);
        REQUIRE(steps.size() == scene.mesh.position.size());
        for (std::size_t v = 0; v < steps.size(); ++v)
            off = std::max(off, std::abs(page["corner"][std::size_t(axis)].get<double>() +
                                         steps[v] * side / 65535 - scene.mesh.position[v][axis]));
    }
    for (std::size_t v = 0; v < values.size(); ++v)
        if (values[v] < 65534)
            wrong = std::max(
                wrong, std::abs(low + values[v] * (high - low) / 65533 - scene.mesh.distance[v]));
    CHECK(off <= 0.51 * side / 65535);
    CHECK(wrong <= 0.51 * (high - low) / 65533);
    CHECK(values[5] == 65535);
    CHECK(values[6] == 65534);
    CHECK(unpacked(page["numbers"])[7] == 4000000001);
    CHECK(unpacked(page["numbers"])[8] == 0);
    CHECK(unpacked(page["labels"])[9] == scene.mesh.label[9] + 1);
    CHECK(sorted(unpackedTriangles(page["triangles"])) == sorted(scene.mesh.triangles));
}

TEST_CASE("view page: triangles come back, however many share a vertex") {
    if (!canDraw()) return;
    ViewScene scene;
    constexpr std::uint32_t kMany = 5000;  // around one vertex, in another order than theirs
    scene.mesh.position.resize(kMany + 1);
    scene.mesh.distance.resize(kMany + 1);
    for (std::uint32_t k = 0; k < kMany; ++k) {
        const std::uint32_t from = 1 + 17 * k % kMany;
        scene.mesh.position[k] = {double(k), double(k % 7), double(k % 11)};
        scene.mesh.triangles.push_back({from, 1 + from % kMany, 0});
    }
    scene.mesh.triangles.push_back({3, 2, 1});
    scene.mesh.triangles.push_back({3, 2, 1});
    const json page = sceneOf(viewPage(scene));
    CHECK(sorted(unpackedTriangles(page["triangles"])) == sorted(scene.mesh.triangles));
}

TEST_CASE("view page: names are text, whatever they hold") {
    if (!canDraw()) return;
    const std::string name = "</script><b>&\"{{css}}\xff\xc3\xa9\xf0\x9f\x90\xb0\n";
    ViewScene scene = sphere(1);
    scene.title = name;
    scene.notes = {name};
    scene.seeds = {{name, {1000, -2000, 3002}}};
    scene.lines.emplace_back();
    scene.lines.back().name = name;
    const std::string page = viewPage(scene);
    CHECK(page.find("</script><b>") == std::string::npos);
    CHECK(page.find("<b>") == std::string::npos);
    CHECK(page.find("<title>&#60;/script&#62;&#60;b&#62;&#38;&#34;{{css}}\xef\xbf\xbd\xc3\xa9") !=
          std::string::npos);
    const std::string shown = "</script><b>&\"{{css}}\xef\xbf\xbd\xc3\xa9\xf0\x9f\x90\xb0\n";
    const json said = sceneOf(page);
    CHECK(said["notes"][0] == shown);
    CHECK(said["seeds"][0]["name"] == shown);
    CHECK(said["lines"]["curves"][0]["name"] == shown);
}

TEST_CASE("view page: bytes that are no UTF-8 are replaced one by one") {
    CHECK(utf8("a\x80z") == "a\xef\xbf\xbdz");
    CHECK(utf8("\xc0\xaf") == "\xef\xbf\xbd\xef\xbf\xbd");  // overlong
    CHECK(utf8("\xed\xa0\x80").size() == 9);                // a surrogate
    CHECK(utf8("\xf4\x90\x80\x80").size() == 12);           // beyond the last
    CHECK(utf8("\xe2\x82") == "\xef\xbf\xbd\xef\xbf\xbd");  // cut off
    CHECK(utf8("\xf0\x9f\x90\xb0\xe2\x82\xac") == "\xf0\x9f\x90\xb0\xe2\x82\xac");
    CHECK(jsonString("\xf0\x9f\x90\xb0<\"\\\x01") ==
          "\"\\ud83d\\udc30\\u003c\\u0022\\u005c\\u0001\"");
    CHECK(filledIn("{{a}} {{b}} {{", {{"a", "{{b}}"}}) == "{{b}} {{b}} {{");
}

TEST_CASE("view page: the same bytes on any number of threads; what it refuses") {
    if (!canDraw()) return;
    ViewScene scene = sphere(4);
    std::string first;
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        const std::string page = viewPage(scene);
        if (first.empty()) first = page;
        CHECK(page == first);
    }
    ViewScene none = scene;
    none.mesh.triangles.clear();
    expectError(Error::Kind::InvalidArgument, {"without triangles"}, [&] { viewPage(none); });
    scene.colorMap = "plaid";
    expectError(Error::Kind::InvalidArgument, {"plaid"}, [&] { viewPage(scene); });
}

TEST_CASE("view page: the picture comes back out of the first bytes") {
    if (!canDraw()) return;
    ViewScene scene = sphere(3);
    CHECK(stillOfPage(viewPage(scene)).empty());
    scene.still = "no picture, but bytes";
    const std::string page = viewPage(scene), address = stillOfPage(page);
    CHECK(address == "data:image/png;base64,bm8gcGljdHVyZSwgYnV0IGJ5dGVz");
    CHECK(stillOfPage(page.substr(0, page.find(address) + address.size() + 1)) == address);
    CHECK(stillOfPage(page.substr(0, page.find(address) + 30)).empty());
    CHECK(stillOfPage("<img src=\"x.png\">").empty());
}

TEST_CASE("view page: triangles are thinned out to vertices of the mesh") {
    ViewScene scene = sphere(6);
    const SurfaceMesh before = scene.mesh;
    REQUIRE(before.triangles.size() == 81920);
    std::vector<std::uint32_t> kept;
    CHECK(!thinOut(scene.mesh, 100000, kept));
    CHECK(scene.mesh.triangles.size() == before.triangles.size());
    CHECK(thinOut(scene.mesh, 10000, kept));
    CHECK(scene.mesh.triangles.size() <= 10000);
    CHECK(scene.mesh.triangles.size() > 6000);
    double area = 0;
    for (const auto& [a, b, c] : scene.mesh.triangles) {
        const std::vector<Vec3d>& p = scene.mesh.position;
        area += length(cross(p[b] - p[a], p[c] - p[a])) / 2;
    }
    CHECK(area ==
          Approx(16 * std::acos(-1)).epsilon(0.03));  // no part is lost, none is there twice
    REQUIRE(kept.size() == scene.mesh.position.size());
    for (std::size_t v = 0; v < kept.size(); ++v) {
        REQUIRE(scene.mesh.position[v] == before.position[kept[v]]);
        REQUIRE(scene.mesh.distance[v] == before.distance[kept[v]]);
        REQUIRE(scene.mesh.label[v] == before.label[kept[v]]);
    }
}

TEST_CASE("view page: the two sides of a thin wall stay apart") {
    const TriangleMesh a = sphereMesh({}, 1, 5), b = sphereMesh({}, 0.999, 5);
    SurfaceMesh mesh;
    for (const TriangleMesh* part : {&a, &b}) {
        const auto first = std::uint32_t(mesh.position.size());
        for (const Vec3d& p : part->points) {
            mesh.position.push_back(p);
            mesh.normal.push_back(Vec3f((part == &a ? 1.0 : -1.0) * normalized(p)));
            mesh.distance.push_back(part == &a);
            mesh.label.push_back(0);
        }
        for (const auto& [i, j, k] : part->triangles)
            mesh.triangles.push_back({first + i, first + j, first + k});
    }
    std::vector<std::uint32_t> kept;
    REQUIRE(thinOut(mesh, 4000, kept));
    for (const auto& [i, j, k] : mesh.triangles) {
        REQUIRE(mesh.distance[i] == mesh.distance[j]);
        REQUIRE(mesh.distance[i] == mesh.distance[k]);
    }
}

}  // namespace igeo::test
