/// An estimate of the remaining time of a stage, from its progress.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

/// Times are seconds on any one clock.
class TimeLeft {
public:
    /// A smaller fraction restarts the stage, as when a march starts again with a larger reach.
    /// Reports from several threads may come in any order.
    void update(const char* stage, double fraction, double now) {
        if (stage != stage_ || fraction < fraction_ / 2)
            stage_ = stage, fraction_ = 0, start_ = updated_ = now;
        if (fraction <= fraction_) return;
        fraction_ = fraction;
        updated_ = now;
    }
    void end() { stage_.clear(); }

    double elapsed(double now) const { return stage_.empty() ? 0 : now - start_; }

    /// Seconds left, at the average pace from the start to the last report. Empty before a pace is
    /// known, and once that time has passed.
    std::optional<double> left(double now) const {
        constexpr double kLeastFraction = 0.02, kLeastSeconds = 0.5;
        const double worked = updated_ - start_;
        if (stage_.empty() || fraction_ < kLeastFraction || worked < kLeastSeconds) return {};
        const double left = start_ + worked / fraction_ - now;
        return left > 0 ? std::optional(left) : std::nullopt;
    }

    /// "march 42 %, 7 s left"; "march 1 %, 2 s so far" while the remaining time is unknown.
    std::string describe(double now) const {
        std::string text = stage_;
        if (fraction_ > 0) text += " " + std::to_string(int(100 * fraction_)) + " %";
        const auto rest = left(now);
        return text + ", " +
               (rest ? duration(*rest) + " left" : duration(elapsed(now)) + " so far");
    }

    static std::string duration(double seconds) {
        const auto s = long(std::ceil(seconds)), minutes = (s + 30) / 60;
        if (s < 100) return std::to_string(std::max(s, 1L)) + " s";
        if (minutes < 100) return std::to_string(minutes) + " min";
        return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
    }

private:
    std::string stage_;
    double fraction_ = 0, start_ = 0, updated_ = 0;
};
