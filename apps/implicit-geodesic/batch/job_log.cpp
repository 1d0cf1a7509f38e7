#include "batch/job_log.h"

#include <igeo/base/error.h>

#include <ctime>

#include "json_file.h"

namespace {

std::string nowUtc() {
    const std::time_t now = std::time(nullptr);
    char text[sizeof "2000-01-01T00:00:00Z"];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
    return text;
}

}  // namespace

JobLog::JobLog(const std::string& file) : file_(file) {
    if (file.empty()) return;
    out_.open(file, std::ios::app);
    if (!out_)
        throw igeo::Error(igeo::Error::Kind::Io, "the log '" + file + "' cannot be written",
                          "name a file in a folder that exists and that you may write to");
}

void JobLog::add(const JobRecord& job, double seconds) {
    if (file_.empty()) return;
    Json line = {{"time", nowUtc()},       {"job", job.name},
                 {"status", job.status()}, {"exitCode", job.exitCode.value_or(0)},
                 {"seconds", seconds},     {"warnings", job.warnings}};
    if (!job.done()) line["error"] = {{"what", job.what}, {"remedy", job.remedy}};
    out_ << line.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!out_)
        throw igeo::Error(igeo::Error::Kind::Io, "the log '" + file_ + "' cannot be written",
                          "check the free space on the disk");
}
