#include <igeo/surface/detail/face_normal.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace igeo {

namespace {

/// How far the length of a gradient may be off 1.
constexpr float kOffUnit = 0.02f;
/// Voxels: a neighbor that is as far off the plane does not count, and one on it counts 1.
constexpr float kOffPlane = 0.015f, kPerOff2 = 1 / (kOffPlane * kOffPlane);
/// How many neighbors have to agree. On the side of a kink of psi no plane fits by chance. On the
/// round side one may where the edge is the nearest point of S, and the more, the farther from S.
/// There kEnough will do within a voxel of S where the foot point on the plane lies on S, by psi
/// within kOnFoot voxels: those of planes that fit by chance lie beyond the edge.
constexpr float kEnough = 6.5f, kOnRoundSide = 9, kPerVoxel = 6, kOnFoot = 0.2f;
/// A gradient made of differences over several faces is of length 1 by chance, and hardly ever as
/// closely as that of a plane: it counts this less per unit that its length is off 1.
constexpr float kPerOffUnit = 200;

/// The voxels around one and numbers without meaning: 13 of the voxels, and as far behind each the
/// one opposite.
constexpr std::size_t kHalf = 16;
using Around = std::array<float, 2 * kHalf>;

constexpr std::size_t placeOf(int x, int y, int z) {
    const int at = 9 * x + 3 * y + z;
    return at > 0 ? std::size_t(at - 1) : kHalf + std::size_t(-at - 1);
}

/// The coordinates of the 13 voxels.
constexpr auto kSteps = [] {
    std::array<std::array<float, kHalf>, 3> steps{};
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                if (9 * x + 3 * y + z <= 0) continue;
                const std::size_t k = placeOf(x, y, z);
                steps[0][k] = float(x), steps[1][k] = float(y), steps[2][k] = float(z);
            }
    return steps;
}();

/// A number for each of the eight octants.
using PerOctant = std::array<float, 8>;
constexpr int sideOf(std::size_t octant, std::size_t axis) {
    return octant >> (2 - axis) & 1 ? 1 : -1;
}

/// Gradients of psi over tetrahedra, or over triangles with the part out of their plane that makes
/// them unit vectors.
struct Gradients {
    alignas(32) std::array<float, 48> x, y, z;
    std::uint64_t unit = 0;  ///< bits: those of length 1
};

/// A gradient and how many neighbors agree with it; of a candidate, less by kPerOffUnit.
struct Agreement {
    Vec3f gradient{};
    float count = 0;
};

/// Finds the plane around a voxel, with the same bits for any width.
template <int Width>
class PlaneSearch {
    using V = typename Registers<Width>::Vector;

public:
    /// @param rise  psi at the voxels around less that at the voxel; NaN for those without value
    IGEO_INLINE explicit PlaneSearch(const Around& rise) : rise_(rise) {}

    /// The gradient with which most neighbors agree, and how many.
    IGEO_INLINE Agreement find() const {
        Gradients g;
        findGradients(g);
        Agreement most;
        findMost(g, most);
        if (most.count <= kEnough) {
            findInPlanes(g);
            findMost(g, most);
        }
        turnAcross(most);
        return most;
    }

private:
    IGEO_INLINE void findMost(const Gradients& g, Agreement& most) const {
        Vec3f last{};
        for (std::uint64_t bits = g.unit; bits; bits &= bits - 1) {
            const auto k = std::size_t(std::countr_zero(bits));
            const Vec3f candidate{g.x[k], g.y[k], g.z[k]};
            // On a plane many are the same.
            constexpr float kSame2 = 1e-8f;
            if (const Vec3f off = candidate - last; dot(off, off) < kSame2) continue;
            last = candidate;
            const float count = agreeing(candidate) - kPerOffUnit * std::abs(length(candidate) - 1);
            if (count > most.count) most = {candidate, count};
        }
    }

    /// psi at the next voxel along an axis less psi at the one before.
    IGEO_INLINE float across(int axis) const {
        constexpr std::array<std::size_t, 3> kNext{placeOf(1, 0, 0), placeOf(0, 1, 0),
                                                   placeOf(0, 0, 1)};
        const std::size_t next = kNext[std::size_t(axis)];
        return rise_[next] - rise_[kHalf + next];
    }

    /// Where hardly any voxel that agrees lies off one plane of the lattice, they say no side: that
    /// of the difference across it counts.
    IGEO_INLINE void turnAcross(Agreement& most) const {
        constexpr float kInPlane = 12, kFew = 1.5f;
        if (most.count > kInPlane) return;
        for (int c = 0; c < 3; ++c) {
            Vec3f turned = most.gradient;
            turned[c] = -turned[c];
            if (!(across(c) * turned[c] > 0)) continue;
            const float count = agreeing(turned);
            if (count > kEnough && count > most.count - kFew) most = {turned, count};
        }
    }

    /// Over a voxel and two face neighbors with which the edge neighbor beside both agrees. The
    /// plane says no side: that of the difference across it counts.
    IGEO_INLINE void findInPlanes(Gradients& g) const {
        const std::array<float*, 3> to{g.x.data(), g.y.data(), g.z.data()};
        g.unit = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
            const auto riseAt = [&](int sideA, int sideB, int sideC) {
                std::array<int, 3> step{};
                step[a] = sideA, step[b] = sideB, step[c] = sideC;
                return rise_[placeOf(step[0], step[1], step[2])];
            };
            const float side = across(int(c));
            for (std::size_t k = 0; k < 4; ++k) {
                const int sideA = k & 1 ? 1 : -1, sideB = k & 2 ? 1 : -1;
                const float first = riseAt(sideA, 0, 0), second = riseAt(0, sideB, 0),
                            rest = 1 - first * first - second * second;
                if (!(rest >= 0 && std::abs(side) > 0 &&
                      std::abs(riseAt(sideA, sideB, 0) - first - second) < kOffPlane))
                    continue;
                const std::size_t at = 4 * c + k;
                to[a][at] = float(sideA) * first, to[b][at] = float(sideB) * second;
                to[c][at] = std::copysign(std::sqrt(rest), side);
                g.unit |= std::uint64_t(1) << at;
            }
        }
    }
    IGEO_INLINE void findGradients(Gradients& g) const {
        alignas(32) std::array<PerOctant, 3> face, edge,
            side;  // edge: by the axis that it is across
        alignas(32) PerOctant corner;
        for (std::size_t s = 0; s < 8; ++s) {
            const int x = sideOf(s, 0), y = sideOf(s, 1), z = sideOf(s, 2);
            face[0][s] = rise_[placeOf(x, 0, 0)], edge[0][s] = rise_[placeOf(0, y, z)];
            face[1][s] = rise_[placeOf(0, y, 0)], edge[1][s] = rise_[placeOf(x, 0, z)];
            face[2][s] = rise_[placeOf(0, 0, z)], edge[2][s] = rise_[placeOf(x, y, 0)];
            side[0][s] = float(x), side[1][s] = float(y), side[2][s] = float(z);
            corner[s] = rise_[placeOf(x, y, z)];
        }
        const std::array<float*, 3> to{g.x.data(), g.y.data(), g.z.data()};
        std::size_t at = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) {
                if (a == b) continue;
                const std::size_t c = 3 - a - b;
                for (std::size_t s = 0; s < 8; s += Width, at += Width) {
                    auto of = [&](const PerOctant& all) __attribute__((always_inline)) {
                        return loadLanes<Width>(&all[s]);
                    };
                    const V first = of(side[a]) * of(face[a]),
                            second = of(side[b]) * (of(edge[c]) - of(face[a])),
                            third = of(side[c]) * (of(corner) - of(edge[c])),
                            square = first * first + second * second + third * third;
                    storeLanes(first, to[a] + at), storeLanes(second, to[b] + at);
                    storeLanes(third, to[c] + at);
                    constexpr float kLeast = (1 - kOffUnit) * (1 - kOffUnit),
                                    kMost = (1 + kOffUnit) * (1 + kOffUnit);
                    g.unit |= std::uint64_t(bitsOf<Width>((square > kLeast) & (square < kMost)))
                              << at;
                }
            }
    }
    /// How many neighbors agree with a gradient.
    IGEO_INLINE float agreeing(const Vec3f& g) const {
        alignas(32) std::array<float, 8> sums{};
        for (std::size_t lane = 0; lane < 8; lane += Width) {
            V sum{};
            for (std::size_t k = lane; k < kHalf; k += 8) {
                auto along = [&](std::size_t axis) __attribute__((always_inline)) {
                    return loadLanes<Width>(&kSteps[axis][k]);
                };
                const V rise = along(0) * g.x + along(1) * g.y + along(2) * g.z;
                auto share = [&](const V& off) __attribute__((always_inline)) {
                    const V s = 1 - off * off * kPerOff2;
                    return s > 0 ? s : V{};
                };
                const V here = share(loadLanes<Width>(&rise_[k]) - rise),
                        opposite = share(loadLanes<Width>(&rise_[kHalf + k]) + rise);
                sum += here + opposite;
            }
            storeLanes(sum, &sums[lane]);
        }
        float all = 0;
        for (const float sum : sums) all += sum;
        return all;
    }

    const Around& rise_;
};

Agreement findByFour(const Around& rise) { return PlaneSearch<4>(rise).find(); }
#ifdef IGEO_AVX2
IGEO_AVX2 Agreement findByEight(const Around& rise) { return PlaneSearch<8>(rise).find(); }
#endif
Agreement findPlane(const Around& rise) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findByEight(rise);
#endif
    return findByFour(rise);
}

}  // namespace

std::optional<Vec3f> faceNormal(const LeafBlock& block, int x, int y, int z) {
    Around rise;
    rise.fill(kMissingVoxel);
    const float here = block.row(x, y)[z];
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k)
                if (i || j || k) rise[placeOf(i, j, k)] = block.row(x + i, y + j)[z + k] - here;
    float laplacian = 0;  // of |psi|
    for (const auto& [i, j, k] : {Ijk{1, 0, 0}, Ijk{0, 1, 0}, Ijk{0, 0, 1}})
        laplacian += rise[placeOf(i, j, k)] + rise[placeOf(-i, -j, -k)];
    if (here < 0) laplacian = -laplacian;
    const Agreement most = findPlane(rise);
    if (!(most.count > kEnough)) return std::nullopt;
    const Vec3f n = normalized(most.gradient);
    const bool isSure = laplacian < 0 || most.count > kOnRoundSide + kPerVoxel * std::abs(here);
    const auto footIsOnS = [&] {
        constexpr float kInBlock = 0.999f;  // whatever is rounded
        const Vec3f foot = Vec3f(Ijk{x, y, z}) - here * n;
        return std::abs(here) < kInBlock && std::abs(block.at(Vec3d(foot))) < kOnFoot;
    };
    if (!isSure && !footIsOnS()) return std::nullopt;
    return n;
}

}  // namespace igeo
