/// The values around many points, found side by side and once for all of them. Internal.
#pragma once

#include <igeo/march/field.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace igeo {

class KnownJets {
public:
    /// Those at the nodes of the cells around points.
    KnownJets(const Field& field, std::span<const Vec3d> points);

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
                  const Vec3d& sheetNormal);

}  // namespace igeo
