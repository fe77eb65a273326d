// Frames of Quality::Game have an end: the work they take, contradictions between given motions, joints that break. No
// test measures a time; work is counted.

#include "tests/plugin/api/support.h"
#include "tests/support/crossings.h"

#include <algorithm>

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kBudget = 8333.0; // the default

/// A plate of 10 x 0.4 m whose lower side starts at `height`, and comes down.
void addPlate(FakeHost& host, double height, double speed) {
    FakeHost::Body& plate = host.add(2, "plate", {0.0, height + 0.2});
    plate.outlines.push_back(FakeHost::box(2, 5.0, 0.2, 0.35));
    plate.state.moving = true;
    plate.state.velocity = {0.0, -speed};
}

/// Its circle has its centre at (x, y), its opening looks up at angle 0.
ShellDef shellAt(double x, double y, double angle, double radius, double mass) {
    ShellDef d = scaled_shell(radius, mass);
    d.position = {x + radius * std::sin(angle), y - radius * std::cos(angle)};
    d.angle = angle;
    return d;
}

FrameReport frame(Shells& shells, FakeHost& host) {
    FrameReport r = shells.pre_step(kFrame);
    REQUIRE(r.failure.empty());
    if (r.advanced > 0.0)
        host.step(r.advanced);
    REQUIRE(shells.post_step());
    // What is promised: one and a half budgets, and one contact problem, which may take a budget.
    CHECK(r.work <= 2.5 * kBudget);
    if (r.budget_exhausted)
        CHECK_FALSE(r.why.empty());
    if (shells.events().crushed.empty())
        CHECK(r.budget_exhausted == (r.advanced < kFrame * (1.0 - 1e-12)));
    return r;
}

} // namespace

TEST_CASE("a press that closes on a shell stands, says so and turns back", "[plugin][frames]") {
    const double speed = GENERATE(0.5, 2.0);
    const bool putForward = GENERATE(false, true); // by its place in each frame, instead of a velocity
    const auto host = groundHost();
    addPlate(*host, 1.1, putForward ? 0.0 : speed);
    step::BodyState& plate = host->bodies.at(2).state;
    Shells shells(host);
    REQUIRE(shells.set_quality(Quality::Game));
    const auto shell = shells.create(shellAt(0.0, 0.51, 0.0, 0.5, 1.0));
    const auto far = shells.create(shellAt(20.0, 5.0, 0.0, 0.5, 1.0)); // an island of its own: it goes on falling
    REQUIRE((shell && far));
    std::vector<double> events;
    double lowest = plate.centre.y();
    for (int i = 0; i < 360; ++i) {
        if (putForward)
            plate.centre.y() -= speed * kFrame;
        const FrameReport r = frame(shells, *host);
        for (const CrushedEvent& e : shells.events().crushed) {
            CHECK(e.shell == *shell);
            CHECK(e.body == 2);
            CHECK(e.hold.null());
            CHECK(r.why.find("crushed") != std::string::npos);
            events.push_back(e.time);
        }
        CHECK(shells.events().quarantined.empty());
        CHECK(crossings(shells) == 0);                            // neither through the floor nor through the plate
        CHECK(plate.velocity.y() == (putForward ? 0.0 : -speed)); // its user finds it as it was
        lowest = std::min(lowest, plate.centre.y());
    }
    REQUIRE(events.size() > 1);
    for (std::size_t k = 1; k < events.size(); ++k)
        CHECK(events[k] - events[k - 1] >= 0.25); // it stands meanwhile
    CHECK(lowest > 0.2);                          // half its thickness above the floor is the shell
    CHECK(shells.state(*far)->centre.y < 1.0);
    plate.velocity.y() = 1.0; // turning back, it waits for nothing
    const double before = plate.centre.y();
    (void)frame(shells, *host);
    CHECK(plate.centre.y() > before + 0.5 * kFrame);
    for (int i = 0; i < 120; ++i)
        (void)frame(shells, *host);
    CHECK(crossings(shells) == 0);
    CHECK(shells.world().stopped.empty());
    CHECK(shells.events().crushed.empty());
    CHECK_FALSE(shells.state(*shell)->quarantined);
}

TEST_CASE("a crosshead that closes on a shell stands", "[plugin][frames]") {
    const auto host = groundHost();
    addPlate(*host, 1.1, 0.0);
    Shells shells(host);
    REQUIRE(shells.set_quality(Quality::Game));
    REQUIRE(shells.attach_to_crosshead("plate"));
    REQUIRE(shells.set_crosshead_velocity({0.0, -0.5}));
    REQUIRE(shells.create(shellAt(0.0, 0.51, 0.0, 0.5, 1.0)));
    std::size_t crushed = 0;
    for (int i = 0; i < 360; ++i) {
        (void)frame(shells, *host);
        crushed += shells.events().crushed.size();
        CHECK(crossings(shells) == 0);
        // Its travel is that of the plate; single precision plays no part here.
        CHECK(shells.world().crossheadTravel.y() == Approx(host->bodies.at(2).state.centre.y() - 1.3).margin(1e-9));
    }
    CHECK(crushed > 0);
    CHECK(shells.world().crossheadVelocity.y() == -0.5);
}

TEST_CASE("crushed shells freeze on request", "[plugin][frames]") {
    const auto host = groundHost();
    addPlate(*host, 1.1, 2.0);
    Shells shells(host);
    REQUIRE(shells.set_quality(Quality::Game));
    CHECK_FALSE(shells.set_crush_policy(static_cast<CrushPolicy>(7)));
    REQUIRE(shells.set_crush_policy(CrushPolicy::Freeze));
    const auto shell = shells.create(shellAt(0.0, 0.51, 0.0, 0.5, 1.0));
    std::size_t crushed = 0, quarantined = 0;
    for (int i = 0; i < 200; ++i) {
        (void)frame(shells, *host);
        crushed += shells.events().crushed.size();
        quarantined += shells.events().quarantined.size();
    }
    CHECK(crushed == 1);
    CHECK(quarantined == 1);
    CHECK(shells.state(*shell)->quarantined);
}

TEST_CASE("a clamp driven into the floor stops, with an event", "[plugin][frames]") {
    const auto host = groundHost();
    Shells shells(host);
    REQUIRE(shells.set_quality(Quality::Game));
    const auto shell = shells.create(shellAt(0.0, 1.2, M_PI, 1.0, 2.0));
    const HoldHandle hold = *shells.create_clamp(*shell, 0.5);
    const double top = shells.target(hold)->position.y;
    std::size_t stopped = 0;
    for (int i = 0; i < 240; ++i) {
        TargetDef to;
        to.position = {0.0, top - 7.0 * std::min(1.0, (i + 1) / 60.0)}; // 5 m below the floor
        to.angle = M_PI;
        REQUIRE(shells.set_target(hold, to));
        (void)frame(shells, *host);
        for (const HoldBlockedEvent& e : shells.events().hold_blocked) {
            CHECK(e.hold == hold);
            CHECK(e.body == 1);
            CHECK(e.stopped);
        }
        stopped += shells.events().hold_blocked.size();
        CHECK(shells.events().crushed.empty());
        CHECK(crossings(shells) == 0);
    }
    CHECK(stopped > 0);
    CHECK(shells.section(*shell, 0.5)->position.y > 0.0);
    CHECK(shells.valid(hold));
}

TEST_CASE("a blow is a frame as others", "[plugin][frames]") {
    // The crossing check followed such a motion in steps of a thousandth of the thickness: millions of samples.
    const double impulse = GENERATE(100.0, 500.0, 700.0);
    const auto host = groundHost();
    Shells shells(host);
    REQUIRE(shells.set_quality(Quality::Game));
    const auto shell = shells.create(shellAt(0.0, 1.0, M_PI, 1.0, 2.0));
    REQUIRE(shells.apply_impulse(*shell, 0.5, {0.0, -impulse}));
    for (int i = 0; i < 30; ++i) {
        CHECK(frame(shells, *host).work < kBudget);
        CHECK(crossings(shells) == 0);
    }
    CHECK(shells.events().quarantined.empty());
}

TEST_CASE("what a frame took is counted alike on every run and for any number of threads", "[plugin][frames]") {
    const auto run = [](int threads) {
        const auto host = groundHost();
        addPlate(*host, 8.0, 1.0);
        Shells shells(host);
        REQUIRE(shells.set_quality(Quality::Game));
        REQUIRE(shells.set_threads(threads));
        REQUIRE(shells.set_frame_budget(400)); // small, so that it acts
        for (int i = 0; i < 12; ++i)
            REQUIRE(shells.create(shellAt(2.1 * (i % 4), 1.1 + 2.1 * (i / 4), 0.4 * i, 1.0, 2.0)));
        std::vector<double> work;
        for (int i = 0; i < 60; ++i) {
            const FrameReport r = shells.pre_step(kFrame);
            REQUIRE(r.failure.empty());
            CHECK(r.work <= 1.5 * 400.0 + 600.0); // a trial of twelve shells is dear beside this budget
            work.push_back(r.work);
            host->step(r.advanced);
            REQUIRE(shells.post_step());
        }
        work.push_back(static_cast<double>(shells.hash() % 1000003));
        return work;
    };
    const std::vector<double> once = run(1);
    CHECK(once == run(1));
    CHECK(once == run(2));
    CHECK(*std::max_element(once.begin(), once.end() - 1) > 400.0);
}

TEST_CASE("the laboratory has no budget and waits", "[plugin][frames]") {
    Shells shells(nullptr);
    CHECK(shells.stepper().settings().frameWork == 0);
    CHECK(shells.stepper().settings().crush == step::CrushPolicy::Wait);
    CHECK_FALSE(shells.stepper().settings().giveUpEarly);
    REQUIRE(shells.set_quality(Quality::Game));
    CHECK(shells.stepper().settings().frameWork == static_cast<std::uint64_t>(kBudget));
    CHECK(shells.stepper().settings().crush == step::CrushPolicy::Stop);
}

TEST_CASE("holds and joints break beyond their largest force", "[plugin][frames]") {
    // A shell that hangs at rest pulls with its weight. Half of it breaks, twice does not.
    const Quality quality = GENERATE(Quality::Laboratory, Quality::Game);
    const bool joint = GENERATE(false, true);
    const double share = GENERATE(0.5, 2.0);
    const auto host = groundHost();
    Shells shells(host);
    REQUIRE(shells.set_quality(quality));
    const ShellDef d = shellAt(0.0, 4.0, 0.0, 1.0, 2.0);
    const auto shell = shells.create(d);
    const double most = share * 2.0 * 9.81; // N
    HoldHandle hold;
    JointHandle string;
    if (joint) {
        string = *shells.create_joint({.kind = JointKind::Tether,
                                       .shell = *shell,
                                       .arc_fraction = 0.5,
                                       .point = {d.position.x, d.position.y + 0.5}});
        CHECK_FALSE(shells.set_max_force(string, -1.0));
        CHECK_FALSE(shells.set_max_force(string, INFINITY));
        REQUIRE(shells.set_max_force(string, most));
    } else {
        hold = *shells.create_pin(*shell, 0.5);
        CHECK_FALSE(shells.set_max_force(hold, NAN));
        REQUIRE(shells.set_max_force(hold, most));
    }
    std::vector<BrokeEvent> broke;
    for (int i = 0; i < 20; ++i) {
        const FrameReport r = shells.pre_step(kFrame);
        REQUIRE(r.failure.empty());
        broke.insert(broke.end(), shells.events().broke.begin(), shells.events().broke.end());
        REQUIRE(shells.post_step());
    }
    REQUIRE(broke.size() == (share < 1.0 ? 1 : 0));
    CHECK((joint ? shells.valid(string) : shells.valid(hold)) == broke.empty());
    if (broke.empty())
        return;
    CHECK(broke[0].shell == *shell);
    CHECK(broke[0].joint == string);
    CHECK(broke[0].hold == hold);
    CHECK(std::hypot(broke[0].force.x, broke[0].force.y) > most);
    CHECK(shells.section(*shell, 0.5)->position.y < d.position.y - 0.05); // it falls
}
