#include "failure.h"

#include <igeo/base/error.h>

#include <exception>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

#include "console.h"
#include "exit_code.h"
#include "option_words.h"
#include "output/stdout.h"

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

bool isThreadRefused(const std::exception& e) {
    const std::string_view what = e.what();
    return what.find("pthread_create") != what.npos || what.find("_beginthreadex") != what.npos;
}

Failure currentFailure() {
    try {
        throw;
    } catch (const ReaderGone&) {
        return {kUnusable, "", ""};
    } catch (const igeo::Error& e) {
        if (e.kind() == igeo::Error::Kind::Cancelled && InterruptGuard::requested())
            return {InterruptGuard::exitCode(), InterruptGuard::message(), ""};
        return {exitCodeFor(e.kind()), inOptionWords(e.what()), inOptionWords(e.remedy())};
    } catch (const std::bad_alloc&) {
        return {kFailed, "out of memory",
                "use a narrower band, larger voxels, a larger --memory-limit or a larger "
                "machine"};
    } catch (const std::filesystem::filesystem_error& e) {
        const std::string what = e.path1().empty() ? "the working folder" : e.path1().string();
        return {kUnusable, "cannot use '" + what + "': " + e.code().message(),
                "check that it is there, and its permissions"};
    } catch (const std::system_error& e) {
        return {kFailed, "the system refuses: " + e.code().message(),
                "raise the limits of the process (ulimit -a)"};
    } catch (const std::exception& e) {
        if (isThreadRefused(e)) return {kFailed, kThreadRefused, kFewerThreads};
        return {kFailed, std::string("unexpected: ") + e.what(), "please report this"};
    }
}
