#include "console.h"

#include <igeo/base/atomic_file.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "printable.h"
#include "process.h"

namespace {

std::atomic<int> gSignal{0};

std::mutex gStderr;
bool gProgressShown = false;  // an unfinished line of progress

// In one call: several threads may write, and lines must not mix.
void put(const std::string& text, bool progress) {
    const std::lock_guard<std::mutex> lock(gStderr);
    std::cerr << (gProgressShown ? "\r\033[K" + text : text) << std::flush;
    gProgressShown = progress;
}

void print(const std::string& line) { put("implicit-geodesic: " + printable(line) + "\n", false); }

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

void Console::file(const std::string& text) const {
    if (level_ == Level::Verbose || (level_ == Level::Normal && before_.empty()))
        print(before_ + text);
}

void Console::warning(const std::string& text) const {
    if (level_ != Level::Quiet) print("warning: " + before_ + text);
}

void Console::error(const std::string& what, const std::string& remedy) {
    const std::string remark = remedy.empty() ? "" : "\n  " + printable(remedy);
    put("implicit-geodesic: error: " + printable(what) + remark + "\n", false);
}

ConsoleProgress::ConsoleProgress(ProgressWhen when) {
    terminal_ = stderrIsTerminal();
    enabled_ = when == ProgressWhen::Always || (when == ProgressWhen::Auto && terminal_);
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

/// On a thread of its own, so that the line changes during work without reports.
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

InterruptGuard::InterruptGuard() {
    onInterrupt([](int signal) {
        gSignal = signal;
        std::this_thread::sleep_for(std::chrono::milliseconds(150));
        igeo::AtomicFile::discardAll();
        print("error: " + message());
        std::_Exit(exitCode());
    });
}

std::string InterruptGuard::message() {
    const std::size_t files = igeo::AtomicFile::committed();
    if (files == 0) return "interrupted; nothing was written";
    return "interrupted; " + std::to_string(files) +
           (files == 1 ? " file was written before" : " files were written before");
}

bool InterruptGuard::requested() { return gSignal != 0; }

int InterruptGuard::exitCode() { return 128 + (gSignal ? gSignal.load() : SIGINT); }
