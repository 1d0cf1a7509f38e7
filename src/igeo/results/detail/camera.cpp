#include <igeo/results/detail/camera.h>

#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <array>
#include <numbers>

namespace igeo {

namespace {

/// The maximum of each of N functions over a surface; values(pWorld) returns an array of them.
template <std::size_t N, typename Values>
std::array<double, N> largest(const DrawnSurface& surface, const Values& values) {
    constexpr std::size_t kChunk = 4096;
    const std::vector<Vec3d>& points = surface.triangles().points();
    std::array<double, N> none;
    none.fill(-kInfinity);
    std::vector<std::array<double, N>> parts((points.size() + kChunk - 1) / kChunk, none);
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            for (std::size_t i = c * kChunk; i < std::min(points.size(), (c + 1) * kChunk); ++i) {
                const auto v = values(surface.transform().worldFromIndex(points[i]));
                for (std::size_t k = 0; k < N; ++k) parts[c][k] = std::max(parts[c][k], v[k]);
            }
    });
    for (const auto& part : parts)
        for (std::size_t k = 0; k < N; ++k) none[k] = std::max(none[k], part[k]);
    return none;
}

/// A point that the picture should show.
struct Sight {
    Vec3d pIndex, normal;
    double weight;
};

/// About `most` foot points all over the band, less where it is not reached.
std::vector<Vec3d> reachedPoints(const Field& field, std::size_t most) {
    const Band& band = *field.band;
    const std::size_t stride = std::max<std::size_t>(band.size() / most, 1);
    const bool all = field.reached == field.size();
    std::vector<Vec3d> reached;
    for (std::size_t i = 0; i < band.size(); i += stride)
        if (all || field.at(NodeIndex(i)).distance < kInfinity)
            reached.push_back(band.footPoint(NodeIndex(i)));
    return reached;
}

/// Seeds, paths and the reached surface; paths have the largest weight.
std::vector<Sight> sights(const DrawnSurface& surface, const Field& field,
                          const std::vector<Path>& paths) {
    constexpr std::size_t kMost = 128;  // of each kind
    std::vector<Vec3d> seeds, vertices;
    for (const SurfacePoint& s : field.seeds) seeds.push_back(s.pIndex);
    for (const Path& path : paths)
        for (const PathVertex& v : path.vertices) vertices.push_back(v.pIndex);
    const std::vector<Vec3d> reached = reachedPoints(field, 8 * kMost);
    std::vector<Sight> all;
    auto add = [&](const std::vector<Vec3d>& points, double weight) {
        const std::size_t n = std::min(points.size(), kMost);
        for (std::size_t k = 0; k < n; ++k) {
            const Vec3d& p = points[k * points.size() / n];
            all.push_back({p, surface.normalNear(p), weight / double(n)});
        }
    };
    add(seeds, 1);
    add(vertices, 2);
    add(reached, 1);
    return all;
}

/// Axes of a camera that looks along -back.
void aim(View& view, const Vec3d& back, const Vec3d& up) {
    view.back = normalized(back);
    view.right = normalized(cross(up, view.back));
    view.up = cross(view.back, view.right);
}

/// Directions to an eye, in order of preference: around the object from slightly above, from high
/// above, then from below. The front is +z if up is y (Houdini), -y if up is z.
std::vector<Vec3d> eyeDirections(const Vec3d& up) {
    const Vec3d sideways = std::abs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d right = normalized(tangential(sideways, up)), front = cross(right, up);
    std::vector<Vec3d> all;
    auto add = [&](double azimuth, double elevation) {
        const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
        all.push_back(std::cos(e) * (std::sin(a) * right + std::cos(a) * front) + std::sin(e) * up);
    };
    for (const double elevation : {30, 60, -30})
        for (const double azimuth : {-45, 45, 0, -90, 90, -135, 135, 180}) {
            add(azimuth, elevation);
        }
    add(0, 85);
    add(0, -85);
    return all;
}

/// How well directions to the eye show the sights. A direction is looked along only once its bound
/// does not decide.
class Scores {
public:
    Scores(const DrawnSurface& surface, const std::vector<Sight>& seen,
           const std::vector<Vec3d>& directions)
        : surface_(surface), seen_(seen) {
        for (const Vec3d& world : directions) {
            Direction d{surface.transform().indexFromWorldDirection(world)};
            for (const Sight& s : seen)
                if (surface.mayBeVisible(s.normal, d.toEye)) d.score += worth(s, d.toEye);
            all_.push_back(d);
        }
    }
    /// The first direction that is almost as good as the best.
    std::size_t choose() {
        constexpr double kAlmost = 0.9;
        const auto lower = [](const Direction& a, const Direction& b) { return a.score < b.score; };
        auto best = std::max_element(all_.begin(), all_.end(), lower);
        while (!best->looked) {
            look(*best);
            best = std::max_element(all_.begin(), all_.end(), lower);
        }
        const double enough = kAlmost * best->score;
        std::size_t k = 0;
        while (all_[k].score < enough || (!all_[k].looked && look(all_[k]) < enough)) ++k;
        return k;
    }

private:
    struct Direction {
        Vec3d toEye;       ///< index space
        double score = 0;  ///< a bound until it was looked along
        bool looked = false;
    };
    static double worth(const Sight& s, const Vec3d& toEye) {
        constexpr double kOpenEnough = 0.4;  // cosine above which a point is fully visible
        return s.weight * std::min(std::abs(dot(s.normal, toEye)) / kOpenEnough, 1.0);
    }
    double look(Direction& d) const {
        std::vector<std::uint8_t> visible(seen_.size());
        parallelFor(seen_.size(), 32, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                visible[i] = surface_.isVisible(seen_[i].pIndex, seen_[i].normal, d.toEye);
        });
        d.score = 0;
        d.looked = true;
        for (std::size_t i = 0; i < seen_.size(); ++i)
            if (visible[i]) d.score += worth(seen_[i], d.toEye);
        return d.score;
    }

    const DrawnSurface& surface_;
    const std::vector<Sight>& seen_;
    std::vector<Direction> all_;
};

/// Chooses the direction to the eye, world space.
Vec3d chooseDirection(const DrawnSurface& surface, const std::vector<Sight>& seen,
                      const Vec3d& up) {
    const std::vector<Vec3d> directions = eyeDirections(up);
    return directions[Scores(surface, seen, directions).choose()];
}

}  // namespace

View chooseView(const DrawnSurface& surface, const Field& field, const std::vector<Path>& paths,
                const PictureOptions& options, double aspect) {
    constexpr double kMargin = 1.06;
    const auto box = largest<6>(surface, [](const Vec3d& p) {
        return std::array<double, 6>{p.x, p.y, p.z, -p.x, -p.y, -p.z};
    });
    const Vec3d middle = 0.5 * Vec3d{box[0] - box[3], box[1] - box[4], box[2] - box[5]};
    const Vec3d target = options.lookAt.value_or(middle);
    const Vec3d up = normalized(options.up);

    View view;
    if (options.eye) {
        view.eye = *options.eye;
        const Vec3d back = view.eye - target;
        if (!(length(back) > 1e-6 * surface.transform().dx))
            throw Error(Error::Kind::InvalidArgument,
                        fmt::format("the camera at {} looks at itself", textOf(view.eye)),
                        "give it another place or another point to look at");
        if (!(length(cross(up, normalized(back))) > 1e-6))
            throw Error(
                Error::Kind::InvalidArgument,
                fmt::format("the camera looks along its up direction, {}", textOf(options.up)),
                "choose another up direction");
        if (surface.encloses(surface.transform().indexFromWorld(view.eye)))
            throw Error(
                Error::Kind::InvalidArgument,
                fmt::format("the camera at {} is inside the surface", textOf(view.eye)),
                fmt::format("move it out; the middle of the surface is {}", textOf(middle)));
        aim(view, back, up);
    } else {
        aim(view, chooseDirection(surface, sights(surface, field, paths), up), up);
        // A point at (a, b, c) from the target along right, up and back is in the frame of an eye
        // at (x, y, depth) if |a - x| <= T (depth - c) and the same of b.
        const double tx = View::kHalfWidth / kMargin, ty = tx * aspect;
        const auto need = largest<4>(surface, [&](const Vec3d& p) {
            const Vec3d r = p - target;
            const double a = dot(r, view.right), b = dot(r, view.up), c = dot(r, view.back);
            return std::array<double, 4>{a + tx * c, -a + tx * c, b + ty * c, -b + ty * c};
        });
        double x = 0, y = 0, depth;
        if (options.lookAt) {
            depth = std::max(std::max(need[0], need[1]) / tx, std::max(need[2], need[3]) / ty);
        } else {
            x = (need[0] - need[1]) / 2;
            y = (need[2] - need[3]) / 2;
            depth = std::max((need[0] + need[1]) / (2 * tx), (need[2] + need[3]) / (2 * ty));
        }
        view.eye = target + x * view.right + y * view.up + depth * view.back;
    }
    view.depth = std::max(dot(view.eye - middle, view.back), 1e-3 * length(view.eye - middle));
    return view;
}

}  // namespace igeo
