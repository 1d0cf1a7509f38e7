/// Threads behind a small interface, so that TBB is compiled once.
///
/// Every parallel loop of the library writes to slots of its own and combines them in order, so
/// results do not depend on the number of threads.
#pragma once

#include <igeo/base/progress.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace igeo {

/// Calls body(begin, end) for disjoint ranges that cover [0, n), in parallel. Ranges hold at least
/// `grain` items, except the last; exceptions from `body` reach the caller. Loops may be nested; a
/// thread runs one range of a loop at a time.
void parallelFor(std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body);

/// The same with cancellation, tested before each range.
/// @throws Error  Cancelled
void parallelFor(std::size_t n, std::size_t grain, const Progress& progress,
                 const std::function<void(std::size_t, std::size_t)>& body);

/// Makes memory that was never used ready to be written, by all threads: its first touch takes
/// longer than most of what is written there, and one thread would do all of it.
void touchPages(void* memory, std::size_t bytes);

/// v.resize(n) of an empty vector, by all threads but for the initial values.
template <typename T>
void resizeByAll(std::vector<T>& v, std::size_t n) {
    v.reserve(n);
    touchPages(v.data(), n * sizeof(T));
    v.resize(n);
}

/// Limits the threads of the process while it lives; for programs, never used inside the library.
class ThreadLimit {
public:
    /// @param threads  0: as many as there are cores
    /// @throws std::bad_alloc  too little memory for TBB
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

    /// Threads that parallel loops use now.
    static int current();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace igeo
