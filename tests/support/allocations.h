#pragma once
// Counts what the program takes from the heap, by operator new or by malloc (Eigen's matrices): for tests that a warm
// step takes nothing. Only where glibc is the heap and no sanitizer stands in front of it; elsewhere nothing is
// counted.

#include <cstdint>

namespace supercircle::test {

/// Whether this build can count.
[[nodiscard]] bool countsAllocations();
/// Of all threads since the program started.
[[nodiscard]] std::uint64_t allocations();

} // namespace supercircle::test
