/// What the program needs of an operating system beyond C++: process_posix.cpp,
/// process_windows.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

constexpr double kGiB = 1024.0 * 1024 * 1024;

/// Opens closed standard streams, so that no output file gets their descriptor and is mixed with
/// messages. Reading and writing them still fails.
void openStandardStreams();

/// The standard output of the process. From now on nothing but this file writes to it: descriptor 1
/// goes to standard error. Null if no descriptor is free.
std::FILE* takeStdout();

bool stderrIsTerminal();

/// The width of the terminal that standard output is, as takeStdout() found it; 0 if it is none.
int stdoutColumns();

/// Whether that output is a terminal.
bool stdoutIsTerminal();

/// Writes without buffering; signal handlers may call it.
void writeToStderr(const char* text, std::size_t size);

/// Calls `handle` on a thread of its own at SIGINT, SIGTERM or SIGHUP, unless ignored. Call it
/// before any thread starts. From then on, writing to a pipe without a reader, or beyond the
/// allowed size of files, is an error instead of a signal.
void onInterrupt(void (*handle)(int signal));

/// Calls `report` at a fault (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) or when the time of
/// limitComputing is up, and then `end`, which does not return; only `end` if `report` itself
/// faults or hangs. Call it in the first thread, which can then also report the overflow of its
/// stack.
void onFault(void (*report)(bool timeIsUp), void (*end)());

/// Seconds from now, on all cores together; 0 for no limit. Windows has none.
void limitComputing(double seconds);

/// Limits the memory of the process to `bytes` more than it has now, so that forged sizes in a
/// damaged file end as std::bad_alloc and not with the system killing some process. No effect where
/// a lower limit is set already, nor on systems other than Linux.
/// @param threads  adds the stacks of this many threads
void limitMemory(double bytes, int threads);

/// The memory that the process may use, bytes: the least of that of the machine, of its control
/// groups (containers) and of its Slurm job.
double machineMemory();

/// The peak memory of the process so far, bytes.
std::uint64_t peakMemory();

/// Keeps other processes from the same part of some work while it lives. The system gives the lock
/// up when its process ends, however that ends; a file that is left then is taken over.
class ProcessLock {
public:
    /// Locks a part of a file, which is made where it is missing and holds the owners' hosts and
    /// processes. Where the file system has no locks, there is none.
    /// @param begin, end  the part of the work, in [0, 1]
    explicit ProcessLock(const std::string& file, double begin = 0, double end = 1);
    /// Removes the file where no other part is locked. A process locks a file once only.
    ~ProcessLock();
    ProcessLock(const ProcessLock&) = delete;
    ProcessLock& operator=(const ProcessLock&) = delete;

    /// An owner, as in "process 123 on host tower", where another process has locked some of the
    /// part; else empty.
    const std::string& otherOwner() const { return owner_; }

private:
    const std::string file_;
    std::string owner_;
    int descriptor_ = -1;
};
