/// The subcommands `batch`, many jobs in one go, and `batch merge`.
#pragma once

#include "console.h"
#include "options/batch_options.h"
#include "options/merge_options.h"

/// Runs the jobs of a manifest that are not done yet, surface by surface, the jobs of one surface
/// side by side, and records each in the summary as it ends. The folder of the manifest becomes the
/// current one.
///
/// A job writes what its single run in the folder of the manifest would, byte by byte. It counts as
/// done if the summary has it with the same program, options, content of inputs and content of
/// outputs; times of files have no effect.
/// @return 0; the largest code of the jobs that failed; or kUnreached, if none did
/// @throws igeo::Error  before anything runs: the manifest, options, outputs; later: the summary
int batch(const BatchOptions& options, Console& console, ConsoleProgress& progress);

/// Joins the summaries of the shards of a batch, or the parts of a matrix.
/// @return for summaries, as `batch` of the whole
/// @throws igeo::Error  BadInput for what does not belong together or is incomplete
int merge(const MergeOptions& options, Console& console);
