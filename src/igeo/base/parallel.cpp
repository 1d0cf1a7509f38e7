#include <igeo/base/parallel.h>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <algorithm>
#include <cstdint>

namespace igeo {

namespace {

/// Asks for pages of 2 MB: reads all over a large array miss the address cache less often, and
/// fewer pages are touched first. A system that has none goes on with its own.
void askForLargePages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    constexpr std::uintptr_t kPage = 2 << 20;
    const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + kPage - 1) / kPage * kPage,
               end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / kPage * kPage;
    if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

}  // namespace

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

ThreadLimit::ThreadLimit(int threads)
    : impl_(threads > 0 ? std::make_unique<Impl>(std::size_t(threads)) : nullptr) {}

ThreadLimit::~ThreadLimit() = default;

int ThreadLimit::current() {
    return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace igeo
