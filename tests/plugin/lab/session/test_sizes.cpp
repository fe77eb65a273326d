// A scaled scene: all lengths times k, the same material, the same crosshead speed. Periods grow like k, and so does
// the time of a test, so without gravity the dimensionless curve is the same. It would be bitwise identical if no
// numerical setting were an absolute length or time.

#include "tests/plugin/lab/session/simulation.h"
#include "tests/support/text.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

lab::RunResult pressOfSize(double R, double phiBar) {
    const std::string path = std::string(SC_SOURCE_DIR) + "/scenes/shell_on_cylinder.json";
    const double k = R / 0.0192;
    std::string text = with(contentOf(path), "\"R\": 0.0192", "\"R\": " + std::to_string(R));
    text = with(text, "\"value\": 1e-8", "\"value\": " + std::to_string(k) + "e-8");
    text = with(text, "\"value\": 0.0005, \"min\": 1e-6, \"max\": 0.001",
                "\"value\": " + std::to_string(k * 500.0) + "e-6, \"min\": 1e-9, \"max\": 1");
    text = with(text, "\"density\": { \"param\"",
                "\"width\": " + std::to_string(k * 1e4) + "e-6, \"density\": { \"param\"");
    std::vector<scene::Problem> problems;
    const auto scene = scene::loadText(text, path, {{"phi_bar", phiBar}}, problems);
    for (const scene::Problem& p : problems)
        UNSCOPED_INFO(p.toString());
    REQUIRE(scene);
    return simulate(*scene);
}

} // namespace

TEST_CASE("shells of 5 mm, 5 cm and 1 m give one dimensionless curve", "[lab]") {
    for (const double phiBar : {0.65, 0.9}) { // smooth and abrupt
        const lab::RunResult middle = pressOfSize(0.05, phiBar);
        const auto [load, pull] = loadingAndUnloading(middle.recording);
        for (const double R : {0.005, 1.0}) {
            INFO("phi_bar " << phiBar << ", R " << R << " m");
            const lab::RunResult other = pressOfSize(R, phiBar);
            const auto [otherLoad, otherPull] = loadingAndUnloading(other.recording);
            // Interpolated: steps differ in the last digits, and at a snap by several steps.
            const auto rms = [](const ForceCurve& a, const ForceCurve& b, double peak) {
                double sum = 0.0, count = 0.0;
                const double from = std::max(std::min(a.d.front(), a.d.back()), std::min(b.d.front(), b.d.back()));
                const double to = std::min(std::max(a.d.front(), a.d.back()), std::max(b.d.front(), b.d.back()));
                for (int i = 1; i < 1000; ++i, count += 1.0) {
                    const double d = from + (to - from) * i / 1000.0;
                    sum += std::pow((a.at(d) - b.at(d)) / peak, 2);
                }
                return std::sqrt(sum / count);
            };
            CHECK(rms(otherLoad, load, load.top()) < 1e-3);
            CHECK(rms(otherPull, pull, load.top()) < 1e-3);
        }
    }
}
