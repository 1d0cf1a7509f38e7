/// The values around many points, found side by side and once for all of them. Internal.
#pragma once

#include <igeo/band/surface_triangles.h>
#include <igeo/march/field.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// The surface around a point at which fields are read: no march changes it.
struct ReadPlace {
    SurfaceCell cell;
    bool hasWalks;         ///< on a mesh, for jet without tensors
    bool byWays = false;   ///< sheets of a mesh cross or fold within a voxel here
    bool byWalks = false;  ///< the same, or walls of a mesh are as thin as the cell, or faces of it
                           ///< meet there: a corner lies in no chart, nor does a rim that bends
    std::optional<SurfaceTriangles::Place> onMesh;  ///< the point on its triangle, if byWalks

    ReadPlace(const Field& field, const Vec3d& p, const Vec3d& sheetNormal);
};

class KnownJets {
public:
    /// Those at the corners of cells.
    KnownJets(const Field& field, std::span<const ReadPlace* const> places);

    /// At the corners of one of these cells, as Field::at.
    std::array<NodeJet, 8> at(const std::array<NodeIndex, 8>& nodes) const;

private:
    std::vector<NodeIndex> nodes_;  ///< ascending
    std::vector<NodeJet> jets_;
};

/// The arrival from the core around a point, where that is of one smooth front; none elsewhere,
/// with weights and on meshes.
std::optional<Arrival> arrivalFromCore(const Field& field, const Vec3d& pIndex,
                                       const Vec3d& sheetNormal);
/// What arrivalAt in field.h is elsewhere, at one of the points.
Arrival arrivalAt(const Field& field, const KnownJets& known, const Vec3d& pIndex,
                  const ReadPlace& place);

}  // namespace igeo
