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
constexpr double kAtSurface = 0.03, kSlack = 0.3, kMostOff = 0.5, kSpacing = 0.25;

/// Where normals are alike (the cosine is above kAlike), psi keeps this share of its value on the
/// chord beyond the surface in a wall, up to a taper of 20 degrees. In the wedge of a groove, and
/// where foot points are off, it falls towards S.
constexpr double kKept = 0.65, kAlike = 0.6;

/// Sine of the angle by which normals on a clearly convex part turn away from each other.
constexpr double kTurn = 0.2;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The bit of the side of S on which psi has this sign.
unsigned sideOf(double psi) { return psi < 0 ? 1 : 2; }

/// Whether the chord between foot points passes through a wall or across a slot.
/// @param a, b  the unit normals at its ends
/// @param sides  bits of the sides of S on which sheets meet: beyond a rim that the interpolant
///               cuts off there is no slot
/// @param offFrom  |psi| at `from`, or NaN: then it is set once it is needed
bool runsThroughWall(const PsiAround& psi, const Vec3d& from, const Vec3d& chord, const Vec3d& a,
                     const Vec3d& b, unsigned sides, double& offFrom) {
    const Vec3d mean = normalized(a + b);
    const double alongA = dot(a, chord), alongB = dot(b, chord), cosine = dot(mean, a);
    const double turn = kTurn * length(chord);
    const double kept = dot(a, b) > kAlike ? kKept : 0;
    const int pieces = int(std::ceil(length(chord) / kSpacing));
    double offTo = kUnknown;
    for (int k = 1; k < pieces; ++k) {
        const double t = double(k) / pieces;
        const Vec3d p = from + t * chord;
        const double value = psi.at(p), sign = value < 0 ? -1 : 1;
        if (!(std::abs(value) > kAtSurface) || !(sides & sideOf(value))) continue;
        // At rims that the interpolant cuts off, the chord of a convex part lies outside of S.
        if (-sign * alongA > turn && sign * alongB > turn) continue;
        // The distance to the nearer plane along the mean normal, if both are on this side of S.
        const double toPlanes =
            std::max(0.0, std::min(sign * t * alongA, -sign * (1 - t) * alongB)) / cosine;
        if (std::isnan(offFrom)) offFrom = std::abs(psi.at(from));
        if (std::isnan(offTo)) offTo = std::abs(psi.at(from + chord));
        const double off = (1 - t) * offFrom + t * offTo;
        const double reach = toPlanes + kSlack + std::min(kMostOff, off);
        auto isBeyond = [&](double far, double least) {
            return sign * psi.at(p - (sign * far) * mean) > least;
        };
        if (isBeyond(reach, std::max(kAtSurface, kept * std::abs(value))) &&
            isBeyond(reach / 2, kAtSurface))
            return true;
    }
    return false;
}

/// Whether a chord over a crease leaves S although it lies in the plane of one end: the normal
/// there mixes two faces, and the chord cuts the corner before them.
/// @param a, b  the unit normals at its ends
bool cutsCorner(const Band& band, const PsiAround& psi, const Vec3d& from, const Vec3d& chord,
                const Vec3d& a, const Vec3d& b) {
    constexpr double kLong = 1.5, kOffPlane = 0.2, kOff = 0.2;  // voxels
    if (!(length(chord) > kLong) || dot(a, b) > double(TangentFrame::creaseCosine(false)) ||
        !(liesInPlane(band, chord, a, kOffPlane) || liesInPlane(band, chord, b, kOffPlane)))
        return false;
    for (int k = 1; k < 4; ++k)
        if (std::abs(psi.at(from + k / 4.0 * chord)) > kOff) return true;
    return false;
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
                const Vec3f& n = band.normal[i];
                double off = kUnknown;
                band.forNeighbors(
                    &BandLeaf::band, LeafIndex(l), at, [&](NodeIndex j, int dx, int dy, int dz) {
                        if (j < i || !beside[j] || dot(n, band.normal[j]) < Band::kOtherSheet)
                            return;
                        const Vec3f chord =
                            Vec3f(Ijk{dx, dy, dz}) + band.footOf(j) - band.footOf(i);
                        const Vec3d from = band.footPoint(i), across(chord), a(n),
                                    b(band.normal[j]);
                        if (cutsCorner(band, psi, from, across, a, b) ||
                            runsThroughWall(psi, from, across, a, b, beside[i] | beside[j], off))
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
