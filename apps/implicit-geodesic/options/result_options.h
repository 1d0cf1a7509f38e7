/// Options for the results of a run.
#pragma once

#include <igeo/base/types.h>
#include <igeo/results/picture_options.h>

#include <optional>
#include <set>
#include <string>

#include "batch/part.h"

struct Command;

/// A grid in the output besides the distance.
enum class Grid { Surface, Gradient, Label, Color, LogMap, Weight, Curvature, Engraved };

struct ImageSize {
    int width = 0, height = 0;  ///< pixels
};

struct Camera {
    igeo::Vec3d eye;                    ///< world
    std::optional<igeo::Vec3d> lookAt;  ///< world; none: the middle of the surface
};

struct PictureOptions {
    std::string image, view;                     ///< files; empty: none
    std::optional<ImageSize> imageSize;          ///< none: default
    std::optional<Camera> camera;                ///< none: chosen
    std::optional<igeo::Vec3d> up;               ///< none: y
    std::optional<igeo::Background> background;  ///< none: white
    std::string unit;                            ///< of lengths, in the legend; empty: none
    std::string colorMap;                        ///< of igeo::ColorMap::names(); empty: viridis
};

/// File names are empty for results that are not requested.
struct ResultOptions {
    std::string output;  ///< empty: <input>_geodesic.vdb in the current folder
    std::set<Grid> grids;
    std::string name;  ///< of the distance grid; empty: <psi>_geodesic
    bool extend = false;
    std::string paths, isolines, meshOut, perVertex, samples, matrix, pairsOut, report;
    bool perSeed = false;
    bool straighten = false;
    double pathStep = 0;  ///< between vertices of paths, world units; 0: vertices as traced
    std::optional<double> pathOffset;  ///< of paths along the normal, world units
    int levels = 0;                    ///< of isolines; 0: by spacing
    double spacing = 0;                ///< of isolines, world units times weight; 0: chosen
    std::optional<Part> matrixRows;    ///< none: all

    /// Whether --grids requests a grid.
    bool asked(Grid grid) const { return grids.count(grid) > 0; }
};

void addResultOptions(Command& command, ResultOptions& options);
void addPictureOptions(Command& command, PictureOptions& options);
void addReportOption(Command& command, ResultOptions& options);
