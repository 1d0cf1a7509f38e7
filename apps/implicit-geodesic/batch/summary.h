/// The outcomes of the jobs of a batch.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/part.h"
#include "console.h"
#include "failure.h"
#include "json_file.h"

struct JobRecord {
    std::size_t index = 0;  ///< in the manifest
    std::string name;
    std::optional<int> exitCode;                 ///< as of a single run; none: not run yet
    std::string what, remedy;                    ///< error of a failed job
    std::vector<std::string> warnings;           ///< of the run
    std::string digest;                          ///< of the program, the options and all inputs
    std::map<std::string, std::string> outputs;  ///< digest of each file
    Json provenance = Json::object();            ///< of a finished run: provenanceJson

    void fail(const Failure& failure) {
        exitCode = failure.exitCode, what = failure.what, remedy = failure.remedy;
    }
    /// Whether its results exist.
    bool done() const;
    /// "waiting", "done", "unreached" (done, but a target, pair or --via is unreached) or "failed"
    const char* status() const;
    /// Whether another record is of the same work and its results, apart from times and memory.
    bool sameOutcome(const JobRecord& other) const;
};

/// docs/summary.schema.json. The same jobs and outcomes give the same bytes, apart
/// from times and memory.
struct Summary {
    std::string creator;    ///< program and version
    std::string manifest;   ///< its name without folders
    std::string digest;     ///< of the names and options of all its jobs
    std::size_t count = 0;  ///< of all its jobs
    Part shard;
    std::vector<JobRecord> jobs;  ///< of the shard, in the order of the manifest

    /// 0; the largest code of the jobs that failed; or kUnreached, if none did.
    int exitCode() const;
    std::vector<std::string> namesOf(const char* status) const;
    std::string text() const;
};

/// @throws igeo::Error  Io, BadInput
Summary readSummary(const std::string& file);

/// The summary of the whole batch, from those of its shards. A job may be in two of them if they
/// agree.
/// @throws igeo::Error  BadInput for shards of different batches, contradictory records, and
///         missing jobs
Summary mergedSummary(const std::vector<std::string>& files);

/// Prints one sentence about the whole batch.
/// @param file the file of the summary
void tell(const Summary& summary, const std::string& file, Console& console);
