/// Where fronts meet: the distance by short geodesics, called rays here, back to where each front
/// is by itself. Internal.
///
/// By Fermat's principle d(x) is the least d(y) + L over the ends y of the geodesics of length L
/// from x, for any L below d(x). Fronts that meet at x are apart at y, unless they meet at a small
/// angle; one that has a focus at x is round there. Each ray gives an upper bound, whose error is
/// that of d(y): x, and the nodes beside it, whose fits had neighbors of several fronts, do not
/// count. d(y) is what the march has left, also where y is near another meeting.
///
/// The direction of a ray is right where it is that of travel at its end. Along a front with
/// curvature k there, the angle between the two changes with the direction by -(1 + k L), which the
/// secant rule finds.
#pragma once

#include <igeo/march/detail/jet_corners.h>
#include <igeo/march/detail/jet_meeting_lanes.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// A foot point where fronts meet.
struct MeetingPoint {
    LeafIndex leaf;
    unsigned offset;  ///< of the voxel, in the leaf
    Vec3f foot;       ///< from the voxel
    LocalFrame local;
    std::uint32_t label;
    double before;  ///< value by the march, over the weight, relative to the least start

    MeetingFronts fronts{};

    /// Voxels: of a ray, and how near to a seed a neighbor of the point may be, as rays keep away
    /// from it.
    static constexpr float kLength = 6, kNearSeed = kLength + 5;
};

/// Finds the fronts at up to eight points side by side: the directions of the neighbors whose plane
/// fronts arrive first; none near a seed.
class FrontsAtPoints {
public:
    /// @param point      its number
    /// @param neighbors  in its chart, of one source
    void add(std::size_t point, std::span<const JetNeighbor> neighbors);
    /// Sets the fronts of the points that were added.
    void finish(std::span<MeetingPoint> points);

private:
    Arrivals arrivals_;
    std::array<std::size_t, Lanes::kNodes> point_;
    std::size_t size_ = 0;
};

/// The first arrival at each of the points, relative to the least start; none where S is creased or
/// ends within 6 voxels, within 11 voxels of a seed, and where the value is 0.25 voxels from that
/// before.
/// The same bits whatever other points there are. Time: some 0.5 microseconds per ray, two to four
/// for each front.
std::vector<std::optional<Solved>> solveByRays(const CoreJets& jets,
                                               std::span<const MeetingPoint> points);

}  // namespace igeo
