/// The main job, as a user or a batch asks for it.
#pragma once

#include "options/metric_options.h"
#include "options/process_options.h"
#include "options/result_options.h"
#include "options/seed_options.h"
#include "options/surface_options.h"

struct Command;

struct RunOptions : SurfaceOptions,
                    MetricOptions,
                    SeedOptions,
                    ResultOptions,
                    PictureOptions,
                    ProcessOptions {
    double memoryLimit = 0;  ///< GiB; 0: what the machine has

    /// Whether results are asked for that a run without seeds does not have.
    bool needsSeeds() const {
        return !output.empty() || !grids.empty() || extend || !meshOut.empty() ||
               !isolines.empty() || !matrix.empty() || hasTargets();
    }
    /// What else than paths reads the gradient of the distance.
    bool needsGradient() const {
        return !meshOut.empty() || !isolines.empty() || !image.empty() || asked(Grid::Gradient) ||
               asked(Grid::Label) || asked(Grid::Engraved);
    }
};

/// As the program takes it.
Command runCommand(RunOptions& options);
/// As a batch takes it: without options on how the process runs.
Command jobCommand(RunOptions& options);
