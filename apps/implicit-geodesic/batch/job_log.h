/// The log of a batch: a line of JSON for each job as it ends, for programs that watch it.
#pragma once

#include <fstream>
#include <string>

#include "batch/summary.h"

/// Times are here and not in the summary, which the same jobs give with the same bytes.
class JobLog {
public:
    /// @param file  lines are appended to it; empty: no log
    /// @throws igeo::Error  Io
    explicit JobLog(const std::string& file);

    /// {"time", "job", "status", "exitCode", "seconds", "warnings", "error"}: when it ended (UTC),
    /// and the wall time that it took. Not for two threads at once.
    /// @throws igeo::Error  Io
    void add(const JobRecord& job, double seconds);

private:
    std::string file_;
    std::ofstream out_;
};
