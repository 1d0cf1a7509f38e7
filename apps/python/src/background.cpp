#include "background.h"

#include <igeo/base/error.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

namespace py = pybind11;

namespace {

/// Progress from the threads of the work to the one that waits.
class SharedProgress : public igeo::Progress {
public:
    explicit SharedProgress(bool listened) : listened_(listened) {}

    void update(const char* name, double fraction) override {
        if (!listened_) return;
        const std::lock_guard<std::mutex> lock(mutex_);
        stage_ = name;
        fraction_ = fraction;
        isNew_ = true;
    }
    bool cancelled() const override { return cancelled_; }
    void cancel() { cancelled_ = true; }

    /// The report since the last call, if any.
    std::optional<std::pair<std::string, double>> news() {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!isNew_) return std::nullopt;
        isNew_ = false;
        return std::pair{stage_, fraction_};
    }

private:
    const bool listened_;
    std::atomic<bool> cancelled_{false};
    std::mutex mutex_;
    std::string stage_;
    double fraction_ = 0;
    bool isNew_ = false;
};

/// The thread that works, and its failure.
class Worker {
public:
    Worker(SharedProgress& progress, const std::function<void(igeo::Progress&)>& work)
        : thread_([this, &progress, &work] {
              try {
                  work(progress);
              } catch (...) {
                  failure_ = std::current_exception();
              }
              const std::lock_guard<std::mutex> lock(mutex_);
              done_ = true;
              ended_.notify_all();
          }) {}
    ~Worker() { thread_.join(); }

    bool endsWithin(std::chrono::milliseconds time) {
        const py::gil_scoped_release released;
        std::unique_lock<std::mutex> lock(mutex_);
        return ended_.wait_for(lock, time, [this] { return done_; });
    }
    /// Call after the work has ended.
    const std::exception_ptr& failure() const { return failure_; }

private:
    std::mutex mutex_;
    std::condition_variable ended_;
    bool done_ = false;
    std::exception_ptr failure_;
    std::thread thread_;  // last: it uses the others
};

void listen(SharedProgress& progress, const py::object& callback) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callback.is_none()) return;
    if (const auto news = progress.news()) callback(news->first, news->second);
}

}  // namespace

void runInBackground(const py::object& callback, const std::function<void(igeo::Progress&)>& work) {
    constexpr std::chrono::milliseconds kPace{50};
    if (!callback.is_none() && !PyCallable_Check(callback.ptr()))
        throw igeo::Error(igeo::Error::Kind::InvalidArgument,
                          "progress is " + std::string(py::repr(callback)) +
                              "; allowed are functions of a stage and a share");
    SharedProgress progress(!callback.is_none());
    std::optional<py::error_already_set> stop;
    Worker worker(progress, work);
    while (!worker.endsWithin(kPace)) {
        if (stop) continue;
        try {
            listen(progress, callback);
        } catch (py::error_already_set& error) {
            stop.emplace(error);
            progress.cancel();
        }
    }
    if (stop) throw py::error_already_set(*stop);
    if (worker.failure()) std::rethrow_exception(worker.failure());
    listen(progress, callback);
}
