#include <igeo/results/picture.h>

#include <fmt/core.h>
#include <igeo/base/parallel.h>
#include <igeo/results/detail/camera.h>
#include <igeo/results/detail/canvas.h>
#include <igeo/results/detail/legend.h>
#include <igeo/results/detail/level_set_rays.h>
#include <igeo/results/detail/triangle_rays.h>
#include <openvdb/tools/RayTracer.h>

#include <atomic>
#include <unordered_map>

namespace igeo {

namespace {

using openvdb::tools::Film;

const Vec3d kWhite{1, 1, 1};  // in linear light

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

/// Segments of paths and seed curves, to be found by position; index space.
class PathMarks {
public:
    PathMarks(const std::vector<Path>& paths, const std::vector<SurfacePoint>& seeds,
              const SurfaceRays& rays, double radius)
        : radius_(radius), cell_(std::max(2 * radius, 2.0)) {
        for (std::size_t k = 0; k < seeds.size(); ++k)
            if (seeds[k].segment != Vec3d{})
                insert({seeds[k].pIndex, seeds[k].pIndex + seeds[k].segment,
                        rays.normal(seeds[k].pIndex)});
        for (const Path& path : paths)
            for (std::size_t k = 0; k + 1 < path.vertices.size(); ++k) {
                const Vec3d &a = path.vertices[k].pIndex, &b = path.vertices[k + 1].pIndex;
                insert({a, b, rays.normal(0.5 * (a + b))});
            }
    }

    /// Whether a seed is one of several that make a curve or the rim of a region.
    static bool isPiece(const std::vector<SurfacePoint>& seeds, std::size_t k) {
        return seeds[k].joined || (k + 1 < seeds.size() && seeds[k + 1].joined);
    }

    /// Distance from a point of S to the nearest segment on its sheet, if below the radius.
    double distance(const Vec3d& p, const Vec3d& normal) const {
        double least = kInfinity;
        if (segments_.empty()) return least;
        const auto found = cells_.find(key(floorToIjk(p * (1 / cell_))));
        if (found == cells_.end()) return least;
        for (const std::uint32_t k : found->second) {
            const Segment& s = segments_[k];
            if (dot(s.normal, normal) > Band::kOtherSheet) least = std::min(least, s.distance(p));
        }
        return least < radius_ ? least : kInfinity;
    }

private:
    struct Segment {
        Vec3d a, b, normal;
        double distance(const Vec3d& p) const {
            const Vec3d along = b - a;
            const double square = dot(along, along);
            const double t = square > 0 ? std::clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
            return length(p - a - t * along);
        }
    };

    /// 21 bits per axis: no two cells of a surface collide, and a collision would only cost time.
    static std::uint64_t key(const Ijk& c) {
        constexpr std::uint64_t kBits = (1u << 21) - 1;
        return (std::uint64_t(c.x) & kBits) << 42 | (std::uint64_t(c.y) & kBits) << 21 |
               (std::uint64_t(c.z) & kBits);
    }

    void insert(const Segment& s) {
        Vec3d low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(s.a[axis], s.b[axis]) - radius_;
            high[axis] = std::max(s.a[axis], s.b[axis]) + radius_;
        }
        const Ijk first = floorToIjk(low * (1 / cell_)), last = floorToIjk(high * (1 / cell_));
        const auto number = std::uint32_t(segments_.size());
        segments_.push_back(s);
        for (int x = first.x; x <= last.x; ++x)
            for (int y = first.y; y <= last.y; ++y)
                for (int z = first.z; z <= last.z; ++z) cells_[key({x, y, z})].push_back(number);
    }

    double radius_, cell_;
    std::vector<Segment> segments_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// A ball that always shows its full disc; index space.
struct Dot {
    Vec3d center;
    double radius;
    Vec3d color;
};

/// What comes along a ray: color, alpha, and between which isolines it came from.
struct Light {
    Film::RGBA color{0.0, 0.0, 0.0, 0.0};
    int step = -1;

    Light() = default;
    explicit Light(const Vec3d& c, int isolineStep = -1)
        : color(c.x, c.y, c.z), step(isolineStep) {}
};

/// The scene, in index space: gives the light that comes along a ray. One per thread.
class Scene {
public:
    Scene(const Field& field, const std::vector<Path>& paths, const Scale& scale,
          const SurfaceRays& rays, const View& view, double pixel, int width)
        : field_(field), scale_(scale) {
        const Similarity& t = rays.transform();
        auto turned = [&](double right, double up, double back) {
            const Vec3d world = normalized(right * view.right + up * view.up + back * view.back);
            return Vec3d{dot(t.axis[0], world), dot(t.axis[1], world), dot(t.axis[2], world)};
        };
        eye_ = t.indexFromWorld(view.eye);
        key_ = turned(-0.55, 0.75, 0.75);
        fill_ = turned(0.9, 0.1, 0.5);

        const double frame = width * pixel;
        isolineHalf_ = std::min(std::max(0.5 * pixel, 0.0009 * frame), 0.15 * scale.spacing);
        pathHalf_ = std::max(pixel, 0.002 * frame);
        outline_ = std::max(0.8 * pixel, 0.001 * frame);
        marks_ = std::make_shared<PathMarks>(paths, field.seeds, rays, pathHalf_ + outline_);
        const double seedRadius = std::max(3 * pixel, 0.0075 * frame);
        auto dotAt = [&](const Vec3d& p, double radius, const Vec3d& color) {
            if (isVisible(rays, p, normalized(eye_ - p))) dots_.push_back({p, radius, color});
        };
        for (const Path& path : paths)
            if (!path.vertices.empty()) dotAt(path.vertices.front().pIndex, 0.6 * seedRadius, kInk);
        for (std::size_t k = 0; k < field.seeds.size(); ++k)
            if (!PathMarks::isPiece(field.seeds, k))
                dotAt(field.seeds[k].pIndex, seedRadius, kWhite);
    }

    const Vec3d& eye() const { return eye_; }
    const std::vector<Dot>& dots() const { return dots_; }

    /// Light from along the unit direction `dir`; alpha 0 if nothing is there.
    /// @param dots numbers of those that may be met
    Light along(const SurfaceRays& rays, const Vec3d& dir,
                const std::vector<std::uint32_t>& dots) const {
        const std::optional<double> hit = rays.hit(eye_, dir);
        Light seen;
        double depth = kInfinity;
        if (hit) {
            const Vec3d p = eye_ + *hit * dir;
            seen = surface(p, rays.normal(p, dir), dir);
            depth = *hit;
        }
        const Dot* front = nullptr;
        double nearest = kInfinity, off = 0;
        for (const std::uint32_t k : dots) {
            const Dot& dot_ = dots_[k];
            const Vec3d r = dot_.center - eye_;
            const double along = dot(r, dir), miss = length(r - along * dir);
            // A dot lies on the surface, which may bulge toward the eye a little.
            if (miss < dot_.radius && along < nearest && along < depth + 2 * dot_.radius)
                front = &dot_, nearest = along, off = miss / dot_.radius;
        }
        if (front) {
            constexpr double kRing = 0.74;
            seen = Light(off > kRing ? kInk : (1 - 0.25 * off * off) * front->color);
        }
        return seen;
    }

private:
    Light surface(const Vec3d& p, Vec3d n, const Vec3d& dir) const {
        double d = sampleDistance(field_, p, n);
        if (field_.stoppedEarly && d > lastKnown(p)) d = kInfinity;
        Vec3d c = d < kInfinity ? scale_.color(d) : kUnreached;
        const double path = marks_->distance(p, n);
        if (path < pathHalf_)
            return Light(0.6 * kWhite + 0.4 * lit(kWhite, dot(n, dir) > 0 ? -n : n, dir));
        if (path < kInfinity)
            c = kInk;
        else if (scale_.spacing > 0 && d < kInfinity &&
                 scale_.fromIsoline(d) < isolineHalf_ * weightAt(p))
            c = Scale::lineOn(c);
        if (dot(n, dir) > 0) n = -n;  // the back of an open surface
        return Light(lit(c, n, dir), scale_.step(d));
    }

    /// Where an early stop ends the colors, so that they end along a line and not cell by cell:
    /// jets reach beyond the last node, means of voxels fall short where some are missing.
    double lastKnown(const Vec3d& p) const {
        return field_.maxDistance - (field_.atFootPoints ? 0 : 2 * weightAt(p));
    }

    double weightAt(const Vec3d& p) const {
        return field_.metric->weighted() ? field_.metric->at(cellAt(*field_.band, p)) : 1.0;
    }

    /// Studio light: a key from the upper left, wrapped around for soft edges, a fill from the
    /// right, and enough all around that nothing is black.
    Vec3d lit(const Vec3d& c, const Vec3d& n, const Vec3d& dir) const {
        const double wrapped = std::max(0.0, (dot(n, key_) + 0.35) / 1.35);
        const double filled = std::max(0.0, dot(n, fill_));
        const double facing = -dot(n, dir);
        const double rim = std::pow(1 - std::min(facing, 1.0), 3);
        const double diffuse = (0.42 + 0.62 * wrapped * wrapped + 0.14 * filled) * (1 - 0.3 * rim);
        const double shine = 0.05 * std::pow(std::max(0.0, dot(n, normalized(key_ - dir))), 30);
        return diffuse * c + shine * kWhite;
    }

    const Field& field_;
    const Scale& scale_;
    Vec3d eye_, key_, fill_;
    double isolineHalf_, pathHalf_, outline_;
    std::shared_ptr<const PathMarks> marks_;
    std::vector<Dot> dots_;
};

/// Fills a film: one ray per pixel, then more where a pixel differs from its neighbors.
class Renderer {
public:
    Renderer(const SurfaceRays& rays, const View& view, const Scene& scene, Film& film,
             Progress& progress)
        : rays_(rays),
          scene_(scene),
          film_(film),
          camera_(film, openvdb::Vec3d(0), vdb(view.eye), View::kFocalLength, View::kAperture,
                  /*nearPlane, which no ray here heeds*/ 1e-3),
          progress_(progress),
          dotsInRow_(film.height()) {
        camera_.lookAt(vdb(view.eye - view.back * view.depth), vdb(view.up));
        placeDots(view);
    }

    void render() {
        const std::size_t width = film_.width();
        std::vector<Light> first(width * film_.height());
        rows(0, [&](const SurfaceRays& rays, std::size_t i, std::size_t j) {
            first[j * width + i] = light(rays, i, j, 0.5, 0.5);
            film_.pixel(i, j) = first[j * width + i].color;
        });
        rows(1, [&](const SurfaceRays& rays, std::size_t i, std::size_t j) {
            if (onEdge(first, i, j)) film_.pixel(i, j) = mean(rays, i, j);
        });
    }

private:
    static constexpr int kSamples = 3;  ///< per axis in pixels with an edge

    static openvdb::Vec3d vdb(const Vec3d& p) { return {p.x, p.y, p.z}; }

    void placeDots(const View& view) {
        const double scale = double(film_.width()) / (2 * View::kHalfWidth);
        const auto rowCount = double(film_.height());
        for (std::size_t k = 0; k < scene_.dots().size(); ++k) {
            const Dot& d = scene_.dots()[k];
            const Vec3d r = rays_.transform().worldFromIndex(d.center) - view.eye;
            const double depth = -dot(r, view.back);
            if (!(depth > 0)) continue;
            const double row = rowCount / 2 - scale * dot(r, view.up) / depth;
            // Off the axis a ball looks longer.
            const double radius = 2 + 1.5 * scale * d.radius * rays_.transform().dx / depth;
            const double from = std::max(row - radius, 0.0), to = std::min(row + radius, rowCount);
            for (double j = std::floor(from); j < to; ++j)
                dotsInRow_[std::size_t(j)].push_back(std::uint32_t(k));
        }
    }

    /// Calls body(rays, i, j) for all pixels; `pass` 0 or 1 of 2.
    template <typename Body>
    void rows(int pass, const Body& body) {
        std::atomic<std::size_t> done{0};
        parallelFor(film_.height(), 4, [&](std::size_t begin, std::size_t end) {
            const auto rays = rays_.copy();
            for (std::size_t j = begin; j < end && !progress_.cancelled(); ++j) {
                for (std::size_t i = 0; i < film_.width(); ++i) body(*rays, i, j);
                progress_.update("picture", (pass + double(++done) / double(film_.height())) / 2);
            }
        });
        progress_.throwIfCancelled();
    }

    /// Light at (i + x, j + y); premultiplied.
    Light light(const SurfaceRays& rays, std::size_t i, std::size_t j, double x, double y) const {
        const openvdb::Vec3d w = camera_.getRay(i, j, x, y).dir();
        const Similarity& t = rays_.transform();
        const Vec3d world{w.x(), w.y(), w.z()};
        const Vec3d dir{dot(t.axis[0], world), dot(t.axis[1], world), dot(t.axis[2], world)};
        return scene_.along(rays, dir, dotsInRow_[j]);
    }

    /// Over kSamples^2 points, no two of them in one row or column.
    Film::RGBA mean(const SurfaceRays& rays, std::size_t i, std::size_t j) const {
        constexpr double n = kSamples;
        Film::RGBA sum(0.0, 0.0, 0.0, 0.0);
        for (int a = 0; a < kSamples; ++a)
            for (int b = 0; b < kSamples; ++b)
                sum += light(rays, i, j, (a + (b + 0.5) / n) / n, (b + (a + 0.5) / n) / n).color;
        const auto share = float(1 / (n * n));
        return {sum.r * share, sum.g * share, sum.b * share, sum.a * share};
    }

    /// Whether a pixel of the first pass, a film of its size, differs from a neighbor.
    bool onEdge(const std::vector<Light>& first, std::size_t i, std::size_t j) const {
        constexpr float kVisible = 0.03f;  // of square roots, which are near what the eye sees
        const std::size_t width = film_.width(), at = j * width + i;
        auto differs = [&](std::size_t other) {
            const Light &a = first[at], &b = first[other];
            auto differ = [](float p, float q) {
                return std::abs(std::sqrt(p) - std::sqrt(q)) > kVisible;
            };
            return a.step != b.step || a.color.a != b.color.a || differ(a.color.r, b.color.r) ||
                   differ(a.color.g, b.color.g) || differ(a.color.b, b.color.b);
        };
        return (i > 0 && differs(at - 1)) || (i + 1 < width && differs(at + 1)) ||
               (j > 0 && differs(at - width)) || (j + 1 < film_.height() && differs(at + width));
    }

    const SurfaceRays& rays_;
    const Scene& scene_;
    Film& film_;
    openvdb::tools::PerspectiveCamera camera_;
    Progress& progress_;
    std::vector<std::vector<std::uint32_t>> dotsInRow_;
};

/// The film over white, at the left of the canvas.
void develop(const Film& film, Canvas& canvas) {
    for (std::size_t j = 0; j < film.height(); ++j)
        for (std::size_t i = 0; i < film.width(); ++i) {
            const Film::RGBA& c = film.pixel(i, j);
            const Vec3d light{c.r, c.g, c.b};
            canvas.set(int(i), int(j), light + (1 - double(c.a)) * kWhite);
        }
}

std::string render(const SurfaceRays& rays, const Field& field, const std::vector<Path>& paths,
                   const PictureOptions& options, Progress& progress) {
    const double dx = rays.transform().dx;
    const Scale scale(field, dx, options);
    const Legend legend(scale, field, dx, options);
    const int width = options.width - legend.taken();

    progress.update("picture", 0);
    const View view = chooseView(rays, field, paths, options, double(options.height) / width);
    const double pixel = 2 * View::kHalfWidth * view.depth / width / dx;
    const Scene scene(field, paths, scale, rays, view, pixel, options.width);
    Film film{std::size_t(width), std::size_t(options.height)};
    Renderer(rays, view, scene, film, progress).render();

    Canvas canvas(options.width, options.height);
    canvas.fill(0, 0, options.width, options.height, kWhite);
    develop(film, canvas);
    legend.draw(canvas);
    return canvas.png();
}

}  // namespace

std::string renderPng(const LevelSet& levelSet, const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options, Progress& progress) {
    checkOptions(options);
    return render(LevelSetRays(levelSet), field, paths, options, progress);
}

std::string renderPng(const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options, Progress& progress) {
    checkOptions(options);
    require(field.band->triangles != nullptr, "the field lies on no mesh",
            "give its level set as well");
    return render(TriangleRays(*field.band), field, paths, options, progress);
}

}  // namespace igeo
