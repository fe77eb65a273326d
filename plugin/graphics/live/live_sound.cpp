#include "plugin/graphics/live/live_sound.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/world.h"

#include <algorithm>
#include <cmath>

namespace supercircle::live {

namespace {

constexpr double kTwoPi = 6.283185307179586;
/// Kept between two pictures: more voices than can ring at a time; the strongest ones stay.
constexpr std::size_t kMostEvents = 2 * sound::kMostVoices;

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
    const auto add = [&](double time, double strength, ShellHandle shell, bool snap) {
        const auto state = shells.state(shell);
        if (!state || !(strength > 0.0))
            return;
        events_.push_back({time, snap ? strength : strength * state->mass, state->length / kTwoPi, snap});
    };
    for (const SnapEndEvent& s : shells.events().snap_end)
        add(s.time, s.energy_released, s.shell, true);
    for (const ContactBeginEvent& c : shells.events().contact_begin)
        add(c.time, c.approach_speed, c.at.a, false);
    if (events_.size() > kMostEvents) { // snaps first, then by strength
        std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
            return a.snap != b.snap ? a.snap : a.strength > b.strength;
        });
        events_.resize(kMostEvents);
    }
    const double now = shells.time(), friction = shells.energy_balance().friction;
    if (now > frictionAt_) {
        power_ = std::max(friction - friction_, 0.0) / (now - frictionAt_);
        const double force = frictionForce(shells.world());
        speed_ = force > 0.0 ? power_ / force : 0.0;
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
