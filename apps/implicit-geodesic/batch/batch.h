/// The subcommands `batch`, which runs many jobs, and `batch merge`.
#pragma once

#include "console.h"
#include "options/batch_options.h"
#include "options/merge_options.h"

/// Runs the jobs of a manifest that are not done yet: surface by surface, the jobs of one surface
/// side by side. Records each in the summary as it ends. The folder of the manifest becomes the
/// current one.
///
/// A job writes the same bytes as a single run in the folder of the manifest, apart from the times
/// and the memory in its documents. It counts as done if
/// the summary records it with the same program, options, content of inputs and content of outputs;
/// times of files have no effect.
/// @return 0; the largest code of the jobs that failed; or kUnreached, if none did
/// @throws igeo::Error  before the first job for the manifest, options and outputs; later for the
///         summary
int batch(const BatchOptions& options, Console& console, ConsoleProgress& progress);

/// Merges the summaries of the shards of a batch, or the parts of a matrix.
/// @return for summaries the exit code of `batch` without shards
/// @throws igeo::Error  BadInput for files of different batches or matrices, and for missing parts
int merge(const MergeOptions& options, Console& console);
