// The tables hold every fifth of the 256 published colors, with straight lines in sRGB in between.
// The result differs from the published colors by 1 of 255 at most, in cividis by 4.
// - viridis, magma: S. van der Walt and N. Smith for matplotlib, CC0.
// - cividis: J. R. Nunez, C. R. Anderton, R. S. Renslow, "Optimizing colormaps with consideration
//   for color vision deficiency to enable accurate interpretation of scientific data", PLoS ONE 13,
//   2018; CC0.
// - turbo: A. Mikhailov, "Turbo, an improved rainbow colormap for visualization", 2019; copyright
//   2019 Google LLC, Apache-2.0.
#include <igeo/results/color_map.h>

#include <igeo/base/error.h>

#include <array>
#include <cstdint>

namespace igeo {

namespace {

struct Table {
    const char* name;
    std::array<std::uint32_t, 52> colors;  ///< 0xrrggbb, sRGB
};

constexpr Table kTables[] = {
    {"viridis",
     {0x440154, 0x46085c, 0x471063, 0x481769, 0x481d6f, 0x482475, 0x472a7a, 0x46307e, 0x453781,
      0x433d84, 0x414287, 0x3f4889, 0x3d4e8a, 0x3a538b, 0x38598c, 0x355e8d, 0x33638d, 0x31688e,
      0x2e6d8e, 0x2c718e, 0x2a768e, 0x297b8e, 0x27808e, 0x25848e, 0x23898e, 0x218e8d, 0x20928c,
      0x1f978b, 0x1e9c89, 0x1fa188, 0x21a585, 0x24aa83, 0x28ae80, 0x2eb37c, 0x35b779, 0x3dbc74,
      0x46c06f, 0x50c46a, 0x5ac864, 0x65cb5e, 0x70cf57, 0x7cd250, 0x89d548, 0x95d840, 0xa2da37,
      0xb0dd2f, 0xbddf26, 0xcae11f, 0xd8e219, 0xe5e419, 0xf1e51d, 0xfde725}},
    {"magma",
     {0x000004, 0x02020b, 0x050416, 0x090720, 0x0e0b2b, 0x140e36, 0x1a1042, 0x21114e, 0x29115a,
      0x311165, 0x390f6e, 0x420f75, 0x4a1079, 0x52137c, 0x5a167e, 0x621980, 0x6a1c81, 0x721f81,
      0x792282, 0x812581, 0x892881, 0x912b81, 0x992d80, 0xa1307e, 0xaa337d, 0xb2357b, 0xba3878,
      0xc23b75, 0xca3e72, 0xd2426f, 0xd9466b, 0xe04c67, 0xe75263, 0xec5860, 0xf1605d, 0xf4695c,
      0xf7725c, 0xf97b5d, 0xfb8560, 0xfc8e64, 0xfd9869, 0xfea16e, 0xfeaa74, 0xfeb47b, 0xfebd82,
      0xfec68a, 0xfecf92, 0xfed89a, 0xfde2a3, 0xfdebac, 0xfcf4b6, 0xfcfdbf}},
    {"cividis",
     {0x00224e, 0x002656, 0x002a5f, 0x002d68, 0x003070, 0x083370, 0x163770, 0x203a6f, 0x273e6e,
      0x2e416d, 0x34456c, 0x3a486c, 0x3f4c6c, 0x444f6c, 0x49536c, 0x4e566c, 0x535a6d, 0x575d6d,
      0x5c616e, 0x60646f, 0x656870, 0x696b71, 0x6d6f72, 0x727274, 0x767676, 0x7a7a78, 0x7e7d78,
      0x838179, 0x888578, 0x8d8878, 0x928c78, 0x969077, 0x9b9476, 0xa09875, 0xa59c74, 0xaaa073,
      0xafa471, 0xb5a86f, 0xbaac6d, 0xbfb06b, 0xc4b468, 0xc9b965, 0xcfbd62, 0xd4c15f, 0xdac65b,
      0xdfca57, 0xe5cf52, 0xead34c, 0xf0d846, 0xf6dd3f, 0xfce236, 0xfee838}},
    {"turbo",
     {0x30123b, 0x36215f, 0x3b2f80, 0x3f3e9c, 0x424bb5, 0x4559cb, 0x4666dd, 0x4773eb, 0x4680f6,
      0x458cfd, 0x4099ff, 0x38a5fb, 0x2fb2f4, 0x27bee9, 0x1fc9dd, 0x1ad4d0, 0x18ddc2, 0x1ae4b6,
      0x22ebaa, 0x2ff19b, 0x3ff68a, 0x52fa7a, 0x65fd69, 0x79fe59, 0x8bff4b, 0x9cfe40, 0xa9fb39,
      0xb7f735, 0xc3f134, 0xd0ea34, 0xdbe236, 0xe5d938, 0xeecf3a, 0xf5c53a, 0xfaba39, 0xfdae35,
      0xfea130, 0xfe932a, 0xfc8423, 0xf9751d, 0xf46617, 0xef5811, 0xe84b0c, 0xe14109, 0xd83706,
      0xce2d04, 0xc32503, 0xb71d02, 0xa91601, 0x9b0f01, 0x8b0902, 0x7a0403}},
    {"gray",
     {0x000000, 0x050505, 0x0a0a0a, 0x0f0f0f, 0x141414, 0x191919, 0x1e1e1e, 0x232323, 0x282828,
      0x2d2d2d, 0x323232, 0x373737, 0x3c3c3c, 0x414141, 0x464646, 0x4b4b4b, 0x505050, 0x555555,
      0x5a5a5a, 0x5f5f5f, 0x646464, 0x696969, 0x6e6e6e, 0x737373, 0x787878, 0x7d7d7d, 0x828282,
      0x878787, 0x8c8c8c, 0x919191, 0x969696, 0x9b9b9b, 0xa0a0a0, 0xa5a5a5, 0xaaaaaa, 0xafafaf,
      0xb4b4b4, 0xb9b9b9, 0xbebebe, 0xc3c3c3, 0xc8c8c8, 0xcdcdcd, 0xd2d2d2, 0xd7d7d7, 0xdcdcdc,
      0xe1e1e1, 0xe6e6e6, 0xebebeb, 0xf0f0f0, 0xf5f5f5, 0xfafafa, 0xffffff}},
};

double clamped(double t) { return t > 0 ? std::min(t, 1.0) : 0.0; }  // NaN: 0

Vec3d linearFromSrgb(const Vec3d& srgb) {
    auto decode = [](double c) {
        return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    return {decode(srgb.x), decode(srgb.y), decode(srgb.z)};
}

Vec3d srgbOf(std::uint32_t rgb) {
    return Vec3d{double(rgb >> 16), double(rgb >> 8 & 0xff), double(rgb & 0xff)} * (1 / 255.0);
}

/// Linear interpolation from a to b, s from 0 to 1.
Vec3d mixed(const Vec3d& a, const Vec3d& b, double s) { return (1 - s) * a + s * b; }

}  // namespace

Vec3d srgbFromLinear(const Vec3d& linear) {
    auto encode = [](double c) {
        c = clamped(c);
        return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    };
    return {encode(linear.x), encode(linear.y), encode(linear.z)};
}

ColorMap::ColorMap(const std::string& name) {
    for (const Table& table : kTables) {
        if (table.name != name) continue;
        constexpr int kFiner = 5;
        for (std::size_t k = 0; k + 1 < table.colors.size(); ++k)
            for (int i = 0; i < kFiner; ++i)
                table_.push_back(linearFromSrgb(mixed(
                    srgbOf(table.colors[k]), srgbOf(table.colors[k + 1]), double(i) / kFiner)));
        table_.push_back(linearFromSrgb(srgbOf(table.colors.back())));
    }
    if (!table_.empty()) return;
    std::string known;
    for (const std::string& n : names()) known += (known.empty() ? "" : ", ") + n;
    throw Error(Error::Kind::InvalidArgument, "there is no color map '" + name + "'",
                "choose one of " + known);
}

Vec3d ColorMap::operator()(double t) const {
    const double at = clamped(t) * double(table_.size() - 1);
    const auto k = std::min(std::size_t(at), table_.size() - 2);
    return mixed(table_[k], table_[k + 1], at - double(k));
}

std::vector<std::string> ColorMap::names() {
    std::vector<std::string> all;
    for (const Table& table : kTables) all.push_back(table.name);
    return all;
}

}  // namespace igeo
