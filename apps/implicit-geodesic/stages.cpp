#include "stages.h"

#include <fmt/core.h>

#include <algorithm>

void Stages::finished(const char* stage) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    const auto same = std::find_if(seconds_.begin(), seconds_.end(),
                                   [&](const auto& entry) { return entry.first == stage; });
    if (same == seconds_.end())
        seconds_.emplace_back(stage, seconds);
    else
        same->second += seconds;
    progress_.clear();
    console_.detail(fmt::format("{}: {:.3f} s", stage, seconds));
}
