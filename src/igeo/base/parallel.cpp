#include <igeo/base/parallel.h>

#include <igeo/base/detail/system.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <new>

namespace igeo {

void parallelFor(std::size_t n, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t)>& body) {
    if (n == 0) return;
    if (n <= grain) return body(0, n);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, std::max<std::size_t>(grain, 1)),
                      [&](const tbb::blocked_range<std::size_t>& r) {
                          // Isolated: a thread that waits for an inner loop, of ours or of OpenVDB,
                          // must not start another range of this loop. That would add its memory,
                          // and it may need a lock that the waiting range holds.
                          tbb::this_task_arena::isolate([&] { body(r.begin(), r.end()); });
                      });
}

void parallelFor(std::size_t n, std::size_t grain, const Progress& progress,
                 const std::function<void(std::size_t, std::size_t)>& body) {
    parallelFor(n, grain, [&](std::size_t begin, std::size_t end) {
        if (!progress.cancelled()) body(begin, end);
    });
    progress.throwIfCancelled();
}

void touchPages(void* memory, std::size_t bytes) {
    constexpr std::size_t kPage = 4096;
    askForLargePages(memory, bytes);
    if (ThreadLimit::current() == 1) return;
    parallelFor(bytes / kPage, 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            static_cast<volatile char*>(memory)[k * kPage] = 0;
    });
}

struct ThreadLimit::Impl {
    explicit Impl(std::size_t n) : control(tbb::global_control::max_allowed_parallelism, n) {}
    tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
    // At first use TBB takes memory of its own from the system, 4 MB. Where oneTBB 2022 finds none
    // it waits forever: it throws while it holds locks, and throwing takes one of them.
    constexpr std::size_t kOfTbb = 16 << 20;
    if (!wouldGive(kOfTbb)) throw std::bad_alloc();
    if (threads > 0) impl_ = std::make_unique<Impl>(std::size_t(threads));
    tbb::task_group().run_and_wait([] {});
}

ThreadLimit::~ThreadLimit() = default;

int ThreadLimit::current() {
    return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace igeo
