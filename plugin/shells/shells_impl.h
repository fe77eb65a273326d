#pragma once
// What stands behind the facade (private to shells/).

#include "plugin/include/supercircle/shells.hpp"
#include "plugin/shells/events_watch.h"
#include "plugin/shells/snapshot_log.h"
#include "supercircle/step/stepper.h"

namespace supercircle {

/// Where a handle leads.
struct Slot {
    std::uint32_t generation = 0; ///< of the shell that lives here, or of the last one that did
    std::uint32_t key = 0;        ///< of the rod, 0: free
    std::uint32_t highest = 0;    ///< highest generation ever given out: a restored past gives none out twice
    std::string name;
    std::uint64_t userData = 0;
};

struct Shells::Impl {
    std::shared_ptr<step::Port> port;
    step::World world;
    step::Stepper stepper{step::Settings{}};
    std::vector<Slot> slots;
    double advanced = 0.0;   ///< s, by the last pre_step
    std::uint32_t tag = 0;   ///< goes into the handles, so that those of another world are refused
    bool inside = false;     ///< in a pre_step: the observer may not start another one or swap the state
    std::uint64_t inner = 0; ///< inner steps of the frame that is running, 0 outside
    std::string hostFault;   ///< what the host threw in post_step
    Watch watch;
    CallRecorder recorder;

    Impl();
    /// Index of the rod in the world, or -1.
    [[nodiscard]] int find(ShellHandle h) const;
    /// The handle of a rod; null if it was not made by the facade.
    [[nodiscard]] ShellHandle handleOf(std::uint32_t key) const;
    /// Gives a new rod a slot.
    ShellHandle adopt(std::uint32_t key, std::string name, std::uint64_t userData);
    [[nodiscard]] const step::Rod& rod(int index) const { return world.rods[static_cast<std::size_t>(index)]; }
};

inline const char* const kNoSuchShell = "no such shell (stale or foreign handle)";

} // namespace supercircle
