/// What a file, and the surface in it, are like to walk on, before any walk.
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

/// A connected component of S: what one seed reaches.
struct SurfaceComponent {
    double area = 0;                                          ///< square voxels
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;  ///< box of its foot points, world
    /// Connected parts of its mesh: several where surfaces come so close that a front passes from
    /// one to the next, none where its mesh is a part of a larger component's (the band is cut
    /// between sheets that the mesh joins).
    int parts = 0;
    /// Of these together: closed lines at which it ends (0: closed), and handles (0: sphere, 1:
    /// torus), counted as if those lines were filled.
    int rims = 0, genus = 0;
};

/// Why results near a voxel are unreliable.
enum class Unreliable {
    Bend,    ///< sqrt(3) voxels are more than the radius of curvature, M&S (14); by what factor
    Facing,  ///< or more than half the distance to a sheet that faces this one; by what factor
    Rough,   ///< | |grad psi| - 1 | exceeds kGradientTolerance; by what factor
    Cut      ///< S is cut here: 1
};
constexpr std::size_t kUnreliableCauses = 4;

/// Lengths and curvatures in voxels.
struct SurfaceSurvey {
    std::vector<SurfaceComponent> components;  ///< those that hold surface, the largest first
    double area = 0;                           ///< of all
    double largestCurvature = 0;               ///< LevelSetStats has the 95th percentile
    double facingShare = 0;                    ///< of the core: a sheet faces it within two voxels
    Unresolved unresolved;                     ///< of a level set and a mesh
    BandBounds bounds;                         ///< M&S (14)
    double godunovBand = 0;                    ///< h by default; that of `jet` is bounds.lower

    std::vector<float> unreliability;  ///< per band node: the largest factor; 0: none
    std::size_t unreliable = 0;        ///< nodes with any
    std::array<std::size_t, kUnreliableCauses> unreliableBy{};  ///< nodes with each

    /// 95 % of the surface is clear for balls of this radius, and 99 % is twice `facingRadius` or
    /// more from sheets that face it (MedialRadii). Of a level set only what its voxels show.
    double medialRadius = kInfinity, facingRadius = kInfinity;
    /// Largest voxel size, in voxels of now, at which M&S (14) holds by these: the smaller of the
    /// two over sqrt(3). Where much of the surface is next to sharp edges, that is small.
    double resolvingSize = kInfinity;
    /// Estimates of a whole run with `jet` from one seed that writes the distance: memory of the
    /// process, processor time.
    std::uint64_t bytes = 0;
    double seconds = 0;
};

/// What a run takes per node of the band, on a core at 2.5 GHz, beside kProgramBytes. Measured
/// (docs/accuracy.md), and constants: a survey says the same every time.
struct RunCost {
    double bytesPerNode, secondsPerNode;
};
constexpr RunCost kVolumeCost{59, 0.5e-6}, kMeshCost{91, 0.9e-6}, kPointsCost{100, 7.5e-6};
constexpr double kProgramBytes = 45e6, kSecondsPerTriangle = 5e-6;

/// Describes a surface, on a grid.
///
/// Pieces are those of the core, connected where Band::linked lets a front pass; areas, rims and
/// genus are those of the mesh. Doubts are judged at the nodes of the core, curvature by the
/// Hessian of psi there as in checkLevelSet; other nodes take the largest of the core around their
/// foot points.
/// @param band  of all of the level set, h >= sqrt(3) voxels
/// @param mesh  the surface as triangles, index space; normals may be zero (surfaceMesh)
/// @throws Error  Cancelled through `progress`
/// Time O(n log n), mostly parallel; 100 bytes per core node while it works. Areas are those of
/// flat triangles: second order in dx.
SurfaceSurvey survey(const LevelSet& levelSet, const Band& band, const SurfaceMesh& mesh,
                     Progress& progress = Progress::none());

/// What a file holds, and the surface among it. Where it is refused, what was found out before.
struct FileSurvey {
    std::string file;                    ///< as named
    std::vector<GridEntry> grids;        ///< of a VDB file: all of them
    std::optional<MeshFacts> mesh;       ///< of a mesh
    std::optional<CloudDensity> points;  ///< of points
    std::optional<VolumeFacts> voxels;   ///< of a volume of voxels, whose surface is a mesh
    /// psi null: none was chosen; else as checkLevelSet leaves it. Of a mesh or points: made of
    /// their band.
    LevelSet levelSet;
    /// A box in the world, if transform.dx is not 0: of the active voxels of a grid, of the mesh,
    /// of the surface on points.
    Vec3d low, high;
    Band band;                             ///< of the default width for `jet`
    std::vector<std::string> warnings;     ///< what a user should know, one sentence each
    std::optional<SurfaceSurvey> surface;  ///< none where it is refused
    std::optional<Error> refusal;          ///< BadInput or Io

    /// Whether `levelSet` is a grid of the file.
    bool ofGrid() const { return levelSet.psi && !mesh && !points; }
    /// No refusal, but warnings, cuts, or places that the grid does not resolve.
    bool withCare() const;
    /// "usable: ...", "usable with care: ..." or "not usable: ...", a line without its end.
    std::string verdict() const;
};

/// Whether a grid holds points, for readPointCloud.
bool holdsPoints(const GridEntry& grid);

/// Reads, checks and surveys a grid.
/// @throws Error  Cancelled through `progress`, and what is neither BadInput nor Io
FileSurvey surveyFile(const GridSource& source, Progress& progress = Progress::none());

/// Surveys a mesh on voxels of size dx, through the level set that its band gives.
/// @param facts  meshFacts(mesh), as its Surface has them
/// @throws Error  as bandFromMesh
FileSurvey surveyMesh(const TriangleMesh& mesh, const MeshFacts& facts, double dx,
                      Progress& progress = Progress::none());

/// Surveys points, as `jet` takes them, on voxels of size dx.
/// @throws Error  as bandFromPoints
FileSurvey surveyPoints(const PointSurface& surface, double dx,
                        Progress& progress = Progress::none());

}  // namespace igeo
