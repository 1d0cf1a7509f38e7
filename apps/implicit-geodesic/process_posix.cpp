#include "process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#ifdef __GLIBC__
#endif

namespace {

int gStdout = STDOUT_FILENO;

constexpr std::array<int, 5> kFaults{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

void (*gReport)(bool timeIsUp);
void (*gEnd)();
std::atomic<bool> gEnding{false};
std::atomic<std::thread::id> gReporter;

void endNow(int) { gEnd(); }

/// Runs on a stack of its own. Only write, unlink and _exit are safe here. If other calls fail, a
/// second fault of the thread ends the process; if they wait for a lock, the alarm does.
void handleFault(int signal) {
    if (gEnding.exchange(true)) {
        if (gReporter.load() == std::this_thread::get_id()) gEnd();
        for (;;) ::pause();  // another thread is ending the process
    }
    gReporter = std::this_thread::get_id();
    ::signal(SIGALRM, endNow);
    sigset_t all;
    sigfillset(&all);
    for (const int s : kFaults) sigdelset(&all, s);
    sigdelset(&all, SIGALRM);
    ::pthread_sigmask(SIG_SETMASK, &all, nullptr);
    ::alarm(1);
    gReport(signal == SIGVTALRM);
    gEnd();
}

}  // namespace

void openStandardStreams() {
    // open() takes the lowest descriptor that is free; opened the other way, so that using it
    // fails.
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(fd, F_GETFD) < 0 &&
            ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
            ::_exit(1);
}

std::FILE* takeStdout() {
    const int given = ::dup(STDOUT_FILENO);
    gStdout = given;
    std::FILE* const file = given < 0 ? nullptr : ::fdopen(given, "wb");
    return file && ::dup2(STDERR_FILENO, STDOUT_FILENO) >= 0 ? file : nullptr;
}

bool stderrIsTerminal() { return ::isatty(STDERR_FILENO) == 1; }
bool stdoutIsTerminal() { return ::isatty(gStdout) == 1; }

int stdoutColumns() {
    struct winsize size {};
    return ::ioctl(gStdout, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

void writeToStderr(const char* text, std::size_t size) {
    // If stderr fails too, there is nothing left to do.
    if (::write(STDERR_FILENO, text, size) < 0) return;
}

void onInterrupt(void (*handle)(int signal)) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::signal(SIGPIPE, SIG_IGN);
    sigset_t set;
    sigemptyset(&set);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction now {};
        // nohup ignores SIGHUP; a shell ignores SIGINT for a job in the background.
        if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler != SIG_IGN)
            sigaddset(&set, number);
    }
    // Blocked here and in all later threads; one thread waits for them and may call anything,
    // unlike a signal handler.
    ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::thread([set, handle] {
        int number = 0;
        if (::sigwait(&set, &number) == 0) handle(number);
    }).detach();
}

void onFault(void (*report)(bool timeIsUp), void (*end)()) {
    gReport = report;
    gEnd = end;
    alignas(16) static std::array<char, 1 << 16> memory;
    stack_t stack{};
    stack.ss_sp = memory.data();
    stack.ss_size = memory.size();
    ::sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_handler = handleFault;
    action.sa_flags = SA_ONSTACK;
    sigfillset(&action.sa_mask);
    for (const int s : kFaults) {
        sigdelset(&action.sa_mask, s);
        ::sigaction(s, &action, nullptr);
    }
    ::sigaction(SIGVTALRM, &action, nullptr);
}

void limitComputing(double seconds) {
    itimerval time{};
    time.it_value.tv_sec = time_t(seconds);
    time.it_value.tv_usec = suseconds_t((seconds - std::floor(seconds)) * 1e6);
    ::setitimer(ITIMER_VIRTUAL, &time, nullptr);
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

namespace {

/// The number at the start of a file; empty where it is "max", or the file is missing.
void limitBy(const std::string& file, double& bytes) {
    double limit = 0;
    if (std::ifstream(file) >> limit && limit > 0) bytes = std::min(bytes, limit);
}

/// By the control groups of the process and all above them.
void limitByControlGroups(double& bytes) {
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const bool second = line.starts_with("0::");  // control groups, version 2
        if (!second && line.find(":memory:") == line.npos) continue;
        const std::string root = second ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory",
                          name = second ? "/memory.max" : "/memory.limit_in_bytes";
        std::string group = line.substr(line.rfind(':') + 1);
        while (group.size() > 1) {
            limitBy(root + group + name, bytes);
            group.erase(group.rfind('/'));
        }
        limitBy(root + name, bytes);
    }
    limitBy("/sys/fs/cgroup/memory.max", bytes);
}

/// MiB from an environment variable.
double mebibytesIn(const char* name) {
    const char* const text = std::getenv(name);
    return text ? std::strtod(text, nullptr) : 0;
}

/// By the memory that Slurm granted: per node, or per processor.
void limitBySlurm(double& bytes) {
    double granted = mebibytesIn("SLURM_MEM_PER_NODE");
    if (!(granted > 0))
        granted = mebibytesIn("SLURM_MEM_PER_CPU") * mebibytesIn("SLURM_CPUS_ON_NODE");
    constexpr double kMiB = 1 << 20;
    if (granted > 0) bytes = std::min(bytes, granted * kMiB);
}

}  // namespace

double machineMemory() {
    double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE));
    limitByControlGroups(bytes);
    limitBySlurm(bytes);
    return bytes;
}

std::uint64_t peakMemory() {
    // What getrusage() has may be that of the parent, before it became this program.
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (std::uint64_t kib = 0; word == "VmHWM:" && status >> kib) return 1024 * kib;
#ifdef __APPLE__
    constexpr std::uint64_t kUnit = 1;
#else
    constexpr std::uint64_t kUnit = 1024;
#endif
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return kUnit * std::uint64_t(usage.ru_maxrss);
}

namespace {

/// A lock of a part of the work, as bytes that the file need not have.
struct flock partOf(double begin, double end) {
    constexpr double kWhole = 0x1p40;
    struct flock part {};
    part.l_type = F_WRLCK;
    part.l_whence = SEEK_SET;
    part.l_start = off_t(begin * kWhole);
    part.l_len = std::max<off_t>(off_t(end * kWhole) - part.l_start, 1);
    return part;
}

/// The line of a process that has locked some of a part.
std::string ownerOf(int descriptor, struct flock part) {
    std::string owner = "another process";
    if (fcntl(descriptor, F_GETLK, &part) != 0 || part.l_type == F_UNLCK || part.l_pid <= 0)
        return owner;
    owner = "process " + std::to_string(part.l_pid);
    std::array<char, 1 << 14> text{};
    const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
    std::istringstream lines(std::string(text.data(), std::size_t(std::max<ssize_t>(size, 0))));
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(owner + " on host ") &&
            std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; }))
            return line;
    return owner;
}

}  // namespace

ProcessLock::ProcessLock(const std::string& file, double begin, double end) : file_(file) {
    for (;;) {
        descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
        if (descriptor_ < 0) return;
        if (struct flock part = partOf(begin, end); fcntl(descriptor_, F_SETLK, &part) != 0) {
            if (errno == EAGAIN || errno == EACCES) owner_ = ownerOf(descriptor_, part);
            close(descriptor_);
            descriptor_ = -1;
            return;
        }
        // The owner before may have removed the file meanwhile, and another made it again.
        struct stat mine, named;
        if (fstat(descriptor_, &mine) == 0 && stat(file.c_str(), &named) == 0 &&
            mine.st_ino == named.st_ino && mine.st_dev == named.st_dev)
            break;
        close(descriptor_);
    }
    std::array<char, 128> host{};
    gethostname(host.data(), host.size() - 1);
    const std::string text =
        "process " + std::to_string(getpid()) + " on host " + host.data() + "\n";
    // For a message only.
    if (write(descriptor_, text.data(), text.size()) < 0) return;
}

ProcessLock::~ProcessLock() {
    if (descriptor_ < 0) return;
    struct flock whole = partOf(0, 1);
    if (fcntl(descriptor_, F_SETLK, &whole) == 0) unlink(file_.c_str());
    close(descriptor_);
}
