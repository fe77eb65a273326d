#include "plugin/graphics/live/live_sound.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/world.h"

#include <algorithm>
#include <cmath>

namespace supercircle::live {

namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kGravity = 9.81; ///< m/s^2: a scale, also where there is none
/// Kept between two pictures: more voices than can ring at a time; the strongest ones stay.
constexpr std::size_t kMostEvents = 2 * sound::kMostVoices;

/// sqrt(g R), m/s.
double froude(double length) {
    return std::sqrt(kGravity * length / kTwoPi);
}

/// Sum of the friction forces of all contacts, N.
double frictionForce(const step::World& world) {
    double sum = 0.0;
    for (const step::ContactImpulse& c : world.impulses)
        sum += std::abs(c.tangent);
    return sum;
}

} // namespace

void SoundWatch::frame(const Shells& shells) {
    if (!on_)
        return;
    const std::vector<ShellHandle> handles = shells.shells();
    const auto rodOf = [&](ShellHandle shell) -> const rod::RodDefinition* {
        const auto at = std::find(handles.begin(), handles.end(), shell);
        return at != handles.end()
                   ? &shells.world().rods[static_cast<std::size_t>(at - handles.begin())].model.definition()
                   : nullptr;
    };
    for (const SnapEndEvent& s : shells.events().snap_end)
        if (const rod::RodDefinition* const d = rodOf(s.shell))
            events_.push_back({s.time, s.energy_released * d->length / d->bendingModulus, d->length / kTwoPi, true});
    for (const ContactBeginEvent& c : shells.events().contact_begin)
        if (const rod::RodDefinition* const d = rodOf(c.at.a)) // its mass times the speed, over m sqrt(g R)
            events_.push_back({c.time, c.approach_speed / froude(d->length), d->length / kTwoPi, false});
    std::erase_if(events_, [](const Event& e) { return !(e.strength > 0.0); });
    if (events_.size() > kMostEvents) { // snaps first, then by strength
        std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
            return a.snap != b.snap ? a.snap : a.strength > b.strength;
        });
        events_.resize(kMostEvents);
    }
    const double now = shells.time(), friction = shells.energy_balance().friction;
    if (now > frictionAt_) {
        const double power = std::max(friction - friction_, 0.0) / (now - frictionAt_); // W
        const double force = frictionForce(shells.world());
        double full = 0.0, speed = 0.0; // W and m/s of strength 1
        for (const step::Rod& rod : shells.world().rods) {
            speed = std::max(speed, froude(rod.model.definition().length));
            full += rod.model.mass() * kGravity * froude(rod.model.definition().length);
        }
        power_ = full > 0.0 ? power / full : 0.0;
        speed_ = force > 0.0 && speed > 0.0 ? power / force / speed : 0.0;
    }
    friction_ = friction;
    frictionAt_ = now;
}

std::span<const float> SoundWatch::make(const Shells& shells, double seconds) {
    const double now = shells.time();
    if (!on_) {
        on_ = true;
        friction_ = shells.energy_balance().friction;
        frictionAt_ = from_ = now;
    }
    const double passed = now - from_;
    for (const Event& e : events_) {
        const double delay = passed > 0.0 ? seconds * std::clamp((e.time - from_) / passed, 0.0, 1.0) : 0.0;
        if (e.snap)
            synthesiser_.snap(e.strength, e.radius, delay);
        else
            synthesiser_.hit(e.strength, e.radius, delay);
    }
    events_.clear();
    synthesiser_.slide(passed > 0.0 ? power_ : 0.0, speed_); // a world that stands still is silent
    from_ = now;
    samples_ = synthesiser_.render(seconds);
    return samples_;
}

} // namespace supercircle::live
