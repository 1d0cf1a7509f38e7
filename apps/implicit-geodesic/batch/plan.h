/// The plan of a batch, made before anything runs.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "batch/summary.h"
#include "console.h"
#include "options/run_options.h"

struct BatchJob : ManifestJob {
    RunOptions options;  ///< its arguments, parsed
};

using JobNumbers = std::vector<std::size_t>;  ///< indices in the manifest

struct BatchPlan {
    std::vector<BatchJob> jobs;
    std::vector<JobNumbers> groups;            ///< of the shard: jobs on one surface
    std::map<std::size_t, JobRecord> records;  ///< of the shard; complete for jobs done before
    std::size_t doneBefore = 0;
    Summary summary;                                  ///< without its jobs
    std::map<std::string, std::string> inputDigests;  ///< of the shard's input files
};

/// Files by their absolute names.
struct BatchFiles {
    std::string manifest, summary;
    std::string table, log, view;  ///< empty: none

    /// The locks of a batch that runs, which it removes.
    std::string summaryLock() const { return summary + ".lock"; }
    std::string manifestLock() const { return manifest + ".lock"; }
};

/// Parses and checks all jobs, and selects those of a shard. File names in the jobs are relative to
/// the current folder.
/// @throws igeo::Error  InvalidArgument for a job that cannot run, or not together with the others;
///         Io, BadInput for the summary of an earlier batch
BatchPlan planBatch(const std::vector<ManifestJob>& jobs, const BatchFiles& files,
                    const Part& shard, ConsoleProgress& progress);

/// Prints each job of the shard, whether it will run, and its command.
void printPlan(const BatchPlan& plan);

/// Groups jobs that agree in a part of their options, each group in the order of the manifest.
template <typename OptionsPart>
std::vector<JobNumbers> groupBy(const std::vector<BatchJob>& jobs, const JobNumbers& numbers) {
    std::vector<JobNumbers> lots;
    for (const std::size_t k : numbers) {
        const OptionsPart& own = jobs[k].options;
        std::size_t lot = 0;
        while (lot < lots.size() &&
               !(own == static_cast<const OptionsPart&>(jobs[lots[lot].front()].options)))
            ++lot;
        if (lot == lots.size()) lots.emplace_back();
        lots[lot].push_back(k);
    }
    return lots;
}
