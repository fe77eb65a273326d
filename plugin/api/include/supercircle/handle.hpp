#pragma once
// How a shell is named, and how a call answers.

#include "result.hpp"

#include <cstdint>

namespace supercircle {

/// Names a shell. A stale or foreign handle gives an error, never a crash. The default is null: no shell.
struct ShellHandle {
    std::uint32_t index = 0;
    std::uint32_t generation = 0;
    std::uint32_t world = 0; ///< which Shells it belongs to
    [[nodiscard]] bool null() const { return generation == 0; }
    friend bool operator==(const ShellHandle&, const ShellHandle&) = default;
};

/// The error of a call that would change shells during pre_step.
inline const char* const kWorldLocked =
    "the shells are being stepped: change them after pre_step, not from its observer";

} // namespace supercircle
