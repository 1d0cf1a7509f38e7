/// The directions of a logarithmic map: those of geodesics at its seeds. Internal to log_map.cpp.
#pragma once

#include <igeo/results/detail/seed_frames.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace igeo {

/// The direction at the seed of the geodesic to a node.
struct Departure {
    Vec2f direction;    ///< unit; 0: unknown
    float slope = 0;    ///< of its angle, per length (times weight) along the front to the left
    bool bent = false;  ///< the geodesic may bend, before the node or at it
    bool known() const { return direction.x != 0 || direction.y != 0; }
};

/// Where the direction or the distance is unknown.
constexpr Vec2f kNoPosition{std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::quiet_NaN()};

/// Finds the departures of all nodes.
class SeedDirections {
public:
    /// @param field      must outlive this
    /// @param reference  of logMap
    SeedDirections(const Field& field, const Vec3d& reference)
        : band_(*field.band),
          field_(field),
          metric_(*field.metric),
          core_(*field.jets->core),
          frames_(field, reference),
          nodes_(frames_.nodes()),
          measured_(core_.nodes.size()) {}

    const std::vector<SeedAxes>& axesAtSeeds() const { return frames_.atSeeds(); }
    /// LogMap::position, in these axes.
    /// @throws Error  Cancelled through `progress`
    std::vector<Vec2f> positions(Progress& progress);

private:
    void addNeighbor(NodeIndex i, const Chart& here, NodeIndex core, const Vec3f& chord,
                     FrontNeighbors& all) const;
    FrontNeighbors neighbors(NodeIndex i, const Chart& here) const;
    bool mayBendAt(NodeIndex core) const;
    bool bendBefore(NodeIndex core, const FrontNeighbors& all) const;
    void carry(NodeIndex i);
    Departure fromNeighbors(const FrontNeighbors& all) const;
    Departure smooth(NodeIndex i) const;
    Vec2f interpolate(NodeIndex i) const;
    Vec2f position(NodeIndex i) const;

    const Band& band_;
    const Field& field_;
    const Metric& metric_;
    const JetCore& core_;
    SeedFrames frames_;
    // By core number:
    const std::vector<NodeIndex>& nodes_;  ///< the band's number
    std::vector<std::uint8_t> mayBend_;
    std::vector<Departure> measured_, departures_;
};

}  // namespace igeo
