#include <igeo/results/detail/canvas.h>

#include <igeo/base/error.h>
#include <igeo/results/color_map.h>
#include <png.h>

#include <array>

namespace igeo {

namespace {

std::uint8_t byteOf(double x) { return std::uint8_t(255 * std::clamp(x, 0.0, 1.0) + 0.5); }

/// From linear light, by a table: the nearest byte, to a quarter of a step.
std::array<std::uint8_t, 3> srgbBytes(const Vec3d& linear) {
    constexpr int kSteps = 1 << 14;
    static const std::vector<std::uint8_t> table = [] {
        std::vector<std::uint8_t> bytes(kSteps + 1);
        for (int k = 0; k <= kSteps; ++k)
            bytes[std::size_t(k)] = byteOf(srgbFromLinear(Vec3d{1, 1, 1} * (double(k) / kSteps)).x);
        return bytes;
    }();
    auto encode = [](double c) {
        return table[std::size_t(kSteps * std::clamp(c, 0.0, 1.0) + 0.5)];
    };
    return {encode(linear.x), encode(linear.y), encode(linear.z)};
}

}  // namespace

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), rgba_(4 * std::size_t(width) * std::size_t(height)) {}

void Canvas::set(int x, int y, const Vec3d& linear, double alpha) {
    if (!holds(x, y)) return;
    const auto c = srgbBytes(linear);
    std::uint8_t* pixel = at(x, y);
    std::copy(c.begin(), c.end(), pixel);
    pixel[3] = byteOf(alpha);
}

void Canvas::fill(int x, int y, int width, int height, const Vec3d& linear, double alpha) {
    for (int j = y; j < y + height; ++j)
        for (int i = x; i < x + width; ++i) set(i, j, linear, alpha);
}

void Canvas::text(const Font& font, double x, double y, const std::string& text,
                  const Vec3d& linear) {
    const auto ink = srgbBytes(linear);
    font.draw(text, x, y, [&](int i, int j, double coverage) {
        if (!holds(i, j)) return;
        // Blended in sRGB, so that strokes look equally heavy on white and on black.
        std::uint8_t* pixel = at(i, j);
        const double below = (1 - coverage) * pixel[3] / 255.0, alpha = coverage + below;
        for (std::size_t k = 0; k < 3; ++k)
            pixel[k] = byteOf((coverage * ink[k] + below * pixel[k]) / alpha / 255);
        pixel[3] = byteOf(alpha);
    });
}

std::string Canvas::png() const {
    bool opaque = true;
    for (std::size_t k = 3; k < rgba_.size(); k += 4) opaque = opaque && rgba_[k] == 255;
    std::vector<std::uint8_t> rgb;
    if (opaque) {
        rgb.reserve(rgba_.size() / 4 * 3);
        for (std::size_t k = 0; k < rgba_.size(); k += 4)
            rgb.insert(rgb.end(), &rgba_[k], &rgba_[k] + 3);
    }
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width_);
    image.height = png_uint_32(height_);
    image.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string file(bytes, '\0');
    if (!png_image_write_to_memory(&image, file.data(), &bytes, /*convert_to_8_bit=*/0,
                                   opaque ? rgb.data() : rgba_.data(), /*row_stride=*/0, nullptr))
        throw Error(Error::Kind::Internal, std::string("libpng: ") + image.message);
    file.resize(bytes);
    return file;
}

}  // namespace igeo
