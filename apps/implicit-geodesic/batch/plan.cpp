#include "batch/plan.h"

#include <igeo/base/digest.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/version.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "options/options.h"
#include "output/output_files.h"
#include "output/result_checks.h"
#include "output/stdout.h"
#include "usage_error.h"

namespace fs = std::filesystem;

namespace {

const char* const kCreator = "implicit-geodesic ";

/// Removes the defaults that have no effect on a job.
void keepWhatMatters(BatchJob& job) {
    // Options may have an effect on those alone that have none: --order on --scheme.
    for (auto idle = optionsWithoutEffect(job.options); !idle.empty();
         idle = optionsWithoutEffect(job.options)) {
        for (const WithoutEffect& w : idle) {
            if (job.defaults.count(w.option) == 0) w.refuse();
            std::erase_if(job.arguments, [&](const std::string& argument) {
                return argument == w.option || argument.rfind(w.option + "=", 0) == 0;
            });
        }
        job.options = parseJob(job.arguments);
    }
}

std::vector<BatchJob> parsedJobs(const std::vector<ManifestJob>& jobs) {
    std::vector<BatchJob> parsed;
    for (const ManifestJob& job : jobs) {
        parsed.push_back({job, {}});
        igeo::naming(job.quoted(), [&] {
            parsed.back().options = parseJob(job.arguments);
            keepWhatMatters(parsed.back());
            parsed.back().options.words = parsed.back().arguments;
        });
    }
    return parsed;
}

/// Refuses what jobs must not do, because they run in any order, side by side and without a
/// terminal.
void refuseConflicts(const std::vector<BatchJob>& jobs, const BatchFiles& files) {
    std::map<std::string, std::string> writers{{files.manifest, "is the manifest"},
                                               {files.summary, "is the summary"},
                                               {files.manifestLock(), "is a lock of the batch"},
                                               {files.summaryLock(), "is a lock of the batch"}};
    if (!files.table.empty()) writers.emplace(files.table, "is the table of the jobs");
    if (!files.view.empty()) writers.emplace(files.view, "is the page of the batch");
    if (!files.log.empty()) writers.emplace(files.log, "is the log");
    std::error_code ignored;
    for (const BatchJob& job : jobs)
        for (const std::string& file : outputFiles(job.options)) {
            if (file == "-")
                usageError(job.quoted() + " writes to standard output",
                           "give each of its results a file");
            const bool device = fs::exists(file, ignored) && !fs::is_regular_file(file, ignored);
            if (device) continue;
            const auto [other, fresh] = writers.emplace(wholeName(file), job.quoted() + " writes");
            if (!fresh)
                usageError(job.quoted() + " writes '" + file + "', which " + other->second,
                           "give each its own files, the distances (\"output\") as well");
        }
    for (const BatchJob& job : jobs)
        for (const std::string& file : inputFiles(job.options)) {
            if (file == "-") usageError(job.quoted() + " reads standard input", "give it a file");
            const auto writer = writers.find(wholeName(file));
            if (writer != writers.end())
                usageError(job.quoted() + " reads '" + file + "', which " + writer->second,
                           "jobs run in any order: put this one into a second batch");
        }
}

/// Jobs sorted by surface, and on one surface by metric, then cut into shards, so that few shards
/// read the same files.
std::vector<JobNumbers> groupsOf(const std::vector<BatchJob>& jobs, const Part& shard) {
    JobNumbers everything(jobs.size());
    std::iota(everything.begin(), everything.end(), std::size_t(0));
    const std::size_t begin = shard.begin(jobs.size()), end = shard.end(jobs.size());
    std::vector<JobNumbers> groups;
    std::size_t position = 0;
    for (const JobNumbers& surface : groupBy<SurfaceOptions>(jobs, everything)) {
        JobNumbers own;
        for (const JobNumbers& metric : groupBy<MetricOptions>(jobs, surface))
            for (const std::size_t k : metric) {
                if (position >= begin && position < end) own.push_back(k);
                ++position;
            }
        if (!own.empty()) groups.push_back(own);
    }
    return groups;
}

/// The digest of the names and options of all jobs.
std::string digestOf(const std::vector<BatchJob>& jobs) {
    igeo::Digest digest;
    for (const BatchJob& job : jobs) {
        digest.addWord(job.name);
        for (const std::string& argument : job.arguments) digest.addWord(argument);
        digest.addWord("");
    }
    return digest.hex();
}

/// The digest of the program, a job's options and the content of its inputs. The content is read
/// before the job, so the next batch detects changes made meanwhile.
/// @param known digests of files; those of this job are added
std::string digestOf(const BatchJob& job, const std::string& creator,
                     std::map<std::string, std::string>& known) {
    igeo::Digest digest;
    digest.addWord(creator);
    for (const std::string& argument : job.arguments) digest.addWord(argument);
    for (const std::string& file : inputFiles(job.options)) {
        if (known.count(file) == 0) known[file] = igeo::digestOfFile(file);
        digest.addWord(known[file]);
    }
    return digest.hex();
}

/// Takes over jobs that were done with the same program, options and inputs, and whose outputs are
/// unchanged.
void reuseFinishedJobs(const Summary& earlier, BatchPlan& plan, ConsoleProgress& progress) {
    std::map<std::string, const JobRecord*> known;
    for (const JobRecord& job : earlier.jobs) known[job.name] = &job;
    std::vector<std::pair<JobRecord*, const JobRecord*>> candidates;
    for (auto& [number, job] : plan.records) {
        const auto before = known.find(job.name);
        if (before != known.end() && before->second->done() && before->second->digest == job.digest)
            candidates.emplace_back(&job, before->second);
    }
    std::vector<char> same(candidates.size());
    igeo::parallelFor(candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto& outputs = candidates[k].second->outputs;
            same[k] = std::all_of(outputs.begin(), outputs.end(), [&](const auto& output) {
                progress.throwIfCancelled();
                return igeo::digestOfFile(output.first) == output.second;
            });
        }
    });
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        if (!same[k]) continue;
        const std::size_t index = candidates[k].first->index;
        *candidates[k].first = *candidates[k].second;
        candidates[k].first->index = index;
        ++plan.doneBefore;
    }
}

/// A word quoted for a shell.
std::string shellWord(const std::string& word) {
    const bool plain = word.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./:,"
                           "+") == std::string::npos;
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    return quoted + "'";
}

}  // namespace

BatchPlan planBatch(const std::vector<ManifestJob>& jobs, const BatchFiles& files,
                    const Part& shard, ConsoleProgress& progress) {
    BatchPlan plan;
    plan.jobs = parsedJobs(jobs);
    refuseConflicts(plan.jobs, files);
    plan.groups = groupsOf(plan.jobs, shard);
    plan.summary.creator = std::string(kCreator) + igeo::kVersion;
    plan.summary.manifest = fs::path(files.manifest).filename().string();
    plan.summary.count = plan.jobs.size();
    plan.summary.digest = digestOf(plan.jobs);
    plan.summary.shard = shard;
    for (const JobNumbers& group : plan.groups)
        for (const std::size_t k : group) {
            const BatchJob& job = plan.jobs[k];
            igeo::naming(job.quoted(), [&] { checkFiles(job.options); });
            JobRecord& record = plan.records[k];
            record.index = k;
            record.name = job.name;
            record.digest = digestOf(job, plan.summary.creator, plan.inputDigests);
        }
    std::error_code ignored;
    if (fs::exists(files.summary, ignored))
        reuseFinishedJobs(readSummary(files.summary), plan, progress);
    return plan;
}

void printPlan(const BatchPlan& plan) {
    for (const auto& [number, job] : plan.records) {
        results() << job.name << ": " << (job.exitCode ? "done before" : "to do") << "\n ";
        results() << " implicit-geodesic";
        for (const std::string& argument : plan.jobs[number].arguments)
            results() << " " << shellWord(argument);
        results() << "\n";
    }
    results() << std::flush;
}
