/// The surface, its band and the scheme.
#pragma once

#include <igeo/io/grid_source.h>
#include <igeo/march/scheme.h>

#include <optional>
#include <string>

struct Command;

enum class SurfaceKind { None, Volume, Mesh, Points, VoxelVolume };

/// The options that determine a surface and its bands: jobs that agree in them share both.
struct SurfaceOptions {
    SurfaceKind kind = SurfaceKind::None;
    igeo::GridSource source;  ///< a grid only for a volume
    double voxelSize = 0;     ///< of a mesh, points or volume; 0: by resolution
    int resolution = 0;       ///< voxels along the longest side; 0: default
    /// Largest gap between components of a mesh, world units; 0: none is joined
    double joinGaps = 0;
    bool rebuild = false;       ///< redistance the volume
    std::optional<double> iso;  ///< the value that becomes the surface; none: by class

    double band = 0;        ///< world units; 0: default
    double bandVoxels = 0;  ///< voxels; 0: default

    igeo::Scheme scheme = igeo::Scheme::Jet;
    std::optional<int> order;  ///< of godunov's differences; none: 2

    bool operator==(const SurfaceOptions&) const = default;
};

/// The kind of surface by the name of a file: a VDB volume, unless the ending is that of a mesh,
/// points or voxels.
SurfaceKind kindByName(const std::string& file);

/// The option for a kind of surface: --sdf, --mesh, --points or --volume.
std::string optionFor(SurfaceKind kind);

/// Adds the surface as an argument without option, its kind by its name.
void addSurfaceArgument(Command& command, SurfaceOptions& options);
void addSurfaceOptions(Command& command, SurfaceOptions& options);
void addBandOptions(Command& command, SurfaceOptions& options);
void addSchemeOptions(Command& command, SurfaceOptions& options);

/// --voxel-size and --resolution
void addVoxelSizeOptions(Command& command, double& voxelSize, int& resolution);
