#pragma once
// Counts allocations by operator new or malloc (Eigen), and the bytes held, for tests that a repeated step allocates
// nothing and that a reader takes a bounded multiple of its file. It works with glibc and without sanitizers; elsewhere
// nothing is counted.

#include <cstdint>

namespace supercircle::test {

/// Whether this build can count.
[[nodiscard]] bool countsAllocations();
/// Of all threads since the program started.
[[nodiscard]] std::uint64_t allocations();
/// Bytes allocated and not freed, of all threads.
[[nodiscard]] std::int64_t heldBytes();
/// Largest `heldBytes` since `restartPeak`.
[[nodiscard]] std::int64_t peakBytes();
void restartPeak();

} // namespace supercircle::test
