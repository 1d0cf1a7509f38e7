#include <igeo/results/detail/font.h>

#include <igeo/base/error.h>

#include <ft2build.h>

#include <cmath>
#include <cstddef>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

namespace igeo {

// The bytes of the file, embedded by CMake.
extern const unsigned char kFontFile[];
extern const std::size_t kFontFileSize;

namespace {

constexpr double kFontUnit = 64;  // FreeType's unit of length, per pixel

void require(FT_Error error, const char* what) {
    if (error)
        throw Error(Error::Kind::Internal,
                    std::string("FreeType: ") + what + ", error " + std::to_string(error));
}

/// The code points of UTF-8; an invalid byte becomes a code point of its own value.
std::u32string codePoints(const std::string& text) {
    std::u32string all;
    for (std::size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i++]);
        const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : 0;
        char32_t c = more ? char32_t(first) & (0x3fu >> more) : char32_t(first);
        for (int k = 0; k < more && i < text.size(); ++k)
            c = c << 6 | (static_cast<unsigned char>(text[i++]) & 0x3fu);
        all += c;
    }
    return all;
}

}  // namespace

struct Font::Face {
    double size;
    FT_Library library = nullptr;
    FT_Face face = nullptr;

    explicit Face(double pixels) : size(pixels) {
        require(FT_Init_FreeType(&library), "it does not start");
        require(FT_New_Memory_Face(library, kFontFile, FT_Long(kFontFileSize), 0, &face),
                "the font is not read");
        require(FT_Set_Char_Size(face, 0, FT_F26Dot6(std::lround(size * kFontUnit)), 72, 72),
                "the font has no such size");
    }
    ~Face() { FT_Done_FreeType(library); }
    Face(const Face&) = delete;
    Face& operator=(const Face&) = delete;

    /// Loads a glyph with its outline.
    FT_GlyphSlot load(char32_t c) const {
        require(FT_Load_Char(face, c, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP),
                "a glyph is missing");
        return face->glyph;
    }
};

Font::Font(double size) : face_(std::make_unique<Face>(size)) {}
Font::~Font() = default;

double Font::size() const { return face_->size; }

double Font::width(const std::string& text) const {
    double sum = 0;
    for (const char32_t c : codePoints(text)) sum += double(face_->load(c)->advance.x) / kFontUnit;
    return sum;
}

void Font::draw(const std::string& text, double x, double y,
                const std::function<void(int, int, double)>& visit) const {
    for (const char32_t c : codePoints(text)) {
        FT_GlyphSlot glyph = face_->load(c);
        const double left = std::floor(x), base = std::floor(y);
        // FreeType's y goes up.
        FT_Outline_Translate(&glyph->outline, FT_Pos(std::lround((x - left) * kFontUnit)),
                             -FT_Pos(std::lround((y - base) * kFontUnit)));
        require(FT_Render_Glyph(glyph, FT_RENDER_MODE_NORMAL), "a glyph is not drawn");
        const FT_Bitmap& map = glyph->bitmap;
        for (unsigned j = 0; j < map.rows; ++j)
            for (unsigned i = 0; i < map.width; ++i)
                if (const unsigned char covered =
                        map.buffer[std::ptrdiff_t(j) * map.pitch + std::ptrdiff_t(i)])
                    visit(int(left) + glyph->bitmap_left + int(i),
                          int(base) - glyph->bitmap_top + int(j), covered / 255.0);
        x += double(glyph->advance.x) / kFontUnit;
    }
}

}  // namespace igeo
