// Events of a frame: contacts, impulses, snaps, quarantine.

#include "tests/plugin/api/support.h"
#include "tests/support/tumble.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// All events of a run, one after the other.
FrameEvents operator+(FrameEvents all, const FrameEvents& more) {
    const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    add(all.contact_begin, more.contact_begin);
    add(all.contact_end, more.contact_end);
    add(all.impulses, more.impulses);
    add(all.snap_begin, more.snap_begin);
    add(all.snap_end, more.snap_end);
    add(all.quarantined, more.quarantined);
    return all;
}

FrameEvents run(Shells& shells, FakeHost* host, double seconds, double dt = 2e-3) {
    FrameEvents all;
    for (const double end = shells.time() + seconds; shells.time() < end - 1e-9;) {
        const FrameReport r = shells.pre_step(dt);
        REQUIRE(r.failure.empty());
        if (host)
            host->step(r.advanced);
        REQUIRE(shells.post_step());
        all = all + shells.events();
    }
    return all;
}

/// A stiff small cup, middle down.
ShellDef cup(double x, double y) {
    ShellDef d;
    d.radius = 0.02;
    d.thickness = 0.001;
    d.phi_bar = 0.4;
    d.elements = 8; // even: a node in the middle
    d.position = {x, y};
    return d;
}

} // namespace

TEST_CASE("a falling shell has one contact event, at the right place and speed", "[plugin][events]") {
    auto host = groundHost();
    Shells shells(host);
    const double height = 0.02;
    const ShellHandle shell = *shells.create(cup(0.0, 0.0005 + height));
    EventSettings settings;
    settings.impulse_threshold = 1e-9;
    REQUIRE(shells.set_event_settings(settings));
    FrameEvents all = run(shells, host.get(), 0.08);
    REQUIRE(all.contact_begin.size() >= 1);
    const ContactBeginEvent& e = all.contact_begin.front();
    CHECK(e.at.a == shell);
    CHECK(e.at.b.null());
    CHECK(e.at.body == 1);
    CHECK(e.at.fraction_a == Approx(0.5).margin(1e-6));
    CHECK(e.at.point.y == Approx(0.0).margin(1e-5));
    CHECK(e.at.normal.y == Approx(1.0));
    // backward Euler falls by g t dt / 2 farther: at 4 ms steps up to 3 % slower or faster than sqrt(2 g h)
    CHECK(e.approach_speed == Approx(std::sqrt(2.0 * 9.81 * height)).epsilon(0.04));
    CHECK(e.time == Approx(std::sqrt(2.0 * height / 9.81)).margin(4e-3));
    // It rocks to rest: no pair begins and ends again and again, and the ground carries the weight in every frame.
    (void)run(shells, host.get(), 1.5);
    all = run(shells, host.get(), 0.2);
    CHECK(all.contact_begin.empty());
    CHECK(all.contact_end.empty());
    const double weight = shells.state(shell)->mass * 9.81;
    REQUIRE(all.impulses.size() == 100);
    for (const ImpulseEvent& i : all.impulses) { // the last rocking is left: a per cent of the weight
        CHECK(i.normal_impulse == Approx(weight * 2e-3).epsilon(0.02));
        CHECK(i.peak_force >= 0.98 * weight);
        CHECK(i.friction_impulse <= 0.35 * i.normal_impulse * (1.0 + 1e-9));
    }
    CHECK(all.snap_begin.empty());
    // Destroyed with the shell; the event comes in the next frame.
    REQUIRE(shells.destroy(shell));
    all = run(shells, host.get(), 2e-3);
    REQUIRE(all.contact_end.size() == 1);
    CHECK(all.contact_end[0].at.a == shell);
    CHECK_FALSE(shells.valid(all.contact_end[0].at.a));
    CHECK(run(shells, host.get(), 2e-3).contact_end.empty());
}

TEST_CASE("two shells meet and part, and their impulse is the change of momentum", "[plugin][events]") {
    Shells shells(nullptr);
    ShellDef d = cup(0.0, 0.0);
    d.velocity = {0.0, 0.5};
    const ShellHandle lower = *shells.create(d); // opens upwards
    d = cup(0.0, 0.01);
    d.angle = M_PI; // a dome above: tips meet tips; so turn it about: middle to middle
    d.position = {0.0, -0.01};
    d.velocity = {0.0, 0.7};
    d.radius = 0.015;
    const ShellHandle faster = *shells.create(d);
    EventSettings settings;
    settings.impulse_threshold = 0.0;
    REQUIRE(shells.set_event_settings(settings));
    const double mass = shells.state(lower)->mass, before = shells.state(lower)->momentum.y;
    const FrameEvents all = run(shells, nullptr, 0.12);
    REQUIRE(all.contact_begin.size() >= 1);
    const ContactBeginEvent& e = all.contact_begin.front();
    CHECK(e.at.a == lower);
    CHECK(e.at.b == faster);
    CHECK(e.at.body == 0);
    CHECK(e.approach_speed == Approx(0.2).epsilon(1e-6));
    CHECK(e.at.normal.y == Approx(1.0)); // towards a
    CHECK(e.at.fraction_a == Approx(0.5).margin(1e-6));
    CHECK(e.at.fraction_b == Approx(0.5).margin(1e-6));
    CHECK(all.contact_end.size() == all.contact_begin.size());
    double impulse = 0.0;
    for (const ImpulseEvent& i : all.impulses)
        impulse += i.normal_impulse * i.at.normal.y;
    CHECK(impulse > 0.1 * mass * 0.2);
    // symmetric about x = 0, so all normals are vertical where force flows; friction takes no part
    CHECK(impulse == Approx(shells.state(lower)->momentum.y - before).epsilon(1e-6));
}

TEST_CASE("a shell that closes on itself touches itself", "[plugin][events]") {
    Shells shells(nullptr);
    ShellDef d;
    d.length = 0.1;
    d.elements = 16;
    d.natural_curvature.assign(16, 1.1 * 2.0 * M_PI / d.length);
    d.curvature.assign(16, 0.9 * 2.0 * M_PI / d.length);
    const ShellHandle shell = *shells.create(d);
    const FrameEvents all = run(shells, nullptr, 0.05);
    REQUIRE_FALSE(all.contact_begin.empty());
    const ContactPoint& at = all.contact_begin.front().at;
    CHECK(at.a == shell);
    CHECK(at.b == shell);
    CHECK(std::min(at.fraction_a, at.fraction_b) < 0.1);
    CHECK(std::max(at.fraction_a, at.fraction_b) > 0.9);
}

TEST_CASE("vibration, impacts and slow unloading are no snap-fits", "[plugin][events]") {
    Shells shells(nullptr);
    ShellDef d; // the default shell, bent by a fifth: it vibrates with 24 times the least energy of a snap
    d.curvature.assign(15, 0.8 / d.radius);
    const ShellHandle free = *shells.create(d);
    CHECK(shells.state(free)->stored_energy * 0.09 / bending_modulus(d) > 0.3);
    shells.stepper().settings().localError = 0.01; // little damping
    const FrameEvents vibration = run(shells, nullptr, 0.4, 4e-3);
    CHECK(vibration.snap_begin.empty());
    CHECK(vibration.snap_end.empty());
    for (const double angle : {0.24, 0.4, 1.0, 2.0, 3.0}) { // in the first two it lands on its edge and rocks
        CAPTURE(angle);
        auto host = groundHost();
        Shells bouncing(host);
        d = ShellDef{};
        d.position = {0.0, 0.5};
        d.angle = angle;
        REQUIRE(bouncing.create(d));
        const FrameEvents impacts = run(bouncing, host.get(), 0.8, 4e-3);
        CHECK_FALSE(impacts.contact_begin.empty());
        CHECK(impacts.snap_begin.empty());
    }
}

TEST_CASE("a buckled strip pushed through has one snap event with the released energy", "[plugin][events]") {
    auto host = std::make_shared<FakeHost>();
    host->add(5, "plate", {0.0, 0.05}).outlines.push_back(FakeHost::box(5, 0.004, 0.01, 0.2));
    host->bodies[5].state.moving = true;
    Shells shells(host);
    shells.stepper().settings().dampingRatio = 0.5; // it is to come to rest between two pushes
    ShellDef d;                                     // straight by nature, bent into an arch between two pins
    d.length = 0.1;
    d.elements = 24;
    d.radius = std::numeric_limits<double>::infinity();
    d.curvature.assign(24, 10.0);
    d.angle = M_PI;
    d.position = {0.0, 0.01};
    const ShellHandle strip = *shells.create(d);
    REQUIRE(shells.create_hold(strip, 0.0, HoldKind::Pin));
    REQUIRE(shells.create_hold(strip, 1.0, HoldKind::Pin));
    REQUIRE(shells.attach_to_crosshead("plate"));
    REQUIRE(run(shells, host.get(), 0.5, 4e-3).snap_begin.empty()); // settles into Euler's first mode
    const double first = shells.state(strip)->stored_energy;
    const double before = shells.section(strip, 0.5)->position.y;
    FrameEvents all;
    double highest = first;
    REQUIRE(shells.set_crosshead_velocity({0.0, -0.02}));
    for (int i = 0; i < 700 && all.snap_end.empty(); ++i) {
        all = all + run(shells, host.get(), 4e-3, 4e-3);
        if (all.snap_begin.empty())
            highest = std::max(highest, shells.state(strip)->stored_energy);
    }
    CHECK(shells.section(strip, 0.5)->position.y < 0.0);
    CHECK(before > 0.0);
    REQUIRE(all.snap_begin.size() == 1);
    REQUIRE(all.snap_end.size() == 1);
    const SnapEndEvent& e = all.snap_end[0];
    CHECK(e.shell == strip);
    CHECK(e.begun == all.snap_begin[0].time);
    CHECK(e.time > e.begun);
    CHECK(all.snap_begin[0].energy < all.snap_begin[0].energy_before);
    // It ends in the mirrored first mode. `highest` is sampled per frame, the event's energy is the least of the time
    // before: a few per cent of slow loading lie between them.
    CHECK(e.energy_released == Approx(highest - first).epsilon(0.1));
    CHECK(e.kinetic_peak > 0.05 * e.energy_released);
    CHECK(e.kinetic_peak <= 1.01 * e.energy_released);
    CHECK(highest < 9.5 * first); // nothing breaks the symmetry, so Euler's third mode is the highest pass
}

TEST_CASE("bad numbers quarantine a shell, with one event", "[plugin][events]") {
    auto host = groundHost();
    Shells shells(host);
    const ShellHandle good = *shells.create(cup(0.0, 0.05));
    const ShellHandle sick = *shells.create(cup(0.1, 0.05));
    REQUIRE(run(shells, host.get(), 4e-3).quarantined.empty());
    shells.world().rods[1].v[0] = std::numeric_limits<double>::quiet_NaN();
    FrameEvents all = run(shells, host.get(), 4e-3, 4e-3);
    REQUIRE(all.quarantined.size() == 1);
    CHECK(all.quarantined[0].shell == sick);
    CHECK(shells.state(sick)->quarantined);
    CHECK_FALSE(shells.state(good)->quarantined);
    const Point stays = shells.state(sick)->centre;
    const Snapshot then = shells.save();
    all = run(shells, host.get(), 0.05);
    CHECK(all.quarantined.empty());
    CHECK(shells.state(sick)->centre.x == stays.x);
    CHECK(shells.state(sick)->centre.y == stays.y);
    CHECK(shells.state(good)->centre.y < stays.y); // the others go on
    Shells fresh(groundHost());
    REQUIRE(fresh.restore(then));
    CHECK(run(fresh, nullptr, 4e-3).quarantined.empty());
}

TEST_CASE("bitwise identical events for any number of threads", "[plugin][events]") {
    struct Seen {
        std::uint64_t hash;
        std::vector<double> numbers;
    };
    const auto play = [](int threads) {
        auto host = tumbleHost();
        Shells shells(host);
        addTumblers(shells, 10);
        shells.stepper().settings().threads = threads;
        EventSettings settings;
        settings.impulse_threshold = 1e-5;
        REQUIRE(shells.set_event_settings(settings));
        Seen seen;
        for (int f = 0; f < 250; ++f) {
            REQUIRE(tumbleFrame(shells, *host));
            const FrameEvents& e = shells.events();
            double last = 0.0;
            for (const ContactBeginEvent& b : e.contact_begin) {
                CHECK(b.time >= last);
                last = b.time;
                seen.numbers.insert(seen.numbers.end(), {b.time, b.at.fraction_a, b.at.point.x, b.approach_speed});
            }
            for (const ContactEndEvent& b : e.contact_end)
                seen.numbers.insert(seen.numbers.end(), {b.time, 1.0 * b.at.a.index, 1.0 * b.at.b.index});
            for (const ImpulseEvent& b : e.impulses)
                seen.numbers.insert(seen.numbers.end(), {b.time, b.normal_impulse, b.friction_impulse});
            for (const SnapBeginEvent& b : e.snap_begin)
                seen.numbers.insert(seen.numbers.end(), {b.time, b.energy});
        }
        seen.hash = shells.hash();
        return seen;
    };
    const Seen one = play(1);
    CHECK(one.numbers.size() > 100);
    for (const int threads : {2, 3, 4}) {
        const Seen more = play(threads);
        CHECK(more.hash == one.hash);
        CHECK((more.numbers == one.numbers));
    }
}
