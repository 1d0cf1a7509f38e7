/// implicit-geodesic: distance and geodesics along a level set.
#include <igeo/error.h>
#include <igeo/parallel.h>

#include <new>

#include "console.h"
#include "info.h"
#include "options.h"
#include "run.h"

namespace {

int exitCodeFor(igeo::Error::Kind kind) {
    using Kind = igeo::Error::Kind;
    switch (kind) {
        case Kind::InvalidArgument:
            return kUsage;
        case Kind::BadInput:
        case Kind::Io:
            return kUnusable;
        case Kind::Cancelled:
            return InterruptGuard::exitCode();
        case Kind::Numerical:
        case Kind::Internal:
            break;
    }
    return kFailed;
}

}  // namespace

int main(int argc, char** argv) {
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
    Console console(options.quiet     ? Console::Level::Quiet
                    : options.verbose ? Console::Level::Verbose
                                      : Console::Level::Normal);
    ConsoleProgress progress(options.progress);
    try {
        return options.info ? info(options, console, progress) : run(options, console, progress);
    } catch (const igeo::Error& e) {
        progress.clear();
        Console::error(e.what(), e.remedy());
        return exitCodeFor(e.kind());
    } catch (const std::bad_alloc&) {
        progress.clear();
        Console::error("out of memory",
                       "use a narrower band, a coarser level set or a larger machine");
    } catch (const std::exception& e) {
        progress.clear();
        Console::error(std::string("unexpected: ") + e.what(), "please report this");
    }
    return kFailed;
}
