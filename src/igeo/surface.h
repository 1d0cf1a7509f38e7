/// A surface: from a level set, a triangle mesh or points.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/ball.h>
#include <igeo/base/fit_error.h>
#include <igeo/base/progress.h>
#include <igeo/io/point_cloud.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/io/vdb_read.h>
#include <igeo/march/scheme.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/level_set.h>
#include <igeo/surface/mesh_facts.h>
#include <igeo/surface/unresolved.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// The voxel size for a mesh or points; a level set has its own.
struct VoxelOptions {
    double size = 0;     ///< world units; 0: by `resolution`
    int resolution = 0;  ///< voxels along the longest side; 0: 256 for a mesh, half the spacing for
                         ///< points (godunov: the spacing)
    Scheme scheme = Scheme::Jet;  ///< the scheme that points are put on voxels for
    /// Components of a mesh this close are joined (bandFromMesh), world units; for jet
    double joinGaps = 0;
};

/// Facts about a surface that need no march.
struct SurfaceFacts {
    enum class Kind { LevelSet, Mesh, Points };
    Kind kind = Kind::LevelSet;
    std::string file, name;               ///< for messages and results
    std::optional<MeshFacts> mesh;        ///< of a mesh
    std::uint64_t activeVoxels = 0;       ///< of a level set
    double halfWidth = 0;                 ///< of the level set, voxels
    double largestCurvature = kInfinity;  ///< per voxel (LevelSetStats); +infinity: unknown
    double joinGaps = 0;                  ///< of a mesh: VoxelOptions::joinGaps
    double diagonal = 0;                  ///< across the surface, voxels
    double snap = 0;                      ///< default of maxSnap, world units
    FitError fit;                         ///< of points: CloudDensity::fitError, voxels
    std::string summary;                  ///< in a few words
    std::vector<std::string> warnings;    ///< for the user, one sentence each
};

/// Half the thickness of a band within M&S (14).
struct BandWidth {
    Scheme scheme = Scheme::Jet;         ///< the scheme that it is for
    double h = 0, lower = 0, upper = 0;  ///< voxels; the bounds: lower <= h < upper
    /// Of S: where it bends or folds within `lower`; empty where h asks for no bounds.
    std::optional<double> unresolvedShare = {};
    std::vector<std::string> warnings = {};
};

/// A surface that was read and checked, from which bands are made.
///
/// Cheap to copy: copies share derived data. Several threads may use it at once.
class Surface {
public:
    /// A signed distance in world units (checkLevelSet). The grid is not changed; its tree is
    /// shared, so it must not change either.
    /// @throws Error  as checkLevelSet
    explicit Surface(const openvdb::FloatGrid& psi, Progress& progress = Progress::none());
    explicit Surface(LoadedGrid psi, Progress& progress = Progress::none());
    /// Triangles, open or closed, welded and split at junctions: by readMesh or, in memory, meshOf.
    /// @throws Error  as requireVoxelSize and requireReasonable, InvalidArgument for
    ///         VoxelOptions::joinGaps of more than 64 voxels
    explicit Surface(TriangleMesh mesh, const VoxelOptions& voxels = {},
                     Progress& progress = Progress::none());
    /// Points on a surface, with or without normals: for `jet` the surface fitted to them, for
    /// `godunov` the union of balls around them (M&S 5.2).
    /// @throws Error  as requireVoxelSize and PointSurface
    explicit Surface(PointCloud cloud, const VoxelOptions& voxels = {},
                     Progress& progress = Progress::none());

    const SurfaceFacts& facts() const;
    const Similarity& transform() const;  ///< world from index; dx is the voxel size
    /// The same for grids; that of a level set itself, so that results match it bit by bit.
    openvdb::math::Transform::ConstPtr gridTransform() const;
    std::string gridName() const;  ///< the base of the names of results

    /// The band's width for a scheme.
    /// @param order  of godunov
    /// @param h      given, voxels; 0: the one of least error
    /// @throws Error  as requireBandWidth
    BandWidth bandWidth(Scheme scheme, int order = 2, double h = 0,
                        Progress& progress = Progress::none()) const;
    /// The band in some balls (index space), for a level set if there are balls; else that of the
    /// whole surface, made once per width.
    std::shared_ptr<const Band> band(const BandWidth& width, const std::vector<Ball>& region = {},
                                     Progress& progress = Progress::none()) const;
    /// The band of the whole surface if it has been made, else null.
    std::shared_ptr<const Band> madeBand(const BandWidth& width) const;
    /// The approximate number of nodes of the band of the whole surface, and the bytes that a march
    /// and one grid of results on it take.
    double estimatedNodes(const BandWidth& width) const;
    double estimatedMemory(const BandWidth& width) const;
    /// @param limit  bytes
    /// @throws Error  InvalidArgument where estimatedMemory exceeds it
    void requireMemory(const BandWidth& width, double limit) const;
    /// Where the voxels do not resolve the surface, for unresolvedWarnings; empty for points.
    /// @param band  of the whole surface
    /// Time O(n), in parallel.
    Unresolved unresolved(const Band& band) const;

    /// The point of the surface nearest to one in index space.
    SurfacePoint nearest(const Band& band, const Vec3d& pIndex) const;
    /// The surface as triangles that carry the distance: the given mesh, refined, or psi = 0.
    SurfaceMesh mesh(const BandWidth& width, const Field& field,
                     Progress& progress = Progress::none()) const;
    /// A level set at least as wide as the band; of a mesh or points made on first use.
    const LevelSet& levelSet(const BandWidth& width, Progress& progress = Progress::none()) const;

    /// A vertex of the mesh, or one of the points, by its number in the file from 0 on (of an STL
    /// file in the order in which they first appear), or by name: +x -x +y -y +z -z (the farthest)
    /// or center (the nearest to the middle of the box of all).
    /// @return its position, world
    /// @throws Error  InvalidArgument for another name, a number out of range, and a level set
    Vec3d vertex(const std::string& name) const;
    /// All of them, world; null for a level set.
    const std::vector<Vec3d>* vertices() const;

    /// Frees the volume that the surface was made from, for a caller who needs no more bands, level
    /// sets or meshes of it: later requests to it and its copies throw InvalidArgument. No effect
    /// on a mesh or points. Only one thread may use the surface during the call.
    void dropVolume() const;

    /// The mesh or points that it is made from; null for another kind.
    const TriangleMesh* triangles() const;
    const class PointSurface* points() const;

    class Shape;

private:
    std::shared_ptr<const Shape> shape_;
};

}  // namespace igeo
