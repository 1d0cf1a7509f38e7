#include "batch/summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include "exit_code.h"
#include "file_ending.h"
#include "json_file.h"

bool JobRecord::done() const { return exitCode == kDone || exitCode == kUnreached; }

const char* JobRecord::status() const {
    if (!exitCode) return "waiting";
    return exitCode == kDone ? "done" : exitCode == kUnreached ? "unreached" : "failed";
}

bool JobRecord::sameOutcome(const JobRecord& o) const {
    // Documents hold times.
    const auto sameOutput = [](const auto& a, const auto& b) {
        return a.first == b.first && (a.second == b.second || endingOf(a.first) == ".json");
    };
    return std::tie(index, name, exitCode, what, remedy, warnings, digest) ==
               std::tie(o.index, o.name, o.exitCode, o.what, o.remedy, o.warnings, o.digest) &&
           std::equal(outputs.begin(), outputs.end(), o.outputs.begin(), o.outputs.end(),
                      sameOutput);
}

int Summary::exitCode() const {
    int failed = kDone, unreached = kDone;
    for (const JobRecord& job : jobs)
        if (job.exitCode == kUnreached)
            unreached = kUnreached;
        else
            failed = std::max(failed, job.exitCode.value_or(kDone));
    return failed != kDone ? failed : unreached;
}

std::vector<std::string> Summary::namesOf(const char* status) const {
    std::vector<std::string> names;
    for (const JobRecord& job : jobs)
        if (std::string(job.status()) == status) names.push_back(job.name);
    return names;
}

namespace {

/// The members of provenanceJson in a job's record, besides the warnings.
constexpr std::array kProvenance{"command",    "versions", "inputs",  "surface",
                                 "parameters", "metric",   "seconds", "peakMemoryBytes"};

Json recordJson(const JobRecord& job) {
    Json j = {{"index", job.index}, {"name", job.name}, {"status", job.status()}};
    if (!job.exitCode) return j;
    j["exitCode"] = *job.exitCode;
    if (!job.done()) j["error"] = {{"what", job.what}, {"remedy", job.remedy}};
    j["warnings"] = job.warnings;
    j["digest"] = job.digest;
    j["outputs"] = job.outputs;
    j.update(job.provenance);
    return j;
}

JobRecord recordOf(const Json& j) {
    JobRecord job;
    j.at("index").get_to(job.index);
    j.at("name").get_to(job.name);
    if (!j.contains("exitCode")) return job;
    job.exitCode = j["exitCode"].get<int>();
    if (j.contains("error")) {
        j["error"].at("what").get_to(job.what);
        j["error"].at("remedy").get_to(job.remedy);
    }
    j.at("warnings").get_to(job.warnings);
    j.at("digest").get_to(job.digest);
    j.at("outputs").get_to(job.outputs);
    for (const char* member : kProvenance)
        if (j.contains(member)) job.provenance[member] = j[member];
    return job;
}

/// Refuses numbers that occur only in files edited by hand.
void requireSound(const Summary& summary, const std::string& file) {
    constexpr std::size_t kMostJobs = 1000000000;
    if (!summary.shard.valid())
        inputError(file + " is of shard " + summary.shard.text() + ", which does not exist",
                   "shards are numbered from 1 to their count, 1000000 at most; run it again");
    if (summary.count > kMostJobs)
        inputError(fmt::format("{} is of {} jobs, more than {}", file, summary.count, kMostJobs),
                   "run the batch again");
    for (const JobRecord& job : summary.jobs)
        if (job.index >= summary.count)
            inputError(
                fmt::format("{} has job {} of {} (counted from 0)", file, job.index, summary.count),
                "run the batch again");
}

}  // namespace

std::string Summary::text() const {
    Json j = {{"schema", 2},          {"type", "summary"}, {"creator", creator},
              {"manifest", manifest}, {"digest", digest},  {"count", count}};
    j["shard"] =
        shard.whole() ? Json(nullptr) : Json{{"number", shard.number}, {"count", shard.count}};
    j["jobs"] = Json::array();
    for (const JobRecord& job : jobs) j["jobs"].push_back(recordJson(job));
    return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Summary readSummary(const std::string& file) {
    const Json j = readJson(file);
    try {
        if (j.at("schema") != 2 || j.at("type") != "summary")
            inputError(file + " is no summary of a batch", "name another file");
        Summary summary;
        j.at("creator").get_to(summary.creator);
        j.at("manifest").get_to(summary.manifest);
        j.at("digest").get_to(summary.digest);
        j.at("count").get_to(summary.count);
        if (!j.at("shard").is_null()) {
            j["shard"].at("number").get_to(summary.shard.number);
            j["shard"].at("count").get_to(summary.shard.count);
        }
        for (const Json& job : j.at("jobs")) summary.jobs.push_back(recordOf(job));
        requireSound(summary, file);
        return summary;
    } catch (const Json::exception&) {
        inputError(file + " is no summary of a batch", "name another file, or remove this one");
    }
}

namespace {

/// "a, b and 3 more"
std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 8;
    std::string text;
    for (std::size_t k = 0; k < std::min(names.size(), kMost); ++k)
        text += (k ? ", " : "") + names[k];
    if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
    return text;
}

/// Refuses jobs missing in all summaries, and names the shards that they belong to.
void refuseMissing(const Summary& whole, const std::vector<Part>& shards) {
    std::vector<std::string> missing = whole.namesOf("waiting");
    if (!missing.empty())
        inputError("jobs that have not run: " + listed(missing),
                   "finish their shards: the same command continues it");
    if (whole.jobs.size() == whole.count) return;
    std::set<std::size_t> given;
    for (const Part& shard : shards) given.insert(shard.number);
    for (std::size_t k = 1; k <= shards.front().count; ++k)
        if (!given.count(k)) missing.push_back(Part{k, shards.front().count}.text());
    inputError(std::to_string(whole.count - whole.jobs.size()) + " of " +
                   std::to_string(whole.count) + " jobs are in none of the summaries; shards " +
                   "that are missing: " + listed(missing),
               "name the summaries of all shards");
}

}  // namespace

Summary mergedSummary(const std::vector<std::string>& files) {
    Summary whole;
    std::vector<Part> shards;
    // Each with the name of its file.
    std::map<std::size_t, std::pair<JobRecord, std::string>> jobs;
    for (const std::string& file : files) {
        const Summary part = readSummary(file);
        if (shards.empty()) whole = part;
        if (std::tie(part.creator, part.digest, part.count) !=
            std::tie(whole.creator, whole.digest, whole.count))
            inputError(files.front() + " and " + file +
                           " are of different batches: other jobs, other options or another "
                           "version of the program",
                       "run all shards from one manifest with one version");
        shards.push_back(part.shard);
        for (const JobRecord& job : part.jobs) {
            auto& [known, from] = jobs.try_emplace(job.index, job, file).first->second;
            if (!known.exitCode) known = job, from = file;
            if (job.exitCode && !known.sameOutcome(job))
                inputError("job '" + job.name + "' differs in " + from + " and " + file,
                           "run that job again and merge the summaries that follow");
        }
    }
    whole.shard = {};
    whole.jobs.clear();
    for (auto& [index, job] : jobs) whole.jobs.push_back(std::move(job.first));
    refuseMissing(whole, shards);
    return whole;
}

void tell(const Summary& summary, const std::string& file, Console& console) {
    const std::vector<std::string> failed = summary.namesOf("failed"),
                                   unreached = summary.namesOf("unreached");
    const std::string all = std::to_string(summary.jobs.size()) + " jobs",
                      done =
                          summary.jobs.size() == 1 ? "the job is done" : "all " + all + " are done";
    if (!failed.empty())
        Console::error(std::to_string(failed.size()) + " of " + all + " failed: " + listed(failed),
                       "'" + file + "' says why; the next run of the batch continues with them");
    else if (!unreached.empty())
        console.warning(done + ", but a target, pair or --via is unreached in " +
                        listed(unreached));
    else
        console.info(done);
}
