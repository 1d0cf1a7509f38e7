/// Solves a point from the two fronts around it (jet_two_fronts.h). Internal.
#pragma once

#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_state.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// The value of the march over the weight, relative to the least start.
inline double marchedAt(const CoreJets& jets, NodeIndex k) {
    return (jets.marchedValueOf(k) - jets.seeds.leastStart) / double(jets.core->nodes[k].weight);
}

/// The link of a point with a core node, whose normal is nj and from which it is `a` away.
inline JetLink linkTo(const TangentFrame& frame, NodeIndex j, const Vec3f& nj, Vec2f a) {
    const Vec2f axis = turnedInto(frame, nj, dot(frame.normal(), nj), TangentFrame(nj).axis(0));
    return {JetLink::keyOf(j), a.x, a.y, axis.x, axis.y};
}

/// For one point at a time.
class TwoFrontsFit {
public:
    explicit TwoFrontsFit(const CoreJets& jets);

    /// A core node beside the point, laid out in its chart.
    struct Neighbor {
        JetLink link;
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
    std::optional<Found> solve(std::span<const Neighbor> around, double before,
                               float mostOff = float(kInfinity),
                               float mostAngle = float(kInfinity));
    /// The same at the begin of a locus, where directions tell the fronts apart.
    std::optional<Found> begin(std::span<const Neighbor> around, double before,
                               const MeetingFronts& fronts);

private:
    /// Lays out what the fronts bring to a point.
    /// @return whether no other front arrives
    bool layOut(std::span<const Neighbor> around, const Neighbor& from, double before);
    JetNeighbor marched(const JetLink& link) const {
        return {link.a(), link.turned(jets_.state[link.node()].g), marchedAt(jets_, link.node())};
    }
    /// Fits the fronts to what was laid out; none of more neighbors than lanes hold.
    void fit(double before, Found& found);
    /// The value of a front, if its neighbors agree on one.
    std::optional<double> valueOf(std::size_t front, double before) const;

    const CoreJets& jets_;
    Vec2f turn_;        ///< as TwoFronts::turn, in the chart
    double apart_ = 0;  ///< as TwoFronts::apart
    std::array<std::vector<JetNeighbor>, 2> of_;
    std::array<Vec2f, 2> lead_;
    JetLanes lanes_;  ///< one per front; the others stay empty
    JetFits fits_;
};

}  // namespace igeo
