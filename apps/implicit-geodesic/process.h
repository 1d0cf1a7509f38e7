/// What the program needs of a system and C++ does not have: process_posix.cpp,
/// process_windows.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>

constexpr double kGiB = 1024.0 * 1024 * 1024;

/// Opens those of stdin, stdout and stderr that are closed, so that no output takes their place and
/// is mixed with messages; reading and writing them fails as before.
void openStandardStreams();

/// The standard output that the process was given, to which nothing but this file writes from now
/// on: descriptor 1 goes to standard error. Null where there are no descriptors left.
std::FILE* takeStdout();

bool stderrIsTerminal();

/// Of the terminal that is the standard output, as takeStdout() found it; 0 where it is none.
int stdoutColumns();

/// Whether that output is a terminal.
bool stdoutIsTerminal();

/// Writes at once; handlers of faults may call it.
void writeToStderr(const char* text, std::size_t size);

/// Calls `handle` on a thread of its own when SIGINT, SIGTERM or SIGHUP comes, unless it is
/// ignored. Call it before any thread starts. From then on a write to a pipe without a reader, or
/// beyond the allowed size of files, is an error and no signal.
void onInterrupt(void (*handle)(int signal));

/// Calls `report` at a fault (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT), or when the time of
/// limitComputing is up, and then `end`, which does not return; `end` alone where `report` itself
/// faults or waits. Call it in the first thread, which from then on also survives the end of its
/// stack.
void onFault(void (*report)(bool timeIsUp), void (*end)());

/// Seconds from now, on all cores together; 0 for no limit. Windows has none.
void limitComputing(double seconds);

/// Lets the process take no more memory than `bytes` beyond what it has now, so that sizes that a
/// damaged file makes up end as std::bad_alloc and not by the system's choice of a victim. Nothing
/// happens where a lower limit is set already, nor on systems other than Linux.
/// @param threads  the stacks of so many are added
void limitMemory(double bytes, int threads);

/// The memory that the process may use, bytes: of the machine, of its control groups (containers),
/// of its Slurm job, whichever is least.
double machineMemory();

/// Gives the system back what was freed, where the C library keeps it: there what one thread has
/// freed serves no other.
void giveBackFreedMemory();

/// The most memory that the process has held so far, bytes.
std::uint64_t peakMemory();
