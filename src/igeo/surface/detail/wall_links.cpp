#include <igeo/surface/detail/wall_links.h>

#include <igeo/band/detail/chord.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/base/parallel.h>
#include <igeo/surface/detail/psi_around.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

namespace igeo {

namespace {

/// Voxels. Below kAtSurface a point is on S: in a wall of one voxel the interpolant of psi is
/// hardly larger. kSlack covers errors of foot points and normals beside creases. At corners foot
/// points are up to 0.48 off the interpolant's zero set; up to kMostOff of this is compensated.
constexpr float kAtSurface = 0.03f, kSlack = 0.3f, kMostOff = 0.5f, kSpacing = 0.25f,
                kCutOff = 0.1f;
/// Cosine of the normals at both ends of a chord along one face.
constexpr double kOneFace = 0.95;

/// Where normals are alike (the cosine is above kAlike), psi keeps this share of its value on the
/// chord beyond the surface in a wall, up to a taper of 20 degrees. In the wedge of a groove, and
/// where foot points are off, it falls towards S.
constexpr float kKept = 0.65f, kAlike = 0.6f;

/// Sine of the angle by which normals on a clearly convex part turn away from each other.
constexpr double kTurn = 0.2;

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// The bit of the side of S on which psi has this sign.
unsigned sideOf(double psi) { return psi < 0 ? 1 : 2; }

/// A chord between foot points, and what is needed to see whether it passes through a wall or
/// across a slot.
struct Chord {
    Vec3d from, along;
    Vec3d a, b;      ///< the unit normals at its ends
    unsigned sides;  ///< bits of the sides of S on which sheets meet: beyond a rim that the
                     ///< interpolant cuts off there is no slot
};

/// Whether a chord passes through a wall or across a slot, by so many points of it at a time.
/// @param offFrom  |psi| at `from`, or NaN: then it is set once it is needed
template <int Width>
IGEO_INLINE bool passesWall(const PsiAround& psi, const Chord& chord, float& offFrom) {
    using V = typename Registers<Width>::Vector;
    const V zero{}, one = zero + 1;
    const auto same = [&](const Vec3d& v) __attribute__((always_inline)) {
        return VectorLanes<Width>{zero + float(v.x), zero + float(v.y), zero + float(v.z)};
    };
    const Vec3d middle = normalized(chord.a + chord.b);
    const VectorLanes<Width> from = same(chord.from - Vec3d(psi.low())), along = same(chord.along),
                             mean = same(middle);
    const double length = igeo::length(chord.along);
    const auto alongA = float(dot(chord.a, chord.along)), alongB = float(dot(chord.b, chord.along)),
               cosine = float(dot(middle, chord.a)), turn = float(kTurn * length),
               kept = dot(chord.a, chord.b) > kAlike ? kKept : 0.0f;
    // Along an edge that the interpolant cuts off, psi is hardly more than at the ends.
    const float cutOff = dot(chord.a, chord.b) > kOneFace ? kCutOff : 0.0f;
    const int inside = chord.sides & sideOf(-1) ? -1 : 0,
              outside = chord.sides & sideOf(1) ? -1 : 0,
              pieces = int(std::ceil(length / kSpacing));
    float offTo = kUnknown;
    for (int k = 1; k < pieces; k += Width) {
        V part;
        for (int lane = 0; lane < Width; ++lane) part[lane] = float(k + lane);
        part /= float(pieces);
        const V t = part < one ? part : one;
        const VectorLanes<Width> p = from + along * t;
        const V value = psi.at(p), size = absolute(value), sign = value < 0 ? -one : one;
        auto found = (part < one) & (size > kAtSurface) & (value < 0 ? inside : outside) &
                     // At rims that the interpolant cuts off, the chord of a convex part lies
                     // outside of S.
                     ~((-sign * alongA > turn) & (sign * alongB > turn));
        if (!any(found)) continue;
        if (std::isnan(offFrom)) offFrom = float(std::abs(psi.at(chord.from)));
        if (std::isnan(offTo)) offTo = float(std::abs(psi.at(chord.from + chord.along)));
        // The distance to the nearer plane along the mean normal, if both are on this side of S.
        const V toA = sign * t * alongA, toB = sign * (t - 1) * alongB,
                nearer = toA < toB ? toA : toB, toPlanes = (nearer > 0 ? nearer : zero) / cosine,
                off = (1 - t) * offFrom + t * offTo,
                reach = toPlanes + kSlack + (off < kMostOff ? off : zero + kMostOff);
        const auto beyond = [&](const V& far) __attribute__((always_inline)) {
            return sign * psi.at(p - mean * (sign * far));
        };
        const V there = beyond(reach);
        found &= (size > (off < cutOff ? off : zero) + kAtSurface) & (there > kAtSurface) &
                 (there > kept * size);
        if (any(found) && any(found & (beyond(reach / 2) > kAtSurface))) return true;
    }
    return false;
}

bool passesByFour(const PsiAround& psi, const Chord& chord, float& offFrom) {
    return passesWall<4>(psi, chord, offFrom);
}
#ifdef IGEO_AVX2
IGEO_AVX2 bool passesByEight(const PsiAround& psi, const Chord& chord, float& offFrom) {
    return passesWall<8>(psi, chord, offFrom);
}
#endif
bool runsThroughWall(const PsiAround& psi, const Chord& chord, float& offFrom) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return passesByEight(psi, chord, offFrom);
#endif
    return passesByFour(psi, chord, offFrom);
}

/// Whether a chord over a crease leaves S although it lies in the plane of one end: the normal
/// there mixes two faces, and the chord cuts the corner before them. Where S follows the straight
/// line over both planes, these are faces.
bool cutsCorner(const Band& band, const PsiAround& psi, const Chord& chord) {
    constexpr double kLong = 1.5, kOffPlane = 0.2, kOff = 0.2, kOnFace = 0.15;  // voxels
    if (!(length(chord.along) > kLong) ||
        dot(chord.a, chord.b) > double(TangentFrame::creaseCosine(false)) ||
        !(liesInPlane(band, chord.along, chord.a, kOffPlane) ||
          liesInPlane(band, chord.along, chord.b, kOffPlane)))
        return false;
    const auto leaves = [&](const Vec3d& from, const Vec3d& along, double most) {
        for (int k = 1; k < 4; ++k)
            if (!(std::abs(psi.at(from + k / 4.0 * along)) <= most)) return true;
        return false;
    };
    if (!leaves(chord.from, chord.along, kOff)) return false;
    const Vec3d toEdge = toEdgeOf(chord.along, chord.a, chord.b);
    return leaves(chord.from, toEdge, kOnFace) ||
           leaves(chord.from + toEdge, chord.along - toEdge, kOnFace);
}

/// Per node the sides of S on which sheets meet there or at a neighbor (sideOf).
std::vector<std::uint8_t> besideMeetings(const Band& band,
                                         const std::vector<std::vector<NodeIndex>>& meetings) {
    std::vector<std::uint8_t> beside(band.size());
    auto mark = [&](NodeIndex i, unsigned side) {
        std::atomic_ref(beside[i]).fetch_or(std::uint8_t(side), std::memory_order_relaxed);
    };
    parallelFor(meetings.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l)
            for (const NodeIndex i : meetings[l]) {
                const unsigned side = sideOf(band.psi[i]);
                mark(i, side);
                band.forNeighbors(&BandLeaf::band, i,
                                  [&](NodeIndex j, int, int, int) { mark(j, side); });
            }
    });
    return beside;
}

}  // namespace

std::vector<Link> linksThroughWalls(const Band& band, const LevelSet& levelSet,
                                    const std::vector<std::vector<NodeIndex>>& meetings) {
    if (std::all_of(meetings.begin(), meetings.end(), [](auto& m) { return m.empty(); })) return {};
    const std::vector<std::uint8_t> beside = besideMeetings(band, meetings);
    std::vector<std::vector<Link>> found(band.leaves.size());
    parallelFor(found.size(), 16, [&](std::size_t begin, std::size_t end) {
        PsiAround psi(levelSet.psi->constTree(), levelSet.transform.dx);
        for (std::size_t l = begin; l < end; ++l) {
            bool gathered = false;
            band.forNodes(LeafIndex(l), [&](NodeIndex i, unsigned at) {
                if (!beside[i]) return;
                if (!gathered) psi.moveTo(band.leaves[l].origin), gathered = true;
                const Vec3f n = band.normal[i], foot = band.footOf(i);
                const Vec3d from = band.footPoint(i), normal(n);
                float off = kUnknown;
                band.forNeighbors(
                    &BandLeaf::band, LeafIndex(l), at, [&](NodeIndex j, int dx, int dy, int dz) {
                        if (j < i || !beside[j] || dot(n, band.normal[j]) < Band::kOtherSheet)
                            return;
                        const Vec3f along = Vec3f(Ijk{dx, dy, dz}) + band.footOf(j) - foot;
                        const Chord c{from, Vec3d(along), normal, Vec3d(band.normal[j]),
                                      unsigned(beside[i] | beside[j])};
                        if (cutsCorner(band, psi, c) || runsThroughWall(psi, c, off))
                            found[l].emplace_back(i, j);
                    });
            });
        }
    });
    std::vector<Link> links;
    for (const auto& part : found) links.insert(links.end(), part.begin(), part.end());
    return links;
}

}  // namespace igeo
