// Effects switched on through the API: the catalogue, bad input, removal, saving, the log.

#include "tests/plugin/api/support.h"

#include <algorithm>

using namespace supercircle;
using namespace supercircle::test;
using Catch::Contains;

namespace {

/// A dome that falls onto the ground.
ShellDef falling() {
    ShellDef d = dome();
    d.position.y += 0.02;
    return d;
}

void run(Shells& shells, FakeHost& host, int frames) {
    advance(shells, &host, 1.0 / 120.0, frames);
}

const EffectInfo& entry(const std::string& key) {
    for (const EffectInfo& e : effect_catalog())
        if (e.key == key)
            return e;
    FAIL("no effect " << key);
    return effect_catalog().front();
}

} // namespace

TEST_CASE("the catalogue of effects is complete and its defaults switch each effect on", "[plugin]") {
    CHECK(effect_catalog().size() == 27);
    for (const EffectInfo& e : effect_catalog()) {
        INFO(e.key);
        CHECK_FALSE(e.about.empty());
        CHECK_FALSE(e.law.empty());
        REQUIRE_FALSE(e.parameters.empty());
        bool on = false;
        for (const EffectParameter& p : e.parameters) {
            INFO(p.name);
            CHECK_FALSE(p.unit.empty());
            CHECK_FALSE(p.about.empty());
            CHECK(p.lowest <= p.highest);
            CHECK(p.default_value >= p.lowest);
            CHECK(p.default_value <= p.highest);
            on = on || (p.is_switch && p.default_value != p.neutral_value);
        }
        CHECK(on);
        Shells shells(groundHost(0.5));
        const ShellHandle shell = *shells.create(falling());
        const Status set = shells.set_effects(shell, e.key);
        CHECK(static_cast<bool>(set) == e.acts_on_shells);
        CHECK(shells.effects(shell)->size() == (e.acts_on_shells ? 1U : 0U));
    }
    CHECK(entry("planar_drag").slot == EffectSlot::Load);
    CHECK(entry("planar_drag").parameters[0].unit == "N/m");
    CHECK(entry("sensor_gain").slot == EffectSlot::Sensor);
    CHECK(entry("viscoelastic_bending").parameters[0].choices.size() == 3);
}

TEST_CASE("an effect changes the motion, and its values can be read back", "[plugin]") {
    auto host = groundHost(0.5), other = groundHost(0.5);
    Shells with(host), without(other);
    const ShellHandle shell = *with.create(falling());
    REQUIRE(without.create(falling()));
    REQUIRE(with.set_effects(shell, "viscoelastic_bending",
                             {{"law", "standard_linear_solid"}, {"branch_over_B", 0.4}, {"tau_s", 0.05}}));
    const std::vector<EffectDef> now = *with.effects(shell);
    REQUIRE(now.size() == 1);
    CHECK(now[0].key == "viscoelastic_bending");
    CHECK(now[0].parameters[0].choice == "standard_linear_solid");
    CHECK(now[0].parameters[1].number == 0.0);
    CHECK(now[0].parameters[2].number == 0.4);
    run(with, *host, 40);
    run(without, *other, 40);
    CHECK(with.world().rods[0].q != without.world().rods[0].q);
    CHECK(with.energy_balance().effects > 0.0);
}

TEST_CASE("an effect without a switch among its parameters is on", "[plugin]") {
    Shells shells(groundHost(0.5));
    const ShellHandle shell = *shells.create(falling());
    REQUIRE(shells.set_effects(shell, "plasticity", {{"hardening", "kinematic"}}));
    REQUIRE(shells.set_effects(shell, "viscoelastic_bending", {{"law", "standard_linear_solid"}}));
    const std::vector<EffectDef> now = *shells.effects(shell);
    REQUIRE(now.size() == 2);
    CHECK(std::isfinite(now[0].parameters[0].number)); // the yield moment
    CHECK(now[0].parameters[2].choice == "kinematic");
    CHECK(now[1].parameters[1].number == 0.0); // of the other law
    CHECK(now[1].parameters[2].number > 0.0);
}

TEST_CASE("a wrong key or parameter of an effect is answered with the nearest one", "[plugin]") {
    Shells shells(groundHost(0.5));
    const ShellHandle shell = *shells.create(falling());
    const std::uint64_t before = shells.hash();
    const auto why = [&](const std::string& key, const std::vector<EffectValue>& values = {}) {
        const Status s = shells.set_effects(shell, key, values);
        return s ? std::string() : s.error();
    };
    CHECK_THAT(why("plasticty"), Contains("did you mean \"plasticity\"?") && Contains("the catalogue of effects"));
    CHECK_THAT(why("nothing like it"), Contains("expected one of") && Contains("planar_drag"));
    CHECK_THAT(why("planar_drag", {{"f_N_n", 1.0}}), Contains("did you mean \"f_N_m\"?"));
    CHECK_THAT(why("planar_drag", {{"f_N_m", -1.0}}), Contains("a number from 0 to 10000 N/m"));
    CHECK_THAT(why("planar_drag", {{"f_N_m", kNan}}), Contains("out of range"));
    CHECK_THAT(why("plasticity", {{"hardening", "kinematik"}}), Contains("did you mean \"kinematic\"?"));
    CHECK_THAT(why("planar_drag", {{"shell", "all"}}), Contains("first argument"));
    CHECK_THAT(why("viscoelastic_bending", {{"branch_over_B", 0.1}}), Contains("standard_linear_solid"));
    CHECK_THAT(why("gravity"), Contains("b2World::SetGravity"));
    CHECK_THAT(why("sensor_gain"), Contains("testing machine"));
    CHECK_THAT(why("bearing_friction"), Contains("rigid bodies"));
    CHECK_THAT(shells.remove_effect(shell, "plasticty").error(), Contains("plasticity"));
    CHECK_FALSE(shells.set_effects(ShellHandle{}, "plasticity"));
    CHECK_FALSE(shells.effects(ShellHandle{}));
    CHECK_FALSE(shells.replace_effects(shell, {{"wear", {}}, {"wear", {}}}));
    CHECK(shells.hash() == before);
}

TEST_CASE("an effect that is off or removed is bitwise identical to an absent one", "[plugin]") {
    for (const bool atRest : {false, true}) {
        auto host = groundHost(0.5), other = groundHost(0.5);
        Shells touched(host), plain(other);
        for (Shells* s : {&touched, &plain})
            for (const double x : {0.0, 0.3}) {
                ShellDef d = falling();
                d.position.x = x;
                REQUIRE(s->create(d));
            }
        if (atRest) {
            settle(touched, host.get());
            settle(plain, other.get());
        }
        REQUIRE(touched.hash() == plain.hash());
        const ShellHandle shell = touched.shells()[0];
        for (const char* key : {"plasticity", "planar_drag", "wear", "static_friction_excess"}) {
            REQUIRE(touched.set_effects(all_shells, key));
            REQUIRE(touched.remove_effect(all_shells, key));
            REQUIRE(touched.set_effects(shell, key));
            REQUIRE(touched.remove_effect(shell, key));
        }
        REQUIRE(touched.set_effects(shell, "planar_drag", {{"f_N_m", 0.0}}));
        CHECK(touched.effects(shell)->empty());
        CHECK(touched.hash() == plain.hash());
        run(touched, *host, 60);
        run(plain, *other, 60);
        CHECK(touched.hash() == plain.hash());
    }
}

TEST_CASE("an effect given while the world runs leaves the state of other slots alone", "[plugin]") {
    auto host = groundHost(0.5);
    Shells shells(host);
    const ShellHandle shell = *shells.create(falling());
    REQUIRE(shells.set_effects(shell, "plasticity", {{"My_over_B_1_m", 0.01}}));
    run(shells, *host, 60);
    const auto plastic = [&] {
        double sum = 0.0;
        for (const double k : shells.world().rods[0].effects.material.plastic)
            sum += std::abs(k);
        return sum;
    };
    const double set = plastic();
    REQUIRE(set > 0.0);
    const double dissipated = shells.energy_balance().effects;
    REQUIRE(shells.set_effects(shell, "planar_drag"));
    CHECK(plastic() == set);
    CHECK(shells.effects(shell)->size() == 2);
    REQUIRE(shells.set_effects(shell, "viscoelastic_bending")); // of the same slot: it starts at rest
    CHECK(plastic() == 0.0);
    CHECK(shells.effects(shell)->size() == 3);
    run(shells, *host, 60);
    CHECK(shells.energy_balance().effects >= dissipated);
    CHECK(std::abs(shells.energy_balance().residual) < 1e-6);
    REQUIRE(shells.replace_effects(shell, {}));
    CHECK(shells.effects(shell)->empty());
    CHECK_FALSE(shells.world().rods[0].effects.on());
    run(shells, *host, 10);
}

TEST_CASE("effects of all shells are given to those created later", "[plugin]") {
    Shells shells(groundHost(0.5));
    const ShellHandle first = *shells.create(falling());
    REQUIRE(shells.set_effects(all_shells, "wear", {{"change", 0.5}}));
    const ShellHandle second = *shells.create(falling());
    for (const ShellHandle s : {first, second})
        CHECK(shells.effects(s)->size() == 1);
    Shells copy(groundHost(0.5));
    REQUIRE(copy.restore(shells.save()));
    const ShellHandle third = *copy.create(falling());
    CHECK(copy.effects(third)->size() == 1);
    REQUIRE(copy.remove_effect(all_shells, "wear"));
    for (const ShellHandle s : copy.shells())
        CHECK(copy.effects(s)->empty());
    CHECK(copy.effects(*copy.create(falling()))->empty());
}

TEST_CASE("the state of effects survives saving and restoring", "[plugin]") {
    auto host = groundHost(0.5), other = groundHost(0.5);
    Shells shells(host), fresh(other);
    REQUIRE(shells.replace_effects(
        all_shells,
        {{"viscoelastic_bending", {{"law", "standard_linear_solid"}, {"branch_over_B", 0.3}, {"tau_s", 0.05}}},
         {"plasticity", {{"My_over_B_1_m", 2.0}}},
         {"planar_drag", {{"f_N_m", 0.02}}},
         {"wear", {{"change", 0.5}, {"distance_m", 0.01}}}}));
    REQUIRE(shells.create(falling()));
    run(shells, *host, 30);
    const Snapshot saved = shells.save();
    const auto bodies = host->bodies;
    run(shells, *host, 30);
    const std::uint64_t end = shells.hash();
    REQUIRE(fresh.restore(*Snapshot::from_bytes(saved.bytes())));
    CHECK(fresh.effects(fresh.shells()[0])->size() == 4);
    other->bodies = bodies;
    run(fresh, *other, 30);
    CHECK(fresh.hash() == end);
    REQUIRE(shells.restore(saved));
    host->bodies = bodies;
    run(shells, *host, 30);
    CHECK(shells.hash() == end);
}

TEST_CASE("calls about effects are replayed from the log", "[plugin]") {
    auto host = groundHost(0.5), other = groundHost(0.5);
    Shells shells(host), replayed(other);
    REQUIRE(shells.start_log());
    const ShellHandle shell = *shells.create(falling());
    REQUIRE(shells.set_effects(all_shells, "wear"));
    REQUIRE(shells.set_effects(shell, "viscoelastic_bending", {{"eta_over_B_s", 0.02}}));
    run(shells, *host, 10);
    REQUIRE(shells.remove_effect(shell, "wear"));
    REQUIRE(shells.replace_effects(all_shells, {{"planar_drag", {}}, {"plasticity", {{"hardening", "kinematic"}}}}));
    run(shells, *host, 10);
    REQUIRE(replayed.replay(shells.log(), [&](double dt) {
        other->step(dt);
        return true;
    }));
    CHECK(replayed.hash() == shells.hash());
    CHECK(replayed.effects(replayed.shells()[0])->size() == 2);
}
