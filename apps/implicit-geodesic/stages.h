/// The times of a job's stages.
#pragma once

#include <igeo/base/progress.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "console.h"

/// Shows progress and records the time of each stage.
class Stages final : public igeo::Progress {
public:
    Stages(const Console& console, ConsoleProgress& progress)
        : console_(console), progress_(progress) {}

    void update(const char* name, double fraction) override { progress_.update(name, fraction); }
    bool cancelled() const override { return progress_.cancelled(); }
    /// Adds the time since the end of the last stage to this one.
    void finished(const char* stage) override;

    /// Wall time per stage, in the order in which they first ended.
    const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

private:
    using Clock = std::chrono::steady_clock;

    const Console& console_;
    ConsoleProgress& progress_;
    Clock::time_point start_ = Clock::now();
    std::vector<std::pair<std::string, double>> seconds_;
};
