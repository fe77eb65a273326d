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
