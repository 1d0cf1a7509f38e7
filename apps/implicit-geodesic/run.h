/// The job: from a level set to distances and geodesics.
#pragma once

#include "console.h"
#include "options/run_options.h"

class MetricInput;
class SurfaceInput;

/// Refuses files that cannot be read or written, before any is read; what options say against each
/// other was refused when they were parsed.
/// @throws igeo::Error  InvalidArgument
void checkRun(const RunOptions& options);

/// Checks, then walks the street: read, check, band, seeds, march, trace, write.
/// @return kDone or kUnreached
/// @throws igeo::Error
int run(const RunOptions& options, Console& console, ConsoleProgress& progress);

/// The street from the band on, for options that were checked, on a surface with the SurfaceOptions
/// of the job and a metric with its MetricOptions, read or not. Jobs may share both and run side by
/// side; each writes what `run` would.
int runOn(const SurfaceInput& surface, MetricInput& metric, const RunOptions& options,
          Console& console, ConsoleProgress& progress);
