/// Where two fronts meet at a small angle: each is carried on by itself. Internal.
///
/// Along a cut locus beside which fronts spread, the angle between them falls. The march fits
/// fronts less than 45 degrees apart together, and below 20 degrees rays (jet_rays.h) end between
/// both. So once a march is over, the nodes beside such a locus are solved again, in the order of
/// the distance, each twice: from neighbors that the first front has reached, and from those of the
/// second. The lesser value counts. The other one is that of a front which has crossed the locus;
/// nodes further on need it.
///
/// The front of a neighbor that was not solved again is that of its side of the locus. The
/// difference of both values at the node before shows the side. Directions do not: each front
/// spreads by degrees from voxel to voxel.
#pragma once

#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_state.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// Solves a point from the two fronts around it.
class TwoFrontsFit {
public:
    explicit TwoFrontsFit(const CoreJets& jets) : jets_(jets) {}

    /// A core node beside the point.
    struct Neighbor {
        NodeIndex node;
        Vec2f a;                ///< from there, in the chart of the point
        const TwoFronts* both;  ///< null: by the march alone
    };
    /// How far beside a locus both fronts are carried on, voxels.
    static constexpr float kWidth = 3;
    /// Fronts that meet at a smaller angle count as one, radians.
    static constexpr float kLeastAngle = 0.044f;
    /// From this angle on rays find the fronts, radians.
    static constexpr float kLargestAngle = 0.524f;

    struct Found {
        TwoFronts both;
        double u;     ///< the lesser value
        Vec2f g;      ///< its direction of travel, in the chart of the point
        float angle;  ///< between the fronts
        float off;    ///< voxels to the locus

        /// Whether the fronts count by themselves.
        bool isBeside() const { return angle >= kLeastAngle && off <= kWidth; }
    };
    /// None where neighbors disagree, a third front arrives, or the point is not beside a locus.
    /// @param before  value by the march, as those of TwoFronts
    /// @param mostOff, mostAngle  none farther from the locus, voxels, or where it is larger
    std::optional<Found> solve(const TangentFrame& frame, std::span<const Neighbor> around,
                               double before, float mostOff = float(kInfinity),
                               float mostAngle = float(kInfinity));
    /// The same at the begin of a locus, where directions tell the fronts apart.
    std::optional<Found> begin(const TangentFrame& frame, std::span<const Neighbor> around,
                               double before, const MeetingFronts& fronts);

private:
    /// Lays out what the fronts bring to a point.
    /// @return whether no other front arrives
    bool layOut(const TangentFrame& frame, std::span<const Neighbor> around, const Neighbor& from,
                double before);
    JetNeighbor marched(const TangentFrame& frame, const Neighbor& n) const;
    /// Fits the fronts to what was laid out.
    void fit(const TangentFrame& frame, double before, Found& found);
    /// The value of a front, if its neighbors agree on one.
    std::optional<double> valueOf(std::size_t front, double before) const;

    const CoreJets& jets_;
    Vec2f turn_;        ///< as TwoFronts::turn, in the chart
    double apart_ = 0;  ///< as TwoFronts::apart
    std::array<std::vector<JetNeighbor>, 2> of_;
    std::array<Vec2f, 2> lead_;
    JetLanes lanes_;
    JetFits fits_;
};

/// Solves the core beside cut loci along which the angle between two fronts falls below 20 degrees
/// from 36 or more. A locus that begins with small angles, at a cusp, is left: the angle grows
/// there, and the march errs no more than elsewhere. In one thread; time O(nodes beside them).
/// @param meetings  ascending; those that are solved here lose their fronts
/// @param near      marks as those of Meetings
/// @return both fronts at nodes within kWidth, ascending
std::vector<TwoFronts> carryTwoFronts(CoreJets& jets, std::vector<Meetings::Meeting>& meetings,
                                      std::vector<std::uint8_t>& near);

}  // namespace igeo
