// The scheme jet over edges too sharp for normals to be compared across them.
#include <igeo/geodesic_solver.h>
#include <support/catch.h>
#include <support/errors.h>
#include <support/openvdb.h>
#include <support/shapes.h>

#include <cmath>
#include <cstdio>

namespace igeo::test {
namespace {

using openvdb::Vec3d;

/// A wedge: two faces that meet at an angle in the z axis, cut off at kLeg from it and at
/// z = +-kHeight, then turned and moved.
class Wedge {
public:
    static constexpr double kLeg = 0.6, kHeight = 0.35;

    Wedge(double degrees, int turn)
        : half_(degrees * M_PI / 360),
          place_(rotatedTransform(1, Vec3d(0.3 + 0.4 * turn, 0.5 - 0.7 * turn, 0.8),
                                  11 + 37.3 * turn, Vec3d(0.013, 0.027, -0.011))) {}

    Vec3d local(const Vec3d& pWorld) const { return place_->worldToIndex(pWorld); }
    /// The point of the upper face at a distance from the edge.
    Vec3d onUpperFace(double r, double z) const {
        return place_->indexToWorld(Vec3d(r * std::cos(half_), r * std::sin(half_), z));
    }
    Shape shape() const {
        Shape s;
        s.name = "wedge";
        s.sdf = [this](const Vec3d& p) { return distance(local(p)); };
        s.bounds = openvdb::BBoxd(Vec3d(-1, -1, -1), Vec3d(1, 1, 1));
        return s;
    }

private:
    double distance(const Vec3d& p) const {
        // The triangle's corners in the plane.
        const double x = kLeg * std::cos(half_), y = kLeg * std::sin(half_);
        const std::array<Vec3d, 3> corner{Vec3d(0, 0, 0), Vec3d(x, y, 0), Vec3d(x, -y, 0)};
        const Vec3d q(p.x(), p.y(), 0);
        double outline = 1e9;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d side = corner[(k + 1) % 3] - corner[k], from = q - corner[k];
            const double t = std::clamp(from.dot(side) / side.lengthSqr(), 0.0, 1.0);
            outline = std::min(outline, (from - t * side).length());
        }
        if (q.x() < x && std::abs(q.y()) < q.x() * std::tan(half_)) outline = -outline;
        const double above = std::abs(p.z()) - kHeight;
        if (outline > 0 && above > 0) return std::hypot(outline, above);
        return std::max(outline, above);
    }

    double half_;
    openvdb::math::Transform::Ptr place_;
};

}  // namespace

TEST_CASE("jet passes sharp edges everywhere along them") {
    constexpr int kN = 60;
    for (const double degrees : {30.0, 45.0, 60.0, 90.0})
        for (int turn = 0; turn < 3; ++turn) {
            const Wedge wedge(degrees, turn);
            const GeodesicSolver solver(Surface(*makeLevelSet(wedge.shape(), 1.0 / kN, 3)));
            const Distance d = solver.distance({fromVdb(wedge.onUpperFace(0.13, 0.0123))});
            const Band& band = d.band();
            const Field& field = d.field();
            const Vec3d from = wedge.local(seedOf(d));
            double sum = 0, most = 0;
            std::size_t count = 0;
            for (NodeIndex i = 0; i < band.size(); ++i) {
                REQUIRE(field.distance[i] < kInfinity);
                const Vec3d p = wedge.local(worldOf(band, band.footPoint(i)));
                const double r = std::hypot(p.x(), p.y());
                // The lower face, where no path over another face is shorter; not the rows next to
                // the edge, where foot points are off by part of a voxel.
                if (p.y() > 0 || r < 2.0 / kN || r > 0.3 || std::abs(p.z()) > Wedge::kHeight - 0.05)
                    continue;
                const double exact =
                    std::hypot(std::hypot(from.x(), from.y()) + r, p.z() - from.z());
                const double error = field.distance[i] - exact * kN;
                sum += std::abs(error);
                most = std::max(most, error);
                ++count;
            }
            std::printf("jet, edge of %.0f degrees, turn %d: mean %.3f, max %.3f voxels\n", degrees,
                        turn, sum / double(count), most);
            CHECK(count > 500);
            // The edge itself is off by up to half a voxel in the level set, and a front may have
            // to go on to the next voxel that is out: less than two along the edge. A gap in the
            // core would cost that and more at every node behind it.
            CHECK(sum / double(count) < 0.6);  // measured 0.44
            CHECK(most < 0.9);                 // measured 0.60
        }
}

}  // namespace igeo::test
