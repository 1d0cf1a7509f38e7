/// What damaged files, and libraries that stumble over them, may not do to a user.
#pragma once

#include <igeo/base/error.h>

#include <mutex>
#include <new>
#include <stdexcept>
#include <string>

#include "output/stdout.h"

/// Turns a fault of the program (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) into a sentence on
/// stderr and an exit code: 3 and the file's name while a FileGuard lives, else 1. Unfinished
/// outputs are removed. Call it in the first thread, which from then on also survives the end of
/// its stack.
void catchFaults();

/// While it lives, a fault is the fault of `file`, and reading it may take so much time as no sound
/// file does: five minutes of computing and ten seconds per megabyte; an hour where the size is not
/// known. Where it ends by an exception, later faults count as the file's as well: what is left to
/// do is to report it, and the reader may have left the heap in ruins. Files are read one after the
/// other: jobs side by side wait for each other. Not nested.
class FileGuard {
public:
    explicit FileGuard(const std::string& file);
    FileGuard(const std::string& file, double seconds);  ///< of computing, on all cores together
    static constexpr double kNoLimit = 0;
    ~FileGuard();
    FileGuard(const FileGuard&) = delete;
    FileGuard& operator=(const FileGuard&) = delete;

private:
    const std::lock_guard<std::mutex> alone_;
    const LibrariesSilenced silenced_;
    const int exceptions_;  ///< in flight when it was made
};

/// ", did you mean 'FILE'?" with the name in its folder that is most like that of a file that is
/// not there; else empty.
std::string namesLike(const std::string& file);

/// What `read` returns, which reads `file`. Whatever goes wrong in it names the file: a refusal as
/// it is, memory that runs out and other exceptions as a refusal (BadInput), a fault as above.
template <typename Read>
auto guardedRead(const std::string& file, const Read& read) {
    using igeo::Error;
    const FileGuard guard(file);
    auto refuse = [&](const std::string& what, const char* remedy) {
        return Error(Error::Kind::BadInput, "cannot read '" + file + "': " + what, remedy);
    };
    constexpr const char* kTooLarge =
        "it is too large for this machine or for --memory-limit, or damaged";
    try {
        return read();
    } catch (const Error& e) {
        const std::string like = e.kind() == Error::Kind::Io ? namesLike(file) : "";
        if (like.empty()) throw;
        throw Error(e.kind(), e.what() + like, e.remedy());
    } catch (const std::bad_alloc&) {
        throw refuse("out of memory", kTooLarge);
    } catch (const std::length_error&) {
        throw refuse("it asks for more memory than there can be", kTooLarge);
    } catch (const std::exception& e) {
        throw refuse(e.what(), "the file may be damaged: write it again");
    }
}
