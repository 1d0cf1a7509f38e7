#include "console.h"

#include <igeo/atomic_file.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace {

std::atomic<int> gSignal{0};

// In one piece: two threads may have something to say, and lines must not mix.
void print(const std::string& line) { std::cerr << "implicit-geodesic: " + line + "\n"; }

}  // namespace

void Console::info(const std::string& text) const {
    if (level_ != Level::Quiet) print(text);
}

void Console::detail(const std::string& text) const {
    if (level_ == Level::Verbose) print(text);
}

void Console::warning(const std::string& text) const {
    if (level_ != Level::Quiet) print("warning: " + text);
}

void Console::error(const std::string& what, const std::string& remedy) {
    print("error: " + what + (remedy.empty() ? "" : "\n  " + remedy));
}

ConsoleProgress::ConsoleProgress(const std::string& when) {
    terminal_ = ::isatty(STDERR_FILENO) == 1 && !std::getenv("NO_COLOR");
    enabled_ = when == "always" || (when == "auto" && terminal_);
}

ConsoleProgress::~ConsoleProgress() { clear(); }

void ConsoleProgress::update(const char* name, double fraction) {
    if (!enabled_) return;
    std::lock_guard<std::mutex> lock(mutex_);
    const auto now = Clock::now();
    if (stage_ != name) stage_ = name, stageStart_ = now;
    const std::chrono::duration<double> elapsed = now - stageStart_;
    if (elapsed.count() < 1 || now - lastShown_ < std::chrono::milliseconds(200)) return;
    lastShown_ = now;
    const double left = fraction > 0 ? elapsed.count() * (1 - fraction) / fraction : 0;
    std::fprintf(stderr, "%s%s %3.0f %%, %.0f s left%s", terminal_ ? "\r\033[K" : "", name,
                 100 * fraction, left, terminal_ ? "" : "\n");
    std::fflush(stderr);
    shown_ = terminal_;
}

void ConsoleProgress::clear() {
    std::lock_guard<std::mutex> lock(mutex_);
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
}

bool ConsoleProgress::cancelled() const { return InterruptGuard::requested(); }

InterruptGuard::InterruptGuard() {
    // A write beyond RLIMIT_FSIZE shall be an error to report, not a signal to die of; the same
    // for a reader of stdout who has gone.
    ::signal(SIGXFSZ, SIG_IGN);
    ::signal(SIGPIPE, SIG_IGN);
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
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
