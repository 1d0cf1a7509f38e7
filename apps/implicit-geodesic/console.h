/// The program's side of a terminal: messages, progress, Ctrl-C.
#pragma once

#include <igeo/base/progress.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "options/process_options.h"
#include "time_left.h"

/// Messages on stderr, in a uniform format.
class Console {
public:
    enum class Level { Quiet, Normal, Verbose };
    /// @param before the start of every message, such as "job 'a': "
    explicit Console(Level level, std::string before = {})
        : level_(level), before_(std::move(before)) {}

    bool verbose() const { return level_ == Level::Verbose; }
    void info(const std::string& text) const;
    void detail(const std::string& text) const;  ///< with -v only
    void file(const std::string& text) const;    ///< of one run, or with -v
    void warning(const std::string& text) const;
    static void error(const std::string& what, const std::string& remedy);

private:
    Level level_;
    std::string before_;
};

/// A line on stderr with the current stage, once it takes longer than a second: updated five times
/// a second on a terminal, else a new line every second.
class ConsoleProgress : public igeo::Progress {
public:
    /// @param when  Auto: only on a terminal
    explicit ConsoleProgress(ProgressWhen when);
    ~ConsoleProgress() override;

    void update(const char* name, double fraction) override;
    bool cancelled() const override;

    void clear();  ///< ends the stage and erases its line

private:
    void show();

    bool enabled_, terminal_, done_ = false;
    std::mutex mutex_;
    std::condition_variable wake_;
    TimeLeft time_;
    std::thread shower_;
};

/// Turns SIGINT, SIGTERM and SIGHUP, unless ignored, into a request to stop. If the work does not
/// stop within 0.15 s (a library call without cancellation), removes unfinished outputs and ends
/// the process. Make one in main, before any thread starts.
class InterruptGuard {
public:
    InterruptGuard();
    static bool requested();
    /// "interrupted", and the files written so far.
    static std::string message();
    static int exitCode();  ///< 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP
};
