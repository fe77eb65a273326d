#include "plugin/api/snapshot_fields.h"

#include <algorithm>
#include <tuple>

namespace supercircle {

using archive::Loader;

namespace {

/// One record of a log.
struct Record {
    Call call{};
    std::vector<std::uint8_t> arguments;
};

template <class T>
constexpr bool kIsHandle = std::is_same_v<T, ShellHandle>;
template <class Tag>
constexpr bool kIsHandle<ConstraintHandle<Tag>> = true;

/// Repeats the calls of a log on other Shells.
class Replay {
public:
    Replay(Shells& shells, const std::function<bool(double)>& hostStep) : shells_(shells), hostStep_(hostStep) {}

    Status run(const std::vector<Record>& records) {
        for (std::size_t i = 0; i < records.size() && !ended_; ++i) {
            if (records[i].call == Call::PreStep)
                frame(records, i++);
            else if (records[i].call == Call::PostStep)
                postStep();
            else if (!makeBasic(records[i]) && !makeMechanics(records[i]) && !makeProperty(records[i]))
                fault_ = "this call is not possible here";
            if (!fault_.empty())
                return refused("record " + std::to_string(i) + " of the log: " + fault_);
        }
        return {};
    }

private:
    template <class H>
    using Pairs = std::vector<std::pair<H, H>>; ///< recorded, here

    /// Replaces a recorded handle by the one of these Shells; other arguments stay.
    template <class T>
    void translate(T& x) const {
        if constexpr (kIsHandle<T>) {
            const Pairs<T>& pairs = std::get<Pairs<T>>(handles_);
            const auto it = std::find_if(pairs.rbegin(), pairs.rend(), [&](const auto& p) { return p.first == x; });
            if (it != pairs.rend())
                x = it->second;
            else if (x.world == recordedWorld_) // made before the log began
                x.world = shells_.id();
        } else if constexpr (std::is_same_v<T, JointDef>) {
            translate(x.shell);
            translate(x.other);
        } else if constexpr (std::is_same_v<T, EffectTarget>) {
            translate(x.shell);
        }
    }

    template <class... T>
    bool read(const Record& r, T&... x) {
        Loader in(r.arguments.data(), r.arguments.size());
        in(x...);
        if (in.fault().empty() && in.left() != 0)
            in.fail("it has too many arguments");
        fault_ = in.fault();
        return fault_.empty();
    }

    /// Makes a call with the recorded arguments and pairs the recorded handle with the returned one.
    template <class... A, class Make>
    bool with(const Record& r, Make make) {
        std::tuple<A...> arguments;
        using R = std::invoke_result_t<Make, A&...>;
        if constexpr (std::is_same_v<R, Status>) {
            if (std::apply([&](A&... a) { return read(r, a...); }, arguments))
                std::apply([&](A&... a) { expect(((translate(a), ...), make(a...))); }, arguments);
        } else {
            using H = std::remove_cvref_t<decltype(*std::declval<R>())>;
            H made;
            if (!std::apply([&](A&... a) { return read(r, a..., made); }, arguments))
                return true;
            const R here = std::apply([&](A&... a) { return (translate(a), ...), make(a...); }, arguments);
            expect(here);
            if (here)
                std::get<Pairs<H>>(handles_).emplace_back(made, *here);
        }
        return true;
    }

    template <class R>
    void expect(const R& result) {
        if (!result)
            fault_ = "the call fails here (is the host the same?): " + result.error();
    }

    bool makeBasic(const Record& r) {
        Shells& s = shells_;
        switch (r.call) {
        case Call::Restore:
            restore(r);
            return true;
        case Call::Create:
            return with<ShellDef>(r, [&](const auto& d) { return s.create(d); });
        case Call::Destroy:
            return with<ShellHandle>(r, [&](auto h) { return s.destroy(h); });
        case Call::AttachToCrosshead:
            return with<std::string>(r, [&](const auto& name) { return s.attach_to_crosshead(name); });
        case Call::SetCrossheadVelocity:
            return with<Point>(r, [&](auto v) { return s.set_crosshead_velocity(v); });
        case Call::SetName:
            return with<ShellHandle, std::string>(r, [&](auto h, const auto& n) { return s.set_name(h, n); });
        case Call::SetUserData:
            return with<ShellHandle, std::uint64_t>(r, [&](auto h, auto d) { return s.set_user_data(h, d); });
        case Call::SetEventSettings:
            return with<EventSettings>(r, [&](const auto& e) { return s.set_event_settings(e); });
        case Call::SetQuality:
            return with<Quality>(r, [&](auto q) { return s.set_quality(q); });
        case Call::SetFrameBudget:
            return with<std::uint64_t>(r, [&](auto work) { return s.set_frame_budget(work); });
        case Call::SetCrushPolicy:
            return with<CrushPolicy>(r, [&](auto policy) { return s.set_crush_policy(policy); });
        case Call::SetRecovery:
            return with<RecoverySettings>(r, [&](const auto& e) { return s.set_recovery(e); });
        case Call::SetSleep:
            return with<SleepSettings>(r, [&](const auto& e) { return s.set_sleep(e); });
        default:
            return false;
        }
    }

    bool makeMechanics(const Record& r) {
        Shells& s = shells_;
        switch (r.call) {
        case Call::CreateHold:
            return with<ShellHandle, double, HoldKind, HoldBase>(
                r, [&](auto h, auto f, auto kind, auto base) { return s.create_hold(h, f, kind, base); });
        case Call::SetHoldTarget:
            return with<HoldHandle, TargetDef>(r, [&](auto h, const auto& d) { return s.set_target(h, d); });
        case Call::DestroyHold:
            return with<HoldHandle>(r, [&](auto h) { return s.destroy(h); });
        case Call::CreateJoint:
            return with<JointDef>(r, [&](const auto& d) { return s.create_joint(d); });
        case Call::SetJointTarget:
            return with<JointHandle, TargetDef>(r, [&](auto h, const auto& d) { return s.set_target(h, d); });
        case Call::SetMaxLength:
            return with<JointHandle, double, double>(r,
                                                     [&](auto h, auto l, auto v) { return s.set_max_length(h, l, v); });
        case Call::SetHoldMaxForce:
            return with<HoldHandle, double>(r, [&](auto h, auto force) { return s.set_max_force(h, force); });
        case Call::SetJointMaxForce:
            return with<JointHandle, double>(r, [&](auto h, auto force) { return s.set_max_force(h, force); });
        case Call::DestroyJoint:
            return with<JointHandle>(r, [&](auto h) { return s.destroy(h); });
        case Call::CreateMouseJoint:
            return with<ShellHandle, MouseJointDef>(r,
                                                    [&](auto h, const auto& d) { return s.create_mouse_joint(h, d); });
        case Call::SetMouseJointTarget:
            return with<MouseJointHandle, Point>(r, [&](auto h, auto p) { return s.set_target(h, p); });
        case Call::DestroyMouseJoint:
            return with<MouseJointHandle>(r, [&](auto h) { return s.destroy(h); });
        case Call::ApplyForce: // its handle ends with the frame
            return with<ShellHandle, double, Point, double, ForceHandle>(
                r, [&](auto h, auto f, auto force, auto t, auto) { return s.apply_force(h, f, force, t); });
        case Call::ApplyImpulse:
            return with<ShellHandle, double, Point, double>(
                r, [&](auto h, auto f, auto p, auto t) { return s.apply_impulse(h, f, p, t); });
        case Call::CreateForce:
            return with<ShellHandle, double, Point, double>(
                r, [&](auto h, auto f, auto force, auto t) { return s.create_force(h, f, force, t); });
        case Call::SetForce:
            return with<ForceHandle, Point, double>(r, [&](auto h, auto f, auto t) { return s.set_force(h, f, t); });
        case Call::DestroyForce:
            return with<ForceHandle>(r, [&](auto h) { return s.destroy(h); });
        default:
            return false;
        }
    }

    bool makeProperty(const Record& r) {
        Shells& s = shells_;
        switch (r.call) {
        case Call::Teleport:
            return with<ShellHandle, Point, double>(r, [&](auto h, auto p, auto a) { return s.teleport(h, p, a); });
        case Call::SetVelocity:
            return with<ShellHandle, Point, double>(r, [&](auto h, auto v, auto w) { return s.set_velocity(h, v, w); });
        case Call::SetMaterial:
            return with<ShellHandle, MaterialDef>(r, [&](auto h, const auto& d) { return s.set_material(h, d); });
        case Call::SetFilter:
            return with<ShellHandle, FilterDef>(r, [&](auto h, const auto& d) { return s.set_filter(h, d); });
        case Call::SetFriction:
            return with<FrictionMaterial, FrictionMaterial, double>(
                r, [&](auto a, auto b, auto mu) { return s.set_friction(a, b, mu); });
        case Call::ResetFriction:
            return with<FrictionMaterial, FrictionMaterial>(r, [&](auto a, auto b) { return s.reset_friction(a, b); });
        case Call::SetShellFrictionMaterial:
            return with<ShellHandle, FrictionMaterial>(r,
                                                       [&](auto h, auto m) { return s.set_friction_material(h, m); });
        case Call::SetBodyFrictionMaterial:
            return with<BodyId, FrictionMaterial>(r, [&](auto b, auto m) { return s.set_friction_material(b, m); });
        case Call::SetEffect:
            return with<EffectTarget, std::string, std::vector<EffectValue>>(
                r, [&](auto t, const auto& key, const auto& values) { return s.set_effects(t, key, values); });
        case Call::ReplaceEffects:
            return with<EffectTarget, std::vector<EffectDef>>(
                r, [&](auto t, const auto& list) { return s.replace_effects(t, list); });
        case Call::RemoveEffect:
            return with<EffectTarget, std::string>(r, [&](auto t, const auto& key) { return s.remove_effect(t, key); });
        case Call::SetSurfaceSpeed:
            return with<BodyId, double, std::uint32_t>(
                r, [&](auto b, auto speed, auto fixture) { return s.set_surface_speed(b, speed, fixture); });
        case Call::ShiftOrigin:
            return with<Point>(r, [&](auto p) { return s.shift_origin(p); });
        case Call::Sleep:
            return with<ShellHandle>(r, [&](auto h) { return s.sleep(h); });
        case Call::Wake:
            return with<ShellHandle>(r, [&](auto h) { return s.wake(h); });
        default:
            return false;
        }
    }

    void restore(const Record& r) {
        std::vector<std::uint8_t> bytes;
        if (!read(r, bytes, recordedWorld_))
            return;
        const Result<Snapshot> state = Snapshot::from_bytes(std::move(bytes));
        if (!state) {
            fault_ = state.error();
            return;
        }
        expect(shells_.restore(*state));
        handles_ = {};
    }

    /// A pre_step; its end is the next record.
    void frame(const std::vector<Record>& records, std::size_t first) {
        double dt = 0.0;
        std::uint64_t steps = 0, seen = 0;
        bool stopped = false, observed = false;
        if (first + 1 >= records.size() || records[first + 1].call != Call::FrameEnd)
            fault_ = "the frame has no end";
        else if (read(records[first], dt) && read(records[first + 1], steps, stopped, observed))
            advanced_ =
                (observed ? shells_.pre_step(dt, [&] { return ++seen == steps && stopped; }) : shells_.pre_step(dt))
                    .advanced;
    }

    void postStep() {
        if (hostStep_ && !hostStep_(advanced_))
            ended_ = true;
        else
            expect(shells_.post_step());
    }

    Shells& shells_;
    const std::function<bool(double)>& hostStep_;
    std::tuple<Pairs<ShellHandle>, Pairs<HoldHandle>, Pairs<JointHandle>, Pairs<MouseJointHandle>, Pairs<ForceHandle>>
        handles_;
    std::uint32_t recordedWorld_ = 0;
    double advanced_ = 0.0;
    bool ended_ = false;
    std::string fault_;
};

} // namespace

Status Shells::replay(const CallLog& log, const std::function<bool(double)>& host_step) {
    return impl_->change([&] {
        const Result<CallLog> checked = CallLog::from_bytes(log.bytes()); // also of one that was never filled
        if (!checked)
            return refused(checked.error());
        Loader in(log.bytes().data() + archive::kHeader, log.bytes().size() - archive::kHeader);
        std::uint64_t seed = 0;
        in(seed);
        std::vector<Record> records;
        while (in.left() > 0 && in.fault().empty()) {
            records.emplace_back();
            in(records.back().call, records.back().arguments);
        }
        return Replay(*this, host_step).run(records);
    });
}

} // namespace supercircle
