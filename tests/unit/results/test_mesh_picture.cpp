// Pictures of meshes show their own triangles, to the pixel.
#include <igeo/march/jet.h>
#include <igeo/results/detail/drawn_surface.h>
#include <igeo/surface/mesh_band.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/mesh_shapes.h>
#include <support/sphere_picture.h>

#include <numbers>

namespace igeo::test {
namespace {

struct Drawn {
    Band band;
    Field field;

    /// @param seed  where it is, voxels
    explicit Drawn(const TriangleMesh& mesh, const Vec3d& seed = {25, 25, 0.2}, double dx = 0.02)
        : band(bandFromMesh(mesh, dx, std::sqrt(3.0))),
          field(marchJet(band, nullptr, {nearestSurfacePoint(band, seed)})) {}

    /// From above.
    PictureOptions fromAbove() const {
        PictureOptions o;
        o.width = 320, o.height = 240;
        o.legend = false;
        o.eye = {0.5, 0.3, 2.5};
        o.lookAt = {0.5, 0.3, 0};
        return o;
    }
    /// Whether pixels show something exactly where `covered` says so of the point of the plane at
    /// height z that is seen through them; leaves out those within a pixel of the rim.
    template <typename Covered>
    void check(double z, const Covered& covered) const {
        const PictureOptions o = fromAbove();
        const Image image(renderPng(nullptr, field, {}, o));
        const double pixel = 2 * View::kHalfWidth * (o.eye->z - z) / o.width;
        int inside = 0, outside = 0;
        for (int j = 0; j < o.height; ++j)
            for (int i = 0; i < o.width; ++i) {
                auto at = [&](double a, double b) {
                    return covered(o.eye->x + (i + a - o.width / 2.0) * pixel,
                                   o.eye->y - (j + b - o.height / 2.0) * pixel);
                };
                const bool in = at(0.5, 0.5);
                if (at(-0.5, -0.5) != in || at(1.5, -0.5) != in || at(-0.5, 1.5) != in ||
                    at(1.5, 1.5) != in)
                    continue;
                INFO(i << " " << j);
                REQUIRE(image.isWhite(i, j) == !in);
                ++(in ? inside : outside);
            }
        CHECK(inside > 5000);
        CHECK(outside > 5000);
    }
};

}  // namespace

TEST_CASE("picture: a plate a third of a voxel thick has no holes and straight rims", "[mesh]") {
    const double thick = 0.007;
    Drawn(boxMesh({1, 0.6, thick})).check(thick, [](double x, double y) {
        return x > 0 && x < 1 && y > 0 && y < 0.6;
    });
}

TEST_CASE("picture: the dot of a seed shows from its own side of a thin plate", "[mesh]") {
    const TriangleMesh plate = boxMesh({1, 0.6, 0.007});  // a third of a voxel
    auto brightness = [&](double z) {
        const Drawn drawn(plate, {25, 15, z});
        const PictureOptions o = drawn.fromAbove();
        const Image image(renderPng(nullptr, drawn.field, {}, o));
        return dot(image.light(o.width / 2, o.height / 2), {1, 1, 1}) / 3;
    };
    CHECK(brightness(0.35) > 0.9);  // white
    CHECK(brightness(0.0) < 0.5);   // faint, over the dark end of the colors
}

TEST_CASE("picture: an open sheet ends where the mesh does", "[mesh]") {
    const double hole = 0.1;
    const TriangleMesh mesh = sheet(4, 90, [&](double u, double v) {
        const double r = hole + u * (0.3 - hole), a = 2 * std::numbers::pi * v;
        return igeo::Vec3d{0.5 + r * std::cos(a), 0.3 + r * std::sin(a), 0};
    });
    Drawn(mesh).check(0, [&](double x, double y) {
        const double a = std::atan2(y - 0.3, x - 0.5), step = std::numbers::pi / 45,
                     middle = (std::floor(a / step) + 0.5) * step;
        const double r = std::hypot(x - 0.5, y - 0.3) * std::cos(a - middle) / std::cos(step / 2);
        return r > hole && r < 0.3;
    });
}

TEST_CASE("picture: wide triangles with level edges, from the front and from behind", "[mesh]") {
    for (const bool fromBehind : {false, true}) {
        TriangleMesh mesh = sheet(3, 3, [](double u, double v) { return igeo::Vec3d{u, v, 0}; });
        if (fromBehind)
            for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
        Drawn(mesh).check(0, [](double x, double y) { return x > 0 && x < 1 && y > 0 && y < 1; });
    }
}

TEST_CASE("picture: a closed mesh is not drawn from inside", "[mesh]") {
    for (const bool inward : {false, true}) {  // as files have them
        TriangleMesh mesh = boxMesh({1, 0.6, 0.5});
        if (inward)
            for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
        const Drawn box(mesh);
        PictureOptions o = box.fromAbove();
        o.eye = {0.5, 0.3, 0.4};
        expectError(Error::Kind::InvalidArgument, {"is inside the surface"},
                    [&] { renderPng(nullptr, box.field, {}, o); });
        o.eye = {0.5, 0.3, 0.6};
        CHECK(!renderPng(nullptr, box.field, {}, o).empty());
    }
}

TEST_CASE("DrawnSurface: what turns its back is hidden on closed meshes with normals outward") {
    SurfaceMesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const Band band;
    CHECK(DrawnSurface(band, mesh, true).hidesBacks());
    SurfaceMesh inward = mesh, open = mesh;
    for (auto& [a, b, c] : inward.triangles) std::swap(b, c);
    CHECK_FALSE(DrawnSurface(band, inward, true).hidesBacks());
    open.triangles.pop_back();
    CHECK_FALSE(DrawnSurface(band, open, true).hidesBacks());
}

}  // namespace igeo::test
