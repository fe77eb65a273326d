#pragma once
// Records the changing calls of a Shells (private to plugin/api).

#include "plugin/api/include/supercircle/snapshot.hpp"
#include "plugin/api/snapshot_archive.h"

#include <memory>

namespace supercircle {

/// Kind of a record in the log; the numbers are part of the format.
enum class Call : std::uint8_t {
    Restore = 1,
    Create = 2,
    Destroy = 3,
    CreateHold = 4,
    AttachToCrosshead = 5,
    SetCrossheadVelocity = 6,
    PreStep = 7,
    FrameEnd = 8, ///< follows PreStep: number of inner steps, stopped by the observer, whether there was one
    PostStep = 9,
    SetName = 10,
    SetUserData = 11,
    SetEventSettings = 12,
    SetQuality = 13,
    SetHoldTarget = 14,
    DestroyHold = 15,
    CreateJoint = 16,
    SetJointTarget = 17,
    SetMaxLength = 18,
    DestroyJoint = 19,
    CreateMouseJoint = 20,
    SetMouseJointTarget = 21,
    DestroyMouseJoint = 22,
    ApplyForce = 23,
    ApplyImpulse = 24,
    CreateForce = 25,
    SetForce = 26,
    DestroyForce = 27,
    Teleport = 28,
    SetVelocity = 29,
    SetMaterial = 30,
    SetFilter = 31,
    SetFriction = 32,
    ResetFriction = 33,
    SetShellFrictionMaterial = 34,
    SetBodyFrictionMaterial = 35,
    SetSleep = 36,
    Sleep = 37,
    Wake = 38,
    SetFrameBudget = 39,
    SetEffect = 40,
    ReplaceEffects = 41,
    RemoveEffect = 42,
    SetSurfaceSpeed = 43,
    ShiftOrigin = 44,
    SetCrushPolicy = 45,
    SetHoldMaxForce = 46,
    SetJointMaxForce = 47,
    SetRecovery = 48,
    Count
};

/// A record is the call (1 byte), the size of its arguments (8 bytes) and the arguments; a returned handle is the last.
class CallRecorder {
public:
    void start(std::uint64_t seed);
    void stop() { on_ = false; }
    [[nodiscard]] bool on() const { return on_; }
    /// Callers include snapshot_fields.h.
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
