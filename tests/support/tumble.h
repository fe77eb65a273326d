#pragma once
// A scene with many events: shells tumble in a box with a loose crate, a plate presses them, and they snap.

#include "plugin/api/include/supercircle/shells.hpp"
#include "tests/support/fake_host.h"

#include <cmath>

namespace supercircle::test {

/// Floor and walls 0.16 m apart, a crate of 5 g, and a plate above, which is attached to the crosshead.
inline std::shared_ptr<FakeHost> tumbleHost() {
    auto host = std::make_shared<FakeHost>();
    host->g = {0.0, -9.81};
    host->addGround(1, 0.35);
    host->add(2, "left wall", {-0.09, 0.2}).outlines.push_back(FakeHost::box(2, 0.01, 0.25, 0.35));
    host->add(3, "right wall", {0.09, 0.2}).outlines.push_back(FakeHost::box(3, 0.01, 0.25, 0.35));
    host->add(4, "crate", {0.05, 0.16}, 0.3, 0.005, 1e-6).outlines.push_back(FakeHost::box(4, 0.015, 0.015, 0.4));
    host->add(5, "plate", {0.0, 0.30}).outlines.push_back(FakeHost::box(5, 0.079, 0.01, 0.35));
    host->bodies[5].state.moving = true;
    return host;
}

/// Shells of different opening angles, some moving fast; two of them snap when the plate comes.
inline void addTumblers(Shells& shells, int count = 5) {
    shells.attach_to_crosshead("plate").or_fail();
    for (int i = 0; i < count; ++i) {
        ShellDef d;
        d.name = "shell " + std::to_string(i);
        d.user_data = 100 + static_cast<std::uint64_t>(i);
        d.elements = 7 + i % 3;
        d.phi_bar = 0.45 + 0.08 * i;
        d.radius = 0.014;
        d.position = {-0.04 + 0.025 * (i % 4), 0.03 + 0.045 * (i / 2)};
        d.angle = 1.3 * i;
        d.velocity = {0.3 * ((i % 3) - 1), -0.2 * i};
        d.spin = 15.0 * (i - 2);
        (void)shells.create(d); // from the eighth on phi_bar exceeds 1, and there are no more
    }
}

/// One frame with the plate moving down and up at up to 0.8 m/s; false when the shells could not go on.
inline bool tumbleFrame(Shells& shells, FakeHost& host, double dt = 1e-3) {
    const double phase = 2.0 * M_PI * shells.time() / 0.6;
    shells.set_crosshead_velocity({0.0, -0.8 * std::sin(phase)}).or_fail();
    const FrameReport r = shells.pre_step(dt);
    host.step(r.advanced);
    shells.post_step().or_fail();
    return r.failure.empty();
}

} // namespace supercircle::test
