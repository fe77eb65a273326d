// The digits of a step do not depend on the number of threads.

#include "tests/step/setup.h"

#include <cstdint>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// FNV-1a over the bits of everything that moves, presses or is booked.
std::uint64_t stateHash(const step::World& w) {
    std::uint64_t hash = 14695981039346656037ull;
    const auto add = [&hash](const void* data, std::size_t bytes) {
        for (std::size_t i = 0; i < bytes; ++i)
            hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ull;
    };
    const auto number = [&add](double x) { add(&x, sizeof x); };
    for (const step::Rod& r : w.rods) {
        add(r.q.data(), sizeof(double) * static_cast<std::size_t>(r.q.size()));
        add(r.v.data(), sizeof(double) * static_cast<std::size_t>(r.v.size()));
        for (const Vec2& u : r.u)
            add(u.data(), sizeof(double) * 2);
    }
    for (const step::ContactImpulse& c : w.impulses) {
        add(&c.id, sizeof c.id);
        number(c.normal);
        number(c.tangent);
    }
    for (const contact::Candidate& c : w.candidates) {
        add(&c.id, sizeof c.id);
        number(c.gap);
    }
    for (const double x : {w.time, w.dtNext, w.ledger.kinetic, w.ledger.bending, w.ledger.gravity, w.ledger.friction,
                           w.ledger.impact, w.ledger.numerical, w.ledger.pushOut, w.ledger.work})
        number(x);
    return hash;
}

struct Squeezed {
    std::vector<std::uint64_t> hashes; ///< after every frame
    std::size_t loaded = 0;
    std::uint64_t unconverged = 0;
};

/// Three columns of four shells in a box, each shell turned a little more than the one below, under a plate that comes
/// down by a third of the pile.
Squeezed squeeze(int threads) {
    FakeHost host;
    host.g = {0.0, -kG};
    host.addGround(1, 0.35);
    const double pitch = 2.05 * kR, wall = 1.55 * pitch;
    host.add(2, "left", {-wall - 0.05, 0.2}).pieces.push_back(FakeHost::box(2, 0.05, 0.3, 0.35));
    host.add(3, "right", {wall + 0.05, 0.2}).pieces.push_back(FakeHost::box(3, 0.05, 0.3, 0.35));
    FakeHost::Body& plate = host.add(4, "plate", {0.0, 4.0 * pitch + 0.02});
    plate.kinematic = true;
    plate.pieces.push_back(FakeHost::box(4, wall - 5e-5, 0.02, 0.35));
    step::World w;
    for (int i = 0; i < 12; ++i) { // `put` takes the middle of the arc, which lies R from its centre
        const double angle = 0.7 * i;
        const Vec2 centre((i % 3 - 1) * pitch, 1.03 * kR + pitch * (i / 3));
        put(w, paperShell(), centre + kR * Vec2(std::sin(angle), -std::cos(angle)), angle, 0.35);
    }
    w.machineBodies = {4};
    w.machineVelocity = {0.0, -0.25};
    step::Settings settings;
    settings.threads = threads;
    settings.witness = true;
    settings.localError = 1.0;
    step::Stepper s(settings);
    Squeezed out;
    for (int i = 0; i < 60; ++i) {
        frame(s, w, host, 4e-3);
        out.hashes.push_back(stateHash(w));
    }
    out.loaded = w.impulses.size();
    out.unconverged = w.counters.unconverged;
    return out;
}

} // namespace

TEST_CASE("a squeezed stack of twelve shells has the same digits from one to four threads", "[step]") {
    const Squeezed one = squeeze(1);
    CHECK(one.loaded >= 24); // every shell carries, or it was no test
    CHECK(one.unconverged == 0);
    for (const int threads : {2, 3, 4}) {
        CAPTURE(threads);
        CHECK(squeeze(threads).hashes == one.hashes);
    }
}
