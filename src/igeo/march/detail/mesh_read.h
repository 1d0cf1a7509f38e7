/// Jets carried to points of a mesh over short walks on its triangles, for scheme `jet`. Internal.
///
/// Where walls are as thin as voxels, and where pages share an edge, normals and psi do not tell
/// sheets apart. The triangles do. A straight walk is a straight line on its triangles laid flat:
/// at both ends it makes the same angle with the direction of travel.
#pragma once

#include <igeo/band/detail/mesh_fan.h>
#include <igeo/band/detail/turned.h>
#include <igeo/march/detail/jet_neighbors.h>
#include <igeo/march/field.h>

#include <vector>

namespace igeo {

/// Whether jets at the corners of a cell may belong to several sheets of a mesh.
bool hasThinWalls(const Band& band, const BandCell& cell);

/// Where the foot point of a node is on its mesh.
SurfaceTriangles::Place footPlace(const SurfaceTriangles& triangles, const Vec3d& foot,
                                  const Vec3d& normal);
/// -1 where the normal of a node is opposite to those of the triangles, as beyond the seam of a
/// mesh with one side, else 1. Over a crease of more than 90 degrees a cosine does not tell.
/// @param foot  its footPlace
double sideOf(const SurfaceTriangles& triangles, const SurfaceTriangles::Place& foot,
              const Vec3d& normal);

/// The cost of a line over triangles: by the weights at its ends and, where these vary, at points
/// between that have a node around, a voxel apart at most.
class LineCost {
public:
    /// @param first  the weight where the line begins
    LineCost(const Band& band, const Metric& metric, double first)
        : band_(band), metric_(metric), weight_(first) {}

    /// Adds a straight part, on a triangle.
    void operator()(const Vec3d& a, const Vec3d& b, std::uint32_t triangle);
    /// Of all parts.
    /// @param last  the weight where the line ends
    double endingAt(double last) {
        take(last);
        return cost_;
    }

private:
    void take(double weight) {
        cost_ += (weight_ + weight) / 2 * (done_ - known_);
        weight_ = weight, known_ = done_;
    }

    const Band& band_;
    const Metric& metric_;
    double weight_;     ///< the last that is known
    double known_ = 0;  ///< so far along the line
    double done_ = 0, cost_ = 0;
};

/// Jets around a point of a mesh, laid flat, on each of the faces that meet in the point by itself.
class JetsByWalks {
public:
    /// @param here  the weight at the point
    JetsByWalks(const Band& band, const Metric& metric, const SurfaceTriangles::Place& at,
                double here)
        : band_(band),
          metric_(metric),
          triangles_(*band.triangles),
          walk_(triangles_),
          at_{at.triangle, at.point},
          here_(here) {}

    /// The weight at the point.
    double here() const { return here_; }

    /// Carries the jet of a node over a walk.
    /// @param jet     its gradient of any length
    /// @param weight  there
    /// @param most    longest walk, voxels
    /// @return an upper bound of the distance at the point; +infinity without a walk, or where an
    ///         obstacle blocks it
    double add(NodeIndex node, const NodeJet& jet, double weight, double most);

    /// Whether an obstacle blocks the walk of a length from a node, or is near where no such walk
    /// is found and no gaps are joined.
    bool isBlocked(NodeIndex node, double walk);
    /// The same over a line that is known, past all obstacles.
    double add(const WalkEnds& line, NodeIndex node, const NodeJet& jet, double weight);
    /// @param cost  of the line
    double addOver(const WalkEnds& line, NodeIndex node, const NodeJet& jet, double cost);

    /// The same across a gap that a bridge joins, to a point at its rim: over both planes,
    /// unfolded.
    /// @param isJump  all such bridges are jumps
    void addAcross(NodeIndex node, const NodeJet& jet, double weight, bool isJump);

    struct First {
        double distance = kInfinity;
        Vec3d direction;  ///< of travel, unit; 0 for a walk without length
        Vec3d normal;     ///< of the face on which it travels
    };
    /// The first arrival of a source, by Fermat's principle; +infinity without jets of it.
    First first(std::uint32_t source);
    /// The sources of the jets, ascending.
    std::vector<std::uint32_t> sources() const;

private:
    struct Carried {
        JetNeighbor jet;   ///< in the plane of its face; u over the weight at the point
        std::size_t face;  ///< kNoFace: the walk bends, and the front starts again
        NodeIndex node;
        std::uint32_t source;
        Vec3d in, up;  ///< at the end of the walk: its direction, and the normal of its triangle
    };
    static constexpr std::size_t kNoFace = std::size_t(-1);
    /// The number of a face by its normal.
    std::size_t faceOf(const Vec3d& up);

    /// By Fermat's principle, over jets on one face.
    ///
    /// A vertex between two walks leaves no plane for both: the segment between their nodes is then
    /// not as long as the walk between these. It counts by itself, in the plane triangle that has
    /// the lengths of the three walks for sides.
    /// @param pairsLeft  so many segments are tested at most
    Jet firstOnFace(const std::vector<const Carried*>& jets, int pairsLeft);
    /// Turns q around the point until its node is so far from that of p.
    static void setApart(const Carried& p, Carried& q, double apart);
    /// The cost of the walk that was found last.
    /// @param weight  where it starts
    double costOf(const MeshPoint& from, const WalkEnds& way, double weight) const;
    /// Whether an obstacle blocks that walk.
    bool isBlocked(const MeshPoint& from, const WalkEnds& way) const;

    const Band& band_;
    const Metric& metric_;
    const SurfaceTriangles& triangles_;
    ShortWalk<SurfaceTriangles> walk_;
    MeshPoint at_;
    double here_;
    std::vector<Carried> jets_;
    std::vector<Vec3d> faceNormal_;
};

/// Whether an obstacle blocks the line of a fan to a point of its part k.
bool isBlocked(const Metric& metric, const SurfaceTriangles& triangles,
               const MeshFan<SurfaceTriangles>& fan, std::size_t k, const Vec3d& to);

/// The cost of that line, by LineCost.
/// @param here, there  the weights at the point of the fan and at the other end
double costOf(const Band& band, const Metric& metric, const MeshFan<SurfaceTriangles>& fan,
              std::size_t k, const Vec3d& to, const WalkEnds& line, double here, double there);

/// Whether lines of MeshWays end at a corner of a cell or beside it.
/// @param even  one cost everywhere, and no obstacles: those at rims count too
bool hasWays(const Band& band, const BandCell& cell, bool even);

/// A node or a seed that a line from a point of a mesh leads to.
struct Seen {
    NodeIndex node = kNoNode;
    const SurfacePoint* seed = nullptr;
    NodeJet jet;                   ///< at the node or the seed
    WalkEnds line;                 ///< from there to the point
    double cost;                   ///< of the line
    std::vector<Vec3d> crossings;  ///< of edges, and vertices, from the point on; if asked for

    double distance() const { return jet.distance + cost; }
};
/// All of them up to MeshWays::kReach that have a value, past all obstacles.
/// @param here  the weight at the point
std::vector<Seen> seenFrom(const Field& field, const SurfaceTriangles::Place& at, double here,
                           bool withCrossings = false);
/// Carries their jets to the point.
void addSeen(const std::vector<Seen>& seen, JetsByWalks& jets);

/// Carries the jets of the core around a point of a mesh to it.
/// @param cell  of the point, with the corners on its sheet
JetsByWalks coreByWalks(const Field& field, const SurfaceTriangles::Place& at,
                        const BandCell& cell);

}  // namespace igeo
