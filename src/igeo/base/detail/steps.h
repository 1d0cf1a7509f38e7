/// Progress reports of parallel loops.
#pragma once

#include <igeo/base/progress.h>

#include <cstddef>
#include <mutex>

namespace igeo {

/// Counts the steps that threads have done, of the `total` equal steps of a stage or of part of
/// one. Reports its shares in order, one at a time.
class Steps {
public:
    /// @param from, to  the part of the stage, fractions
    Steps(Progress& progress, const char* stage, std::size_t total, double from = 0, double to = 1)
        : progress_(progress), stage_(stage), total_(total), from_(from), to_(to) {
        progress_.update(stage_, from_);
    }
    void add(std::size_t steps) {
        const std::lock_guard<std::mutex> lock(mutex_);
        done_ += steps;
        progress_.update(stage_, from_ + (to_ - from_) * double(done_) / double(total_));
    }
    bool cancelled() const { return progress_.cancelled(); }

private:
    Progress& progress_;
    const char* stage_;
    std::size_t total_;
    double from_, to_;
    std::mutex mutex_;
    std::size_t done_ = 0;
};

}  // namespace igeo
