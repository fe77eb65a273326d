#include "tests/support/allocations.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SC_COUNTS 1
#include <malloc.h>
#endif

namespace {
std::atomic<std::uint64_t> taken{0};
std::atomic<std::int64_t> held{0}, peak{0};
} // namespace

namespace supercircle::test {

std::uint64_t allocations() {
    return taken.load(std::memory_order_relaxed);
}
std::int64_t heldBytes() {
    return held.load(std::memory_order_relaxed);
}
std::int64_t peakBytes() {
    return peak.load(std::memory_order_relaxed);
}
void restartPeak() {
    peak.store(heldBytes(), std::memory_order_relaxed);
}
bool countsAllocations() {
#ifdef SC_COUNTS
    return true;
#else
    return false;
#endif
}

} // namespace supercircle::test

#ifdef SC_COUNTS
// operator new of libstdc++ asks malloc, so counting there sees both.
extern "C" {
void* __libc_malloc(std::size_t size);                      // NOLINT
void* __libc_calloc(std::size_t count, std::size_t size);   // NOLINT
void* __libc_realloc(void* old, std::size_t size);          // NOLINT
void* __libc_memalign(std::size_t align, std::size_t size); // NOLINT
void __libc_free(void* block);                              // NOLINT
}

namespace {

void hold(void* block, int sign) {
    const auto size = sign * static_cast<std::int64_t>(malloc_usable_size(block));
    const std::int64_t now = held.fetch_add(size, std::memory_order_relaxed) + size;
    std::int64_t most = peak.load(std::memory_order_relaxed);
    while (now > most && !peak.compare_exchange_weak(most, now, std::memory_order_relaxed)) {
    }
}

void* counted(void* block) {
    taken.fetch_add(1, std::memory_order_relaxed);
    hold(block, 1);
    return block;
}

} // namespace

extern "C" {
void* malloc(std::size_t size) noexcept {
    return counted(__libc_malloc(size));
}
void* calloc(std::size_t count, std::size_t size) noexcept {
    return counted(__libc_calloc(count, size));
}
void* realloc(void* old, std::size_t size) noexcept {
    hold(old, -1);
    void* block = __libc_realloc(old, size);
    if (block == nullptr && size > 0)
        hold(old, 1); // what was there stays
    return counted(block);
}
void* aligned_alloc(std::size_t align, std::size_t size) noexcept {
    return counted(__libc_memalign(align, size));
}
void* memalign(std::size_t align, std::size_t size) noexcept {
    return counted(__libc_memalign(align, size));
}
int posix_memalign(void** block, std::size_t align, std::size_t size) noexcept {
    *block = counted(__libc_memalign(align, size));
    return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) noexcept {
    hold(block, -1);
    __libc_free(block);
}
}
#endif
