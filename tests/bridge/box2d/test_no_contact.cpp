// Each reason for "no contact" holds for the crossing check as well: shells pass, and no step is rejected.

#include "tests/bridge/box2d/game_world.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

enum class Why {
    Sensor,
    Category,
    Mask,
    Group,
    Disabled,
    Veto,
    Joined,
    Changed,
    ShellGroup,
    ShellsJoined,
    OneSided,
    Count
};

struct CrossingLevel : GameWorld {
    explicit CrossingLevel(Quality quality) : GameWorld(quality) {
        wall = body(b2_staticBody, 0.0F, 0.0F);
        box.SetAsBox(0.5F, 0.02F);
        edge.SetTwoSided({-0.5F, 0.0F}, {0.5F, 0.0F});
        disc.m_radius = 0.05F;
        back.SetOneSided({-2.0F, 0.0F}, {-0.5F, 0.0F}, {0.5F, 0.0F}, {2.0F, 0.0F}); // its front is below
    }
    /// A strip of 1.1 m with its middle at a place.
    ShellHandle strip(double x, double y, double angle) {
        ShellDef d = scaled_shell(0.35, 0.4, 0.5, 60.0);
        d.elements = 10;
        d.natural_curvature.assign(10, 0.0);
        d.position = {x, y};
        d.angle = angle;
        return shells.create(d).value();
    }
    void pin(ShellHandle shell, BodyId body, ShellHandle other) {
        JointDef j;
        j.kind = JointKind::Pin;
        j.shell = shell;
        j.arc_fraction = 0.0;
        j.body = body;
        j.other = other;
        shells.create_joint(j).or_fail();
    }
    void frame() {
        GameWorld::frame();
        CHECK(shells.events().quarantined.empty());
        CHECK(shells.events().contact_begin.empty());
        CHECK(shells.events().overlapping.empty());
    }
    [[nodiscard]] double tip(ShellHandle shell, double fraction) const {
        return shells.section(shell, fraction).value().position.y;
    }

    b2Body* wall = nullptr;
    b2PolygonShape box;
    b2EdgeShape edge, back;
    b2CircleShape disc;
};

/// The shell that passes, set up so that only `why` keeps it from touching.
ShellHandle setUp(CrossingLevel& level, Why why, b2FixtureDef& f) {
    // A joined strip hangs by its end and swings through what it is joined to; others fall through the wall.
    const bool swings = why == Why::Joined || why == Why::ShellsJoined;
    const ShellHandle shell = swings ? level.strip(0.19, 0.2, 0.5) : level.strip(0.0, 1.0, 0.4);
    const ShellHandle other = why == Why::ShellGroup     ? level.strip(0.02, 0.5, -0.4)
                              : why == Why::ShellsJoined ? level.strip(0.1, 0.07, 0.0)
                                                         : ShellHandle{};
    if (why == Why::OneSided)
        f.shape = &level.back;
    if (why == Why::Sensor)
        f.isSensor = true;
    if (why == Why::Category) {
        f.filter.categoryBits = 4;
        level.shells.set_filter(shell, {1, 0xfffb, 0}).or_fail();
    }
    if (why == Why::Mask)
        f.filter.maskBits = 0xfffe;
    if (why == Why::Group) {
        f.filter.groupIndex = -3;
        level.shells.set_filter(shell, {1, 0xffff, -3}).or_fail();
    }
    if (why == Why::Veto)
        level.shells.set_pair_filter([](const PairQuery&) { return false; }).or_fail();
    if (why == Why::ShellGroup || why == Why::ShellsJoined) {
        f.filter.maskBits = 0;
        level.shells.create_clamp(other, 0.5).or_fail();
    }
    if (why == Why::ShellGroup) {
        level.shells.set_filter(shell, {1, 0xffff, -1}).or_fail();
        level.shells.set_filter(other, {1, 0xffff, -1}).or_fail();
    }
    level.wall->CreateFixture(&f);
    if (why == Why::Disabled)
        level.wall->SetEnabled(false);
    if (why == Why::Joined)
        level.pin(shell, level.port.body_id(*level.wall), {});
    if (why == Why::ShellsJoined)
        level.pin(shell, 0, other);
    return shell;
}

} // namespace

TEST_CASE("what shells do not touch they pass, and no step is rejected for it", "[box2d][no_contact]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const Why why = static_cast<Why>(GENERATE(range(0, static_cast<int>(Why::Count))));
    const int shape = GENERATE(0, 1, 2);
    CAPTURE(static_cast<int>(quality), static_cast<int>(why), shape);
    CrossingLevel level(quality);
    b2FixtureDef f;
    f.shape = shape == 0   ? static_cast<const b2Shape*>(&level.box)
              : shape == 1 ? static_cast<const b2Shape*>(&level.edge)
                           : &level.disc;
    const ShellHandle shell = setUp(level, why, f);
    double lowest = 1.0;
    for (int i = 0; i < 60; ++i) {
        if (why == Why::Changed && i == 5) // within the fall, above the wall
            level.shells.set_filter(shell, {1, 0, 0}).or_fail();
        level.frame();
        lowest = std::min(lowest, level.tip(shell, 1.0));
    }
    CHECK(lowest < -0.1);
    const step::Counters& c = level.shells.world().counters;
    CHECK(c.crossings == 0);
    CHECK(c.rejectedFor[static_cast<std::size_t>(step::Reason::Crossing)] == 0);
}
