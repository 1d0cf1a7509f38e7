/// Parts that are a closed outline, swept: distances between their faces are those on the strip
/// laid flat.
#pragma once

#include <openvdb/tools/MeshToVolume.h>
#include <support/shapes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace igeo::test {

/// A closed outline across y, swept from y = 0 to `kWidth`. In voxels.
struct Sweep {
    static constexpr double kWidth = 28;
    std::string name;
    std::vector<std::array<double, 2>> outline;  ///< corners (x, z)

    /// The distance from the outline.
    double off(const openvdb::Vec3d& p) const {
        double least = kInfinity;
        forEdges([&](const auto& a, const auto& b) {
            const double ux = b[0] - a[0], uz = b[1] - a[1], vx = p.x() - a[0], vz = p.z() - a[1];
            const double t = std::clamp((ux * vx + uz * vz) / (ux * ux + uz * uz), 0.0, 1.0);
            least = std::min(least, std::hypot(vx - t * ux, vz - t * uz));
        });
        return least;
    }
    /// The point of the outline at a length from its first corner.
    std::array<double, 2> at(double s) const {
        std::array<double, 2> p = outline.front();
        forEdges([&](const auto& a, const auto& b) {
            const double side = std::hypot(b[0] - a[0], b[1] - a[1]);
            if (s >= 0 && s <= side)
                p = {a[0] + s / side * (b[0] - a[0]), a[1] + s / side * (b[1] - a[1])};
            s -= side;
        });
        return p;
    }
    Shape shape() const {
        Shape s;
        s.sdf = [this](const openvdb::Vec3d& p) {
            bool in = false;
            forEdges([&](const auto& a, const auto& b) {
                if ((a[1] > p.z()) != (b[1] > p.z()) &&
                    p.x() < a[0] + (p.z() - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                    in = !in;
            });
            const double across = in ? -off(p) : off(p);
            const double beyond = std::abs(p.y() - kWidth / 2) - kWidth / 2;
            if (across > 0 && beyond > 0) return std::hypot(across, beyond);
            return std::max(across, beyond);
        };
        for (const auto& [x, z] : outline)
            s.bounds.expand(openvdb::Vec3d(x, 0, z)), s.bounds.expand(openvdb::Vec3d(x, kWidth, z));
        return s;
    }

private:
    template <typename Visit>
    void forEdges(const Visit& visit) const {
        for (std::size_t k = 0; k < outline.size(); ++k)
            visit(outline[k], outline[(k + 1) % outline.size()]);
    }
};

/// The level set of a part, as OpenVDB converts its mesh.
/// @param ends  triangles and quads between corners of the outline, which fill it
inline openvdb::FloatGrid::Ptr converted(const Sweep& part,
                                         const std::vector<std::vector<unsigned>>& ends,
                                         const openvdb::math::Transform& transform) {
    const auto n = unsigned(part.outline.size());
    std::vector<openvdb::Vec3s> points;
    for (const double y : {0.0, Sweep::kWidth})
        for (const auto& [x, z] : part.outline) points.emplace_back(x, y, z);
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    for (unsigned k = 0; k < n; ++k) quads.emplace_back(k, n + k, n + (k + 1) % n, (k + 1) % n);
    for (const auto& e : ends)
        if (e.size() == 3) {
            triangles.emplace_back(e[0], e[1], e[2]);
            triangles.emplace_back(n + e[2], n + e[1], n + e[0]);
        } else {
            quads.emplace_back(e[0], e[1], e[2], e[3]);
            quads.emplace_back(n + e[3], n + e[2], n + e[1], n + e[0]);
        }
    return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(transform, points, triangles, quads);
}

}  // namespace igeo::test
