#include <igeo/surface/detail/grid_similarity.h>

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <array>
#include <cmath>

namespace igeo {

Similarity similarityOf(const openvdb::math::Transform& transform, const std::string& at) {
    const std::string remedy =
        "resample the grid to cubic voxels first, for instance with OpenVDB's "
        "tools::resampleToMatch";
    if (!transform.isLinear())
        throw Error(
            Error::Kind::BadInput,
            "the transform is a " + transform.mapType() +
                " (not linear); only uniform scale, rotation and translation keep distances" + at,
            remedy);
    const auto m = transform.baseMap()->getAffineMap()->getMat4();
    Similarity s;
    std::array<double, 3> size{};
    for (int a = 0; a < 3; ++a) {  // OpenVDB multiplies row vectors: row a is the image of axis a
        s.axis[std::size_t(a)] = {m(a, 0), m(a, 1), m(a, 2)};
        size[std::size_t(a)] = length(s.axis[std::size_t(a)]);
    }
    s.origin = {m(3, 0), m(3, 1), m(3, 2)};
    // Of numbers between 1/2 and 1: std::cbrt may round the root of 8 x in another way than that of
    // x, and distances should not depend on the unit.
    int exponent = 0;
    std::frexp(size[0], &exponent);
    for (double& v : size) v = std::ldexp(v, -exponent);
    s.dx = std::ldexp(std::cbrt(size[0] * size[1] * size[2]), exponent);
    for (double& v : size) v = std::ldexp(v, exponent);
    constexpr double kTolerance = 1e-5;
    if (!(s.dx > 0) || !std::isfinite(s.dx))
        throw Error(Error::Kind::BadInput, "the voxel size is not a positive number" + at, remedy);
    // Shear first: it makes the sizes differ as well.
    for (std::size_t a = 0; a < 3; ++a) {
        const double cosine = dot(normalized(s.axis[a]), normalized(s.axis[(a + 1) % 3]));
        if (std::abs(cosine) > kTolerance)
            throw Error(
                Error::Kind::BadInput,
                fmt::format("the transform shears: index axes meet at {:.4g} degrees, not 90{}",
                            std::acos(cosine) * 57.29577951, at),
                remedy);
    }
    for (const double v : size)
        if (std::abs(v / s.dx - 1) > kTolerance)
            throw Error(
                Error::Kind::BadInput,
                fmt::format("voxels are not cubes: sizes {:g}, {:g}, {:g}; all three must agree{}",
                            size[0], size[1], size[2], at),
                remedy);
    for (auto& axis : s.axis) axis *= 1 / s.dx;
    // Exactly dx where the map says so: cbrt(dx^3) may be off in the last bit.
    if (size[0] == size[1] && size[1] == size[2]) s.dx = size[0];
    return s;
}

}  // namespace igeo
