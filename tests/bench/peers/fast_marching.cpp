#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <queue>
#include <utility>

#include "bench/extracted_mesh.h"
#include "peer.h"

namespace igeo::test {
namespace {

using Vertex = std::uint32_t;
using Point = std::complex<double>;  // in the plane of a triangle, its vertex at the origin

constexpr double kStartEdges = 3.5;  // as many mean edges as `jet` and `godunov` start with voxels

double dot(Point p, Point q) { return (p * std::conj(q)).real(); }

/// What a vertex is updated from: two others, by their scalar products as seen from it.
struct Wedge {
    Vertex at, a, b;
    double aa, ab, bb;

    /// From plane waves through a and b; infinity where they do not come from between them.
    double update(double da, double db) const {
        const double det = aa * bb - ab * ab;
        if (!(det > 0)) return kInfinity;
        const double u = db - da, qa = bb - ab, qb = aa - ab, q = qa + qb;
        const double discriminant = q * det - det * u * u;
        if (!(q > 0) || discriminant < 0) return kInfinity;
        const double rise = (qb * u + std::sqrt(discriminant)) / q;  // above da
        const bool between = bb * rise > ab * (rise - u) && aa * (rise - u) > ab * rise;
        return between ? da + rise : kInfinity;
    }
};

/// Kimmel and Sethian 1998, corners of more than 90 degrees split by unfolding. The wedges serve
/// all seeds.
class FastMarching : public Peer {
public:
    explicit FastMarching(const TriangleMesh& mesh)
        : mesh_(mesh),
          startRadius_(kStartEdges * meanEdge(mesh)),
          neighbor_(meshTopology(mesh).neighbor) {
        wedges_.reserve(4 * mesh.triangles.size());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) addCorner(t, k);
        neighbor_ = {};
        listUses();
    }

    std::vector<double> distances(std::size_t seed) override {
        std::vector<double> distance(mesh_.points.size(), kInfinity);
        std::vector<bool> accepted(distance.size());
        Trials trials;
        startAt(Vertex(seed), distance, trials);
        while (!trials.empty()) {
            const Vertex v = trials.top().second;
            trials.pop();
            if (accepted[v]) continue;
            accepted[v] = true;
            for (std::size_t k = firstUse_[v]; k < firstUse_[v + 1]; ++k) {
                const Wedge& w = wedges_[uses_[k]];
                if (accepted[w.at]) continue;
                double d = distance[v] + std::sqrt(v == w.a ? w.aa : w.bb);
                if (accepted[w.a] && accepted[w.b])
                    d = std::min(d, w.update(distance[w.a], distance[w.b]));
                if (d < distance[w.at]) trials.emplace(distance[w.at] = d, w.at);
            }
        }
        return distance;
    }

private:
    using Index = std::uint32_t;
    using Trial = std::pair<double, Vertex>;
    using Trials = std::priority_queue<Trial, std::vector<Trial>, std::greater<>>;

    /// Straight lines to what is near, as plane waves are wrong there.
    void startAt(Vertex seed, std::vector<double>& distance, Trials& trials) const {
        std::vector<Vertex> reached{seed};
        distance[seed] = 0;
        for (std::size_t r = 0; r < reached.size(); ++r) {
            const Vertex v = reached[r];
            trials.emplace(distance[v], v);
            for (std::size_t k = firstUse_[v]; k < firstUse_[v + 1]; ++k) {
                const Vertex next = wedges_[uses_[k]].at;
                const double d = length(at(next) - at(seed));
                if (d < startRadius_ && !(distance[next] < kInfinity))
                    distance[next] = d, reached.push_back(next);
            }
        }
    }

    const Vec3d& at(Vertex v) const { return mesh_.points[v]; }

    Index beyond(Index t, Vertex p, Vertex q) const {
        const auto& corners = mesh_.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const Vertex from = corners[k], to = corners[(k + 1) % 3];
            if ((from == p && to == q) || (from == q && to == p)) return neighbor_[t][k];
        }
        return MeshTopology::kNone;
    }
    Vertex third(Index t, Vertex p, Vertex q) const {
        for (const Vertex v : mesh_.triangles[t])
            if (v != p && v != q) return v;
        return p;
    }

    void addCorner(std::size_t t, std::size_t k) {
        const auto& corners = mesh_.triangles[t];
        const Vertex v = corners[k], a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
        const Vec3d toA = at(a) - at(v), toB = at(b) - at(v);
        const double size = length(toA);
        if (!(size > 0)) return;
        const Point pa = size, pb{igeo::dot(toA, toB) / size, length(cross(toA, toB)) / size};
        if (dot(pa, pb) < 0 && split(Index(t), v, a, b, pa, pb)) return;
        add(v, a, b, pa, pb);
    }
    void add(Vertex v, Vertex a, Vertex b, Point pa, Point pb) {
        wedges_.push_back({v, a, b, std::norm(pa), dot(pa, pb), std::norm(pb)});
    }

    /// Unfolds triangles beyond a and b until a vertex makes two corners of less than 90 degrees.
    bool split(Index t, Vertex v, Vertex a, Vertex b, Point pa, Point pb) {
        constexpr int kMost = 10;
        Vertex p = a, q = b;
        Point atP = pa, atQ = pb;
        for (int k = 0; k < kMost; ++k) {
            t = beyond(t, p, q);
            if (t >= MeshTopology::kMany) return false;
            const Vertex c = third(t, p, q);
            const Vec3d edge = at(q) - at(p), side = at(c) - at(p);
            const Point turn(igeo::dot(side, edge), -length(cross(side, edge)));
            const Point atC = atP + (atQ - atP) * turn / igeo::dot(edge, edge);
            const bool fromA = dot(atC, pa) > 0, fromB = dot(atC, pb) > 0;
            if (fromA && fromB) {
                add(v, a, c, pa, atC);
                add(v, c, b, atC, pb);
                return true;
            }
            if (fromA)
                p = c, atP = atC;
            else
                q = c, atQ = atC;
        }
        return false;
    }

    void listUses() {
        firstUse_.assign(mesh_.points.size() + 1, 0);
        for (const Wedge& w : wedges_) ++firstUse_[w.a + 1], ++firstUse_[w.b + 1];
        for (std::size_t v = 0; v + 1 < firstUse_.size(); ++v) firstUse_[v + 1] += firstUse_[v];
        std::vector<Index> next(firstUse_.begin(), firstUse_.end() - 1);
        uses_.resize(2 * wedges_.size());
        for (std::size_t k = 0; k < wedges_.size(); ++k) {
            uses_[next[wedges_[k].a]++] = Index(k);
            uses_[next[wedges_[k].b]++] = Index(k);
        }
    }

    const TriangleMesh& mesh_;
    double startRadius_;
    std::vector<std::array<std::uint32_t, 3>> neighbor_;
    std::vector<Wedge> wedges_;
    std::vector<Index> firstUse_, uses_;  ///< per vertex the wedges it is in
};

}  // namespace

std::unique_ptr<Peer> fastMarching(const TriangleMesh& mesh) {
    return std::make_unique<FastMarching>(mesh);
}

}  // namespace igeo::test
