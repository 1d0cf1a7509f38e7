/// Solves a point from the two fronts around it (jet_two_fronts.h). Internal.
#pragma once

#include <igeo/march/detail/jet_fit.h>
#include <igeo/march/detail/jet_state.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace igeo {

/// A direction of travel at a neighbor in the chart of a point.
inline Vec2f turnedInto(const TangentFrame& frame, const Vec3f& normal, const Vec3f& g) {
    return turnedInto(frame, normal, dot(frame.normal(), normal), g);
}
/// The value of the march over the weight, relative to the least start.
inline double marchedAt(const CoreJets& jets, NodeIndex k) {
    return (jets.marchedValueOf(k) - jets.seeds.leastStart) / double(jets.core->nodes[k].weight);
}

/// For one point at a time.
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

}  // namespace igeo
