// windows.h comes before psapi.h, which needs it.
// clang-format off
#include <windows.h>
#include <psapi.h>
// clang-format on
#include <io.h>

#include <array>
#include <atomic>
#include <csignal>
#include <thread>

#include "process.h"

namespace {

int gStdout = 1;

constexpr int kStdout = 1, kStderr = 2;
constexpr std::array<int, 4> kFaults{SIGSEGV, SIGFPE, SIGILL, SIGABRT};

void (*gReport)(bool timeIsUp);
void (*gEnd)();
std::atomic<bool> gEnding{false};
std::atomic<std::thread::id> gReporter;

void handleFault(int) {
    for (const int s : kFaults) std::signal(s, handleFault);
    if (gEnding.exchange(true)) {
        if (gReporter.load() == std::this_thread::get_id()) gEnd();
        for (;;) ::Sleep(INFINITE);  // another thread is ending the process
    }
    gReporter = std::this_thread::get_id();
    gReport(false);
    gEnd();
}

}  // namespace

void openStandardStreams() {}  // on Windows, files do not take the place of closed streams

std::FILE* takeStdout() {
    const int given = ::_dup(kStdout);
    gStdout = given;
    std::FILE* const file = given < 0 ? nullptr : ::_fdopen(given, "wb");
    return file && ::_dup2(kStderr, kStdout) == 0 ? file : nullptr;
}

bool stderrIsTerminal() { return ::_isatty(kStderr) != 0; }
bool stdoutIsTerminal() { return ::_isatty(gStdout) != 0; }
int stdoutColumns() { return 0; }

void writeToStderr(const char* text, std::size_t size) {
    if (::_write(kStderr, text, unsigned(size)) < 0) return;
}

// Handlers of SIGINT run on a thread of their own. Windows has no SIGHUP and sends no SIGTERM.
void onInterrupt(void (*handle)(int signal)) { std::signal(SIGINT, handle); }

void onFault(void (*report)(bool timeIsUp), void (*end)()) {
    gReport = report;
    gEnd = end;
    for (const int s : kFaults) std::signal(s, handleFault);
}

void limitComputing(double) {}

// Windows refuses memory that it does not have at once: std::bad_alloc.
void limitMemory(double, int) {}

double machineMemory() {
    MEMORYSTATUSEX memory{};
    memory.dwLength = sizeof memory;
    ::GlobalMemoryStatusEx(&memory);
    return double(memory.ullTotalPhys);
}

std::uint64_t peakMemory() {
    PROCESS_MEMORY_COUNTERS memory{};
    ::GetProcessMemoryInfo(::GetCurrentProcess(), &memory, sizeof memory);
    return memory.PeakWorkingSetSize;
}

ProcessLock::ProcessLock(const std::string& file, double, double) : file_(file) {}

ProcessLock::~ProcessLock() = default;
