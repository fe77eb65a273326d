// One shell between two plates against the solved curves T5A (standing on its tips) and T5B (lying on its back).

#include "tests/plugin/lab/session/simulation.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

scene::Scene squeeze(double phiBar, double mu, double travel) {
    scene::Scene s = loadScene("squeeze", {{"phi_bar", phiBar},
                                           {"mu", mu},
                                           {"thickness", 5e-5},
                                           {"elements", 31},
                                           {"speed", 0.005},
                                           {"travel_over_R", travel}});
    keepFrequencies(s, 5e-5);
    return s;
}

/// Height between the plates of a C-shape under force f (T5B): 2 int_0^{pi/2} cos t / sqrt(1 + 2 f cos t) dt.
double heightOfC(double f) {
    double sum = 0.0; // Simpson
    const int n = 200;
    for (int i = 0; i <= n; ++i) {
        const double t = 0.5 * M_PI * i / n, weight = i == 0 || i == n ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
        sum += weight * std::cos(t) / std::sqrt(1.0 + 2.0 * f * std::cos(t));
    }
    return 2.0 * sum * 0.5 * M_PI / n / 3.0;
}

} // namespace

TEST_CASE("a shell standing between plates follows the solved curves", "[lab]") {
    const struct {
        double phiBar, mu, travel;
        const char* file;
    } cases[] = {{0.75, 0.1, 0.36, "T5A_cap_Phi0.75_mu0.10.csv"}, {0.60, 0.2, 0.62, "T5A_cap_Phi0.60_mu0.20.csv"}};
    for (const auto& c : cases) {
        INFO(c.file);
        const lab::RunResult out = simulate(squeeze(c.phiBar, c.mu, c.travel));
        const ForceCurve load = loadingAndUnloading(out.recording).first, up = reference(c.file);
        double worst = 0.0;
        for (const double share : {0.2, 0.4, 0.6, 0.8, 0.95})
            worst = std::max(worst, std::abs(load.at(share * c.travel) / up.at(share * c.travel) - 1.0));
        CAPTURE(worst);
        CHECK(worst < 0.03); // 31 arcs; the flattening crown is resolved by a few of them
        checkInvariants(out.recording);
    }
}

TEST_CASE("a shell lying on its back between plates, whatever the friction", "[lab]") {
    for (const double mu : {0.0, 0.35}) {
        INFO("mu " << mu);
        scene::Scene s = squeeze(0.75, mu, 0.5);
        const double h = 5e-5, R = 0.0192, gap = 1e-8;
        s.shells[0].position = {0.0, R + 0.5 * h + gap};
        s.shells[0].angle = -0.5 * M_PI; // runs down and turns left: opens to the right
        for (step::BodyDefinition& b : s.rigid.bodies)
            if (b.name == "plate")
                b.position.y() = 2.0 * R + h + 2.0 * gap;
        const lab::RunResult out = simulate(s);
        const ForceCurve load = loadingAndUnloading(out.recording).first;
        double worst = 0.0;
        for (const double f : {0.05, 0.1, 0.2, 0.4}) {
            const double d = 2.0 - heightOfC(f);
            if (d < 0.49)
                worst = std::max(worst, std::abs(load.at(d) / f - 1.0));
        }
        CAPTURE(worst);
        CHECK(worst < 0.02); // 31 arcs
        checkInvariants(out.recording);
        // the horizontal balance holds without friction
        CHECK(*std::max_element(out.recording.series.find("friction_J")->begin(),
                                out.recording.series.find("friction_J")->end()) <
              1e-3 * number(out.recording, "plate_work_J"));
    }
}
