/// What a stage of a program costs: wall time, processor time of all threads, memory.
#pragma once

#include <time.h>

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace igeo::test {

struct Stage {
    std::string name;
    double wall, cpu;  ///< seconds
};

/// Times stages that follow each other.
class Stages {
public:
    Stages() : wall_(now()), cpu_(cpuNow()) {}
    /// Ends a stage: what has passed since the last one ended.
    void finished(const std::string& name) {
        stages_.push_back({name, since(wall_), cpuNow() - cpu_});
        restart();
    }
    /// The same, in a copy.
    Stages with(const std::string& name) const {
        Stages copy = *this;
        copy.finished(name);
        return copy;
    }
    /// The time since the last stage ended belongs to none.
    void restart() { wall_ = now(), cpu_ = cpuNow(); }
    /// "name": {"wall": seconds, "cpu": seconds}, ...
    std::string json() const {
        std::string text;
        for (const Stage& stage : stages_) {
            char numbers[80];
            std::snprintf(numbers, sizeof numbers, "\": {\"wall\": %.6f, \"cpu\": %.6f}",
                          stage.wall, stage.cpu);
            text += (text.empty() ? "\"" : ", \"") + stage.name + numbers;
        }
        return text;
    }

private:
    using Clock = std::chrono::steady_clock;
    static Clock::time_point now() { return Clock::now(); }
    static double since(Clock::time_point start) {
        return std::chrono::duration<double>(now() - start).count();
    }
    static double cpuNow() {
        timespec t{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
    }
    Clock::time_point wall_;
    double cpu_;
    std::vector<Stage> stages_;
};

/// Peak resident memory of this process so far, bytes; without that of its parent.
inline double peakMemory() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (word == "VmHWM:") {
            double kib = 0;
            status >> kib;
            return 1024 * kib;
        }
    return 0;
}

}  // namespace igeo::test
