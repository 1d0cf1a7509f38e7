#include <igeo/surface/detail/wall_links.h>

#include <igeo/base/parallel.h>
#include <igeo/surface/detail/leaf_block.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>

namespace igeo {

namespace {
double env(const char* n, double d) { const char* v = std::getenv(n); return v ? std::atof(v) : d; }
const double kSlack = env("W_SLACK", 0.3), kDeep = env("W_DEEP", 0.1), kStep = env("W_STEP", 0.35), kOff = env("W_OFF", 0.5);

/// psi between voxels, in voxels; NaN beside inactive ones.
class PsiBetween {
public:
    PsiBetween(const LevelSet& levelSet)
        : psi_(levelSet.psi->constTree()), perDx_(1 / levelSet.transform.dx) {}
    double at(const Vec3d& p) {
        const Ijk low = floorToIjk(p);
        const Vec3d t = p - Vec3d(low);
        double sum = 0;
        for (int k = 0; k < 8; ++k) {
            const int a = k >> 2, b = k >> 1 & 1, c = k & 1;
            float v;
            if (!psi_.probeValue({low.x + a, low.y + b, low.z + c}, v))
                return std::numeric_limits<double>::quiet_NaN();
            sum += (a ? t.x : 1 - t.x) * (b ? t.y : 1 - t.y) * (c ? t.z : 1 - t.z) * double(v);
        }
        return perDx_ * sum;
    }
private:
    LeafBlock::Accessor psi_;
    double perDx_;
};

bool throughWall(PsiBetween& psi, const Vec3d& from, const Vec3f& d, const Vec3f& a, const Vec3f& b) {
    const Vec3d chord(d), m = normalized(Vec3d(a) + Vec3d(b));
    const double alongA = dot(Vec3d(a), chord), alongB = dot(Vec3d(b), chord), cosine = dot(m, Vec3d(a));
    const double len = length(chord);
    const int n = int(std::ceil(len / kStep));
    const double offA = std::abs(psi.at(from)), offB = std::abs(psi.at(from + chord));
    for (int k = 1; k < n; ++k) {
        const double t = double(k) / n;
        const Vec3d q = from + t * chord;
        const double v = psi.at(q);
        if (!(std::abs(v) > kDeep)) continue;
        const double side = v < 0 ? 1 : -1;
        // Heights of the planes over q along the mean normal, on that side.
        const double rise = std::max(0.0, std::min(-side * t * alongA, side * (1 - t) * alongB));
        const double reach = rise / cosine + kSlack + std::min(kOff, (1 - t) * offA + t * offB);
        bool out = false;
        for (int s = 1; s <= 2 && !out; ++s) {
            const double w = psi.at(q + (side * reach * s / 2) * m);
            out = !(-side * w > kDeep);
        }
        if (!out) return true;
    }
    return false;
}

}  // namespace

std::vector<Link> linksThroughWalls(const Band& band, const LevelSet& levelSet,
                                    const std::vector<std::vector<NodeIndex>>& kinks) {
    std::vector<std::uint8_t> beside(band.size());
    parallelFor(kinks.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            for (const NodeIndex i : kinks[l]) {
                auto mark = [&](NodeIndex j) { std::atomic_ref(beside[j]).store(1, std::memory_order_relaxed); };
                mark(i);
                band.forNeighbors(&BandLeaf::band, band.leaf[i], band.offset[i], [&](NodeIndex j, int, int, int) { mark(j); });
            }
    });
    std::vector<std::vector<Link>> found(band.leaves.size());
    std::atomic<std::size_t> tested{0};
    parallelFor(found.size(), 16, [&](std::size_t begin, std::size_t end) {
        PsiBetween psi(levelSet);
        std::size_t n = 0;
        for (std::size_t l = begin; l < end; ++l) {
            const LeafNodes& nodes = band.leaves[l].band;
            for (NodeIndex i = nodes.firstNode; i < nodes.firstNode + nodes.count; ++i) {
                if (!beside[i]) continue;
                band.forNeighbors(&BandLeaf::band, LeafIndex(l), band.offset[i], [&](NodeIndex j, int dx, int dy, int dz) {
                    if (j < i || !beside[j]) return;
                    if (dot(band.normal[i], band.normal[j]) < Band::kOtherSheet) return;
                    const Vec3f chord = Vec3f(Ijk{dx, dy, dz}) + band.foot[j] - band.foot[i];
                    ++n;
                    if (throughWall(psi, band.footPoint(i), chord, band.normal[i], band.normal[j]))
                        found[l].emplace_back(i, j);
                });
            }
        }
        tested += n;
    });
    std::vector<Link> links;
    for (const auto& part : found) links.insert(links.end(), part.begin(), part.end());
    if (std::getenv("W_SAY")) std::printf("(nodes %zu tested %zu severed %zu) ", band.size(), tested.load(), links.size());
    return links;
}

}  // namespace igeo
