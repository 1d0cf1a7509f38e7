/// What holds for every distance field and every path, whatever the surface: each function says by
/// how much it fails to.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/trace.h>

#include <vector>

namespace igeo::test {

/// Of the band's nodes, jet marches the core; the others take their jets from it.
enum class Nodes { Marched, All };

struct FieldChecks {
    std::size_t notNumbers = 0;  ///< NaN, or a gradient that is none; of all nodes
    std::size_t missed = 0;      ///< marched, connected with a seed, but not reached
    std::size_t stuck = 0;       ///< marched, outside the start discs, and no neighbor lies lower
    std::size_t negative = 0;
    double shortcut = 0;  ///< |foot - nearest seed| - d
    double jump = 0;  ///< |d_i - d_j| - path between the foot points, over linked face neighbors

    void keepWorst(const FieldChecks& other);
};
/// The longest that the path between the foot points of neighbors may be: where normals are at an
/// angle t, that over a crease between two planes is at most chord / cos(t/2), and an arc is
/// shorter than that. Infinity where they lie on two sheets, or across a gap, by the rules of jet.
double wayBetween(const Band& band, NodeIndex i, NodeIndex j);

/// Of a field of jet whose seeds start at 0. Foot points that are more than 0.1 voxels off S are no
/// points to have a distance, and left out of `shortcut` and `jump`.
FieldChecks checkField(const Field& field, Nodes nodes);

struct PathChecks {
    std::size_t traced = 0, lost = 0;  ///< lost: not Reached
    double rise = 0;                   ///< of d above its least before, toward the seed

    void keepWorst(const PathChecks& other);
};
/// Paths from some 40 points spread over what is reached.
PathChecks checkPaths(const Field& field);

/// Points of S spread over what is reached, in the order of the nodes.
std::vector<SurfacePoint> spreadPoints(const Field& field, std::size_t count);

}  // namespace igeo::test
