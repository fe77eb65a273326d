#pragma once
// Random calls of the public API, chosen by a sequence of bytes.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::fuzz {

/// Counts of a session.
struct Statistics {
    std::uint64_t calls = 0;   ///< of the public API, with failed ones
    std::uint64_t failed = 0;  ///< calls that returned an error
    std::uint64_t frames = 0;  ///< accepted pre_steps
    std::uint64_t replays = 0; ///< logs whose replay was compared
    std::uint64_t events = 0;
    std::uint64_t alarms = 0; ///< frames that gained energy though all their problems were solved
    std::string violation;    ///< empty, or the violated guarantee
    Statistics& operator+=(const Statistics& more);
};

/// Creates a Box2D world with shells and makes calls until the bytes are used up. Violated guarantees are reported.
Statistics runSession(const std::vector<std::uint8_t>& bytes);

} // namespace supercircle::fuzz
