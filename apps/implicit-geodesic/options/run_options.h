/// The options of a run, from a user or a batch.
#pragma once

#include "options/metric_options.h"
#include "options/process_options.h"
#include "options/result_options.h"
#include "options/seed_options.h"
#include "options/surface_options.h"

struct RunOptions : SurfaceOptions,
                    MetricOptions,
                    SeedOptions,
                    ResultOptions,
                    PictureOptions,
                    ProcessOptions {
    std::vector<std::string> words;  ///< of the command line, for the report
    double memoryLimit = 0;          ///< GiB; 0: the memory of the machine
};
