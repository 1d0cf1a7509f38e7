/// Points of a mesh without a distance, though triangles join them to a seed.
#pragma once

#include <igeo/march/field.h>

#include <memory>
#include <string>
#include <vector>

namespace igeo {

/// Marches over a mesh, and their distances to points of it. The voxels may lack a link that
/// the mesh has: in walls narrower than they are, and between sheets that meet at a small angle.
class LostPoints {
public:
    /// @param band  of a mesh; of anything else no point counts as lost
    /// @param metric  null: Euclidean
    /// @param pWorld  points of S
    LostPoints(const Band& band, const MetricPtr& metric, std::vector<Vec3d> pWorld);
    ~LostPoints();
    /// Adds the distances of a march that no limit has ended, one per point; +infinity: unreached,
    /// NaN: not asked for.
    /// Time O(triangles + points log triangles) for the first point without a distance, then O(1)
    /// per point.
    void add(const std::vector<SurfacePoint>& seeds, const double* distance);
    /// The same of a march from one source of a field alone.
    void addSource(const Field& field, std::size_t source, const double* distance);
    /// Adds the distance to a single point.
    void add(const std::vector<SurfacePoint>& seeds, std::size_t point, double distance);
    /// The number of points without a distance that edges of triangles, past all obstacles, join to
    /// a seed, or to a point with a distance over joined gaps (Band::joints).
    std::size_t count() const { return lost_; }
    /// A sentence for users; empty where none is lost.
    /// @param what  of what: "vertices"
    std::string warning(const char* what) const;

private:
    struct Parts;  ///< of the mesh
    const Band& band_;
    const MetricPtr metric_;
    const std::vector<Vec3d> points_;
    std::unique_ptr<Parts> parts_;  ///< made when needed
    std::size_t lost_ = 0, all_ = 0;

    /// In the range of points; `distance` is that of the first.
    void add(const std::vector<SurfacePoint>& seeds, std::size_t begin, std::size_t end,
             const double* distance);
};

/// The warning of one march to points of S; empty where a limit has ended it. Time as of `add`.
std::string lostWarning(const Field& field, const char* what, const std::vector<Vec3d>& pWorld,
                        const std::vector<double>& distance);

}  // namespace igeo
