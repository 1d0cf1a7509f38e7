/// Jets read at points of a mesh over short walks on its triangles, for scheme `jet`. Internal.
///
/// Where walls are as thin as voxels, the cell around a point has corners of several sheets, and
/// normals and psi do not tell them apart. The triangles do.
#pragma once

#include <igeo/band/detail/short_walk.h>
#include <igeo/march/field.h>
#include <igeo/march/detail/jet_neighbors.h>

#include <vector>

namespace igeo {

/// A tangent vector turned along with its plane: the least rotation that takes one normal to the
/// other. Over a crease both planes are unfolded.
inline Vec3d turned(const Vec3d& v, const Vec3d& fromNormal, const Vec3d& toNormal) {
    constexpr double kOpposite = -0.9;
    const double cosine = dot(fromNormal, toNormal);
    if (cosine < kOpposite) return v;
    return v - (dot(v, toNormal) / (1 + cosine)) * (fromNormal + toNormal);
}

/// Whether jets at the corners of a cell may belong to several sheets of a mesh.
bool hasThinWalls(const Band& band, const BandCell& cell);

/// The core around a point of a mesh: nodes that a walk of at most 3 voxels joins with the point.
/// Those reached straight are laid out flat, face by face of those that meet in the point.
class CoreByWalks {
public:
    /// @param place  of the point
    CoreByWalks(const Field& field, const SurfaceTriangles::Place& place);

    /// The sources whose fronts have reached the nodes, ascending.
    std::vector<std::uint32_t> sources() const;
    /// The first arrival of a source, by Fermat's principle on each face by itself; +infinity
    /// without nodes that it has reached.
    double first(std::uint32_t source) const;

private:
    struct Node {
        JetNeighbor jet;   ///< in the plane of its face; u over the weight at the point
        std::size_t face;  ///< kNoFace: the walk bends, and the front starts again
        std::uint32_t source;
    };
    static constexpr std::size_t kNoFace = std::size_t(-1);

    std::vector<Node> nodes_;
    std::size_t faces_ = 0;
    double here_ = 1;  ///< the weight at the point
};

}  // namespace igeo
