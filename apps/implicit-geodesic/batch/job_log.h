/// The log of a batch: a line of JSON for each job as it ends, for monitoring.
#pragma once

#include <fstream>
#include <string>

#include "batch/summary.h"

/// Times are written here and not in the summary, whose bytes depend on the jobs only.
class JobLog {
public:
    /// @param file  lines are appended to it; empty: no log
    /// @throws igeo::Error  Io
    explicit JobLog(const std::string& file);

    /// Writes {"time", "job", "status", "exitCode", "seconds", "warnings", "error"}: the end time
    /// (UTC), and the wall time of the job. For one thread at a time.
    /// @throws igeo::Error  Io
    void add(const JobRecord& job, double seconds);

private:
    std::string file_;
    std::ofstream out_;
};
