#include <igeo/band/surface_triangles.h>

#include <igeo/base/nearest_on_triangle.h>

#include <algorithm>
#include <unordered_set>

namespace igeo {

namespace {

std::pair<std::uint32_t, std::uint32_t> ends(const SurfaceTriangles::Triangle& t, unsigned corner) {
    return std::minmax(t[corner], t[(corner + 1) % 3]);
}

/// The distance along a ray to a triangle, +infinity where it misses. (T. Moeller and B. Trumbore,
/// 1997; edges belong to the triangle, with a margin for rounding, so that no ray passes between
/// two neighbors.)
double meeting(const Vec3d& from, const Vec3d& dir, const Vec3d& a, const Vec3d& ab,
               const Vec3d& ac) {
    constexpr double kRoom = 1e-9;
    const Vec3d p = cross(dir, ac), r = from - a;
    const double volume = dot(ab, p);
    if (volume == 0) return kInfinity;
    const double u = dot(r, p) / volume;
    const Vec3d q = cross(r, ab);
    const double v = dot(dir, q) / volume;
    if (!(u >= -kRoom && v >= -kRoom && u + v <= 1 + kRoom)) return kInfinity;
    return dot(ac, q) / volume;
}

}  // namespace

inline void SurfaceTriangles::Box::add(const Vec3d& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

inline void SurfaceTriangles::Box::add(const Box& box) { add(box.low), add(box.high); }

double SurfaceTriangles::Box::squaredDistance(const Vec3d& p) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
        const double d = std::max({low[a] - p[a], p[a] - high[a], 0.0});
        sum += d * d;
    }
    return sum;
}

double SurfaceTriangles::Box::entry(const Vec3d& from, const Vec3d& inverse) const {
    double enter = 0, leave = kInfinity;
    for (int a = 0; a < 3; ++a) {
        // 0 times infinity, for an origin in a face of the box, gives no bound.
        const double s = (low[a] - from[a]) * inverse[a], t = (high[a] - from[a]) * inverse[a];
        if (std::isnan(s) || std::isnan(t)) continue;
        enter = std::max(enter, std::min(s, t));
        leave = std::min(leave, std::max(s, t));
    }
    constexpr double kRoom = 1e-9;
    return enter <= leave * (1 + kRoom) + kRoom ? enter : kInfinity;
}

SurfaceTriangles::SurfaceTriangles(std::vector<Vec3d> points, std::vector<Triangle> triangles,
                                   std::vector<std::array<std::uint32_t, 3>> neighbor,
                                   std::size_t run)
    : points_(std::move(points)),
      triangles_(std::move(triangles)),
      neighbor_(std::move(neighbor)),
      run_(run) {
    for (std::uint32_t t = 0; t < neighbor_.size(); ++t)
        for (unsigned k = 0; k < 3; ++k)
            if (neighbor_[t][k] == kMany) many_.push_back({ends(triangles_[t], k), {t, k}});
    std::stable_sort(many_.begin(), many_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
}

bool SurfaceTriangles::closed() const {
    return std::all_of(neighbor_.begin(), neighbor_.end(), [](const auto& beside) {
        return std::max({beside[0], beside[1], beside[2]}) < kMany;
    });
}

unsigned SurfaceTriangles::cornerAt(std::uint32_t t, const Side& edge) const {
    const auto wanted = ends(triangles_[edge.triangle], edge.corner);
    unsigned k = 0;
    // Two triangles may share more than one edge.
    while (k < 2 && !(ends(triangles_[t], k) == wanted && neighbor_[t][k] == edge.triangle)) ++k;
    return k;
}

std::vector<SurfaceTriangles::Side> SurfaceTriangles::sidesAtManyEdge(const Side& side) const {
    const auto edge = ends(triangles_[side.triangle], side.corner);
    std::vector<Side> sides;
    for (auto it = std::lower_bound(many_.begin(), many_.end(), edge,
                                    [](const auto&a, const auto&b) { return a.first < b; });
         it != many_.end() && it->first == edge; ++it)
        sides.push_back(it->second);
    return sides;
}

const SurfaceTriangles::Tree& SurfaceTriangles::tree() const {
    // On one thread: a thread that waits for others could take another task and enter here again.
    std::call_once(treeMade_, [this] { makeTree(); });
    return tree_;
}

/// Of the triangles from the first to the last.
inline SurfaceTriangles::Box SurfaceTriangles::boxOf(std::size_t first, std::size_t last) const {
    Box box;
    for (std::size_t t = first; t <= last; ++t)
        for (unsigned c = 0; c < 3; ++c) box.add(corner(t, c));
    return box;
}

void SurfaceTriangles::makeTree() const {
    Tree& tree = tree_;
    while ((runs() >> tree.levels) >= bucket()) ++tree.levels;
    tree.order.reserve(runs());
    tree.boxes.resize((std::size_t(2) << tree.levels) - 1);
    if (run_ > kFew)
        for (std::size_t t = 0; t < size(); t += kFew)
            tree.few.push_back(boxOf(t, std::min(t + kFew, size()) - 1));
    struct Item {
        Vec3d middle;  ///< times three, of its middle triangle
        std::uint32_t run;
    };
    std::vector<Item> items(runs());
    for (std::uint32_t k = 0; k < items.size(); ++k) {
        const std::size_t t = std::min(k * run_ + run_ / 2, size() - 1);
        items[k] = {corner(t, 0) + corner(t, 1) + corner(t, 2), k};
    }
    auto at = [&](unsigned level, std::size_t k) {
        return items.begin() + std::ptrdiff_t(edge(level, k));
    };
    for (unsigned level = 0; level < tree.levels; ++level)
        for (std::size_t k = 0; k < std::size_t(1) << level; ++k) {
            Box centers;
            for (auto i = at(level, k); i != at(level, k + 1); ++i) centers.add(i->middle);
            const Vec3d size = centers.high - centers.low;
            double Vec3d::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3d::x
                                        : size.y >= size.z                   ? &Vec3d::y
                                                                             : &Vec3d::z;
            std::nth_element(at(level, k), at(level + 1, 2 * k + 1), at(level, k + 1),
                             [axis](const Item& a, const Item& b) {
                                 const double x = a.middle.*axis, y = b.middle.*axis;
                                 return x < y || (x == y && a.run < b.run);
                             });
        }
    for (std::size_t k = 0; k < std::size_t(1) << tree.levels; ++k) {
        const auto begin = at(tree.levels, k), end = at(tree.levels, k + 1);
        std::sort(begin, end, [](const Item& a, const Item& b) { return a.run < b.run; });
        Box& box = tree.boxes[(std::size_t(1) << tree.levels) - 1 + k];
        for (auto i = begin; i != end; ++i) {
            tree.order.push_back(i->run);
            const std::size_t first = i->run * run_, last = endOf(i->run) - 1;
            if (tree.few.empty()) box.add(boxOf(first, last));
            for (std::size_t f = first / kFew; f <= last / kFew && f < tree.few.size(); ++f)
                box.add(tree.few[f]);
        }
    }
    for (std::size_t b = (std::size_t(1) << tree.levels) - 1; b-- > 0;)
        for (const std::size_t half : {2 * b + 1, 2 * b + 2}) tree.boxes[b].add(tree.boxes[half]);
}

template <typename Key, typename Limit, typename Visit>
void SurfaceTriangles::forLeaves(const Key& key, const Limit& limit, const Visit& visit) const {
    const Tree& in = tree();
    struct Waiting {
        double key;
        unsigned level;
        std::size_t box;
    };
    auto boxAt = [&](unsigned level, std::size_t k) {
        return Waiting{key(in.boxes[(std::size_t(1) << level) - 1 + k]), level, k};
    };
    Waiting stack[64];
    std::size_t top = 0;
    stack[top++] = boxAt(0, 0);
    while (top > 0) {
        const Waiting w = stack[--top];
        // Boxes at equal distance are visited too: they may hold the lower triangle number.
        if (!(w.key < kInfinity) || w.key > limit()) continue;
        if (w.level < in.levels) {
            Waiting nearer = boxAt(w.level + 1, 2 * w.box),
                    farther = boxAt(w.level + 1, 2 * w.box + 1);
            if (farther.key < nearer.key) std::swap(nearer, farther);
            stack[top++] = farther;
            stack[top++] = nearer;
            continue;
        }
        for (std::size_t i = edge(w.level, w.box); i < edge(w.level, w.box + 1); ++i) {
            const std::size_t end = endOf(in.order[i]);
            for (std::size_t t = in.order[i] * run_; t < end;) {
                const std::size_t next = in.few.empty() ? end : std::min(t + kFew, end);
                const double few = in.few.empty() ? w.key : key(in.few[t / kFew]);
                for (; t < next; ++t)
                    if (few < kInfinity && !(few > limit())) visit(std::uint32_t(t));
            }
        }
    }
}

SurfaceTriangles::Place SurfaceTriangles::placeOn(std::uint32_t t, const Vec3d& p) const {
    const Vec3d q = nearestOnTriangle(p, corner(t, 0), corner(t, 1), corner(t, 2)).point;
    return {t, q, dot(q - p, q - p)};
}

SurfaceTriangles::Place SurfaceTriangles::nearest(const Vec3d& p, double within,
                                                  const Vec3d& sheetNormal) const {
    Place best, other;
    const double most = within * within;
    const bool anySheet = sheetNormal == Vec3d{};
    forLeaves([&](const Box& b) { return b.squaredDistance(p); },
              [&] { return std::min(best.squared, most); },
              [&](std::uint32_t t) {
                  const Place here = placeOn(t, p);
                  if (!(here.squared <= most)) return;
                  const bool opposes = !anySheet && dot(normal(t), sheetNormal) < kOpposed;
                  Place& of = opposes ? other : best;
                  if (here.squared < of.squared || (here.squared == of.squared && t < of.triangle))
                      of = here;
              });
    return best.triangle != kNone ? best : other;
}

bool SurfaceTriangles::any(const Vec3d& p, double within,
                           const std::function<bool(const Place&)>& is) const {
    bool found = false;
    forLeaves([&](const Box& b) { return b.squaredDistance(p); },
              [&] { return found ? -1 : within * within; },
              [&](std::uint32_t t) {
                  if (found) return;
                  const Place here = placeOn(t, p);
                  found = here.squared <= within * within && is(here);
              });
    return found;
}

bool SurfaceTriangles::joins(const Place& from, const Place& to, double radius) const {
    if (from.triangle == to.triangle) return true;
    const Vec3d middle = 0.5 * (from.point + to.point);
    std::vector<std::uint32_t> found{from.triangle};
    std::unordered_set<std::uint32_t> seen{from.triangle};
    for (std::size_t k = 0; k < found.size(); ++k)
        for (unsigned c = 0; c < 3; ++c) {
            const Vec3d a = corner(found[k], c), b = corner(found[k], c + 1);
            if (length(nearestOnTriangle(middle, a, b, a).point - middle) > radius) continue;
            bool arrived = false;
            forBeyond({found[k], c}, [&](const Side& side) {
                arrived |= side.triangle == to.triangle;
                if (seen.insert(side.triangle).second) found.push_back(side.triangle);
            });
            if (arrived) return true;
        }
    return false;
}

bool SurfaceTriangles::meets(const Vec3d& from, const Vec3d& dir) const {
    const Vec3d inverse{1 / dir.x, 1 / dir.y, 1 / dir.z};
    bool met = false;
    forLeaves([&](const Box& b) { return b.entry(from, inverse); },
              [&] { return met ? -1 : kInfinity; },
              [&](std::uint32_t t) {
                  if (met) return;
                  const Vec3d a = corner(t, 0);
                  const double along = meeting(from, dir, a, corner(t, 1) - a, corner(t, 2) - a);
                  met = along > 0 && along < kInfinity;
              });
    return met;
}

}  // namespace igeo
