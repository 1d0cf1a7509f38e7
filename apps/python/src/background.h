/// Work without Python's lock, with Ctrl-C and progress.
#pragma once

#include <igeo/base/progress.h>
#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <utility>

/// Calls work(progress) in a thread of its own, while the calling thread waits without the lock.
/// Only the calling thread runs Python: signal handlers, and callback(stage, fraction) unless it is
/// None; Error if it is no function. An exception there cancels the work, and is thrown after the
/// work has ended.
void runInBackground(const pybind11::object& callback,
                     const std::function<void(igeo::Progress&)>& work);

/// The same, returning what `work` returns.
template <typename Work>
auto inBackground(const pybind11::object& callback, const Work& work) {
    std::optional<decltype(work(std::declval<igeo::Progress&>()))> result;
    runInBackground(callback, [&](igeo::Progress& progress) { result.emplace(work(progress)); });
    return std::move(*result);
}
