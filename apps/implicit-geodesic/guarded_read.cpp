#include "guarded_read.h"

#include <igeo/atomic_file.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>

#include "run.h"

namespace {

/// A message made while all is well: a handler may not.
struct Message {
    std::array<char, 1024> text{};
    std::size_t size = 0;

    void set(const std::string& words) {
        size = std::min(words.size(), text.size());
        std::memcpy(text.data(), words.data(), size);
    }
    void write() const {
        // Nothing is left to do where stderr takes no more.
        if (::write(STDERR_FILENO, text.data(), size) < 0) return;
    }
};

constexpr std::array<int, 5> kFaults{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

Message gFault, gOutOfMemory, gFileFault, gFileTime;
std::atomic<bool> gReading{false};
std::mutex gGuard;
std::atomic<bool> gEnding{false};
// Wipes a line of progress.
const char* gLineStart = "";

/// An exception that nothing can catch, as one on a thread of TBB: what fails there is memory.
[[noreturn]] void onTerminate() {
    try {
        if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
    } catch (const std::bad_alloc&) {
        gFault = gOutOfMemory;
    } catch (...) {
    }
    std::abort();
}

[[noreturn]] void endNow(int) { ::_exit(gReading ? kUnusable : kFailed); }

/// Runs on a stack of its own. Only write, unlink and _exit may be relied on here; what else is
/// tried is cut short by a second fault or, where it waits for a lock, by the alarm.
void onFault(int signal) {
    if (gEnding.exchange(true)) {
        for (;;) ::pause();  // another thread is ending the process
    }
    for (const int s : kFaults) ::signal(s, endNow);
    ::signal(SIGALRM, endNow);
    sigset_t all;
    sigfillset(&all);
    for (const int s : kFaults) sigdelset(&all, s);
    sigdelset(&all, SIGALRM);
    ::pthread_sigmask(SIG_SETMASK, &all, nullptr);
    ::alarm(1);
    (signal == SIGVTALRM ? gFileTime : gReading ? gFileFault : gFault).write();
    igeo::AtomicFile::discardAll();
    endNow(signal);
}

double readingSeconds(const std::string& file) {
    constexpr double kLeast = 300, kUnknown = 3600, kPerMegabyte = 10;
    std::error_code none;
    const bool known = file != "-" && std::filesystem::is_regular_file(file, none);
    return known ? kLeast + kPerMegabyte * double(std::filesystem::file_size(file, none)) / 1e6
                 : kUnknown;
}

void setTimer(double seconds) {
    itimerval time{};
    time.it_value.tv_sec = time_t(seconds);
    time.it_value.tv_usec = suseconds_t((seconds - std::floor(seconds)) * 1e6);
    ::setitimer(ITIMER_VIRTUAL, &time, nullptr);
}

}  // namespace

void catchFaults() {
    if (::isatty(STDERR_FILENO) == 1) gLineStart = "\r\033[K";
    gFault.set(std::string(gLineStart) +
               "implicit-geodesic: error: the program has crashed\n"
               "  please report this, with the command and its files; no output is half written\n");
    gOutOfMemory.set(std::string(gLineStart) +
                     "implicit-geodesic: error: out of memory\n"
                     "  use a coarser level set or a larger machine\n");
    std::set_terminate(onTerminate);
    alignas(16) static std::array<char, 1 << 16> memory;
    stack_t stack{};
    stack.ss_sp = memory.data();
    stack.ss_size = memory.size();
    ::sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_handler = onFault;
    action.sa_flags = SA_ONSTACK;
    sigfillset(&action.sa_mask);
    for (const int s : kFaults) {
        sigdelset(&action.sa_mask, s);
        ::sigaction(s, &action, nullptr);
    }
    ::sigaction(SIGVTALRM, &action, nullptr);
}

double machineMemory() {
    double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE));
    // "max" where there is no limit: no number.
    double limit = 0;
    if (std::ifstream("/sys/fs/cgroup/memory.max") >> limit) bytes = std::min(bytes, limit);
    return bytes;
}

void limitMemory(double bytes, int threads) {
    constexpr double kLeast = 256e6, kStack = 8e6;
    double mapped = 0;
    // Pages: in all, resident, shared, code, library, data.
    std::ifstream statm("/proc/self/statm");
    for (int k = 0; k < 6; ++k) statm >> mapped;
    if (!statm) return;
    mapped *= double(::sysconf(_SC_PAGE_SIZE));
    rlimit limit{};
    if (::getrlimit(RLIMIT_DATA, &limit) != 0) return;
    limit.rlim_cur =
        std::min(limit.rlim_cur, rlim_t(mapped + std::max(bytes, kLeast) + kStack * threads));
    ::setrlimit(RLIMIT_DATA, &limit);
}

FileGuard::FileGuard(const std::string& file) : FileGuard(file, readingSeconds(file)) {}

FileGuard::FileGuard(const std::string& file, double seconds)
    : alone_(gGuard), exceptions_(std::uncaught_exceptions()) {
    const std::string start = std::string(gLineStart) + "implicit-geodesic: error: cannot read " +
                              (file == "-" ? "standard input" : "'" + file.substr(0, 600) + "'");
    gFileFault.set(start +
                   ": its reader crashed, which damaged files bring about\n"
                   "  write the file again; if it is sound, please report this with the file\n");
    gFileTime.set(start + ": it took more than " + std::to_string(std::llround(seconds)) +
                  " s of computing\n"
                  "  the file is damaged: write it again\n");
    gReading = true;
    setTimer(seconds);
}

FileGuard::~FileGuard() {
    setTimer(0);
    if (std::uncaught_exceptions() == exceptions_) gReading = false;
}
