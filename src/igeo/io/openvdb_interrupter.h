/// Adapters between Progress and the interrupters of OpenVDB and its hosts, in both directions.
#pragma once

#include <igeo/base/progress.h>
#include <openvdb/util/NullInterrupter.h>

#include <atomic>
#include <mutex>

namespace igeo {

/// Progress for a tool of OpenVDB.
class OpenVdbInterrupter final : public openvdb::util::NullInterrupter {
public:
    explicit OpenVdbInterrupter(Progress& progress) : progress_(progress) {}

    void start(const char* name = nullptr) override { name_ = name ? name : "OpenVDB"; }
    bool wasInterrupted(int percent = -1) override {
        if (percent >= 0) progress_.update(name_, percent / 100.0);
        return progress_.cancelled();
    }
    /// The type that the tools compiled into OpenVDB take.
    openvdb::util::NullInterrupter* pointer() { return this; }

private:
    Progress& progress_;
    const char* name_ = "OpenVDB";
};

/// A host's interrupter as a Progress: anything with start(name), end() and
/// wasInterrupted(percent), such as Houdini's UT_VDBUtils hvdb::Interrupter and all classes derived
/// from OpenVDB's NullInterrupter.
///
/// One thread calls it at a time. Once interrupted, it stays interrupted.
template <typename Interrupter>
class InterrupterProgress final : public Progress {
public:
    explicit InterrupterProgress(Interrupter& host) : host_(host) { host_.start("igeo"); }
    ~InterrupterProgress() override { host_.end(); }
    InterrupterProgress(const InterrupterProgress&) = delete;
    InterrupterProgress& operator=(const InterrupterProgress&) = delete;

    void update(const char*, double fraction) override { ask(int(100 * fraction)); }
    bool cancelled() const override {
        ask(-1);
        return interrupted_;
    }

private:
    void ask(int percent) const {
        // While another thread asks the host, this one uses the last answer.
        const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
        if (lock.owns_lock() && host_.wasInterrupted(percent)) interrupted_ = true;
    }

    Interrupter& host_;
    mutable std::mutex mutex_;
    mutable std::atomic<bool> interrupted_{false};
};

}  // namespace igeo
