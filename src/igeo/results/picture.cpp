#include <igeo/results/picture.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/results/detail/camera.h>
#include <igeo/results/detail/drawn_picture.h>
#include <igeo/results/detail/film.h>
#include <igeo/results/detail/legend.h>
#include <igeo/results/detail/marks.h>
#include <igeo/results/detail/openness.h>
#include <igeo/results/detail/shader.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/level_set.h>

#include <atomic>

namespace igeo {

namespace {

void require(bool good, const std::string& what, const std::string& remedy) {
    if (!good) throw Error(Error::Kind::InvalidArgument, what, remedy);
}

void checkOptions(const PictureOptions& o) {
    constexpr int kLargest = 16384;
    auto inRange = [](int n) { return n >= 1 && n <= kLargest; };
    require(inRange(o.width) && inRange(o.height),
            fmt::format("a picture of {} x {} pixels; both may be 1 to {}", o.width, o.height,
                        kLargest),
            "choose a size in that range");
    require(std::isfinite(o.isolineSpacing), "the isoline spacing is not a number",
            "give a positive one, 0 for a round one, or a negative one for no lines");
    auto finite = [](const Vec3d& p) { return std::isfinite(dot(p, p)); };
    require(finite(o.eye.value_or(kWhite)) && finite(o.lookAt.value_or(kWhite)),
            "the camera's position or target is not a point", "give three finite numbers each");
    require(finite(o.up) && length(o.up) > 0, "the camera's up direction is no direction",
            "give three finite numbers, for instance 0,1,0");
}

Frame frameOf(const View& view, const Similarity& t, int width, int height) {
    auto turned = [&](const Vec3d& world) {
        return Vec3d{dot(t.axis[0], world), dot(t.axis[1], world), dot(t.axis[2], world)};
    };
    return {t.indexFromWorld(view.eye),
            turned(view.right),
            turned(view.up),
            turned(view.back),
            width / (2 * View::kHalfWidth),
            2 * View::kHalfWidth / width,
            width,
            height};
}

/// Draws the surface: one sample per pixel, then more where pixels show different parts of the
/// surface. Lines are antialiased by their width at a sample.
class Renderer {
public:
    Renderer(const DrawnSurface& surface, const Frame& frame, const Shader& shader,
             Progress& progress)
        : surface_(surface),
          frame_(frame),
          shader_(shader),
          raster_(surface.triangles(), frame),
          progress_(progress),
          samples_(std::size_t(frame.width) * std::size_t(frame.height)),
          normals_(samples_.size()),
          distances_(samples_.size()) {}

    /// @param radius  of the shading in folds, voxels
    void render(double radius, Film& film) {
        sample();
        rows(0, [&](int y) { lookAt(y); });
        open_ = openness(frame_, samples_, normals_, radius);
        std::vector<std::uint8_t> refine(raster_.tiles());
        rows(1, [&](int y) {
            for (int x = 0; x < frame_.width; ++x) {
                const Around around = lookAround(x, y);
                if (around.edge)
                    refine[raster_.tileOf(x, y)] = 1;
                else if (samples_[index(x, y)].covered())
                    film.at(x, y) = Rgba(colorAt(x, y, around.slope), 1);
            }
        });
        refineTiles(refine, film);
    }
    const std::vector<Sample>& samples() const { return samples_; }
    const std::vector<Vec3f>& normals() const { return normals_; }

private:
    static constexpr int kFiner = 3;  ///< samples per axis, in pixels with an edge

    /// Differences between a pixel and its neighbors.
    struct Around {
        bool edge = false;
        double slope = 0;  ///< of the distance, per pixel
    };

    std::size_t index(int x, int y) const {
        return std::size_t(y) * std::size_t(frame_.width) + std::size_t(x);
    }

    void sample() {
        parallelFor(raster_.tiles(), 1, progress_, [&](std::size_t begin, std::size_t end) {
            std::vector<Sample> tile;
            for (std::size_t t = begin; t < end; ++t) {
                raster_.draw(t, {{0.5, 0.5}}, /*wanted: all*/ {}, tile);
                forPixels(t, [&](int x, int y, std::size_t k) { samples_[index(x, y)] = tile[k]; });
            }
        });
    }

    /// Calls visit(x, y, number in the tile).
    template <typename Visit>
    void forPixels(std::size_t tile, const Visit& visit) const {
        constexpr int kTile = Raster::kTile;
        const auto [left, top] = raster_.origin(tile);
        for (int y = top; y < std::min(top + kTile, frame_.height); ++y)
            for (int x = left; x < std::min(left + kTile, frame_.width); ++x)
                visit(x, y, std::size_t((y - top) * kTile + x - left));
    }

    /// Calls body(y) for all rows; `pass` 0 or 1 of 2.
    template <typename Body>
    void rows(int pass, const Body& body) {
        std::atomic<int> done{0};
        parallelFor(std::size_t(frame_.height), 4, [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end) && !progress_.cancelled(); ++y) {
                body(y);
                progress_.update("picture", (pass + double(++done) / frame_.height) / 2);
            }
        });
        progress_.throwIfCancelled();
    }

    /// Computes the normals and distances of a row.
    void lookAt(int y) {
        std::vector<Spot> spots;
        std::vector<std::size_t> pixel;
        for (int x = 0; x < frame_.width; ++x)
            if (const std::size_t i = index(x, y); samples_[i].covered()) {
                spots.push_back(spotAt(samples_[i], frame_.toward(x + 0.5, y + 0.5)));
                pixel.push_back(i);
            }
        if (!surface_.hasDistances()) shader_.setDistances(spots);
        for (std::size_t k = 0; k < spots.size(); ++k) {
            normals_[pixel[k]] = Vec3f(spots[k].normal);
            distances_[pixel[k]] = float(spots[k].distance);
        }
    }

    /// A spot without its distance, unless the triangles have distances.
    Spot spotAt(const Sample& s, const Vec3d& toward) const {
        const std::array<double, 3> shares = raster_.shares(s.triangle, toward);
        Spot spot;
        spot.p = frame_.eye + double(s.depth) * toward;
        spot.normal = surface_.normal(s.triangle, shares, toward);
        if (surface_.hasDistances())
            spot.distance = shader_.known(spot.p, surface_.distance(s.triangle, shares));
        return spot;
    }

    /// Whether two pixels show different parts: surface and background, reached and unreached, one
    /// behind the other, or two sides of a crease.
    bool parted(int x, int y, int u, int v) const {
        constexpr float kSmooth = 0.97f;  // cosine
        const std::size_t i = index(x, y), j = index(u, v);
        const Sample &a = samples_[i], &b = samples_[j];
        if (a.covered() != b.covered()) return true;
        if (!a.covered()) return false;
        if (std::isinf(distances_[i]) != std::isinf(distances_[j])) return true;
        if (dot(normals_[i], normals_[j]) < kSmooth) return true;
        const Vec3d r = double(b.depth) * frame_.toward(u + 0.5, v + 0.5) -
                        double(a.depth) * frame_.toward(x + 0.5, y + 0.5);
        const double most = 1.5 * double(a.depth) / frame_.scale;
        return std::abs(dot(r, Vec3d(normals_[i]))) > most &&
               std::abs(dot(r, Vec3d(normals_[j]))) > most;
    }

    Around lookAround(int x, int y) const {
        Around around;
        std::array<double, 2> steepest{};
        const double here = double(distances_[index(x, y)]);
        for (int side = 0; side < 4; ++side) {
            const int axis = side / 2, step = side % 2 ? 1 : -1;
            const int u = x + (axis == 0 ? step : 0), v = y + (axis == 1 ? step : 0);
            if (u < 0 || v < 0 || u >= frame_.width || v >= frame_.height) continue;
            if (parted(x, y, u, v)) {
                around.edge = true;
            } else if (samples_[index(x, y)].covered() && here < kInfinity) {
                double& most = steepest[std::size_t(axis)];
                most = std::max(most, std::abs(double(distances_[index(u, v)]) - here));
            }
        }
        around.slope = std::sqrt(steepest[0] * steepest[0] + steepest[1] * steepest[1]);
        return around;
    }

    /// The color at the middle of a pixel that shows the surface.
    Vec3d colorAt(int x, int y, double slope) const {
        const std::size_t i = index(x, y);
        const Vec3d toward = frame_.toward(x + 0.5, y + 0.5);
        const double depth = double(samples_[i].depth);
        return shader_.color({frame_.eye + depth * toward, Vec3d(normals_[i]),
                              double(distances_[i]), 1 - double(open_[i]), slope},
                             normalized(toward));
    }

    void refineTiles(const std::vector<std::uint8_t>& refine, Film& film) {
        // No two in one row or column of the pixel.
        std::vector<Raster::Offset> offsets;
        for (int a = 0; a < kFiner; ++a)
            for (int b = 0; b < kFiner; ++b)
                offsets.push_back(
                    {(a + (b + 0.5) / kFiner) / kFiner, (b + (a + 0.5) / kFiner) / kFiner});
        parallelFor(refine.size(), 1, progress_, [&](std::size_t begin, std::size_t end) {
            std::vector<Sample> samples;
            std::vector<std::uint8_t> edges(std::size_t(Raster::kTile) * Raster::kTile);
            std::vector<double> slopes(edges.size());
            for (std::size_t t = begin; t < end; ++t) {
                if (!refine[t]) continue;
                forPixels(t, [&](int x, int y, std::size_t k) {
                    const Around around = lookAround(x, y);
                    edges[k] = around.edge, slopes[k] = around.slope;
                });
                raster_.draw(t, offsets, edges, samples);
                forPixels(t, [&](int x, int y, std::size_t k) {
                    if (edges[k])
                        film.at(x, y) =
                            mean(x, y, offsets, &samples[k * offsets.size()], slopes[k]);
                });
            }
        });
    }

    Rgba mean(int x, int y, const std::vector<Raster::Offset>& offsets, const Sample* samples,
              double slope) const {
        std::vector<Spot> spots;
        std::vector<Vec3d> toward;
        for (std::size_t k = 0; k < offsets.size(); ++k) {
            if (!samples[k].covered()) continue;
            toward.push_back(frame_.toward(x + offsets[k][0], y + offsets[k][1]));
            spots.push_back(spotAt(samples[k], toward.back()));
            spots.back().occluded = 1 - opennessNear(x, y, samples[k].depth);
            spots.back().slope = slope / kFiner;
        }
        if (!surface_.hasDistances()) shader_.setDistances(spots);
        Rgba sum;
        for (std::size_t k = 0; k < spots.size(); ++k)
            sum += Rgba(shader_.color(spots[k], normalized(toward[k])), 1);
        return sum * float(1.0 / double(offsets.size()));
    }

    /// Ambient light of the pixel or its neighbor, whichever is closest in depth.
    double opennessNear(int x, int y, float depth) const {
        float least = std::numeric_limits<float>::infinity(), found = 1;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, frame_.height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, frame_.width - 1); ++u) {
                const std::size_t i = index(u, v);
                const float off = std::abs(samples_[i].depth - depth);
                if (samples_[i].covered() && off < least) least = off, found = open_[i];
            }
        return double(found);
    }

    const DrawnSurface& surface_;
    const Frame& frame_;
    const Shader& shader_;
    const Raster raster_;
    Progress& progress_;
    std::vector<Sample> samples_;  ///< at the centers of the pixels
    std::vector<Vec3f> normals_;
    std::vector<float> distances_, open_;
};

/// Whether the surface hides a segment of a path, by the pixel of its middle.
bool isHidden(const MarkedSegment& s, const Frame& frame, const Renderer& seen) {
    const Vec3d middle = 0.5 * (s.a + s.b), at = frame.seen(middle);
    const auto [x, y] = frame.place(at);
    if (!(x >= 0 && y >= 0 && x < frame.width && y < frame.height)) return false;
    const std::size_t i = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
    const Sample& front = seen.samples()[i];
    if (!front.covered() || at.z <= double(front.depth)) return false;
    // A segment on the visible sheet lies in its tangent plane, up to curvature.
    const Vec3d n(seen.normals()[i]);
    const Vec3d p =
        frame.eye + double(front.depth) * frame.toward(std::floor(x) + 0.5, std::floor(y) + 0.5);
    return dot(n, s.normal) <= Band::kOtherSheet ||
           std::abs(dot(middle - p, n)) > 0.2 + 3 * at.z / frame.scale;
}

void drawPaths(const std::vector<MarkedSegment>& segments, const Frame& frame, const Renderer& seen,
               int pictureWidth, Film& film) {
    const double core = std::max(1.0, 0.002 * pictureWidth),
                 edge = core + std::max(0.8, 0.001 * pictureWidth);
    Strokes hidden(frame.width, frame.height, edge + 1), shown = hidden;
    for (const MarkedSegment& s : segments) {
        const Vec3d a = frame.seen(s.a), b = frame.seen(s.b);
        if (std::min(a.z, b.z) > 0)
            (isHidden(s, frame, seen) ? hidden : shown).add(frame.place(a), frame.place(b));
    }
    film.drawStrokes(hidden, core, edge, Film::kFaint);
    film.drawStrokes(shown, core, edge, 1);
}

}  // namespace

DrawnSurface drawnSurface(const LevelSet* levelSet, const Band& band, Progress& progress) {
    if (!levelSet) return DrawnSurface(band);
    const bool closed = levelSet->stats.cutVoxels == 0;
    return DrawnSurface(band, surfaceMesh(*levelSet, band, progress), closed);
}

std::string renderPng(const DrawnSurface& surface, const Field& field, const ArrivalReader& reader,
                      const std::vector<Path>& paths, const PictureOptions& options,
                      const View* given, Progress& progress) {
    checkOptions(options);
    const double dx = surface.transform().dx;
    const Scale scale(field, options);
    const Legend legend(scale, field, options);
    const int width = options.width - legend.taken();

    progress.update("picture", 0);
    const View view =
        given ? *given : chooseView(surface, field, paths, options, double(options.height) / width);
    const Frame frame = frameOf(view, surface.transform(), width, options.height);
    const double pixel = view.depth / dx / frame.scale, across = options.width * pixel;
    const Shader shader(field, reader, scale, std::max(0.5 * pixel, 0.0009 * across), frame);
    Renderer renderer(surface, frame, shader, progress);
    Film film(width, options.height);
    renderer.render(0.08 * across, film);

    const bool dark = options.background == Background::Black;
    film.drawRim(dark ? kUnreached : kInk);
    drawPaths(markedSegments(paths, field.seeds, surface), frame, renderer, options.width, film);
    const std::vector<Dot> marks =
        dots(field, paths, surface, frame.eye, std::max(3 * pixel, 0.0075 * across));
    for (const bool hidden : {true, false})
        for (const Dot& mark : marks)
            if (mark.hidden == hidden) film.drawDot(mark, frame, renderer.samples());

    Canvas canvas(options.width, options.height);
    const bool clear = options.background == Background::Transparent;
    canvas.fill(0, 0, options.width, options.height, dark ? Vec3d{} : kWhite, clear ? 0 : 1);
    film.develop(options.background, canvas);
    legend.draw(canvas, dark ? kWhite : kInk);
    return canvas.png();
}

std::string renderPng(const LevelSet* levelSet, const Field& field, const ArrivalReader& reader,
                      const std::vector<Path>& paths, const PictureOptions& options,
                      Progress& progress) {
    checkOptions(options);
    return renderPng(drawnSurface(levelSet, *field.band, progress), field, reader, paths, options,
                     nullptr, progress);
}

std::string renderPng(const LevelSet* levelSet, const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options, Progress& progress) {
    return renderPng(levelSet, field, ArrivalReader(field), paths, options, progress);
}

}  // namespace igeo
