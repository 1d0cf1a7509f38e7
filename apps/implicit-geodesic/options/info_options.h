/// The subcommand `info`.
#pragma once

#include <igeo/io/grid_source.h>

#include <optional>
#include <string>
#include <vector>

#include "options/process_options.h"

struct Command;

struct InfoOptions : ProcessOptions {
    std::vector<std::string> words;  ///< of the command line, for the document
    igeo::GridSource source;         ///< a volume and a grid of it, a mesh or points
    double voxelSize = 0;            ///< of a mesh or points; 0: by resolution
    std::optional<double> iso;       ///< of a volume of voxels
    int resolution = 0;              ///< voxels along the longest side; 0: default
    bool json = false;               ///< print the survey as JSON instead of text
    std::string unreliable;  ///< file of the volume of unreliable places; empty: not written
};

Command infoCommand(InfoOptions& options);
