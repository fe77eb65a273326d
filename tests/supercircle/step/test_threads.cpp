// The digits of a step do not depend on the number of threads.

#include "supercircle/step/parallel.h"
#include "tests/supercircle/step/setup.h"
#include "tests/support/loops.h"

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <thread>

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr int kSqueeze = 95; ///< frames

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
    for (const double x : {w.time, w.dtNext, w.energyBalance.kinetic, w.energyBalance.bending, w.energyBalance.gravity,
                           w.energyBalance.friction, w.energyBalance.impact, w.energyBalance.numerical,
                           w.energyBalance.positionCorrection, w.energyBalance.work})
        number(x);
    return hash;
}

/// `columns` of shells in a box, `rows` high, each shell turned a little more than the one before, under a plate that
/// comes down.
struct Pile {
    FakeHost host;
    step::World world;

    Pile(int columns, int rows) {
        host.g = {0.0, -kG};
        host.addGround(1, 0.35);
        const double pitch = 2.05 * kR, wall = (0.5 * columns + 0.05) * pitch, half = 0.5 * rows * pitch + 0.1;
        host.add(2, "left", {-wall - 0.05, half}).outlines.push_back(FakeHost::box(2, 0.05, half + 0.1, 0.35));
        host.add(3, "right", {wall + 0.05, half}).outlines.push_back(FakeHost::box(3, 0.05, half + 0.1, 0.35));
        FakeHost::Body& plate = host.add(4, "plate", {0.0, rows * pitch + 0.02});
        plate.kinematic = true;
        plate.outlines.push_back(FakeHost::box(4, wall - 5e-5, 0.02, 0.35));
        for (int i = 0; i < columns * rows; ++i) // `put` takes the middle of the arc, which lies R from its centre
            add({(i % columns - 0.5 * (columns - 1)) * pitch, 1.03 * kR + pitch * (i / columns)}, 0.7 * i);
        world.crossheadBodies = {4};
        world.crossheadVelocity = {0.0, -0.25};
    }

    void add(const Vec2& centre, double angle) {
        put(world, paperShell(0.75, 9), centre + kR * Vec2(std::sin(angle), -std::cos(angle)), angle, 0.35);
    }
};

struct Squeezed {
    std::vector<std::uint64_t> hashes; ///< after every frame
    std::size_t loaded = 0;            ///< contacts, most in one solve
    std::uint64_t unconverged = 0;
};

Squeezed squeeze(Pile& pile, int frames, int threads, const parallel::For& hostLoop = {}) {
    step::Settings settings;
    settings.threads = threads;
    settings.crossingCheck = true;
    settings.localError = 1.0;
    step::Stepper s(settings);
    s.loop = hostLoop;
    Squeezed out;
    s.onSolve = [&out](const coulomb::Problem&, const coulomb::SolveReport& report) {
        out.loaded = std::max(out.loaded, static_cast<std::size_t>(report.activeContacts));
    };
    for (int i = 0; i < frames; ++i) {
        frame(s, pile.world, pile.host, 4e-3);
        out.hashes.push_back(stateHash(pile.world));
    }
    out.unconverged = pile.world.counters.unconverged;
    return out;
}

Squeezed squeezeTwelve(int threads) {
    Pile pile(3, 4);
    return squeeze(pile, 60, threads);
}

} // namespace

TEST_CASE("a squeezed stack of twelve shells has the same digits from one to four threads", "[step]") {
    const Squeezed one = squeezeTwelve(1);
    CHECK(one.loaded >= 24); // every shell carries, or it was no test
    CHECK(one.unconverged == 0);
    for (const int threads : {2, 3, 4}) {
        CAPTURE(threads);
        CHECK(squeezeTwelve(threads).hashes == one.hashes);
    }
}

TEST_CASE("a big pile with subdomains and islands has the same digits from any number of threads and any loop",
          "[step]") {
    Pile start(16, 4);
    for (int i = 0; i < 6; ++i) // islands of their own, outside of the box
        start.add({1.0 + 0.2 * i, 1.01 * kR}, 0.3 * i);
    const Squeezed before = squeeze(start, kSqueeze, 1); // until it carries
    CHECK(before.unconverged == 0);
    Pile pile = start;
    const Squeezed one = squeeze(pile, 2, 1);
    CHECK(one.loaded > 230); // the solver goes region by region from 200 in one island on; the others have some 2 each
    for (const int threads : {4, 7}) {
        CAPTURE(threads);
        pile = start;
        CHECK(squeeze(pile, 2, threads).hashes == one.hashes);
    }
    pile = start;
    CHECK(squeeze(pile, 2, 1, backwards()).hashes == one.hashes); // a loop of the host's own
}

TEST_CASE("a loop over four threads has four threads at work, on a machine with fewer cores too", "[step]") {
    std::atomic<int> inside{0};
    std::atomic<bool> all{false};
    // Every turn waits for three others, which only other threads can take. The limit keeps a failure from hanging.
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    step::threadLoop(4)(4, [&](std::size_t) {
        if (++inside == 4)
            all = true;
        while (!all && std::chrono::steady_clock::now() < limit)
            std::this_thread::yield();
    });
    CHECK(all);
}

// Not asserted, and only when asked for: `test_step "[speed]"`. The best of many short pieces is the only wall time
// worth anything on a machine with neighbours.
TEST_CASE("wall time of a loaded pile on one and two threads", "[.][speed]") {
    Pile start(16, 4);
    (void)squeeze(start, kSqueeze, 1);
    std::map<int, double> best;
    std::size_t loaded = 0;
    for (int i = 0; i < 150; ++i)
        for (const int threads : {1, 2}) {
            Pile pile = start;
            step::Settings settings;
            settings.threads = threads;
            settings.localError = 1.0;
            step::Stepper s(settings);
            frame(s, pile.world, pile.host, 1e-4); // makes the threads and the work spaces
            const auto from = std::chrono::steady_clock::now();
            frame(s, pile.world, pile.host, 4e-4);
            const double ms = 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
            best[threads] = best.count(threads) == 0 ? ms : std::min(best[threads], ms);
            loaded = pile.world.impulses.size();
        }
    std::printf("%zu loaded contacts, best of 150: %.2f ms on one thread, %.2f ms on two: x%.2f\n", loaded, best[1],
                best[2], best[1] / best[2]);
}
