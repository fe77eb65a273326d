// The demonstration scene: every kind of missing physics acts in a scene, and the books close with it.

#include "tests/plugin/lab/session/play.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct Slider {
    const char* name;
    double value;
    double least; ///< change of the force that it makes at least somewhere, as a share of the peak
    bool sensor = false;
};

record::Recording demonstrate(const Overrides& more) {
    Overrides all = {{"elements", 8}, {"travel_over_R", 0.3}, {"speed", 0.01}};
    all.insert(all.end(), more.begin(), more.end());
    return play(loadScene("effects", all)).recording;
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

TEST_CASE("every effect of the demonstration scene changes the force, and the books close with it", "[lab]") {
    const record::Recording plain = demonstrate({});
    const double peak = number(plain, "peak_force_N");
    // The least changes are a fifth of what these settings make: enough to tell an effect from one that is not there.
    for (const Slider& s :
         {Slider{"viscosity", 0.5, 0.05},  Slider{"stiffness_drop", 0.6, 0.005}, Slider{"flattening", -30, 0.01},
          Slider{"gradient", 0.3, 0.0005}, Slider{"softening", 0.3, 0.005},      Slider{"drag", 0.1, 0.02},
          Slider{"sideways", 5, 1e-6},     Slider{"static_ratio", 1.8, 1e-4},    Slider{"stribeck", -0.5, 0.02},
          Slider{"wear_change", 1, 0.002}, Slider{"attraction", 36, 0.005},      Slider{"contact_give", 0.001, 0.002},
          Slider{"play", 0.001, 1e-9},     Slider{"offset", 0.003, 0.01},        Slider{"drift", 0.03, 0.01},
          Slider{"gain_error", 0.2, 0.15}, Slider{"delay", 0.1, 0.01},           Slider{"knee", 20, 0.002},
          Slider{"yield", 4, 0.002},       Slider{"machine_stiffness", 20, 0.01}}) {
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
