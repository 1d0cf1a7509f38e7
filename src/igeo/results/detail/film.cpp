#include <igeo/results/detail/film.h>

#include <igeo/base/parallel.h>
#include <igeo/results/detail/legend.h>

#include <algorithm>
#include <cmath>

namespace igeo {

void Rgba::tint(const Vec3d& color, double share) {
    if (!(a > 0)) return;
    auto mix = [&](float& c, double with) {
        const double root = (1 - share) * std::sqrt(double(c / a)) + share * std::sqrt(with);
        c = float(root * root) * a;
    };
    mix(r, color.x);
    mix(g, color.y);
    mix(b, color.z);
}

void Film::drawRim(const Vec3d& color) {
    constexpr double kStrength = 0.5;
    constexpr float kNone = std::numeric_limits<float>::infinity();
    parallelFor(std::size_t(height_), 16, [&](std::size_t begin, std::size_t end) {
        std::vector<float> column(std::size_t(width_) + 2, kNone);  // least alpha of three rows
        for (int y = int(begin); y < int(end); ++y) {
            const int above = std::max(y - 1, 0), below = std::min(y + 1, height_ - 1);
            for (int x = 0; x < width_; ++x)
                column[std::size_t(x + 1)] = std::min({at(x, above).a, at(x, y).a, at(x, below).a});
            for (int x = 0; x < width_; ++x) {
                Rgba& here = at(x, y);
                const float* around = &column[std::size_t(x)];
                const float least = std::min({around[0], around[1], around[2]});
                if (!(least < here.a)) continue;
                const double share = kStrength * double(1 - least / here.a);
                const Rgba rim(color, share * double(here.a));
                const auto rest = float(1 - share);
                here.r = here.r * rest + rim.r;
                here.g = here.g * rest + rim.g;
                here.b = here.b * rest + rim.b;
            }
        }
    });
}

void Film::drawStrokes(const Strokes& strokes, double core, double edge, double strength) {
    if (strokes.empty()) return;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const double off = strokes.at(x, y);
            if (!(off < edge + 0.5)) continue;
            const double all = std::min(edge - off + 0.5, 1.0),
                         white = std::clamp(core - off + 0.5, 0.0, all) / all;
            at(x, y).tint(white * kWhite + (1 - white) * kInk, strength * all);
        }
}

void Film::drawDot(const Dot& dot, const Frame& frame, const SeenPixels& seen) {
    constexpr double kRing = 0.72;
    const Vec3d s = frame.seen(dot.center);
    if (!(s.z > 0)) return;
    const auto [cx, cy] = frame.place(s);
    const double radius = frame.scale * dot.radius / s.z;
    auto from = [&](double c) { return int(std::max(std::floor(c - radius - 1), 0.0)); };
    auto to = [&](double c, int count) {
        return int(std::clamp(std::ceil(c + radius + 1), 0.0, double(count)));
    };
    const Vec3d light = 0.95 * kWhite;  // white paper stays whiter
    const Vec3d core = dot.seed ? light : kInk, ring = dot.seed ? kInk : light;
    for (int y = from(cy); y < to(cy, height_); ++y)
        for (int x = from(cx); x < to(cx, width_); ++x) {
            const double off = std::hypot(x + 0.5 - cx, y + 0.5 - cy),
                         covered = std::clamp(radius - off + 0.5, 0.0, 1.0);
            if (!(covered > 0)) continue;
            // It lies on the surface, which may bulge toward the eye a little.
            const bool hidden =
                dot.hidden || double(seen.depth[seen.index(x, y)]) < s.z - 2 * dot.radius;
            const double inner = std::clamp(kRing * radius - off + 0.5, 0.0, 1.0);
            const Vec3d color = inner * core + (1 - inner) * ring;
            if (hidden)
                at(x, y).tint(color, kFaint * covered);
            else
                at(x, y).cover(color, covered);
        }
}

void Film::develop(Background background, Canvas& canvas) const {
    parallelFor(std::size_t(height_), 16, [&](std::size_t begin, std::size_t end) {
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < width_; ++x) {
                const Rgba& c = at(x, y);
                if (!(c.a > 0)) continue;
                Canvas::Four light = loadAs<Canvas::Four>(&c);
                if (c.a != 1) {
                    const float clear = 1 - std::min(c.a, 1.0f);
                    if (background == Background::Transparent)
                        light = light * (1 / c.a), light[3] = c.a;
                    else if (background == Background::White)
                        light += clear;
                    else
                        light += Canvas::Four{0, 0, 0, clear};
                }
                canvas.set(x, y, light);
            }
    });
}

}  // namespace igeo
