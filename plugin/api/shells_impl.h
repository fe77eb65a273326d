#pragma once
// The implementation behind class Shells (private to plugin/api).

#include "plugin/api/event_detector.h"
#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/api/snapshot_log.h"
#include "supercircle/step/stepper.h"

#include <cmath>
#include <exception>
#include <new>

namespace supercircle {

inline const char* const kMovedFrom = "these Shells were moved from: use the object they were moved to";

/// What a handle refers to.
struct Slot {
    std::uint32_t generation = 0; ///< of the shell in this slot, or of the last one
    std::uint32_t key = 0;        ///< of the rod, 0: free
    std::uint32_t highest = 0;    ///< highest generation ever given out; none is given out twice, also after restore()
    std::string name;
    std::uint64_t userData = 0;
};

struct Shells::Impl {
    std::shared_ptr<step::Port> port;
    step::World world;
    step::Stepper stepper{step::Settings{}};
    std::vector<Slot> slots;
    double advanced = 0.0;                 ///< s, by the last pre_step
    std::uint32_t worldId = nextWorldId(); ///< stored in the handles: those of another world fail
    bool stepping = false;                 ///< during pre_step: nothing may be changed
    EventDetector detector;
    CallRecorder recorder;
    std::vector<effects::Setting> effectsOfNew; ///< what shells created later get
    /// Coordinates of a rod at the start of the last frame, for drawing.
    struct StartPose {
        std::uint32_t key = 0;
        Eigen::VectorXd q;
    };
    std::vector<StartPose> startPoses;
    bool gone = false; ///< stands in for the contents that were moved away

    /// What every object that was moved from refers to: no shells, and nothing can be changed.
    static std::shared_ptr<Impl> movedFrom();
    /// Coordinates of a rod between the start and the end of the last frame.
    [[nodiscard]] Eigen::VectorXd between(const step::Rod& rod, double alpha) const;
    void recordStart();
    void tell(const step::FrameResult& frame);
    void forgetStart(std::uint32_t key);
    template <class Change>
    Status changeEffects(const EffectTarget& target, Change changeList);

    /// A number no other Shells of this process has or had.
    static std::uint32_t nextWorldId();
    /// Index of the rod in the world, or -1.
    [[nodiscard]] int find(ShellHandle h) const;
    /// The handle of a rod; null if Shells did not create it.
    [[nodiscard]] ShellHandle handleOf(std::uint32_t key) const;
    /// Assigns a slot to a new rod.
    ShellHandle assignSlot(std::uint32_t key, std::string name, std::uint64_t userData);
    [[nodiscard]] step::Rod& rod(int index) { return world.rods[static_cast<std::size_t>(index)]; }
    [[nodiscard]] const step::Rod& rod(int index) const { return world.rods[static_cast<std::size_t>(index)]; }

    /// A constraint of a rod (Hold, MouseJoint, AppliedForce) by its key.
    template <class Constraint>
    struct Found {
        step::Rod* rod = nullptr;
        Constraint* constraint = nullptr;
        std::size_t index = 0; ///< of the rod
    };
    template <class Constraint, class Kind>
    [[nodiscard]] Found<Constraint> find(const ConstraintHandle<Kind>& h, std::vector<Constraint> step::Rod::*list) {
        if (h.null() || h.world != worldId)
            return {};
        const int i = step::rodIndex(world, h.index);
        if (i < 0)
            return {};
        for (Constraint& c : rod(i).*list)
            if (c.key == h.generation)
                return {&rod(i), &c, static_cast<std::size_t>(i)};
        return {};
    }
    [[nodiscard]] step::Link* findLink(JointHandle h);
    /// `once`: for the coming frame only.
    Result<ForceHandle> addForce(ShellHandle shell, double arc_fraction, Point force, double torque, bool once);
    /// Wakes the rods of a link.
    void wake(const step::Link& link);

    /// Runs a changing call: it fails while the shells are being stepped, and when something is thrown.
    template <class Call>
    auto change(Call call) -> decltype(call()) {
        using R = decltype(call());
        if (gone)
            return R::failure(kMovedFrom);
        if (stepping)
            return R::failure(kWorldLocked);
        return withoutExceptions(call);
    }
    /// An exception of the host, the canvas or a standard container becomes the failure.
    template <class Call>
    static auto withoutExceptions(Call call) -> decltype(call()) {
        using R = decltype(call());
        try {
            return call();
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& e) {
            return R::failure(e.what());
        } catch (...) {
            return R::failure("an exception of unknown type was thrown");
        }
    }
};

inline const char* const kNoSuchShell = "no such shell (stale or foreign handle)";
inline const char* const kNoSuchConstraint = "no such hold, joint, mouse joint or force (stale or foreign handle)";

inline Status done() {
    return Status(std::monostate{});
}
inline Status refused(std::string why) {
    return Status::failure(std::move(why));
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
/// Bending strain at an element's surfaces, 1.
inline double surfaceStrain(const step::Rod& rod, int element) {
    const rod::RodDefinition& d = rod.model.definition();
    return 0.5 * d.thickness *
           std::abs(rod.q[rod.model.dofOfElement(element)] - d.naturalCurvature[static_cast<std::size_t>(element)]);
}
/// Sets the target of a hold or of the far end of a tether for the coming frame; the step gives it its times. It
/// replaces a target that was not reached yet.
inline void setPendingTarget(const TargetDef& to, step::Target& target) {
    target.path.active = false;
    target.path.to = vec(to.position);
    target.path.toVelocity = vec(to.velocity);
    target.path.toAngle = to.angle;
    target.path.toSpin = to.spin;
    target.pending = true;
}
inline const char* const kBadFraction = "the place along a shell must lie between 0 and 1, its two ends";

} // namespace supercircle
