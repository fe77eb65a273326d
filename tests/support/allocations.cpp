#include "tests/support/allocations.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SC_COUNTS 1
#endif

namespace {
std::atomic<std::uint64_t> taken{0};
}

namespace supercircle::test {

std::uint64_t allocations() {
    return taken.load(std::memory_order_relaxed);
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

void* malloc(std::size_t size) noexcept {
    taken.fetch_add(1, std::memory_order_relaxed);
    return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
    taken.fetch_add(1, std::memory_order_relaxed);
    return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
    taken.fetch_add(1, std::memory_order_relaxed);
    return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t align, std::size_t size) noexcept {
    taken.fetch_add(1, std::memory_order_relaxed);
    return __libc_memalign(align, size);
}
}
#endif
