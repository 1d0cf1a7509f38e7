/// The survey: what a file and its surface are like, before any march.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/error.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/io/vdb_read.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/cloud_density.h>
#include <igeo/surface/level_set.h>
#include <igeo/surface/mesh_facts.h>
#include <igeo/surface/point_surface.h>
#include <igeo/surface/unresolved.h>
#include <igeo/surface/volume_mesh.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// A connected component of S: the part that one seed reaches.
struct SurfaceComponent {
    double area = 0;                                          ///< square voxels
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;  ///< box of its foot points, world
    /// Number of connected parts of its mesh: several where surfaces come so close that a front
    /// passes between them, none where its mesh belongs to a larger component (the band is cut
    /// between sheets that the mesh joins).
    int parts = 0;
    /// Of these together: closed rims at which it ends (0: closed), and handles (0: sphere, 1:
    /// torus), counted with the rims filled.
    int rims = 0, genus = 0;
};

/// Why results near a voxel are unreliable.
enum class Unreliable {
    Bend,    ///< sqrt(3) voxels exceed the radius of curvature, M&S (14); by what factor
    Facing,  ///< or half the distance to a sheet that faces this one; by what factor
    Rough,   ///< | |grad psi| - 1 | exceeds kGradientTolerance; by what factor
    Cut      ///< S is cut here: 1
};
constexpr std::size_t kUnreliableCauses = 4;

/// Lengths and curvatures in voxels.
struct SurfaceSurvey {
    std::vector<SurfaceComponent> components;  ///< those that hold surface, the largest first
    double area = 0;                           ///< of all components
    double largestCurvature = 0;  ///< the maximum; LevelSetStats has the 95th percentile
    double facingShare = 0;       ///< share of the core that a sheet faces within two voxels
    Unresolved unresolved;        ///< for a level set or a mesh
    BandBounds bounds;            ///< M&S (14)
    double godunovBand = 0;       ///< default h; that of `jet` is bounds.lower

    std::vector<float> unreliability;  ///< per band node: the largest factor; 0: reliable
    std::size_t unreliable = 0;        ///< number of nodes with a factor
    std::array<std::size_t, kUnreliableCauses> unreliableBy{};  ///< by cause

    /// 95 % of the surface is clear for balls of this radius, and 99 % is at least twice
    /// `facingRadius` away from sheets that face it (MedialRadii). Of a level set only as far as
    /// its voxels show.
    double medialRadius = kInfinity, facingRadius = kInfinity;
    /// Largest voxel size, in current voxels, at which M&S (14) holds by these radii: the smaller
    /// of the two over sqrt(3). Small where much of the surface is next to sharp edges.
    double resolvingSize = kInfinity;
    /// Estimates for a whole run with `jet` from one seed that writes the distance: memory of the
    /// process, processor time.
    std::uint64_t bytes = 0;
    double seconds = 0;
};

/// The cost of a run per node of the band, on a core at 2.5 GHz, beside kProgramBytes. Measured
/// (docs/accuracy.md) and constant: a survey always reports the same. The memory for a level set
/// is counted instead.
struct RunCost {
    double bytesPerNode, secondsPerNode;
};
constexpr RunCost kMeshCost{91, 0.9e-6}, kPointsCost{100, 7.5e-6};
constexpr double kProgramBytes = 46e6, kVolumeSecondsPerNode = 0.5e-6, kSecondsPerTriangle = 5e-6;

/// Describes a surface, on a grid.
///
/// Components are those of the core, connected where Band::linked lets a front pass; areas, rims
/// and genus are those of the mesh. Reliability is evaluated at the nodes of the core, curvature by
/// the Hessian of psi there as in checkLevelSet; other nodes take the largest factor of the core
/// around their foot points.
/// @param band  of all of the level set, h >= sqrt(3) voxels
/// @param mesh  the surface as triangles, index space; normals may be zero (surfaceMesh)
/// @throws Error  Cancelled through `progress`
/// Time O(n log n), mostly parallel; 100 bytes of working memory per core node. Areas are those of
/// flat triangles: second order in dx.
SurfaceSurvey survey(const LevelSet& levelSet, const Band& band, const SurfaceMesh& mesh,
                     Progress& progress = Progress::none());

/// The content of a file, and its surface. For a refused file, what was found before the refusal.
struct FileSurvey {
    std::string file;                    ///< as given
    std::vector<GridEntry> grids;        ///< of a VDB file: all of them
    std::optional<MeshFacts> mesh;       ///< of a mesh
    std::optional<CloudDensity> points;  ///< of points
    std::optional<VolumeFacts> voxels;   ///< of a volume of voxels, whose surface is a mesh
    /// psi null: no grid was chosen; else as checkLevelSet returns it. Of a mesh or points: made
    /// from their band.
    LevelSet levelSet;
    /// A box in world space, if transform.dx is not 0: of the active voxels of a grid, of the mesh,
    /// of the surface on points.
    Vec3d low, high;
    Band band;                             ///< of the default width for `jet`
    std::vector<std::string> warnings;     ///< for the user, one sentence each
    std::optional<SurfaceSurvey> surface;  ///< empty if refused
    std::optional<Error> refusal;          ///< BadInput or Io

    /// Whether `levelSet` is a grid of the file.
    bool ofGrid() const { return levelSet.psi && !mesh && !points; }
    /// No refusal, but warnings, cuts, or parts that the grid does not resolve.
    bool withCare() const;
    /// "usable: ...", "usable with care: ..." or "not usable: ...", one line without line end.
    std::string verdict() const;
};

/// Whether a grid holds points, for readPointCloud.
bool holdsPoints(const GridEntry& grid);

/// Reads, checks and surveys a grid.
/// @throws Error  Cancelled through `progress`, and errors other than BadInput and Io
FileSurvey surveyFile(const GridSource& source, Progress& progress = Progress::none());

/// Surveys a mesh on voxels of size dx, through the level set that its band gives.
/// @param facts  meshFacts(mesh), as in its Surface
/// @throws Error  as bandFromMesh
FileSurvey surveyMesh(const TriangleMesh& mesh, const MeshFacts& facts, double dx,
                      Progress& progress = Progress::none());

/// Surveys points, as `jet` uses them, on voxels of size dx.
/// @throws Error  as bandFromPoints
FileSurvey surveyPoints(const PointSurface& surface, double dx,
                        Progress& progress = Progress::none());

}  // namespace igeo
