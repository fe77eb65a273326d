#include "tests/plugin/identification/replay/support.h"

using namespace replaytest;
using Catch::Contains;

TEST_CASE("parameters have names, units and the stated intervals", "[replay]") {
    const experiment::Experiment e = baseline(101);
    const std::vector<replay::ParameterInfo> list = replay::parameterList(e);
    const auto find = [&](const std::string& name) {
        for (const replay::ParameterInfo& p : list)
            if (p.name == name)
                return p;
        FAIL("no parameter " << name);
        return replay::ParameterInfo{};
    };
    CHECK(find("friction").stated.value == 0.3);
    CHECK(find("friction").stated.halfWidth == 0.05);
    CHECK(find("bending_modulus").unit == "N m^2");
    CHECK(find("bending_modulus").stated.halfWidth == Approx(0.06 * e.specimens[0].bendingModulus.value));
    CHECK(find("gap_shift").stated.halfWidth == 5e-5);
    CHECK(find("gravity_y").stated.value == -9.81);
    CHECK(find("series_compliance").stated.value == 0.0);
    CHECK(find("touch_compliance").stated.value == 0.0);
    const replay::Parameters nominal = replay::nominal(e);
    for (const replay::ParameterInfo& p : list)
        CHECK(replay::get(nominal, e, p.name) == p.stated.value);
}

TEST_CASE("the contact compliance of a strip is its length over its axial stiffness", "[replay]") {
    const experiment::Experiment e = baseline(104);
    CHECK(replay::nominal(e).touchCompliance == Approx(0.06 / 11000.0).epsilon(1e-12));
    CHECK(replay::nominal(e).seriesCompliance == 0.0);
}

TEST_CASE("every listed name can be set, shared or per specimen", "[replay]") {
    const experiment::Experiment e = baseline(103);
    for (const replay::ParameterInfo& info : replay::parameterList(e)) {
        INFO(info.name);
        replay::Parameters p = replay::nominal(e);
        const double value = info.stated.value + 0.01 * std::abs(info.stated.value) + 1e-6;
        CHECK(replay::set(p, e, info.name, value).empty());
        CHECK(replay::get(p, e, info.name) == value);
    }
    replay::Parameters p = replay::nominal(e);
    CHECK(replay::set(p, e, "thickness", 6e-4).empty());
    CHECK(p.specimens[0].thickness == 6e-4);
    CHECK(p.specimens[1].thickness == 6e-4);
    CHECK(replay::set(p, e, "thickness.B", 7e-4).empty());
    CHECK(p.specimens[0].thickness == 6e-4);
    CHECK(p.specimens[1].thickness == 7e-4);
}

TEST_CASE("bad names and values are rejected", "[replay]") {
    const experiment::Experiment e = baseline(101);
    replay::Parameters p = replay::nominal(e);
    CHECK_THAT(replay::set(p, e, "bending_moduls", 1.0), Contains("did you mean \"bending_modulus\"?"));
    CHECK_THAT(replay::set(p, e, "friction", -0.1), Contains("out of range"));
    CHECK_THAT(replay::set(p, e, "thickness", 0.0), Contains("finite number > 0"));
    CHECK_THAT(replay::set(p, e, "contact_arm", 1.5), Contains("at most 1"));
    CHECK_FALSE(replay::get(p, e, "nothing"));
    CHECK(p.friction == 0.3);
}
