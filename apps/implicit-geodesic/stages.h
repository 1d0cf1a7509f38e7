/// What the stages of a job cost.
#pragma once

#include <igeo/base/detail/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "console.h"

class Stages {
public:
    Stages(Console& console, ConsoleProgress& progress) : console_(console), progress_(progress) {}

    /// Ends a stage: its name, and the time since the last one ended.
    void finished(const char* stage) {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - start_).count();
        start_ = now;
        const auto same = std::find_if(seconds_.begin(), seconds_.end(),
                                       [&](const auto& entry) { return entry.first == stage; });
        if (same == seconds_.end())
            seconds_.emplace_back(stage, seconds);
        else
            same->second += seconds;
        progress_.clear();
        console_.detail(std::string(stage) + igeo::format(": %.3f s", seconds));
    }
    /// Wall time by stage, in the order in which they first ended.
    const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

private:
    Console& console_;
    ConsoleProgress& progress_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::vector<std::pair<std::string, double>> seconds_;
};
