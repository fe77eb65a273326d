// The demonstration scene: every effect acts in a scene, and the energy balance holds with it.

#include "tests/plugin/lab/session/simulation.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct EffectSetting {
    const char* name;
    double value;
    double least; ///< smallest expected change of the force, as a fraction of the peak
    bool sensor = false;
};

record::Recording demonstrate(const Overrides& more) {
    Overrides all = {{"elements", 8}, {"travel_over_R", 0.3}, {"speed", 0.01}};
    all.insert(all.end(), more.begin(), more.end());
    return simulate(loadScene("effects", all)).recording;
}

double forceAt(const record::Recording& r, double displacement) {
    const std::vector<double>& d = *r.series.find("displacement_m");
    const std::vector<double>& f = *r.series.find("force_N");
    for (std::size_t i = 1; i < d.size(); ++i)
        if (d[i] >= displacement && d[i - 1] < displacement)
            return f[i - 1] + (f[i] - f[i - 1]) * (displacement - d[i - 1]) / (d[i] - d[i - 1]);
    FAIL("displacement " << displacement << " is not on the curve");
    return 0.0;
}

} // namespace

TEST_CASE("every effect of the demonstration scene changes the force, and the energy balance holds", "[lab]") {
    const record::Recording plain = demonstrate({});
    const double peak = number(plain, "peak_force_N");
    // The least changes are a fifth of those of these settings: enough to detect whether an effect acts.
    for (const EffectSetting& s :
         {EffectSetting{"viscosity", 0.5, 0.05},  EffectSetting{"stiffness_drop", 0.6, 0.005},
          EffectSetting{"flattening", -30, 0.01}, EffectSetting{"gradient", 0.3, 0.0005},
          EffectSetting{"softening", 0.3, 0.005}, EffectSetting{"drag", 0.1, 0.02},
          EffectSetting{"sideways", 5, 1e-6},     EffectSetting{"static_ratio", 1.8, 1e-4},
          EffectSetting{"stribeck", -0.5, 0.02},  EffectSetting{"wear_change", 1, 0.002},
          EffectSetting{"attraction", 36, 0.005}, EffectSetting{"contact_give", 0.001, 0.002},
          EffectSetting{"play", 0.001, 1e-9},     EffectSetting{"offset", 0.003, 0.01},
          EffectSetting{"drift", 0.03, 0.01},     EffectSetting{"gain_error", 0.2, 0.15},
          EffectSetting{"delay", 0.1, 0.01},      EffectSetting{"knee", 20, 0.002},
          EffectSetting{"yield", 4, 0.002},       EffectSetting{"machine_stiffness", 20, 0.01}}) {
        INFO(s.name << " = " << s.value);
        const record::Recording r = demonstrate({{s.name, s.value}});
        CHECK(std::abs(number(r, "energy_residual_relative")) < 1e-9); // round-off
        CHECK(number(r, "crossings") == 0.0);
        CHECK(number(r, "unconverged_steps") == 0.0);
        double change = 0.0;
        for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
            change = std::max(change, std::abs(forceAt(r, share * 0.3 * r.R) - forceAt(plain, share * 0.3 * r.R)));
        CAPTURE(change / peak);
        if (std::string(s.name) != "play") // which acts behind the reversal
            CHECK(change > s.least * peak);
    }
}

TEST_CASE("in a scene air acts on the shell that it is given to", "[lab]") {
    // Level strips fall side by side: one through vacuum, one through air to v = V tanh(g t / V), V^2 = lambda g / b2.
    const double line = 1270.0 * 0.01 * 0.002, last = 2.0, time = 0.5, g = 9.81; // kg/m, m/s, s
    const std::string strip = R"("radius": "infinite", "length": 0.1, "thickness": 0.002, "elements": 8})";
    const std::string text = R"({"schema": "supercircle-scene/1", "duration": 0.5, "numerics": {"quasi_static": false},
        "shell": [{"name": "leaf", "position": {"x": 0, "y": 5}, )" +
                             strip + R"(, {"name": "stone", "position": {"x": 1, "y": 5}, )" + strip +
                             R"(], "effects": [{"key": "air_drag", "shell": "leaf", "quadratic_N_s2_m3": )" +
                             std::to_string(line * g / (last * last)) + "}]}";
    std::vector<scene::Problem> problems;
    const auto made = scene::loadText(text, "leaf.json", {}, problems);
    INFO(made.error());
    REQUIRE(made);
    const record::Recording r = simulate(*made).recording;
    const auto fallOf = [&](std::size_t shell) {
        return r.frames.front().shells[shell].start[1] - r.frames.back().shells[shell].start[1];
    };
    CHECK(r.frames.back().time == Approx(time));
    // Steps are chosen for an error of the position, places are recorded in single precision: 0.2 %.
    CHECK(fallOf(0) == Approx(last * last / g * std::log(std::cosh(g * time / last))).epsilon(2e-3));
    CHECK(fallOf(1) == Approx(0.5 * g * time * time).epsilon(2e-3));
    checkInvariants(r);
    // Friction of bearings has nothing to act on in a scene that is played.
    const auto refused = scene::loadText(R"({"schema": "supercircle-scene/1", "duration": 1, "shell": [{"name": "a"}],
        "effects": [{"key": "bearing_friction", "torque_N_m": 1}]})",
                                         "bearing.json", {}, problems);
    CHECK(refused.error().find("rigid bodies") != std::string::npos);
}
