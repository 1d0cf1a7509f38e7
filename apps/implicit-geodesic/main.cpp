/// implicit-geodesic: distance and geodesics along a level set.
#include <igeo/base/parallel.h>

#include "batch.h"
#include "console.h"
#include "exit_code.h"
#include "failure.h"
#include "guarded_read.h"
#include "info.h"
#include "options.h"
#include "process.h"
#include "results.h"
#include "run.h"

namespace {

int runCommand(const Options& options, Console& console, ConsoleProgress& progress) {
    if (options.info) return info(options, console, progress);
    if (options.batch.merge) return merge(options.batch, console);
    if (options.batch.asked) return batch(options, console, progress);
    return run(options, console, progress);
}

int start(int argc, char** argv) {
    Options options;
    switch (parseOptions(argc, argv, options)) {
        case ParseResult::Done:
            return kDone;
        case ParseResult::Usage:
            return kUsage;
        case ParseResult::Run:
            break;
    }
    const InterruptGuard interrupts;
    const igeo::ThreadLimit threads(options.threads);
    limitMemory(options.memoryLimit > 0 ? options.memoryLimit * kGiB : machineMemory(),
                igeo::ThreadLimit::current());
    Console console(options.quiet     ? Console::Level::Quiet
                    : options.verbose ? Console::Level::Verbose
                                      : Console::Level::Normal);
    ConsoleProgress progress(options.progress);
    return runCommand(options, console, progress);
}

}  // namespace

int main(int argc, char** argv) {
    openStandardStreams();
    reserveStdout();
    catchFaults();
    try {
        return start(argc, argv);
    } catch (...) {
        const Failure failure = currentFailure();
        Console::error(failure.what, failure.remedy);
        return failure.exitCode;
    }
}
