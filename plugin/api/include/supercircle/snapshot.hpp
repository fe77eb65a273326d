#pragma once
// Saved states and recorded calls.
//
// A snapshot holds all that the shells' future depends on: restored into the same Shells or into a fresh one (with the
// same host around it) it goes on bit for bit. It does not hold the host. Box2D 2.4.1 in particular cannot be put back
// exactly by anybody: positions and velocities can be set, but the impulses its contacts and joints start from, the
// order of its contact list, the enlarged boxes of its broad phase and its sleep timers cannot be reached from outside.
// Where only static and kinematic bodies touch shells none of this matters. With dynamic bodies, repeat instead of
// restoring: record the calls (CallLog), build the Box2D world anew and replay them.

#include "handle.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace supercircle {

class Shells;

/// The state of all shells at one moment; a plain value, to be copied at will.
class Snapshot {
public:
    Snapshot() = default;
    /// From bytes written by bytes(), on any machine. Refused with a reason: other files, other versions, damage.
    static Result<Snapshot> from_bytes(std::vector<std::uint8_t> bytes);
    /// Header with name, version and checksum, then the state; what to write into a file.
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    [[nodiscard]] bool empty() const { return bytes_.empty(); }
    friend bool operator==(const Snapshot& a, const Snapshot& b) { return a.bytes_ == b.bytes_; }

private:
    friend class Shells;
    std::vector<std::uint8_t> bytes_;
    std::uint32_t origin_ = 0; ///< which Shells of this process saved it; 0: read from bytes
};

/// Every call that changed a Shells, in order, from Shells::start_log() on. The calls of the host are its
/// user's: keep them in the same order between the same frames.
class CallLog {
public:
    CallLog() = default;
    /// As of Snapshot.
    static Result<CallLog> from_bytes(std::vector<std::uint8_t> bytes);
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    [[nodiscard]] std::uint64_t seed() const { return seed_; } ///< the user's, given to start_log
    [[nodiscard]] std::uint64_t calls() const { return calls_; }
    [[nodiscard]] std::uint64_t frames() const { return frames_; } ///< how often pre_step was called

private:
    friend class Shells;
    std::vector<std::uint8_t> bytes_;
    std::uint64_t seed_ = 0, calls_ = 0, frames_ = 0;
};

} // namespace supercircle
