#include "batch.h"

#include <igeo/base/atomic_file.h>
#include <igeo/base/digest.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/version.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>

#include "exit_code.h"
#include "failure.h"
#include "guarded_read.h"
#include "manifest.h"
#include "matrix_parts.h"
#include "metric_input.h"
#include "output_files.h"
#include "process.h"
#include "results.h"
#include "run.h"
#include "summary.h"
#include "surface_input.h"
#include "usage_error.h"

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

const char* const kCreator = "implicit-geodesic ";
/// What writing the summary may take of the time, so that many quick jobs are not held up by it.
constexpr int kWritingShare = 20;

std::string wholeName(const std::string& file) {
    std::error_code ignored;
    return fs::weakly_canonical(fs::absolute(file), ignored).string();
}

/// jobs.json: jobs.summary.json, for shards jobs.summary-2-of-3.json, beside it.
std::string defaultSummary(const fs::path& manifest, const Part& shard) {
    const std::string which =
        shard.whole() ? ""
                      : "-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count);
    return (manifest.parent_path() / (manifest.stem().string() + ".summary" + which + ".json"))
        .string();
}

/// A word as a shell reads it.
std::string shellWord(const std::string& word) {
    const bool plain = word.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./:,"
                           "+") == std::string::npos;
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    return quoted + "'";
}

class Batch {
public:
    Batch(const Options& options, Console& console, ConsoleProgress& progress);
    int run();

private:
    using Numbers = std::vector<std::size_t>;  ///< of jobs in the manifest

    void refuseConflicts() const;
    template <typename Part>
    std::vector<Numbers> groupBy(const Numbers& jobs) const;
    void chooseShard();
    void reuseFinishedJobs(const Summary& earlier);
    std::string digestOf(const BatchJob& job);
    void print() const;

    void runGroup(const Numbers& group);
    std::unique_ptr<SurfaceInput> readSurface(const Numbers& group);
    void makeWhatAllNeed(const SurfaceInput& surface, const Numbers& group);
    double memoryFor(const Numbers& group) const;
    std::size_t jobsAtOnce(const SurfaceInput& surface, const Numbers& group) const;
    void runJob(const SurfaceInput& surface, MetricInput& metric, std::size_t number);
    void record(std::size_t number, JobRecord outcome);
    void writeSummary();
    int tellEnd();

    const Options& options_;
    Console& console_;
    ConsoleProgress& progress_;
    const std::string manifest_;  ///< with its folders
    std::vector<BatchJob> jobs_;
    std::string summaryFile_;

    /// Of the jobs in the shard: those on one surface together.
    std::vector<Numbers> groups_;
    std::map<std::string, std::string> inputDigests_;  ///< by file
    std::map<std::size_t, JobRecord> records_;         ///< of the shard
    std::size_t skipped_ = 0, ended_ = 0;
    Summary summary_;
    std::vector<std::size_t> unsaid_;  ///< of the records that the file does not have yet
    Clock::time_point nextWrite_{};
    std::mutex mutex_;  ///< of records_, ended_ and the summary
};

Batch::Batch(const Options& options, Console& console, ConsoleProgress& progress)
    : options_(options),
      console_(console),
      progress_(progress),
      manifest_(wholeName(options.batch.manifest)),
      jobs_(readManifest(options.batch.manifest)) {
    summary_.shard = Part::parse("--shard", options.batch.shard);
    summaryFile_ = options.batch.summary.empty() ? defaultSummary(manifest_, summary_.shard)
                                                 : wholeName(options.batch.summary);
    // Jobs then name their files as single runs in that folder do, in reports as well.
    fs::current_path(fs::path(manifest_).parent_path());
    refuseConflicts();
    chooseShard();
    summary_.creator = std::string(kCreator) + igeo::kVersion;
    summary_.manifest = fs::path(manifest_).filename().string();
    summary_.count = jobs_.size();
    igeo::Digest digest;
    for (const BatchJob& job : jobs_) {
        digest.addWord(job.name);
        for (const std::string& argument : job.arguments) digest.addWord(argument);
        digest.addWord("");
    }
    summary_.digest = digest.hex();
    for (const Numbers& group : groups_)
        for (const std::size_t k : group) {
            try {
                checkRun(jobs_[k].options);
            } catch (const igeo::Error& e) {
                throw igeo::Error(e.kind(), jobs_[k].quoted() + ": " + e.what(), e.remedy());
            }
            JobRecord& job = records_[k];
            job.index = k;
            job.name = jobs_[k].name;
            job.digest = digestOf(jobs_[k]);
        }
    std::error_code ignored;
    if (fs::exists(summaryFile_, ignored)) reuseFinishedJobs(readSummary(summaryFile_));
}

/// Jobs that agree in a part of their options together, each lot in the order of the manifest.
template <typename Part>
std::vector<Batch::Numbers> Batch::groupBy(const Numbers& jobs) const {
    std::vector<Numbers> lots;
    for (const std::size_t k : jobs) {
        const Part& own = jobs_[k].options;
        const auto same = std::find_if(lots.begin(), lots.end(), [&](const Numbers& lot) {
            return own == static_cast<const Part&>(jobs_[lot.front()].options);
        });
        if (same == lots.end())
            lots.push_back({k});
        else
            same->push_back(k);
    }
    return lots;
}

/// What jobs may not do since they run in any order, side by side and without a terminal.
void Batch::refuseConflicts() const {
    std::map<std::string, std::string> writers{{manifest_, "is the manifest"},
                                               {wholeName(summaryFile_), "is the summary"}};
    std::error_code ignored;
    for (const BatchJob& job : jobs_)
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
    for (const BatchJob& job : jobs_)
        for (const std::string& file : inputFiles(job.options)) {
            if (file == "-") usageError(job.quoted() + " reads standard input", "give it a file");
            const auto writer = writers.find(wholeName(file));
            if (writer != writers.end())
                usageError(job.quoted() + " reads '" + file + "', which " + writer->second,
                           "jobs run in no order: put this one into a batch that follows");
        }
}

/// Jobs in the order of their surfaces, on one surface in that of their metrics, cut into shards:
/// so few shards read the same files.
void Batch::chooseShard() {
    Numbers everything(jobs_.size());
    std::iota(everything.begin(), everything.end(), std::size_t(0));
    std::vector<Numbers> all = groupBy<SurfaceOptions>(everything);
    for (Numbers& surface : all) {
        Numbers ordered;
        for (const Numbers& metric : groupBy<MetricOptions>(surface))
            ordered.insert(ordered.end(), metric.begin(), metric.end());
        surface = ordered;
    }
    const std::size_t begin = summary_.shard.begin(jobs_.size()),
                      end = summary_.shard.end(jobs_.size());
    std::size_t position = 0;
    for (const Numbers& group : all) {
        Numbers own;
        for (const std::size_t k : group) {
            if (position >= begin && position < end) own.push_back(k);
            ++position;
        }
        if (!own.empty()) groups_.push_back(own);
    }
}

/// Content is looked at before the job: what changes meanwhile is found by the next batch.
std::string Batch::digestOf(const BatchJob& job) {
    igeo::Digest digest;
    digest.addWord(summary_.creator);
    for (const std::string& argument : job.arguments) digest.addWord(argument);
    for (const std::string& file : inputFiles(job.options)) {
        const auto known = inputDigests_.find(file);
        digest.addWord(known != inputDigests_.end()
                           ? known->second
                           : inputDigests_[file] = igeo::digestOfFile(file));
    }
    return digest.hex();
}

/// Jobs that were done with the same program, options and inputs, and whose outputs are still
/// theirs.
void Batch::reuseFinishedJobs(const Summary& earlier) {
    std::map<std::string, const JobRecord*> known;
    for (const JobRecord& job : earlier.jobs) known[job.name] = &job;
    std::vector<std::pair<JobRecord*, const JobRecord*>> candidates;
    for (auto& [number, job] : records_) {
        const auto before = known.find(job.name);
        if (before != known.end() && before->second->done() && before->second->digest == job.digest)
            candidates.emplace_back(&job, before->second);
    }
    std::vector<char> same(candidates.size());
    igeo::parallelFor(candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto& outputs = candidates[k].second->outputs;
            same[k] = std::all_of(outputs.begin(), outputs.end(), [&](const auto& output) {
                progress_.throwIfCancelled();
                return igeo::digestOfFile(output.first) == output.second;
            });
        }
    });
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        if (!same[k]) continue;
        const std::size_t index = candidates[k].first->index;
        *candidates[k].first = *candidates[k].second;
        candidates[k].first->index = index;
        ++skipped_;
    }
}

void Batch::print() const {
    for (const auto& [number, job] : records_) {
        results() << job.name << ": " << (job.exitCode ? "done before" : "to do") << "\n ";
        results() << " implicit-geodesic";
        for (const std::string& argument : jobs_[number].arguments)
            results() << " " << shellWord(argument);
        results() << "\n";
    }
    results() << std::flush;
}

int Batch::run() {
    if (options_.batch.dryRun) {
        print();
        return kDone;
    }
    ended_ = skipped_;
    writeSummary();
    if (skipped_ > 0)
        console_.info(std::to_string(skipped_) + " of " + std::to_string(records_.size()) +
                      " jobs are done already");
    for (Numbers group : groups_) {
        group.erase(
            std::remove_if(group.begin(), group.end(),
                           [&](std::size_t k) { return records_.at(k).exitCode.has_value(); }),
            group.end());
        if (!group.empty()) runGroup(group);
    }
    if (!unsaid_.empty()) writeSummary();
    return tellEnd();
}

void Batch::runGroup(const Numbers& group) {
    const std::unique_ptr<SurfaceInput> surface = readSurface(group);
    if (!surface) return;
    makeWhatAllNeed(*surface, group);
    const std::size_t atOnce = jobsAtOnce(*surface, group);
    console_.detail("surface " + surface->name() + ": " + surface->summary() + "; " +
                    std::to_string(group.size()) + " jobs, " + std::to_string(atOnce) + " at once");
    progress_.update("batch", double(ended_) / double(records_.size()));
    // Each metric lives until the last of its jobs is done.
    std::vector<std::shared_ptr<MetricInput>> metrics;
    for (const Numbers& lot : groupBy<MetricOptions>(group))
        metrics.insert(metrics.end(), lot.size(),
                       std::make_shared<MetricInput>(jobs_[lot.front()].options));
    std::atomic<std::size_t> next{0};
    std::exception_ptr stop;
    // No exception may leave the loop: TBB would cut short the loops of the other jobs, which would
    // not know and write what they have.
    igeo::parallelFor(atOnce, 1, [&](std::size_t, std::size_t) {
        try {
            for (std::size_t k = next++; k < group.size(); k = next++) {
                const std::shared_ptr<MetricInput> metric = std::move(metrics[k]);
                runJob(*surface, *metric, group[k]);
            }
        } catch (...) {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (!stop) stop = std::current_exception();
            next = group.size();
        }
    });
    if (!stop) return;
    try {
        if (!unsaid_.empty()) writeSummary();
    } catch (const std::exception&) {
        // The first trouble is the one to tell of.
    }
    std::rethrow_exception(stop);
}

/// @return null if it cannot be used, and all jobs of the group have failed
std::unique_ptr<SurfaceInput> Batch::readSurface(const Numbers& group) {
    try {
        auto surface = SurfaceInput::of(jobs_[group.front()].options);
        progress_.update("read", 0);
        surface->read();
        surface->prepare(progress_);
        return surface;
    } catch (...) {
        const Failure failure = currentFailure();
        progress_.throwIfCancelled();
        for (const std::size_t k : group) {
            JobRecord outcome = records_[k];
            outcome.exitCode = failure.exitCode;
            outcome.what = failure.what;
            outcome.remedy = failure.remedy;
            record(k, outcome);
        }
        return nullptr;
    }
}

/// The band of the whole surface, if a job is sure to ask for it: by all threads at once.
void Batch::makeWhatAllNeed(const SurfaceInput& surface, const Numbers& group) {
    const bool everywhere = std::any_of(group.begin(), group.end(), [&](std::size_t k) {
        const Options& o = jobs_[k].options;
        return o.hasSeeds() && !(o.maxDistance > 0) && !o.stopAtTargets;
    });
    if (!everywhere) return;
    if (surface.estimatedMemory() > memoryFor(group)) return;
    try {
        surface.band({}, progress_);
    } catch (const std::exception&) {
        progress_.throwIfCancelled();
        // Each job that needs it says why it cannot be made.
    }
}

/// GiB: of the machine, or the least that a job allows.
double Batch::memoryFor(const Numbers& group) const {
    double memory = machineMemory() / kGiB;
    for (const std::size_t k : group)
        if (const double limit = jobs_[k].options.memoryLimit; limit > 0)
            memory = std::min(memory, limit);
    return memory;
}

/// As many as there are threads, and as memory holds.
std::size_t Batch::jobsAtOnce(const SurfaceInput& surface, const Numbers& group) const {
    const auto fit = std::size_t(std::min(memoryFor(group) / surface.estimatedMemory(), 1e6));
    return std::max<std::size_t>(
        1, std::min({group.size(), std::size_t(igeo::ThreadLimit::current()), fit}));
}

void Batch::runJob(const SurfaceInput& surface, MetricInput& metric, std::size_t number) {
    const BatchJob& job = jobs_[number];
    JobRecord outcome = records_.at(number);
    try {
        Console console(options_.verbose ? Console::Level::Verbose : Console::Level::Quiet,
                        job.quoted() + ": ");
        ConsoleProgress quiet("never");
        outcome.exitCode = runOn(surface, metric, job.options, console, quiet);
        for (const std::string& file : outputFiles(job.options))
            outcome.outputs[file] = igeo::digestOfFile(file);
    } catch (...) {
        progress_.throwIfCancelled();
        const Failure failure = currentFailure();
        outcome.exitCode = failure.exitCode;
        outcome.what = failure.what;
        outcome.remedy = failure.remedy;
    }
    record(number, outcome);
}

void Batch::record(std::size_t number, JobRecord outcome) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!outcome.done()) outcome.outputs.clear();
    records_.at(number) = std::move(outcome);
    unsaid_.push_back(number);
    if (Clock::now() >= nextWrite_) writeSummary();
    progress_.update("batch", double(++ended_) / double(records_.size()));
}

/// Only what is recorded is said to be done.
void Batch::writeSummary() {
    const Clock::time_point begin = Clock::now();
    summary_.jobs.clear();
    for (const auto& [k, job] : records_) summary_.jobs.push_back(job);
    igeo::writeFile(summaryFile_, summary_.text());
    nextWrite_ = Clock::now() + (kWritingShare - 1) * (Clock::now() - begin);
    for (const std::size_t k : unsaid_) {
        const JobRecord& job = records_.at(k);
        const std::string name = jobs_[k].quoted();
        if (!job.done())
            Console::error(name + ": " + job.what, job.remedy);
        else if (job.exitCode == kUnreached)
            console_.warning(name + " is done, but a target is unreached");
        else
            console_.info(name + " is done");
    }
    unsaid_.clear();
}

/// One sentence on the whole.
void tell(const Summary& summary, const std::string& file, Console& console) {
    const std::vector<std::string> failed = summary.namesOf("failed"),
                                   unreached = summary.namesOf("unreached");
    const std::string all = std::to_string(summary.jobs.size()) + " jobs";
    if (!failed.empty())
        Console::error(std::to_string(failed.size()) + " of " + all + " failed: " + listed(failed),
                       "'" + file + "' says why; the next run of the batch goes on with them");
    else if (!unreached.empty())
        console.warning("all " + all + " are done, but targets are unreached in " +
                        listed(unreached));
    else
        console.info("all " + all + " are done");
}

int Batch::tellEnd() {
    progress_.clear();
    tell(summary_, fs::path(summaryFile_).filename().string(), console_);
    return summary_.exitCode();
}

}  // namespace

int batch(const Options& options, Console& console, ConsoleProgress& progress) {
    if (options.batch.manifest.empty())
        usageError("no manifest is given", "name a file of jobs; see docs/formats.md");
    return Batch(options, console, progress).run();
}

int merge(const BatchOptions& options, Console& console) {
    if (options.matrix) {
        writeDocument(options.output, joinedMatrix(options.parts, options.output));
        return kDone;
    }
    const Summary summary = mergedSummary(options.parts);
    writeDocument(options.output, summary.text());
    tell(summary, options.output, console);
    return summary.exitCode();
}
