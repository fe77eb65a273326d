// Changes of existing shells: position, velocity, material, filter, friction of pairs, sleep.

#include "plugin/api/limits.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/step/sleep.h"

#include <algorithm>

namespace supercircle {

namespace {

bool isConstrained(const step::World& world, const step::Rod& rod) {
    return !rod.holds.empty() || std::any_of(world.links.begin(), world.links.end(), [&](const step::Link& l) {
        return l.rodA == rod.key || (l.end == step::LinkEnd::Rod && l.rodB == rod.key);
    });
}

Status checkMaterial(const MaterialDef& m, int elements) {
    const auto positive = [](const std::optional<double>& x) { return !x || (std::isfinite(*x) && *x > 0.0); };
    if (!positive(m.young_modulus) || !positive(m.density))
        return refused("young_modulus and density must be positive and finite");
    if (m.mu && !limits::friction(*m.mu))
        return refused(limits::kBadFriction);
    if (m.damping_ratio && !limits::damping(*m.damping_ratio))
        return refused(limits::kBadDamping);
    if (!m.natural_curvature)
        return {};
    const std::size_t n = m.natural_curvature->size();
    if (n != 1 && n != static_cast<std::size_t>(elements))
        return refused("natural_curvature needs one value, or one per element (" + std::to_string(elements) + ")");
    for (const double k : *m.natural_curvature)
        if (!std::isfinite(k))
            return refused("natural_curvature must be finite");
    return {};
}

step::PairFriction pairOf(FrictionMaterial a, FrictionMaterial b, double mu) {
    return {std::min(a, b), std::max(a, b), mu};
}

auto lowerBound(std::vector<step::PairFriction>& list, const step::PairFriction& pair) {
    return std::lower_bound(list.begin(), list.end(), pair,
                            [](const auto& x, const auto& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
}

} // namespace

Status Shells::teleport(ShellHandle shell, Point position, double angle) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        if (!limits::position(position) || !limits::angle(angle))
            return refused("position and angle must be finite and within 1e12 (m, rad)");
        if (isConstrained(impl_->world, impl_->rod(i)))
            return refused("the shell has a hold or a joint: destroy it first");
        step::moveRod(impl_->world, static_cast<std::size_t>(i), vec(position), angle);
        impl_->forgetStart(impl_->rod(i).key);
        impl_->recorder.record(Call::Teleport, shell, position, angle);
        return done();
    });
}

Status Shells::set_velocity(ShellHandle shell, Point velocity, double spin) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        const rod::RodModel& m = impl_->rod(i).model;
        if (!limits::velocity(velocity, spin) || !limits::motion(m.definition(), velocity, spin))
            return refused("velocity, spin and the kinetic energy must be finite");
        Eigen::VectorXd v = Eigen::VectorXd::Zero(m.dofs());
        v[m.dofX()] = velocity.x;
        v[m.dofY()] = velocity.y;
        v[m.dofTheta()] = spin;
        step::placeRod(impl_->world, static_cast<std::size_t>(i), Eigen::VectorXd(impl_->rod(i).q), v);
        impl_->recorder.record(Call::SetVelocity, shell, velocity, spin);
        return done();
    });
}

Status Shells::set_material(ShellHandle shell, const MaterialDef& change) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        step::Rod& rod = impl_->rod(i);
        if (Status checked = checkMaterial(change, rod.model.elements()); !checked)
            return checked;
        rod::RodDefinition d = rod.model.definition();
        const double section = rod.width * d.thickness;
        if (change.young_modulus)
            d.bendingModulus = *change.young_modulus * section * d.thickness * d.thickness / 12.0;
        if (change.density)
            d.linearMass = *change.density * section;
        if (change.natural_curvature && change.natural_curvature->size() == 1)
            d.naturalCurvature.assign(d.naturalCurvature.size(), change.natural_curvature->front());
        else if (change.natural_curvature)
            d.naturalCurvature = *change.natural_curvature;
        for (std::string why :
             {rod::validate(d), limits::shell(d).error(), limits::turns(rod.model, d.naturalCurvature).error()})
            if (!why.empty())
                return refused(std::move(why));
        if (change.mu)
            rod.mu = *change.mu;
        if (change.damping_ratio)
            rod.dampingRatio = *change.damping_ratio;
        step::changeRod(impl_->world, static_cast<std::size_t>(i), d);
        impl_->recorder.record(Call::SetMaterial, shell, change);
        return done();
    });
}

Status Shells::set_filter(ShellHandle shell, const FilterDef& filter) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        step::wake(impl_->world, static_cast<std::size_t>(i));
        step::Rod& rod = impl_->rod(i);
        rod.category = filter.category;
        rod.mask = filter.mask;
        rod.group = filter.group;
        impl_->world.range.clear();
        impl_->recorder.record(Call::SetFilter, shell, filter);
        return done();
    });
}

Result<FilterDef> Shells::filter(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<FilterDef>::failure(kNoSuchShell);
    const step::Rod& rod = impl_->rod(i);
    return FilterDef{rod.category, rod.mask, rod.group};
}

Status Shells::set_friction(FrictionMaterial a, FrictionMaterial b, double mu) {
    return impl_->change([&] {
        if (a == 0 || b == 0)
            return refused("material 0 means none: give shells and bodies a friction material first");
        if (!limits::friction(mu))
            return refused(limits::kBadFriction);
        auto& list = impl_->world.pairFriction;
        const step::PairFriction pair = pairOf(a, b, mu);
        const auto it = lowerBound(list, pair);
        if (it != list.end() && it->a == pair.a && it->b == pair.b)
            it->mu = mu;
        else
            list.insert(it, pair);
        step::wakeAll(impl_->world);
        impl_->recorder.record(Call::SetFriction, a, b, mu);
        return done();
    });
}

Status Shells::reset_friction(FrictionMaterial a, FrictionMaterial b) {
    return impl_->change([&] {
        auto& list = impl_->world.pairFriction;
        const step::PairFriction pair = pairOf(a, b, 0.0);
        const auto it = lowerBound(list, pair);
        if (it == list.end() || it->a != pair.a || it->b != pair.b)
            return refused("no friction is set for these two materials");
        list.erase(it);
        step::wakeAll(impl_->world);
        impl_->recorder.record(Call::ResetFriction, a, b);
        return done();
    });
}

Status Shells::set_friction_material(ShellHandle shell, FrictionMaterial material) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        step::wake(impl_->world, static_cast<std::size_t>(i));
        impl_->rod(i).material = material;
        impl_->recorder.record(Call::SetShellFrictionMaterial, shell, material);
        return done();
    });
}

Status Shells::set_friction_material(BodyId body, FrictionMaterial material) {
    return impl_->change([&] {
        step::BodyState state;
        if (body == 0 || !impl_->port || !impl_->port->state(body, state))
            return refused("there is no such body");
        auto& list = impl_->world.bodyMaterials;
        const auto it = std::lower_bound(list.begin(), list.end(), body,
                                         [](const step::BodyMaterial& b, BodyId want) { return b.body < want; });
        if (it != list.end() && it->body == body)
            it->material = material;
        else
            list.insert(it, {body, material});
        step::wakeAll(impl_->world);
        impl_->recorder.record(Call::SetBodyFrictionMaterial, body, material);
        return done();
    });
}

Status Shells::set_surface_speed(BodyId body, double speed, std::uint32_t fixture) {
    return impl_->change([&] {
        step::BodyState state;
        if (body == 0 || !impl_->port || !impl_->port->state(body, state))
            return refused("there is no such body");
        if (!limits::velocity({speed, 0.0}, 0.0))
            return refused("the surface speed must be finite");
        auto& list = impl_->world.surfaceSpeeds;
        const auto it = std::lower_bound(list.begin(), list.end(), body, [&](const step::SurfaceSpeed& s, BodyId want) {
            return s.body != want ? s.body < want : s.fixture < fixture;
        });
        const bool known = it != list.end() && it->body == body && it->fixture == fixture;
        if (known && speed == 0.0 && fixture == all_fixtures)
            list.erase(it);
        else if (known)
            it->speed = speed;
        else
            list.insert(it, {body, fixture, speed});
        step::wakeAll(impl_->world);
        impl_->recorder.record(Call::SetSurfaceSpeed, body, speed, fixture);
        return done();
    });
}

Status Shells::set_pair_filter(std::function<bool(const PairQuery&)> filter) {
    return impl_->change([&] {
        step::PairFilter& ask = impl_->stepper.pairFilter;
        ask = nullptr;
        if (filter) // asked shell by shell: the handle is looked up once for each
            ask = [m = impl_.get(), filter = std::move(filter), shell = ShellHandle{},
                   key = std::uint32_t{0}](const step::Rod& rod, const step::BodyOutline& piece) mutable {
                if (rod.key != key || m->slots.size() <= shell.index ||
                    m->slots[shell.index].generation != shell.generation || m->worldId != shell.world) {
                    key = rod.key;
                    shell = m->handleOf(key);
                }
                return filter({shell, piece.body, piece.fixture});
            };
        return done();
    });
}

Result<BodyId> Shells::body(const std::string& name) const {
    return Impl::withoutExceptions([&] {
        const step::BodyId id = impl_->port ? impl_->port->find(name) : 0;
        return id != 0 ? Result<BodyId>(id) : Result<BodyId>::failure("there is no body called '" + name + "'");
    });
}

Status Shells::set_sleep(const SleepSettings& settings) {
    return impl_->change([&] {
        if (!(settings.drift > 0.0) || !std::isfinite(settings.drift) || !(settings.delay >= 0.0) ||
            !std::isfinite(settings.delay))
            return refused("drift must be positive, delay not negative, both finite");
        step::Settings& s = impl_->stepper.settings();
        s.autoSleep = settings.automatic;
        s.sleepDrift = settings.drift;
        s.sleepAfter = settings.delay;
        impl_->recorder.record(Call::SetSleep, settings);
        return done();
    });
}

SleepSettings Shells::sleep_settings() const {
    const step::Settings& s = impl_->stepper.settings();
    return {s.autoSleep, s.sleepDrift, s.sleepAfter};
}

Status Shells::sleep(ShellHandle shell) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        const std::string why = step::putToSleep(impl_->world, static_cast<std::size_t>(i));
        if (!why.empty())
            return refused("the shell cannot sleep: " + why);
        impl_->recorder.record(Call::Sleep, shell);
        return done();
    });
}

Status Shells::wake(ShellHandle shell) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        step::wake(impl_->world, static_cast<std::size_t>(i));
        impl_->recorder.record(Call::Wake, shell);
        return done();
    });
}

Result<bool> Shells::asleep(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<bool>::failure(kNoSuchShell);
    return impl_->rod(i).asleep();
}

} // namespace supercircle
