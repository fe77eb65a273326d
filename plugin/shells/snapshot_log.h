#pragma once
// Writes the changing calls of a Shells down (private to shells/).

#include "plugin/include/supercircle/snapshot.hpp"
#include "plugin/shells/snapshot_archive.h"

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
    PreStep = 7,  ///< records until FrameEnd were made by its observer
    FrameEnd = 8, ///< inner steps, stopped by the observer
    PostStep = 9,
    SetName = 10,
    SetUserData = 11,
    SetEventSettings = 12,
    SetQuality = 13,
    Last = SetQuality
};

/// Records are: call (1 byte), inner steps (8), size of the arguments (8), arguments.
class CallRecorder {
public:
    void start(std::uint64_t seed);
    void stop() { on_ = false; }
    [[nodiscard]] bool on() const { return on_; }
    /// `inner`: steps of the running frame when the call was made, 0 outside of frames. Who calls this includes
    /// snapshot_fields.h.
    template <class... T>
    void record(Call call, std::uint64_t inner, const T&... arguments) {
        if (!on_)
            return;
        archive::Saver content;
        content(arguments...);
        content_(call, inner, content.bytes);
    }
    /// Seed and records.
    [[nodiscard]] const std::vector<std::uint8_t>& content() const { return content_.bytes; }

private:
    bool on_ = false;
    archive::Saver content_;
};

} // namespace supercircle
