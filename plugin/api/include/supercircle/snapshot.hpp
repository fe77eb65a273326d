#pragma once
// Saved states and recorded calls.
//
// A snapshot holds the state that determines the shells' future. Restored into the same Shells or into new ones with
// the same host, it continues bitwise identically. It does not hold the host, and Box2D 2.4.1 cannot be restored
// exactly: its warm-starting impulses, contact order, enlarged boxes and sleep timers are not accessible. Static and
// kinematic bodies do not need them. With dynamic bodies record the calls (CallLog), build the Box2D world anew and
// replay them.

#include "handle.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace supercircle {

class Shells;

/// The state of all shells at one time; a plain value.
class Snapshot {
public:
    Snapshot() = default;
    /// From bytes written by bytes(), on any machine. Fails with a reason on other files, other versions and damage.
    static Result<Snapshot> from_bytes(std::vector<std::uint8_t> bytes);
    /// Header with name, version and checksum, then the state: the content of a file.
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    [[nodiscard]] bool empty() const { return bytes_.empty(); }
    friend bool operator==(const Snapshot& a, const Snapshot& b) { return a.bytes_ == b.bytes_; }

private:
    friend class Shells;
    std::vector<std::uint8_t> bytes_;
    std::uint32_t origin_ = 0; ///< id() of the Shells of this process that saved it; 0: from bytes
};

/// The calls that changed a Shells since Shells::start_log(), in order. Calls of the host are not recorded: repeat them
/// in the same order between the same frames.
class CallLog {
public:
    CallLog() = default;
    /// As of Snapshot.
    static Result<CallLog> from_bytes(std::vector<std::uint8_t> bytes);
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    [[nodiscard]] std::uint64_t seed() const { return seed_; } ///< the user's, given to start_log
    [[nodiscard]] std::uint64_t calls() const { return calls_; }
    [[nodiscard]] std::uint64_t frames() const { return frames_; } ///< calls of pre_step

private:
    friend class Shells;
    std::vector<std::uint8_t> bytes_;
    std::uint64_t seed_ = 0, calls_ = 0, frames_ = 0;
};

} // namespace supercircle
