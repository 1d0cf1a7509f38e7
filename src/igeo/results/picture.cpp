#include <igeo/results/picture.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/results/detail/camera.h>
#include <igeo/results/detail/drawn_picture.h>
#include <igeo/results/detail/film.h>
#include <igeo/results/detail/legend.h>
#include <igeo/results/detail/marks.h>
#include <igeo/results/detail/renderer.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/level_set.h>

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
    return {t.indexFromWorld(view.eye),
            t.indexFromWorldDirection(view.right),
            t.indexFromWorldDirection(view.up),
            t.indexFromWorldDirection(view.back),
            width / (2 * View::kHalfWidth),
            2 * View::kHalfWidth / width,
            width,
            height};
}

/// Whether the surface hides a segment of a path, by the pixel of its middle.
bool isHidden(const MarkedSegment& s, const Frame& frame, const SeenPixels& seen) {
    const Vec3d middle = frame.seen(0.5 * (s.a + s.b));
    const auto [x, y] = frame.place(middle);
    if (!(x >= 0 && y >= 0 && x < frame.width && y < frame.height)) return false;
    const std::size_t i = seen.index(int(x), int(y));
    if (!(middle.z > double(seen.depth[i]))) return false;
    // A segment on the visible sheet lies in its tangent plane, up to curvature.
    const Vec3d n(seen.normal(i)), p(seen.place(int(x), int(y)));
    return dot(n, frame.turned(s.normal)) <= Band::kOtherSheet ||
           std::abs(dot(middle - p, n)) > 0.2 + 3 * middle.z / frame.scale;
}

void drawPaths(const std::vector<MarkedSegment>& segments, const Frame& frame,
               const SeenPixels& seen, int pictureWidth, Film& film) {
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
    const Shader shader(field, reader, scale, std::max(0.5 * pixel, 0.0009 * across), frame,
                        0.5 * pixel);
    Renderer renderer(surface, frame, shader, progress);
    Film film(width, options.height);
    renderer.render(0.08 * across, pixel, film);

    const bool dark = options.background == Background::Black;
    film.drawRim(dark ? kUnreached : kInk);
    drawPaths(markedSegments(paths, field.seeds, surface), frame, renderer.seen(), options.width,
              film);
    const std::vector<Dot> marks =
        dots(field, paths, surface, frame.eye, std::max(3 * pixel, 0.0075 * across));
    for (const bool hidden : {true, false})
        for (const Dot& mark : marks)
            if (mark.hidden == hidden) film.drawDot(mark, frame, renderer.seen());

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
