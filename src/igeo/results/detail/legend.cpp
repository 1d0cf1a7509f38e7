#include <igeo/results/detail/legend.h>

#include <fmt/core.h>
#include <igeo/results/isolines.h>

namespace igeo {

namespace {

// In units of the legend.
constexpr double kFontSize = 9, kBar = 14, kTick = 4, kGap = 3, kLine = 12, kMargin = 10;

std::string numberText(double value, int digits = 6) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (text[0] == '-') text = "\u2212" + text.substr(1);
    return text;
}

}  // namespace

Scale::Scale(const Field& field, const PictureOptions& options)
    : colors(options.colorMap), high(field.maxDistance) {
    low = kInfinity;
    for (const SurfacePoint& s : field.seeds) low = std::min(low, s.start);
    low = std::min(low, high);
    if (options.isolineSpacing >= 0 && high > low)
        levels = chosenLevels(field, options.isolineCount, options.isolineSpacing);
}

double Scale::fromIsoline(double d, std::size_t& above) const {
    while (above < levels.size() && levels[above] < d) ++above;
    while (above > 0 && !(levels[above - 1] < d)) --above;
    double least = kInfinity;
    if (above < levels.size()) least = levels[above] - d;
    if (above > 0) least = std::min(least, d - levels[above - 1]);
    return least;
}

Legend::Legend(const Scale& scale, const Field& field, const PictureOptions& options)
    : scale_(scale),
      unit_(std::max(1.0, std::min(options.width, options.height) / 400.0)),
      font_(kFontSize * unit_),
      hasUnreached_(field.reached < field.size()),
      height_(int(std::min(0.6 * options.height, 300 * unit_))) {
    const double dx = field.band->transform.dx;
    const bool weighted = field.metric->weighted();
    head_ = {options.quantity, !options.unit.empty() ? "(" + options.unit + ")"
                               : weighted            ? "(weighted)"
                                                     : "(world units)"};
    if (weighted && !options.unit.empty()) head_[0] = "weighted " + head_[0];
    if (!scale.levels.empty()) {
        const double step =
            scale.levels.size() > 1 ? scale.levels[1] - scale.levels[0] : scale.levels[0];
        foot_ = {scale.levels.size() > 1 ? "isolines" : "isoline",
                 (scale.levels.size() > 1 ? "every " : "at ") + numberText(step * dx, 4)};
    }
    chooseTicks(dx);
    measure();
    shown_ = options.legend && field.reached > 0 && width_ * 3 <= options.width &&
             height_ + 90 * unit_ <= options.height;
}

void Legend::chooseTicks(double dx) {
    const double low = scale_.low * dx, high = scale_.high * dx;
    const double step = high > low ? roundSpacing(high - low, 5) : 1;
    for (double k = std::ceil(low / step - 1e-9) + 0.0; k * step <= high + 1e-9 * step; ++k)
        ticks_.push_back({k * step / dx, numberText(k * step + 0.0)});
}

void Legend::measure() {
    double width = kBar * unit_;
    auto hold = [&](double left, const std::string& text) {
        width = std::max(width, left * unit_ + font_.width(text));
    };
    for (const std::string& line : head_) hold(0, line);
    for (const Tick& tick : ticks_) hold(kBar + kTick + kGap, tick.text);
    for (const std::string& line : foot_) hold(0, line);
    if (hasUnreached_) hold(kBar, "unreached");
    width_ = int(std::ceil(width + kMargin * unit_));
}

void Legend::drawBar(Canvas& canvas, int x, int y, const Vec3d& ink) const {
    const int rim = pixels(0.5), bar = pixels(kBar);
    canvas.fill(x - rim, y - rim, bar + 2 * rim, height_ + 2 * rim, ink);
    for (int j = 0; j < height_; ++j)
        canvas.fill(x, y + j, bar, 1, scale_.color(scale_.atShare(1 - (j + 0.5) / height_)));
    const int thick = pixels(0.6);
    auto rowOf = [&](double d) {
        return int(std::lround(y + (1 - scale_.share(d)) * (height_ - thick)));
    };
    for (const double level : scale_.levels)
        canvas.fill(x, rowOf(level), bar, thick, Scale::lineOn(scale_.color(level)));
    for (const Tick& tick : ticks_) {
        const int top = rowOf(tick.d);
        const double row = top + 0.5 * thick;
        canvas.fill(x + bar, top, pixels(kTick), thick, ink);
        // Digits are 0.73 em high.
        canvas.text(font_, x + bar + (kTick + kGap) * unit_, row + 0.365 * font_.size(), tick.text,
                    ink);
    }
}

void Legend::draw(Canvas& canvas, const Vec3d& ink) const {
    if (!shown_) return;
    // Centered slightly higher, because more text is below the bar than above.
    const int x = canvas.width() - width_, y = (canvas.height() - height_) / 2 - pixels(9);
    canvas.text(font_, x, y - (10 + kLine) * unit_, head_[0], ink);
    canvas.text(font_, x, y - 10 * unit_, head_[1], ink);
    drawBar(canvas, x, y, ink);
    double base = y + height_ + 20 * unit_;
    for (const std::string& line : foot_) {
        canvas.text(font_, x, base, line, ink);
        base += kLine * unit_;
    }
    if (!hasUnreached_) return;
    base += 0.5 * kLine * unit_;
    const int side = pixels(9);
    canvas.fill(x, int(base) - side + pixels(1), side, side, kUnreached);
    canvas.text(font_, x + kBar * unit_, base, "unreached", ink);
}

}  // namespace igeo
