/// What a person at a terminal meets: messages, progress, Ctrl-C.
#pragma once

#include <igeo/progress.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>

/// Messages on stderr, in one shape.
class Console {
public:
    enum class Level { Quiet, Normal, Verbose };
    explicit Console(Level level) : level_(level) {}

    void info(const std::string& text) const;
    void detail(const std::string& text) const;  ///< with -v only
    void warning(const std::string& text) const;
    static void error(const std::string& what, const std::string& remedy);

private:
    Level level_;
};

/// A line on stderr with percentage and time left, once work takes longer than a second.
class ConsoleProgress : public igeo::Progress {
public:
    /// @param when "auto" (only on a terminal and without NO_COLOR), "always" or "never"
    explicit ConsoleProgress(const std::string& when);
    ~ConsoleProgress() override;

    void update(const char* name, double fraction) override;
    bool cancelled() const override;

    void clear();  ///< wipes the line before other output

private:
    using Clock = std::chrono::steady_clock;
    bool enabled_, terminal_;
    std::mutex mutex_;
    std::string stage_;
    Clock::time_point stageStart_ = Clock::now(), lastShown_ = stageStart_;
    bool shown_ = false;
};

/// Turns SIGINT and SIGTERM into a request to stop; what does not stop within 0.15 s (a library
/// call that cannot be told) is ended, after removing unfinished outputs. Make one in main, before
/// any thread starts.
class InterruptGuard {
public:
    InterruptGuard();
    static bool requested();
    static int exitCode();  ///< 130 for SIGINT, 143 for SIGTERM
};
