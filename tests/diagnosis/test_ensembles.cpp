#include "plugin/diagnosis/ensembles.h"
#include "plugin/diagnosis/random.h"

#include <catch2/catch.hpp>

using namespace supercircle::diagnosis;

namespace {

/// Stacks whose heights and losses scatter together around given means.
Ensemble stacks(const std::string& label, double height, double loss, int n, std::uint64_t seed) {
    Random random(seed);
    Ensemble e{label, Eigen::MatrixXd(n, 3)};
    for (int i = 0; i < n; ++i) {
        const double common = random.normal();
        e.values.row(i) << height + 0.1 * (common + random.normal()), loss + 0.02 * (common + random.normal()),
            3.0 + random.normal();
    }
    return e;
}

const std::vector<std::string> kQuantities = {"H0_over_R", "eta", "snap_fits"};

} // namespace

TEST_CASE("an ensemble of stacks that agrees lacks nothing, one that is shifted is named by what shifts it",
          "[diagnosis]") {
    const Ensemble nominal = stacks("nominal", 5.0, 0.15, 40, 1);
    const std::vector<Ensemble> effects = {stacks("adhesion", 5.0, 0.25, 40, 2), stacks("gravity", 4.6, 0.15, 40, 3)};
    const auto with = [&](double height, double loss, std::uint64_t seed) {
        return diagnoseEnsembles(kQuantities, stacks("recorded", height, loss, 30, seed), nominal, effects, 7);
    };
    const EnsembleDiagnosis same = with(5.0, 0.15, 11);
    CHECK(same.verdict == "nothing_missing");
    CHECK(same.nothing > 0.75);
    const EnsembleDiagnosis lossy = with(5.0, 0.25, 12);
    INFO(lossy.statement);
    CHECK(lossy.verdict == "named");
    CHECK(lossy.effects.front().label == "adhesion");
    CHECK(lossy.shifts[1].p < 0.01);
    CHECK(lossy.shifts[2].p > 0.01);
    CHECK(with(4.6, 0.15, 13).effects.front().label == "gravity");
    CHECK(with(6.0, 0.15, 14).verdict == "unexplained"); // higher than anything that was simulated
}

TEST_CASE("equal ensembles raise an alarm in one case of twenty", "[diagnosis]") {
    int alarms = 0;
    constexpr int kTrials = 60;
    for (std::uint64_t i = 0; i < kTrials; ++i)
        alarms += diagnoseEnsembles(kQuantities, stacks("recorded", 5.0, 0.15, 12, 100 + i),
                                    stacks("nominal", 5.0, 0.15, 12, 300 + i), {}, i)
                              .p <= 0.05
                      ? 1
                      : 0;
    CHECK(alarms <= 8); // 3 expected; more than 8 in one of 200
}

TEST_CASE("ensembles that are too small or incomplete are refused with a reason", "[diagnosis]") {
    const Ensemble good = stacks("a", 1.0, 0.1, 10, 1), few = stacks("b", 1.0, 0.1, 3, 2);
    CHECK(diagnoseEnsembles(kQuantities, few, good, {}, 1).failure.find("at least 4") != std::string::npos);
    CHECK_FALSE(diagnoseEnsembles({"one"}, good, good, {}, 1).failure.empty());
}
