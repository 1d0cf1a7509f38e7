#include <igeo/results/detail/canvas.h>

#include <igeo/base/error.h>
#include <igeo/results/color_map.h>
#include <png.h>

#include <cctype>
#include <cstring>

namespace igeo {

namespace {

constexpr int kGlyphWidth = 5, kGlyphHeight = 9;

/// Some glyphs side by side, a column free between two.
struct GlyphRow {
    const char* characters;
    const char* pixels[kGlyphHeight];
};
constexpr GlyphRow kFont[] = {
    {"0123456789abcd",
     {".###. .#... .###. .###. ...#. ##### ..##. ##### .###. .###. ..... #.... ..... ....#",
      "#...# ##... #...# #...# ..##. #.... .#... ....# #...# #...# ..... #.... ..... ....#",
      "#...# .#... ....# ....# .#.#. ####. #.... ...#. #...# #...# .###. ####. .###. .####",
      "#...# .#... ...#. ..##. #..#. ....# ####. ...#. .###. .#### ....# #...# #...# #...#",
      "#...# .#... ..#.. ....# ##### ....# #...# ..#.. #...# ....# .#### #...# #.... #...#",
      "#...# .#... .#... #...# ...#. #...# #...# ..#.. #...# ...#. #...# #...# #...# #...#",
      ".###. ###.. ##### .###. ...#. .###. .###. ..#.. .###. .##.. .#### ####. .###. .####",
      "..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... .....",
      "..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ....."}},
    {"efghijklmnopqr",
     {"..... ..##. ..... #.... #.... ..#.. #.... #.... ..... ..... ..... ..... ..... .....",
      "..... .#... ..... #.... ..... ..... #.... #.... ..... ..... ..... ..... ..... .....",
      ".###. ####. .#### ####. #.... ..#.. #..#. #.... ####. ####. .###. ####. .#### #.##.",
      "#...# .#... #...# #...# #.... ..#.. #.#.. #.... #.#.# #...# #...# #...# #...# ##...",
      "##### .#... #...# #...# #.... ..#.. ##... #.... #.#.# #...# #...# #...# #...# #....",
      "#.... .#... #...# #...# #.... ..#.. #.#.. #.... #.#.# #...# #...# #...# #...# #....",
      ".###. .#... .#### #...# #.... ..#.. #..#. .#... #.#.# #...# .###. ####. .#### #....",
      "..... ..... ....# ..... ..... ..#.. ..... ..... ..... ..... ..... #.... ....# .....",
      "..... ..... .###. ..... ..... ##... ..... ..... ..... ..... ..... #.... ....# ....."}},
    {"stuvwxyz.,-+()",
     {"..... .#... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..#.. #....",
      "..... .#... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... .#... .#...",
      ".#### ####. #...# #...# #.#.# #...# #...# ##### ..... ..... ..... ..#.. #.... ..#..",
      "#.... .#... #...# #...# #.#.# .#.#. #...# ...#. ..... ..... ####. ..#.. #.... ..#..",
      ".###. .#... #...# #...# #.#.# ..#.. #...# ..#.. ..... ..... ..... ##### #.... ..#..",
      "....# .#... #...# .#.#. #.#.# .#.#. #...# .#... ..... ..... ..... ..#.. #.... ..#..",
      "####. ..##. .#### ..#.. .#.#. #...# .#### ##### #.... .#... ..... ..#.. #.... ..#..",
      "..... ..... ..... ..... ..... ..... ....# ..... ..... .#... ..... ..... .#... .#...",
      "..... ..... ..... ..... ..... ..... .###. ..... ..... #.... ..... ..... ..#.. #...."}},
    {":/",
     {"..... ....#", "..... ....#", "#.... ...#.", "..... ..#..", "..... .#...", "#.... #....",
      "..... #....", "..... .....", "..... ....."}},
};

/// Whether a pixel of a character is set; characters without a glyph are blank.
bool inGlyph(char c, int x, int y) {
    c = char(std::tolower(static_cast<unsigned char>(c)));
    for (const GlyphRow& row : kFont)
        if (const char* at = c ? std::strchr(row.characters, c) : nullptr)
            return row.pixels[y][(at - row.characters) * (kGlyphWidth + 1) + x] == '#';
    return false;
}

/// Columns up to the last one used; a blank is three wide.
int glyphWidth(char c) {
    for (int x = kGlyphWidth - 1; x >= 0; --x)
        for (int y = 0; y < kGlyphHeight; ++y)
            if (inGlyph(c, x, y)) return x + 1;
    return 3;
}

std::uint8_t byteOf(double x) { return std::uint8_t(255 * std::clamp(x, 0.0, 1.0) + 0.5); }

}  // namespace

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), rgb_(3 * std::size_t(width) * std::size_t(height)) {}

void Canvas::set(int x, int y, const Vec3d& linear) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    std::uint8_t* pixel = &rgb_[3 * (std::size_t(y) * std::size_t(width_) + std::size_t(x))];
    const Vec3d c = srgbFromLinear(linear);
    for (int k = 0; k < 3; ++k) pixel[k] = byteOf(c[k]);
}

void Canvas::fill(int x, int y, int width, int height, const Vec3d& linear) {
    for (int j = y; j < y + height; ++j)
        for (int i = x; i < x + width; ++i) set(i, j, linear);
}

void Canvas::text(int x, int y, const std::string& text, int scale, const Vec3d& linear) {
    for (const char c : text) {
        for (int j = 0; j < kGlyphHeight; ++j)
            for (int i = 0; i < kGlyphWidth; ++i)
                if (inGlyph(c, i, j)) fill(x + scale * i, y + scale * j, scale, scale, linear);
        x += scale * (glyphWidth(c) + 1);
    }
}

std::string Canvas::png() const {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width_);
    image.height = png_uint_32(height_);
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string file(bytes, '\0');
    if (!png_image_write_to_memory(&image, file.data(), &bytes, /*convert_to_8_bit=*/0, rgb_.data(),
                                   /*row_stride=*/0, nullptr))
        throw Error(Error::Kind::Internal, std::string("libpng: ") + image.message);
    file.resize(bytes);
    return file;
}

}  // namespace igeo
