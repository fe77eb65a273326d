#pragma once
// Writes the changing calls of a Shells down (private to shells/).

#include "plugin/api/include/supercircle/snapshot.hpp"
#include "plugin/api/snapshot_archive.h"

#include <memory>

namespace supercircle {

/// What a record in the log is; the numbers are part of the format.
enum class Call : std::uint8_t {
    Restore = 1,
    Create = 2,
    Destroy = 3,
    Hold = 4,
    Carry = 5,
    MachineVelocity = 6,
    PreStep = 7,
    FrameEnd = 8, ///< right behind it: inner steps, stopped by the observer
    PostStep = 9,
    SetName = 10,
    SetUserData = 11,
    SetEventSettings = 12,
    SetQuality = 13,
    DriveHold = 14,
    ReleaseHold = 15,
    Join = 16,
    DriveJoint = 17,
    Reel = 18,
    ReleaseJoint = 19,
    Grab = 20,
    MoveGrab = 21,
    ReleaseGrab = 22,
    ApplyForce = 23,
    ApplyImpulse = 24,
    AddForce = 25,
    SetForce = 26,
    ReleaseForce = 27,
    Teleport = 28,
    SetVelocity = 29,
    SetMaterial = 30,
    SetFilter = 31,
    SetFriction = 32,
    ResetFriction = 33,
    SetShellSurface = 34,
    SetBodySurface = 35,
    SetSleep = 36,
    Sleep = 37,
    Wake = 38,
    SetFrameBudget = 39,
    Count
};

/// Records are: call (1 byte), size of the arguments (8), arguments; last of them what the call returned, if a handle.
class CallRecorder {
public:
    void start(std::uint64_t seed);
    void stop() { on_ = false; }
    [[nodiscard]] bool on() const { return on_; }
    /// Who calls this includes snapshot_fields.h.
    template <class... T>
    void record(Call call, const T&... arguments) {
        if (!on_)
            return;
        archive::Saver content;
        content(arguments...);
        content_(call, content.bytes);
    }
    /// Seed and records.
    [[nodiscard]] const std::vector<std::uint8_t>& content() const { return content_.bytes; }

private:
    bool on_ = false;
    archive::Saver content_;
};

} // namespace supercircle
