#include <igeo/results/detail/legend.h>

#include <fmt/core.h>
#include <igeo/results/isolines.h>

namespace igeo {

namespace {

std::string text(double value) { return fmt::format("{:.6g}", value); }

}  // namespace

Scale::Scale(const Field& field, double dx, const PictureOptions& options)
    : colors(options.colorMap), high(field.maxDistance) {
    low = kInfinity;
    for (const SurfacePoint& s : field.seeds) low = std::min(low, s.start);
    low = std::min(low, high);
    constexpr double kLines = 16;
    if (options.isolineSpacing >= 0 && high > low)
        spacing = options.isolineSpacing > 0 ? options.isolineSpacing / dx
                                             : roundSpacing((high - low) * dx, kLines) / dx;
}

Legend::Legend(const Scale& scale, const Field& field, double dx, const PictureOptions& options)
    : scale_(scale),
      dx_(dx),
      hasUnreached_(field.reached < field.distance.size()),
      weighted_(field.metric->weighted()),
      unit_(std::max(1, std::min(options.width, options.height) / 400)) {
    height_ = std::min(options.height * 3 / 5, 300 * unit_);
    if (options.legend && field.reached > 0 && width() * 3 <= options.width &&
        (height_ + 90 * unit_) <= options.height)
        shown_ = true;
}

void Legend::draw(Canvas& canvas) const {
    if (!shown_) return;
    const int u = unit_, x = canvas.width() - width();
    int y = (canvas.height() - height_) / 2;
    canvas.text(x, y - 36 * u, "distance", u, kInk);
    canvas.text(x, y - 24 * u, weighted_ ? "(weighted)" : "(world units)", u, kInk);
    canvas.fill(x - 1, y - 1, kBar * u + 2, height_ + 2, kInk);
    for (int j = 0; j < height_; ++j) {
        const double d = atRow(j + 0.5);
        const double half = 0.5 * (scale_.high - scale_.low) / height_ * 0.6 * u;
        const bool line = scale_.spacing > 0 && scale_.fromIsoline(d) <= half;
        const Vec3d color = scale_.color(d);
        canvas.fill(x, y + j, kBar * u, 1, line ? Scale::lineOn(color) : color);
    }
    drawTicks(canvas, x + kBar * u, y);
    y += height_ + 14 * u;
    if (scale_.spacing > 0) {
        canvas.text(x, y, "isolines", u, kInk);
        canvas.text(x, y + 12 * u, "every " + text(scale_.spacing * dx_), u, kInk);
        y += 30 * u;
    }
    if (hasUnreached_) {
        canvas.fill(x, y - u, 9 * u, 9 * u, kUnreached);
        canvas.text(x + 13 * u, y, "unreached", u, kInk);
    }
}

void Legend::drawTicks(Canvas& canvas, int x, int y) const {
    const int u = unit_;
    const double low = scale_.low * dx_, high = scale_.high * dx_;
    const double step = high > low ? roundSpacing(high - low, 5) : 1;
    for (double k = std::ceil(low / step - 1e-9) + 0.0; k * step <= high + 1e-9 * step; ++k) {
        const double share = high > low ? (high - k * step) / (high - low) : 1;
        const int row = y + int(std::lround(share * (height_ - u)));
        canvas.fill(x, row, 4 * u, u, kInk);
        canvas.text(x + 7 * u, row - Canvas::kDigitHeight * u / 2 + u / 2, text(k * step + 0.0), u,
                    kInk);
    }
}

}  // namespace igeo
