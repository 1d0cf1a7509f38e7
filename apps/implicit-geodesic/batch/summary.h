/// What became of the jobs of a batch.
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
    std::optional<int> exitCode;                 ///< as of a run on its own; none: has not run
    std::string what, remedy;                    ///< where it failed
    std::vector<std::string> warnings;           ///< of the run
    std::string digest;                          ///< of the program, the options and all inputs
    std::map<std::string, std::string> outputs;  ///< of each file its digest
    Json provenance = Json::object();            ///< of the run, if it is done: provenanceJson

    void fail(const Failure& failure) {
        exitCode = failure.exitCode, what = failure.what, remedy = failure.remedy;
    }
    /// Whether it has left its results.
    bool done() const;
    /// "waiting", "done", "unreached" (done, but for a target) or "failed"
    const char* status() const;
    bool operator==(const JobRecord& other) const;
};

/// docs/summary.schema.json. The same jobs and outcomes give the same bytes.
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

/// That of the whole batch, from those of its shards. The same job in two of them is fine if they
/// agree.
/// @throws igeo::Error  BadInput for shards of different batches, records that contradict each
///         other, and missing jobs
Summary mergedSummary(const std::vector<std::string>& files);

/// One sentence on the whole.
/// @param file where the summary is
void tell(const Summary& summary, const std::string& file, Console& console);
