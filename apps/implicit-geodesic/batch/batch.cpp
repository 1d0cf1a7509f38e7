#include "batch/batch.h"

#include <fmt/core.h>
#include <igeo/base/atomic_file.h>
#include <igeo/base/digest.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "batch/index_page.h"
#include "batch/job_log.h"
#include "batch/manifest.h"
#include "batch/matrix_parts.h"
#include "batch/plan.h"
#include "batch/summary.h"
#include "exit_code.h"
#include "failure.h"
#include "input/surface_input.h"
#include "output/output_files.h"
#include "output/result_checks.h"
#include "prepared_solver.h"
#include "process.h"
#include "usage_error.h"

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

/// Writing the summary may take 1/20 of the time, so that it does not delay many quick jobs.
constexpr int kWritingShare = 20;

/// jobs.json: jobs.summary.json beside it; for shards jobs.summary-2-of-3.json.
std::string defaultSummary(const fs::path& manifest, const Part& shard) {
    const std::string which =
        shard.whole() ? ""
                      : "-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.count);
    return (manifest.parent_path() / (manifest.stem().string() + ".summary" + which + ".json"))
        .string();
}

/// Refuses a summary, log or page that cannot be written, or that would overwrite another or the
/// jobs. Files that jobs read and write are compared with them later, by planBatch.
void checkOwnOutputs(const BatchOptions& o, const std::string& summary, const std::string& table) {
    std::vector<OutputFile> outputs{{"--summary", o.summary.empty() ? summary : o.summary, ""}};
    if (!o.log.empty()) outputs.push_back({"--log", o.log, ""});
    if (!o.view.empty()) outputs.push_back({"--view", o.view, ".html"});
    std::vector<std::string> inputs{o.manifest};
    if (!table.empty()) inputs.push_back(table);
    checkOutputFiles(outputs, inputs);
}

/// Refuses what would be lost with a lock: an output of its name, and a file that is no lock.
void checkLocks(const BatchFiles& files) {
    for (const std::string& lock : {files.summaryLock(), files.manifestLock()}) {
        for (const auto& [option, file] :
             {std::pair("--summary", files.summary), {"--log", files.log}, {"--view", files.view}})
            if (file == lock)
                usageError(fmt::format("{} {}: that is a lock of the batch", option, file),
                           "give it another name");
        std::ifstream there(lock);
        if (std::string word; there >> word && word != "process")
            usageError("'" + lock + "' is no lock of a batch, which would remove it",
                       "move it, or give the jobs or --summary another name");
    }
}

void tellLeftOut(const std::vector<std::string>& files, const Console& console) {
    if (files.empty()) return;
    const bool one = files.size() == 1;
    console.info(
        fmt::format("{} file{} like \"files\" {} left out, as the batch writes {} itself: {}{}",
                    files.size(), one ? "" : "s", one ? "is" : "are", one ? "it" : "them",
                    files.front(), one ? "" : ", ..."));
}

/// Two batches at once would compute the same jobs twice.
void refuseOther(const ProcessLock& lock, const std::string& does) {
    if (lock.otherOwner().empty()) return;
    throw igeo::Error(igeo::Error::Kind::InvalidArgument,
                      "another batch " + does + ": " + lock.otherOwner(),
                      "wait until it has ended; what it has done then is not done again");
}

/// The solver of jobs with the same surface and metric, made by the first job that needs it.
class SharedSolver {
public:
    PreparedSolver prepared(const igeo::Surface& surface, const RunOptions& options,
                            igeo::Progress& progress) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!prepared_) prepared_ = prepareSolver(surface, options, progress);
        return *prepared_;
    }

private:
    std::mutex mutex_;
    std::optional<PreparedSolver> prepared_;
};

/// A batch that is running.
class Batch {
public:
    Batch(const BatchPlan& plan, const BatchFiles& files, bool verbose, Console& console,
          ConsoleProgress& progress)
        : plan_(plan),
          summaryFile_(files.summary),
          view_(files.view),
          verbose_(verbose),
          log_(files.log),
          console_(console),
          progress_(progress),
          summary_(plan.summary),
          records_(plan.records),
          ended_(plan.doneBefore) {}
    int run();

private:
    void runGroup(const JobNumbers& group);
    std::optional<igeo::Surface> surfaceOf(const JobNumbers& group);
    std::size_t prepareBand(const igeo::Surface& surface, const JobNumbers& group);
    double memoryFor(const JobNumbers& group) const;
    void runJob(const igeo::Surface& surface, SharedSolver& solver, std::size_t number);
    void record(std::size_t number, JobRecord outcome, double seconds);
    void writeSummary();
    int tellEnd();

    const BatchPlan& plan_;
    const std::string summaryFile_, view_;
    const bool verbose_;
    JobLog log_;
    Console& console_;
    ConsoleProgress& progress_;
    Summary summary_;
    std::map<std::size_t, JobRecord> records_;  ///< of the shard
    std::size_t ended_;
    std::vector<std::size_t> unsaid_;  ///< indices of records that are not yet in the file
    Clock::time_point nextWrite_{};
    std::mutex mutex_;  ///< of records_, ended_, the log and the summary
};

int Batch::run() {
    writeSummary();
    if (plan_.doneBefore > 0)
        console_.info(std::to_string(plan_.doneBefore) + " of " + std::to_string(records_.size()) +
                      " jobs are done already");
    for (JobNumbers group : plan_.groups) {
        group.erase(
            std::remove_if(group.begin(), group.end(),
                           [&](std::size_t k) { return records_.at(k).exitCode.has_value(); }),
            group.end());
        if (!group.empty()) runGroup(group);
    }
    if (!unsaid_.empty()) writeSummary();
    if (!view_.empty()) writeDocument(view_, indexPage(plan_, summary_, view_));
    return tellEnd();
}

void Batch::runGroup(const JobNumbers& group) {
    const std::optional<igeo::Surface> surface = surfaceOf(group);
    if (!surface) return;
    const std::size_t atOnce = prepareBand(*surface, group);
    console_.detail(fmt::format("surface {}: {}; {} jobs, {} at once", surface->facts().name,
                                surface->facts().summary, group.size(), atOnce));
    progress_.update("batch", double(ended_) / double(records_.size()));
    // A solver, with its metric, is freed after the last of its jobs.
    std::vector<std::shared_ptr<SharedSolver>> solvers;
    for (const JobNumbers& lot : groupBy<MetricOptions>(plan_.jobs, group))
        solvers.insert(solvers.end(), lot.size(), std::make_shared<SharedSolver>());
    std::atomic<std::size_t> next{0};
    std::exception_ptr stop;
    // No exception may leave the loop: TBB would cancel the loops of the other jobs, which would
    // write incomplete results without notice.
    igeo::parallelFor(atOnce, 1, [&](std::size_t, std::size_t) {
        try {
            for (std::size_t k = next++; k < group.size(); k = next++) {
                const std::shared_ptr<SharedSolver> solver = std::move(solvers[k]);
                runJob(*surface, *solver, group[k]);
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
        // The first error is reported.
    }
    std::rethrow_exception(stop);
}

/// @return empty if the surface cannot be used; all jobs of the group have then failed
std::optional<igeo::Surface> Batch::surfaceOf(const JobNumbers& group) {
    try {
        return readSurface(plan_.jobs[group.front()].options, progress_);
    } catch (...) {
        const Failure failure = currentFailure();
        progress_.throwIfCancelled();
        for (const std::size_t k : group) {
            JobRecord outcome = records_[k];
            outcome.fail(failure);
            record(k, outcome, 0);
        }
        return std::nullopt;
    }
}

/// Makes the band of the whole surface with all threads, if a job is sure to need it.
/// @return number of jobs that may run at once: one per thread, as far as memory allows
std::size_t Batch::prepareBand(const igeo::Surface& surface, const JobNumbers& group) {
    try {
        const igeo::BandWidth width =
            igeo::bandWidth(surface, solverOptions(plan_.jobs[group.front()].options));
        const double memory = surface.estimatedMemory(width), limit = memoryFor(group);
        const bool everywhere = std::any_of(group.begin(), group.end(), [&](std::size_t k) {
            const RunOptions& job = plan_.jobs[k].options;
            return job.hasSeeds() && !(job.maxDistance > 0) && !job.stopAtTargets;
        });
        if (everywhere && memory <= limit) surface.band(width, {}, progress_);
        const auto fit = std::size_t(std::min(limit / memory, 1e6));
        return std::max<std::size_t>(
            1, std::min({group.size(), std::size_t(igeo::ThreadLimit::current()), fit}));
    } catch (const std::exception&) {
        progress_.throwIfCancelled();
        return 1;  // each job that needs the band reports why it cannot be made
    }
}

/// Bytes: the memory of the machine, or the least limit of the jobs.
double Batch::memoryFor(const JobNumbers& group) const {
    double memory = machineMemory();
    for (const std::size_t k : group)
        if (const double limit = plan_.jobs[k].options.memoryLimit; limit > 0)
            memory = std::min(memory, limit * kGiB);
    return memory;
}

void Batch::runJob(const igeo::Surface& surface, SharedSolver& solver, std::size_t number) {
    const BatchJob& job = plan_.jobs[number];
    JobRecord outcome = records_.at(number);
    const Clock::time_point begin = Clock::now();
    try {
        Console console(verbose_ ? Console::Level::Verbose : Console::Level::Quiet,
                        job.quoted() + ": ");
        ConsoleProgress quiet(ProgressWhen::Never);
        Stages stages(console, quiet);
        const RunOutcome ended = runOn(solver.prepared(surface, job.options, stages), job.options,
                                       console, stages, plan_.inputDigests);
        outcome.exitCode = ended.exitCode, outcome.warnings = ended.warnings;
        outcome.provenance = ended.provenance;
        outcome.provenance.erase("warnings");
        for (const std::string& file : outputFiles(job.options))
            outcome.outputs[file] = igeo::digestOfFile(file);
    } catch (...) {
        progress_.throwIfCancelled();
        outcome.fail(currentFailure());
    }
    record(number, outcome, std::chrono::duration<double>(Clock::now() - begin).count());
}

void Batch::record(std::size_t number, JobRecord outcome, double seconds) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!outcome.done()) outcome.outputs.clear();
    log_.add(outcome, seconds);
    records_.at(number) = std::move(outcome);
    unsaid_.push_back(number);
    if (Clock::now() >= nextWrite_) writeSummary();
    progress_.update("batch", double(++ended_) / double(records_.size()));
}

/// A job is reported as done only after it is recorded.
void Batch::writeSummary() {
    const Clock::time_point begin = Clock::now();
    summary_.jobs.clear();
    for (const auto& [k, job] : records_) summary_.jobs.push_back(job);
    igeo::writeFile(summaryFile_, summary_.text());
    nextWrite_ = Clock::now() + (kWritingShare - 1) * (Clock::now() - begin);
    for (const std::size_t k : unsaid_) {
        const JobRecord& job = records_.at(k);
        const std::string name = plan_.jobs[k].quoted();
        if (!verbose_ && !job.warnings.empty())  // otherwise the messages of the job show them
            console_.warning(fmt::format(
                "{}: {}{}", name, job.warnings.front(),
                job.warnings.size() == 1
                    ? ""
                    : fmt::format(" (and {} more in the summary)", job.warnings.size() - 1)));
        if (!job.done())
            Console::error(name + ": " + job.what, job.remedy);
        else if (job.exitCode == kUnreached)
            console_.warning(name + " is done, but a target, pair or --via is unreached");
        else
            console_.info(name + " is done");
    }
    unsaid_.clear();
}

int Batch::tellEnd() {
    progress_.clear();
    if (!view_.empty()) console_.info("wrote view to " + view_);
    tell(summary_, fs::path(summaryFile_).filename().string(), console_);
    return summary_.exitCode();
}

}  // namespace

int batch(const BatchOptions& options, Console& console, ConsoleProgress& progress) {
    const std::string manifest = wholeName(options.manifest);
    const std::string summary = options.summary.empty() ? defaultSummary(manifest, options.shard)
                                                        : wholeName(options.summary);
    auto wholeOrNone = [](const std::string& file) { return file.empty() ? "" : wholeName(file); };
    BatchFiles files{manifest, summary, "", wholeOrNone(options.log), wholeOrNone(options.view)};
    const Manifest read =
        readManifest(options.manifest, {manifest, summary, files.log, files.view});
    files.table = wholeOrNone(read.table);
    checkOwnOutputs(options, summary, read.table);
    checkLocks(files);
    tellLeftOut(read.leftOut, console);
    // In the folder of the manifest, jobs name their files as single runs there do, also in
    // reports.
    fs::current_path(fs::path(manifest).parent_path());
    if (options.dryRun) {
        printPlan(planBatch(read.jobs, files, options.shard, progress));
        return kDone;
    }
    const ProcessLock ofSummary(files.summaryLock());
    refuseOther(ofSummary, "writes the summary '" + summary + "'");
    const ProcessLock ofJobs(files.manifestLock(), options.shard.begin(), options.shard.end());
    refuseOther(ofJobs, "computes jobs of '" + manifest + "' that this one has too");
    const BatchPlan plan = planBatch(read.jobs, files, options.shard, progress);
    return Batch(plan, files, options.verbose, console, progress).run();
}

int merge(const MergeOptions& options, Console& console) {
    checkOutputFiles({{"-o", options.output, options.matrix ? ".csv .json .npy" : ""}},
                     options.parts);
    if (options.matrix) {
        writeDocument(options.output, joinedMatrix(options.parts, options.output, console));
        return kDone;
    }
    const Summary summary = mergedSummary(options.parts);
    writeDocument(options.output, summary.text());
    tell(summary, options.output, console);
    return summary.exitCode();
}
