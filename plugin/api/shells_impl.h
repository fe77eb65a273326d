#pragma once
// What stands behind the facade (private to shells/).

#include "plugin/api/events_watch.h"
#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/api/snapshot_log.h"
#include "supercircle/step/stepper.h"

#include <cmath>
#include <exception>
#include <new>

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
    double advanced = 0.0;         ///< s, by the last pre_step
    std::uint32_t tag = nextTag(); ///< goes into the handles, so that those of another world are refused
    bool inside = false;           ///< in a pre_step: nothing may be changed
    Watch watch;
    CallRecorder recorder;

    /// A number no other Shells of this process has or had.
    static std::uint32_t nextTag();
    /// Index of the rod in the world, or -1.
    [[nodiscard]] int find(ShellHandle h) const;
    /// The handle of a rod; null if it was not made by the facade.
    [[nodiscard]] ShellHandle handleOf(std::uint32_t key) const;
    /// Gives a new rod a slot.
    ShellHandle adopt(std::uint32_t key, std::string name, std::uint64_t userData);
    [[nodiscard]] step::Rod& rod(int index) { return world.rods[static_cast<std::size_t>(index)]; }
    [[nodiscard]] const step::Rod& rod(int index) const { return world.rods[static_cast<std::size_t>(index)]; }

    /// A part of a rod (Hold, Grab, PointForce) by its key.
    template <class Part>
    struct Found {
        step::Rod* rod = nullptr;
        Part* part = nullptr;
        std::size_t index = 0; ///< of the rod
    };
    template <class Part, class Kind>
    [[nodiscard]] Found<Part> find(const PartHandle<Kind>& h, std::vector<Part> step::Rod::*list) {
        if (h.null() || h.world != tag)
            return {};
        const int i = step::rodIndex(world, h.index);
        if (i < 0)
            return {};
        for (Part& p : rod(i).*list)
            if (p.key == h.generation)
                return {&rod(i), &p, static_cast<std::size_t>(i)};
        return {};
    }
    [[nodiscard]] step::Link* findLink(JointHandle h);
    /// `once`: for the coming frame only.
    Result<ForceHandle> addForce(ShellHandle shell, double arc_fraction, Point force, double torque, bool once);
    /// Wakes the rods of a link.
    void wake(const step::Link& link);

    /// Runs a changing call: refused while the shells are being stepped; what is thrown becomes the failure.
    template <class Call>
    auto change(Call call) -> decltype(call()) {
        using R = decltype(call());
        if (inside)
            return R::failure(kStepping);
        return caught(call);
    }
    /// What the host, the canvas or a standard container throws becomes the failure.
    template <class Call>
    static auto caught(Call call) -> decltype(call()) {
        using R = decltype(call());
        try {
            return call();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& e) {
            return R::failure(e.what());
        } catch (...) {
            return R::failure("something was thrown that is no std::exception");
        }
    }
};

inline const char* const kNoSuchShell = "no such shell (stale or foreign handle)";
inline const char* const kNoSuchPart = "no such part (stale or foreign handle)";

inline Outcome done() {
    return Outcome(std::monostate{});
}
inline Outcome refused(std::string why) {
    return Outcome::failure(std::move(why));
}
inline bool finite(const Point& p) {
    return std::isfinite(p.x) && std::isfinite(p.y);
}
inline bool isFraction(double f) {
    return f >= 0.0 && f <= 1.0;
}
inline step::Vec2 vec(const Point& p) {
    return {p.x, p.y};
}
inline Point point(const step::Vec2& v) {
    return {v.x(), v.y()};
}
/// Strain of an element's surfaces by bending, 1.
inline double surfaceStrain(const step::Rod& rod, int element) {
    const rod::RodDefinition& d = rod.model.definition();
    return 0.5 * d.thickness *
           std::abs(rod.q[rod.model.dofOfElement(element)] - d.naturalCurvature[static_cast<std::size_t>(element)]);
}
/// A goal for the coming frame, to a hold or to the far end of a tether; its times are given by the step. What was
/// under way before ends here.
inline void setGoal(const DriveDef& to, step::Target& target) {
    target.path.active = false;
    target.path.to = vec(to.position);
    target.path.toVelocity = vec(to.velocity);
    target.path.toAngle = to.angle;
    target.path.toSpin = to.spin;
    target.pending = true;
}
inline const char* const kBadFraction = "arc_fraction must lie between 0 and 1";

} // namespace supercircle
