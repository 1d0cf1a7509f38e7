/// Protects the program from damaged files, and from libraries that crash on them.
#pragma once

#include <igeo/base/error.h>

#include <mutex>
#include <new>
#include <stdexcept>
#include <string>

#include "failure.h"
#include "output/stdout.h"

/// The remedy where the memory does not suffice for a file.
constexpr const char* kTooLarge =
    "it is too large for this machine or for --memory-limit, or damaged";

/// Turns a fault of the program (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) into a message on stderr
/// and an exit code: 3 and the file's name while a FileGuard lives, else 1. Unfinished outputs are
/// removed. An exception that cannot be caught, as on a thread of TBB, ends the program likewise;
/// one that means too little memory, or a thread that the system refuses, says so. Call it in the
/// first thread, which can then also report the overflow of its stack.
void catchFaults();

/// While it lives, a fault is blamed on `file`, and reading has a time limit that no sound file
/// reaches: five minutes of computing and ten seconds per megabyte; an hour where the size is
/// unknown. If it ends by an exception, later faults are blamed on the file too: only the report
/// remains to be done, and the reader may have damaged the heap. Files are read one after another:
/// concurrent jobs wait for each other. Not nested.
class FileGuard {
public:
    explicit FileGuard(const std::string& file);
    /// Seconds of computing, on all cores together
    FileGuard(const std::string& file, double seconds);
    static constexpr double kNoLimit = 0;
    ~FileGuard();
    FileGuard(const FileGuard&) = delete;
    FileGuard& operator=(const FileGuard&) = delete;

private:
    const std::lock_guard<std::mutex> alone_;
    const LibrariesSilenced silenced_;
    const int exceptions_;  ///< in flight when it was made
};

/// ", did you mean 'FILE'?" for a file that does not exist, with the most similar name in its
/// folder; else empty.
std::string namesLike(const std::string& file);

/// Returns what `read` returns for `file`. All errors name the file: a refusal is passed on, memory
/// that runs out and other exceptions become a refusal (BadInput), a fault is handled as above. A
/// thread that the system does not grant is no fault of the file.
template <typename Read>
auto guardedRead(const std::string& file, const Read& read) {
    using igeo::Error;
    const FileGuard guard(file);
    auto refuse = [&](const std::string& what, const char* remedy) {
        return Error(Error::Kind::BadInput, "cannot read '" + file + "': " + what, remedy);
    };
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
        if (isThreadRefused(e)) throw;
        throw refuse(e.what(), "the file may be damaged: write it again");
    }
}
