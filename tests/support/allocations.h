#pragma once
// Counts allocations by operator new or malloc (Eigen), for tests that a repeated step allocates nothing. It works with
// glibc and without sanitizers; elsewhere nothing is counted.

#include <cstdint>

namespace supercircle::test {

/// Whether this build can count.
[[nodiscard]] bool countsAllocations();
/// Of all threads since the program started.
[[nodiscard]] std::uint64_t allocations();

} // namespace supercircle::test
