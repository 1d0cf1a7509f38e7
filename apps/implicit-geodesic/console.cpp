#include "console.h"

#include <fcntl.h>
#include <igeo/atomic_file.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace {

std::atomic<int> gSignal{0};

std::mutex gStderr;
bool gProgressShown = false;  // a line of progress, without its end

// In one piece: several threads may have something to say, and lines must not mix.
void put(const std::string& text, bool progress) {
    const std::lock_guard<std::mutex> lock(gStderr);
    std::cerr << (gProgressShown ? "\r\033[K" + text : text) << std::flush;
    gProgressShown = progress;
}

void print(const std::string& line) { put("implicit-geodesic: " + line + "\n", false); }

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

void Console::info(const std::string& text) const {
    if (level_ != Level::Quiet) print(before_ + text);
}

void Console::detail(const std::string& text) const {
    if (level_ == Level::Verbose) print(before_ + text);
}

void Console::warning(const std::string& text) const {
    if (level_ != Level::Quiet) print("warning: " + before_ + text);
}

void Console::error(const std::string& what, const std::string& remedy) {
    print("error: " + what + (remedy.empty() ? "" : "\n  " + remedy));
}

ConsoleProgress::ConsoleProgress(const std::string& when) {
    terminal_ = ::isatty(STDERR_FILENO) == 1 && !std::getenv("NO_COLOR");
    enabled_ = when == "always" || (when == "auto" && terminal_);
    if (enabled_) shower_ = std::thread([this] { show(); });
}

ConsoleProgress::~ConsoleProgress() {
    clear();
    if (!enabled_) return;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        done_ = true;
    }
    wake_.notify_one();
    shower_.join();
}

void ConsoleProgress::update(const char* name, double fraction) {
    if (!enabled_) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    time_.update(name, fraction, now());
}

/// On a thread of its own, so that work which says nothing for long is seen to go on.
void ConsoleProgress::show() {
    const std::chrono::milliseconds pause(terminal_ ? 200 : 1000);
    std::unique_lock<std::mutex> lock(mutex_);
    while (!wake_.wait_for(lock, pause, [this] { return done_; }))
        if (const double t = now(); time_.elapsed(t) > 1)
            put(time_.describe(t) + (terminal_ ? "" : "\n"), terminal_);
}

void ConsoleProgress::clear() {
    if (!enabled_) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    time_.end();
    put("", false);
}

bool ConsoleProgress::cancelled() const { return InterruptGuard::requested(); }

void openStandardStreams() {
    // open() takes the lowest descriptor that is free; the wrong way round, so that using it fails.
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(fd, F_GETFD) < 0 &&
            ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
            ::_exit(1);
}

InterruptGuard::InterruptGuard() {
    // A write beyond RLIMIT_FSIZE shall be an error to report, not a signal to die of; the same
    // for a reader of stdout who has gone.
    ::signal(SIGXFSZ, SIG_IGN);
    ::signal(SIGPIPE, SIG_IGN);
    sigset_t set;
    sigemptyset(&set);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction now {};
        // nohup ignores SIGHUP, a shell that starts a job in the background SIGINT.
        if (::sigaction(number, nullptr, &now) == 0 && now.sa_handler != SIG_IGN)
            sigaddset(&set, number);
    }
    // Blocked here and in all threads to come; one thread waits for them and may do as it likes,
    // which a signal handler may not.
    ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::thread([set] {
        int number = 0;
        if (::sigwait(&set, &number) != 0) return;
        gSignal = number;
        std::this_thread::sleep_for(std::chrono::milliseconds(150));
        igeo::AtomicFile::discardAll();
        print("error: interrupted");
        std::_Exit(exitCode());
    }).detach();
}

bool InterruptGuard::requested() { return gSignal != 0; }

int InterruptGuard::exitCode() { return 128 + (gSignal ? gSignal.load() : SIGINT); }
