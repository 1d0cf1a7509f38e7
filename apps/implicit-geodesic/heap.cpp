#include "heap.h"

#include <cstdlib>  // __GLIBC__

#if defined(__SANITIZE_ADDRESS__)
#define OTHER_HEAP 1  // which reports memory that another operator new took
#elif defined(__has_feature)
#define OTHER_HEAP __has_feature(address_sanitizer)
#endif

#if defined(__GLIBC__) && !OTHER_HEAP

#include <igeo/base/detail/system.h>

#include <malloc.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <new>

namespace {

constexpr std::uintptr_t kLargePage = 2 << 20;
constexpr std::uintptr_t kNotSetUp = std::numeric_limits<std::uintptr_t>::max();

/// Where the part of the heap ends that has been asked to be in large pages.
std::atomic<std::uintptr_t> asked{kNotSetUp};

std::uintptr_t addressOf(void* p) { return reinterpret_cast<std::uintptr_t>(p); }
std::uintptr_t endOfHeap() { return addressOf(::sbrk(0)); }

/// Asks for large pages up to the end of the heap, or for a block beside it: those of 32 MB and
/// more, and those of other threads.
void askFor(void* block, std::size_t bytes) {
    const std::uintptr_t end = endOfHeap();
    if (addressOf(block) >= end) {
        if (bytes >= kLargePage) igeo::askForLargePages(block, bytes);
        return;
    }
    const std::uintptr_t begin = asked.exchange(end) & -kLargePage;
    if (begin < end) igeo::askForLargePages(reinterpret_cast<void*>(begin), end - begin);
}

}  // namespace

void useLargePages() {
    constexpr int kStep = 32 << 20, kLeastBeside = 32 << 20,
                  kNever = std::numeric_limits<int>::max();
    ::mallopt(M_TOP_PAD, kStep);
    ::mallopt(M_MMAP_THRESHOLD, kLeastBeside);
    ::mallopt(M_TRIM_THRESHOLD, kNever);
    asked = endOfHeap();
}

void giveBackFreedMemory() {
    ::malloc_trim(0);
    // Where the heap grows again, its pages are new.
    if (asked != kNotSetUp) asked = std::min(asked.load(), endOfHeap());
}

/// As the standard library has it, in large pages.
void* operator new(std::size_t bytes) {
    void* block;
    while (!(block = std::malloc(bytes))) {
        const std::new_handler handler = std::get_new_handler();
        if (!handler) throw std::bad_alloc();
        handler();
    }
    if (addressOf(block) + bytes > asked.load(std::memory_order_relaxed)) askFor(block, bytes);
    return block;
}

#else

void useLargePages() {}
void giveBackFreedMemory() {}

#endif
