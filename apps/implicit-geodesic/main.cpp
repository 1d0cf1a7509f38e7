/// implicit-geodesic: distances and geodesics along a surface.
#include <igeo/base/parallel.h>

#include "batch/batch.h"
#include "console.h"
#include "exit_code.h"
#include "failure.h"
#include "heap.h"
#include "info.h"
#include "input/guarded_read.h"
#include "options/options.h"
#include "output/stdout.h"
#include "process.h"
#include "run.h"

namespace {

/// Runs a command after setting up the process.
template <typename Work>
int withProcess(const ProcessOptions& options, double memoryLimit, const Work& work) {
    const InterruptGuard interrupts;
    const igeo::ThreadLimit threads(options.threads);
    limitMemory(memoryLimit > 0 ? memoryLimit * kGiB : machineMemory(),
                igeo::ThreadLimit::current());
    Console console(options.quiet     ? Console::Level::Quiet
                    : options.verbose ? Console::Level::Verbose
                                      : Console::Level::Normal);
    ConsoleProgress progress(options.progress);
    return work(console, progress);
}

int start(const RunOptions& options) {
    return withProcess(options, options.memoryLimit, [&](auto& console, auto& progress) {
        return run(options, console, progress);
    });
}

int start(const InfoOptions& options) {
    return withProcess(options, 0, [&](auto& console, auto& progress) {
        return info(options, console, progress);
    });
}

int start(const BatchOptions& options) {
    return withProcess(options, 0, [&](auto& console, auto& progress) {
        return batch(options, console, progress);
    });
}

int start(const MergeOptions& options) {
    return withProcess({}, 0, [&](auto& console, auto&) { return merge(options, console); });
}

}  // namespace

int main(int argc, char** argv) {
    useLargePages();
    openStandardStreams();
    reserveStdout();
    catchFaults();
    try {
        const std::optional<Options> options = parseOptions(argc, argv);
        const int code =
            options ? std::visit([](const auto& asked) { return start(asked); }, *options) : kDone;
        flushResults();
        return code;
    } catch (...) {
        const Failure failure = currentFailure();
        if (!failure.what.empty()) Console::error(failure.what, failure.remedy);
        return failure.exitCode;
    }
}
