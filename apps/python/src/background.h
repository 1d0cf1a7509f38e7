/// Work without Python's lock, which Ctrl-C ends and which reports how far it is.
#pragma once

#include <igeo/base/progress.h>
#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <utility>

/// Calls work(progress) in a thread of its own, while the thread that called waits without the
/// lock. That thread alone runs Python: the handlers of signals, and callback(stage, fraction)
/// unless that is None. An exception there cancels the work, and is thrown once the work has ended.
void runInBackground(const pybind11::object& callback,
                     const std::function<void(igeo::Progress&)>& work);

/// The same with what `work` returns.
template <typename Work>
auto inBackground(const pybind11::object& callback, const Work& work) {
    std::optional<decltype(work(std::declval<igeo::Progress&>()))> result;
    runInBackground(callback, [&](igeo::Progress& progress) { result.emplace(work(progress)); });
    return std::move(*result);
}
