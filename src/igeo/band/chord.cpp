#include <igeo/band/detail/chord.h>

namespace igeo {

namespace {

constexpr int kHalvings = 4;

/// The length of a path on S between two points, by halving the chord; +infinity where none is
/// found.
double lengthAlong(const Band& band, const Vec3d& a, const Vec3d& b, int halvings) {
    constexpr double kStep = 0.5;  // voxels
    const double chord = length(b - a);
    if (chord <= kStep) return chord;
    Vec3d middle = 0.5 * (a + b);
    if (halvings == 0 || !projectToSurface(band, middle)) return kInfinity;
    return lengthAlong(band, a, middle, halvings - 1) + lengthAlong(band, middle, b, halvings - 1);
}

}  // namespace

bool staysNearPsi(const Band& band, const Vec3d& from, const Vec3d& chord, int parts, double most) {
    for (int k = 1; k < parts; ++k) {
        const double psi = psiAt(band, from + (double(k) / parts) * chord);
        if (!(std::abs(psi) <= most)) return false;
    }
    return true;
}

double overOneEdge(const Band& band, const Vec3d& from, const Vec3d& to, const Vec3d& n,
                   const Vec3d& nTo) {
    constexpr double kSharp = 0.5, kOnFace = 0.15;  // sine of the bend; voxels
    const double cosine = dot(n, nTo), sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    if (sine < kSharp || cosine < Band::kOtherSheet) return kInfinity;
    const Vec3d edge = from + toEdgeOf(to - from, n, nTo);
    const bool onSurface = staysNearPsi(band, from, edge - from, 4, kOnFace) &&
                           staysNearPsi(band, to, edge - to, 4, kOnFace);
    return onSurface ? length(edge - from) + length(to - edge) : kInfinity;
}

bool runsInPlane(const Band& band, const Vec3d& from, const Vec3d& chord, const Vec3d& n) {
    constexpr double kOff = 0.2;  // voxels
    return liesInPlane(band, chord, n) &&
           (band.triangles || staysNearPsi(band, from, chord, 4, kOff));
}

bool psiJoins(const Band& band, const Vec3d& p, const Vec3d& foot) {
    constexpr double kLonger = 1.2, kRoom = 0.1, kOff = 0.35;  // but kLonger: voxels
    return !(std::abs(psiAt(band, foot)) > kOff) &&
           lengthAlong(band, p, foot, kHalvings) <= kLonger * length(foot - p) + kRoom;
}

bool followsSurface(const Band& band, const Vec3d& a, const Vec3d& b) {
    constexpr double kLonger = 1.1, kRoom = 0.1, kOn = 0.5, kOff = 0.3;  // but kLonger: voxels
    const double chord = length(b - a);
    if (!band.triangles)
        // Along a crease, where Newton's steps of a projection fail, psi tells.
        return staysNearPsi(band, a, b - a, 4, kOff) ||
               lengthAlong(band, a, b, kHalvings) <= kLonger * chord + kRoom;
    const auto from = band.triangles->nearest(a, kOn), to = band.triangles->nearest(b, kOn);
    return from.triangle != SurfaceTriangles::kNone && to.triangle != SurfaceTriangles::kNone &&
           band.triangles->joins(from, to, kLonger / 2 * chord + kRoom);
}

}  // namespace igeo
