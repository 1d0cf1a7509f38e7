/// What a file, and a level set in it, are like as a surface to walk on, before any walk.
#pragma once

#include <igeo/band.h>
#include <igeo/band_width.h>
#include <igeo/error.h>
#include <igeo/level_set.h>
#include <igeo/progress.h>
#include <igeo/vdb_io.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace igeo {

/// A connected piece of S: what one seed reaches.
struct SurfacePiece {
    double area = 0;                                          ///< square voxels
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;  ///< box of its foot points, world
    /// Connected parts of its mesh: several where surfaces come so close that a front passes from
    /// one to the next, none where its mesh is a part of a larger piece's (the band is cut between
    /// sheets that the mesh joins).
    int parts = 0;
    /// Of these together: closed lines at which it ends (0: closed), and handles (0: sphere, 1:
    /// torus), counted as if those lines were filled.
    int rims = 0, genus = 0;
};

/// Why results near a voxel are doubtful.
enum class Doubt {
    Bend,    ///< sqrt(3) voxels are more than the radius of curvature, M&S (14); by what factor
    Facing,  ///< or more than half the way to a sheet that faces this one; by what factor
    Rough,   ///< | |grad psi| - 1 | exceeds kGradientTolerance; by what factor
    Cut      ///< S is cut here: 1
};
constexpr std::size_t kDoubts = 4;

/// Lengths and curvatures in voxels.
struct SurfaceSurvey {
    std::vector<SurfacePiece> pieces;  ///< those that hold surface, the largest first
    double area = 0;                   ///< of all
    double largestCurvature = 0;       ///< LevelSetStats has the 95th percentile
    double facingShare = 0;            ///< of the core: a sheet faces it within two voxels
    BandBounds bounds;                 ///< M&S (14)
    double godunovBand = 0;            ///< h by default; that of `jet` is bounds.lower

    std::vector<float> doubt;                   ///< per band node: the largest factor; 0: none
    std::size_t doubtful = 0;                   ///< nodes with any
    std::array<std::size_t, kDoubts> doubts{};  ///< nodes with each

    /// Largest voxel size, in voxels of now, at which M&S (14) would hold for the 95th percentile
    /// of curvature and for the reach. Edges that are sharp in truth stay so at any size.
    double resolvingSize = 0;
    std::uint64_t bytes = 0;  ///< estimate of what band, level set and march of `jet` need
    double seconds = 0;       ///< estimate for band and march on one core
};

/// Of band and march with `jet` together, from docs/accuracy.md (a core at 2.5 GHz). Constants, not
/// a trial march, so that a survey says the same every time.
constexpr double kJetSecondsPerNode = 0.42e-6, kJetBytesPerNode = 33;

/// Describes a level set and the band on it.
///
/// Pieces are those of the core, connected where Band::linked lets a front pass; areas, rims and
/// genus are those of surfaceMesh(). Doubts are judged at the nodes of the core, curvature by the
/// Hessian of psi there as in checkLevelSet; other nodes take the largest of the core around their
/// foot points.
/// @param band bandFromLevelSet() of the whole level set, h >= sqrt(3) voxels
/// @throws Error  Cancelled through `progress`
/// Time O(n log n), mostly parallel; 100 bytes per core node while it works. Areas are those of
/// flat triangles: second order in dx.
SurfaceSurvey survey(const LevelSet& levelSet, const Band& band,
                     Progress& progress = Progress::none());

/// What a file holds, and the surface among it. Where it is refused, what was found out before.
struct FileSurvey {
    std::string file;              ///< as named
    std::vector<GridEntry> grids;  ///< all of them
    LevelSet levelSet;             ///< psi null: none was chosen; else as checkLevelSet leaves it
    Vec3d low, high;               ///< box of its active voxels, world; if transform.dx is not 0
    Band band;                     ///< of the default width for `jet`
    std::optional<SurfaceSurvey> surface;  ///< none where it is refused
    std::optional<Error> refusal;          ///< BadInput or Io

    /// No refusal, but warnings, cuts, or places that the grid does not resolve.
    bool withCare() const;
    /// "usable: ...", "usable with care: ..." or "not usable: ...", a line without its end.
    std::string verdict() const;
};

/// Reads, checks and surveys.
/// @throws Error  Cancelled through `progress`, and what is neither BadInput nor Io
FileSurvey surveyFile(const GridSource& source, Progress& progress = Progress::none());

}  // namespace igeo
