// Shells of another thickness, stiffness or mass in the contract's scenes: h / R from 3e-4 to 0.2, 3 to 100 arcs.

#include "tests/plugin/lab/session/simulation.h"
#include "tests/support/text.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kRadius = 0.0192; // m

/// Thickness, and the density that keeps the frequencies of the scene's shell of 0.5 mm.
Overrides thickness(double h, int elements) {
    return {{"thickness", h}, {"density", 1270.0 * std::pow(h / 5e-4, 2)}, {"elements", static_cast<double>(elements)}};
}

} // namespace

TEST_CASE("stiffness, masses and loads times a million or a millionth leave a run as it is", "[lab][scale]") {
    // A power of two scales without rounding: only a number of newtons or newton seconds can make a difference.
    for (const char* name : {"two_shells", "squeeze", "ramp"}) {
        const scene::Scene unscaled = loadScene(name, {});
        const lab::RunResult expected = simulate(unscaled);
        for (const double factor : {std::pow(2.0, -20.0), std::pow(2.0, 20.0)}) {
            INFO(name << " times " << factor);
            scene::Scene scaled = unscaled;
            for (ShellDef& d : scaled.shells) {
                d.young_modulus *= factor;
                d.density *= factor;
            }
            const lab::RunResult out = simulate(scaled);
            for (const char* key : {"steps", "unconverged_steps", "rejected_steps", "pivots", "contact_residual_max",
                                    "penetration_max_over_h"}) {
                INFO(key);
                CHECK(number(out.recording, key) == number(expected.recording, key));
            }
        }
    }
}

TEST_CASE("thin shells converge as those of usual thickness do", "[lab]") {
    for (const char* name : {"shell_on_cylinder", "two_shells", "squeeze"})
        for (const int elements : {3, 15}) {
            INFO(name << ", " << elements << " arcs");
            const lab::RunResult out = simulate(loadScene(name, thickness(3e-4 * kRadius, elements)));
            checkInvariants(out.recording);
            // What the impulse scaled with B excuses; the scenes' own shells reach 5e-7. Unscaled, it is 1e-3.
            CHECK(number(out.recording, "contact_residual_max") <= 1e-6);
        }
}

TEST_CASE("shells thicker than their arcs are long meet what their surface touches", "[lab]") {
    // 60 and 100 arcs are 0.4 and 0.24 thicknesses long. Their peak is that of 40 arcs but for the discretisation, 0.3
    // %.
    const auto peak = [](int elements) {
        // The scene's own range ends where the tips of the deepest shell overlap.
        const std::string path = std::string(SC_SOURCE_DIR) + "/scenes/squeeze.json";
        const std::string text = with(contentOf(path), "\"min\": 1e-6, \"max\": 0.001", "\"min\": 1e-6, \"max\": 1");
        std::vector<scene::Problem> problems;
        const auto scene = scene::loadText(
            text, path,
            {{"thickness", 0.2 * kRadius}, {"elements", static_cast<double>(elements)}, {"travel_over_R", 0.1}},
            problems);
        for (const scene::Problem& problem : problems)
            UNSCOPED_INFO(problem.toString());
        REQUIRE(scene);
        const lab::RunResult out = simulate(*scene);
        checkInvariants(out.recording);
        return loadingAndUnloading(out.recording).first.top();
    };
    const double coarse = peak(40);
    for (const int elements : {60, 100})
        CHECK(peak(elements) == Approx(coarse).epsilon(0.01));
}

TEST_CASE("a clamped rod that touches nothing takes the same steps, however thin it is", "[lab]") {
    // Of equal weight and stiffness: only the lengths of the numerics can tell the thicknesses apart.
    const scene::Scene usual = loadScene("cantilever", {});
    scene::Scene thin = usual;
    ShellDef& d = thin.shells[0];
    const double ratio = d.thickness / (3e-4 * kRadius);
    d.thickness /= ratio;
    d.density *= ratio;
    d.young_modulus *= ratio * ratio * ratio;
    const lab::RunResult expected = simulate(usual), out = simulate(thin);
    checkInvariants(out.recording);
    CHECK(number(out.recording, "steps") < 1.2 * number(expected.recording, "steps"));
    for (const char* key : {"tip_x_over_L", "tip_y_over_L"}) // both hang still to 1e-6 of the length
        CHECK(number(out.recording, key) == Approx(number(expected.recording, key)).margin(1e-6));
}
