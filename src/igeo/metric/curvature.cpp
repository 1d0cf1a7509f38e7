#include <igeo/metric/curvature.h>

#include <fmt/core.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/symmetric_eigen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// The least-squares weights are (1 - r^2 / reach^2)^2, with standard deviation reach / sqrt(8)
/// along a tangent: as accurate as a Gaussian, with bounded support.
const double kReachPerScale = std::sqrt(8.0);
constexpr double kLeastScale = 1, kLargestScale = 16;

/// Curvature at one foot point.
struct Bend {
    float k1 = 0, k2 = 0;
    Vec3f direction1;
};

/// Least squares for n = c + W y + Q(y) in the tangent plane.
class WeingartenFit {
public:
    explicit WeingartenFit(double reach) : reach_(reach) {}

    /// @param y, n  position and normal, in the plane
    void add(Vec2f y, Vec2f n, double w) {
        const double u = double(y.x) / reach_, v = double(y.y) / reach_;
        const std::array<double, kTerms> basis{1, u, v, u * u, u * v, v * v};
        for (std::size_t a = 0; a < kTerms; ++a) {
            const double wa = w * basis[a];
            for (std::size_t b = 0; b <= a; ++b) matrix_[a][b] += wa * basis[b];
            right_[a][0] += wa * double(n.x);
            right_[a][1] += wa * double(n.y);
        }
    }

    /// W = (xx, xy, yy), made symmetric.
    std::array<double, 3> solve() {
        // Terms that the points hardly determine come out small; the others lose 1e-4 of their
        // value.
        constexpr double kRidge = 1e-5;
        const double ridge = kRidge * matrix_[0][0];
        for (std::size_t a = 0; a < kTerms; ++a) matrix_[a][a] += ridge;
        factorize();
        // Back substitution down to the linear terms.
        std::array<std::array<double, 2>, kTerms> c{};
        for (std::size_t a = kTerms; a-- > 1;)
            for (std::size_t r = 0; r < 2; ++r) {
                double sum = right_[a][r];
                for (std::size_t b = a + 1; b < kTerms; ++b) sum -= matrix_[b][a] * c[b][r];
                c[a][r] = sum / matrix_[a][a];
            }
        return {c[1][0] / reach_, (c[1][1] + c[2][0]) / (2 * reach_), c[2][1] / reach_};
    }

private:
    static constexpr std::size_t kTerms = 6;

    /// Cholesky; the right sides are transformed along with it.
    void factorize() {
        for (std::size_t a = 0; a < kTerms; ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
                double sum = matrix_[a][b];
                for (std::size_t k = 0; k < b; ++k) sum -= matrix_[a][k] * matrix_[b][k];
                matrix_[a][b] = a == b ? std::sqrt(sum) : sum / matrix_[b][b];
            }
            for (std::size_t r = 0; r < 2; ++r) {
                for (std::size_t k = 0; k < a; ++k) right_[a][r] -= matrix_[a][k] * right_[k][r];
                right_[a][r] /= matrix_[a][a];
            }
        }
    }

    double reach_;
    std::array<std::array<double, kTerms>, kTerms> matrix_{};  ///< lower half
    std::array<std::array<double, 2>, kTerms> right_{};
};

/// Whether neighbors with foot points `chord` apart are on different sheets: their normals are
/// opposite, or both are along a chord longer than neighbors of one sheet have (sqrt(3), with a
/// margin), as where psi bends in a gap.
bool onOtherSheet(const Vec3f& chord, const Vec3f& a, const Vec3f& b) {
    constexpr float kFar2 = 3.2f, kAlong2 = 0.25f;
    if (dot(a, b) < Band::kOtherSheet) return true;
    const float c2 = dot(chord, chord), alongA = dot(a, chord), alongB = dot(b, chord);
    return c2 > kFar2 && std::min(alongA * alongA, alongB * alongB) > kAlong2 * c2;
}

/// Curvature at the core's foot points.
class CoreCurvature {
public:
    CoreCurvature(const Band& band, double scale);
    void compute(Progress& progress);
    const Bend& at(NodeIndex core) const { return bend_[core]; }
    /// At the foot point of a band node outside the core.
    /// @param l, at  its leaf and offset
    Bend extendTo(NodeIndex i, LeafIndex l, unsigned at) const;

private:
    struct Node {
        Vec3f foot, normal;
        Ijk ijk;
        std::size_t links = 0;  ///< index of its first neighbor in links_
    };
    /// A walk around a foot point. One per thread, reused.
    struct Walk {
        struct Stop {
            NodeIndex node;
            Vec3f chord;  ///< from the foot point in the middle
        };
        std::vector<Stop> stops;
        /// Per voxel of a box: number of the last walk that visited it
        std::vector<std::uint32_t> seen;
        std::uint32_t number = 0;
    };

    void link();
    template <typename Visit>
    void forLinks(const Visit& visit) const;
    void walkAround(NodeIndex i, Walk& walk) const;
    Bend solve(NodeIndex i, Walk& walk) const;
    Bend nearestTo(NodeIndex i, LeafIndex l, unsigned at) const;

    const Band& band_;
    double reach_;            ///< of a walk, voxels
    int half_;                ///< half the size of its box, voxels
    std::vector<Node> core_;  ///< by core number; one more at the end, for the end of the links
    std::vector<NodeIndex> links_;  ///< core neighbors on the same sheet
    std::vector<Bend> bend_;        ///< by core number
};

CoreCurvature::CoreCurvature(const Band& band, double scale)
    : band_(band),
      reach_(kReachPerScale * scale),
      half_(int(reach_) +
            4),  // Foot points are up to a voxel off, and a step may pass beyond reach.
      core_(band.coreSize() + 1),
      bend_(band.coreSize()) {
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            const NodeIndex c = band.coreNode(i);
            if (c != kNoNode) core_[c] = {band.footOf(i), band.normal[k], band.ijk(i), 0};
        }
    });
    link();
}

template <typename Visit>
void CoreCurvature::forLinks(const Visit& visit) const {
    parallelFor(band_.leaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            for (unsigned at = 0; at < 512; ++at) {
                const NodeIndex i = band_.leaves[l].core.node(at);
                if (i == kNoNode) continue;
                const Node& node = core_[i];
                const std::uint32_t severed = band_.severedSteps(band_.leaves[l].band.numberOf(at));
                band_.forNeighbors(
                    &BandLeaf::core, LeafIndex(l), at, [&](NodeIndex j, int dx, int dy, int dz) {
                        const Vec3f chord =
                            core_[j].foot - node.foot + Vec3f{float(dx), float(dy), float(dz)};
                        if (!(severed & SeveredLinks::bit(dx, dy, dz)) &&
                            !onOtherSheet(chord, node.normal, core_[j].normal))
                            visit(i, j);
                    });
            }
    });
}

void CoreCurvature::link() {
    forLinks([&](NodeIndex i, NodeIndex) { ++core_[i].links; });
    std::size_t count = 0;
    for (Node& node : core_) count += node.links, node.links = count;
    links_.resize(count);
    // Filled from the back, so that `links` ends at the beginning.
    forLinks([&](NodeIndex i, NodeIndex j) { links_[--core_[i].links] = j; });
}

void CoreCurvature::walkAround(NodeIndex i, Walk& walk) const {
    const int width = 2 * half_ + 1;
    const auto reach2 = float(reach_ * reach_);
    if (++walk.number == 1) walk.seen.assign(std::size_t(width * width * width), 0);
    const Node& middle = core_[i];
    // Whether a node was visited before; nodes outside the box count as visited.
    auto meet = [&](const Ijk& step) {
        const int x = step.x + half_, y = step.y + half_, z = step.z + half_;
        if (std::min({x, y, z}) < 0 || std::max({x, y, z}) >= width) return true;
        std::uint32_t& seen = walk.seen[std::size_t((x * width + y) * width + z)];
        return std::exchange(seen, walk.number) == walk.number;
    };
    meet({});
    walk.stops.assign(1, {i, {}});
    for (std::size_t k = 0; k < walk.stops.size(); ++k) {
        const NodeIndex from = walk.stops[k].node;
        for (std::size_t at = core_[from].links; at < core_[from + 1].links; ++at) {
            const Node& next = core_[links_[at]];
            const Ijk step = next.ijk - middle.ijk;
            if (meet(step)) continue;
            const Vec3f chord = Vec3f(step) + next.foot - middle.foot;
            if (dot(chord, chord) < reach2 && dot(middle.normal, next.normal) >= Band::kOtherSheet)
                walk.stops.push_back({links_[at], chord});
        }
    }
}

Bend CoreCurvature::solve(NodeIndex i, Walk& walk) const {
    walkAround(i, walk);
    const TangentFrame frame(core_[i].normal);
    const double reach2 = reach_ * reach_;
    WeingartenFit fit(reach_);
    for (const Walk::Stop& stop : walk.stops) {
        const double left = 1 - double(dot(stop.chord, stop.chord)) / reach2;
        fit.add(frame.flat(stop.chord), frame.flat(core_[stop.node].normal), left * left);
    }
    const auto [xx, xy, yy] = fit.solve();
    const SymmetricEigen2 e = symmetricEigen(xx, xy, yy);
    const Vec3f d =
        e.radius > 0 ? normalized(frame.lift({float(e.x), float(e.y)})) : frame.lift({1, 0});
    return {float(e.largest()), float(e.least()), d};
}

void CoreCurvature::compute(Progress& progress) {
    Steps steps(progress, "curvature", bend_.size());
    parallelFor(bend_.size(), 256, progress, [&](std::size_t begin, std::size_t end) {
        Walk walk;
        for (std::size_t i = begin; i < end; ++i) bend_[i] = solve(NodeIndex(i), walk);
        steps.add(end - begin);
    });
}

Bend CoreCurvature::extendTo(NodeIndex i, LeafIndex l, unsigned at) const {
    constexpr float kFlat = 0.8f;
    const Vec3f n = band_.normal[i];
    Bend sum;
    float total = 0;
    band_.forCornersOfFoot(&BandLeaf::core, i, l, at, [&](NodeIndex j, float w, const Vec3f&) {
        if (dot(n, core_[j].normal) < kFlat) return;
        const Bend& b = bend_[j];
        sum.k1 += w * b.k1, sum.k2 += w * b.k2;
        // A direction and its opposite are one.
        sum.direction1 += (dot(sum.direction1, b.direction1) < 0 ? -w : w) * b.direction1;
        total += w;
    });
    if (total == 0) sum = nearestTo(i, l, at), total = 1;
    const Vec3f d = normalized(tangential(sum.direction1, n));
    return {sum.k1 / total, sum.k2 / total, d == Vec3f{} ? TangentFrame(n).lift({1, 0}) : d};
}

Bend CoreCurvature::nearestTo(NodeIndex i, LeafIndex l, unsigned at) const {
    // The core passes within two voxels of a voxel of the band or of its foot point.
    constexpr int kFar = 2;
    const Vec3f foot = band_.footOf(i);
    for (const Ijk& middle : {roundToIjk(Vec3d(foot)), Ijk{}}) {
        Bend nearest;
        float least = float(kInfinity);
        band_.forBox(&BandLeaf::core, l, at, middle, kFar, [&](NodeIndex j, const Ijk& step) {
            if (dot(band_.normal[i], core_[j].normal) < Band::kOtherSheet ||
                !band_.joined(i, band_.neighbor(i, step)))
                return;
            const Vec3f chord = Vec3f(step) + core_[j].foot - foot;
            const float c2 = dot(chord, chord);
            if (c2 < least) least = c2, nearest = bend_[j];
        });
        if (least < float(kInfinity)) return nearest;
    }
    return {};
}

/// The quantity that a kind of weight grows with, in units of kCurvatureUnit.
float measure(const Curvature& c, CurvatureKind kind, std::size_t k) {
    constexpr auto kUnit = float(kCurvatureUnit);
    const float k1 = kUnit * c.k1[k], k2 = kUnit * c.k2[k];
    switch (kind) {
        case CurvatureKind::Valley:
            return k1 + k2;
        case CurvatureKind::Crest:
            return -(k1 + k2);
        case CurvatureKind::Mean:
            return std::abs(k1 + k2);
        case CurvatureKind::Gaussian:
            return std::abs(k1 * k2);
        case CurvatureKind::Principal:
            break;
    }
    return std::max(std::abs(k1), std::abs(k2));
}

/// The value below which a share kLeastShare of all values lies; 0 if there are none.
float robustLeast(std::vector<float> values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + std::ptrdiff_t(kLeastShare * double(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

Curvature curvature(const Band& band, double scale, Progress& progress) {
    if (!(scale >= kLeastScale && scale <= kLargestScale))
        throw Error(
            Error::Kind::InvalidArgument,
            fmt::format("a curvature scale of {:g} voxels is out of range: 1 to 16 are allowed",
                        scale),
            "take coarser voxels for a larger scale");
    CoreCurvature core(band, scale);
    core.compute(progress);
    Curvature c;
    c.k1.resize(band.size());
    c.k2.resize(band.size());
    c.direction1.resize(band.size());
    parallelFor(band.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto i = NodeIndex(k);
            const auto [l, at] = band.placeOf(i);
            const NodeIndex inCore = band.leaves[l].core.node(at);
            const Bend b = inCore == kNoNode ? core.extendTo(i, l, at) : core.at(inCore);
            c.k1[k] = b.k1, c.k2[k] = b.k2, c.direction1[k] = b.direction1;
        }
    });
    return c;
}

double shareOfWideFacets(const TriangleMesh& mesh, double dx, double scale) {
    constexpr double kLeastCosine = 0.6, kMostCosine = 0.99985;  // 53 and 1 degrees
    const double widest = kWidestFacetPerScale * scale * dx;
    const auto corner = [&](std::size_t t, std::size_t k) {
        return mesh.points[mesh.triangles[t][k % 3]];
    };
    const auto twiceArea = [&](std::size_t t) {
        return cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    };
    const MeshTopology topology = meshTopology(mesh);
    double wide = 0, all = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d here = twiceArea(t);
        bool isWide = false;
        for (std::size_t k = 0; k < 3 && !isWide; ++k) {
            const std::uint32_t beyond = topology.neighbor[t][k];
            const double edge = length(corner(t, k + 1) - corner(t, k));
            if (beyond >= MeshTopology::kMany || length(here) <= widest * edge) continue;
            const Vec3d there = twiceArea(beyond);
            const double cosine = dot(normalized(here), normalized(there));
            isWide = length(there) > widest * edge && cosine > kLeastCosine && cosine < kMostCosine;
        }
        all += length(here);
        if (isWide) wide += length(here);
    }
    return all > 0 ? wide / all : 0;
}

std::string wideFacetWarning(const TriangleMesh& mesh, double dx, double scale) {
    constexpr double kLeast = 0.01;
    const double share = shareOfWideFacets(mesh, dx, scale);
    if (share < kLeast) return {};
    return fmt::format(
        "on {} of the surface the facets of the mesh are wider than {:g} voxels, {:g} times the "
        "scale of curvature: the curvature of the surface that they stand for is not seen, and "
        "costs from it may be off by 5 to 50 %; use a finer mesh, larger voxels, or a larger scale",
        percent(share), kWidestFacetPerScale * scale, kWidestFacetPerScale);
}

std::vector<float> curvatureWeights(const Curvature& curvature, CurvatureKind kind, double epsilon,
                                    double power) {
    if (!(epsilon > 0 && epsilon < kInfinity && power > 0 && power < kInfinity))
        throw Error(Kind::InvalidArgument,
                    fmt::format("curvature weights need a positive, finite epsilon and power, not "
                                "{:g} and {:g}",
                                epsilon, power));
    std::vector<float> weight(curvature.k1.size());
    for (std::size_t k = 0; k < weight.size(); ++k) weight[k] = measure(curvature, kind, k);
    const bool fromLeast = kind == CurvatureKind::Valley || kind == CurvatureKind::Crest;
    const float least = fromLeast ? robustLeast(weight) : 0;
    for (float& w : weight) {
        const double g = epsilon + std::pow(std::max(double(w) - least, 0.0), power);
        w = float(g);
        if (!(g >= std::numeric_limits<float>::min() && g <= std::numeric_limits<float>::max()))
            throw Error(Kind::InvalidArgument,
                        fmt::format("a curvature weight of {:g} does not fit a float", g),
                        "lower the power, or choose an epsilon nearer to 1");
    }
    return weight;
}

std::vector<Tensor> curvatureTensor(const Band& band, const Curvature& curvature, Bending bending,
                                    double length) {
    if (!(length >= 0 && length < kInfinity))
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("a bending length of {:g} is not finite and >= 0", length));
    std::vector<Tensor> tensor(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            auto squared = [&](float k) {
                const double x = std::min(length * std::abs(double(k)), kMostBending);
                return float(x * x);
            };
            float a = squared(curvature.k1[i]), b = squared(curvature.k2[i]);
            if (bending == Bending::Prefer) std::swap(a, b);
            const Vec3f e = curvature.direction1[i], f = cross(band.normal[i], e);
            tensor[i] = {1 + a * e.x * e.x + b * f.x * f.x, 1 + a * e.y * e.y + b * f.y * f.y,
                         1 + a * e.z * e.z + b * f.z * f.z, a * e.x * e.y + b * f.x * f.y,
                         a * e.x * e.z + b * f.x * f.z,     a * e.y * e.z + b * f.y * f.z};
        }
    });
    return tensor;
}

}  // namespace igeo
