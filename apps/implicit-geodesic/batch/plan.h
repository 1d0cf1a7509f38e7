/// What a batch is to do, before anything runs.
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

using JobNumbers = std::vector<std::size_t>;  ///< places in the manifest

struct BatchPlan {
    std::vector<BatchJob> jobs;
    std::vector<JobNumbers> groups;            ///< of the shard: those on one surface together
    std::map<std::size_t, JobRecord> records;  ///< of the shard; those of jobs done before are full
    std::size_t doneBefore = 0;
    Summary summary;                                  ///< but for its jobs
    std::map<std::string, std::string> inputDigests;  ///< of the shard's input files
};

/// Files by their whole names.
struct BatchFiles {
    std::string manifest, summary, log;
};

/// Parses and checks all jobs, and takes those of a shard. Names of files in the jobs are relative
/// to the current folder.
/// @throws igeo::Error  InvalidArgument for a job that cannot run, or not beside the others; Io,
///         BadInput for the summary of an earlier batch
BatchPlan planBatch(const std::vector<ManifestJob>& jobs, const BatchFiles& files,
                    const Part& shard, ConsoleProgress& progress);

/// Prints each job of the shard, whether it is to do, and its command.
void printPlan(const BatchPlan& plan);

/// Jobs that agree in a part of their options together, each lot in the order of the manifest.
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
