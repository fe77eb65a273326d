#include "plugin/identification/diagnosis/ensembles.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "tests/support/folder.h"

#include <catch2/catch.hpp>

using namespace supercircle::diagnosis;

namespace {

/// Stacks with correlated heights and losses around given means.
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

const std::vector<std::string> kQuantities = {"H0_over_R", "dissipation_ratio", "snap_fits"};

} // namespace

TEST_CASE("equal ensembles are adequate, a shift is identified", "[diagnosis]") {
    const Ensemble nominal = stacks("nominal", 5.0, 0.15, 40, 1);
    const std::vector<Ensemble> effects = {stacks("adhesion", 5.0, 0.25, 40, 2), stacks("gravity", 4.6, 0.15, 40, 3)};
    const auto with = [&](double height, double loss, std::uint64_t seed) {
        return diagnoseEnsembles(kQuantities, stacks("recorded", height, loss, 30, seed), nominal, effects, 7);
    };
    const EnsembleDiagnosis same = with(5.0, 0.15, 11);
    CHECK(same.verdict == "adequate");
    CHECK(same.adequate > 0.75);
    const EnsembleDiagnosis lossy = with(5.0, 0.25, 12);
    INFO(lossy.statement);
    CHECK(lossy.verdict == "identified");
    CHECK(lossy.effects.front().label == "adhesion");
    CHECK(lossy.shifts[1].p < 0.01);
    CHECK(lossy.shifts[2].p > 0.01);
    CHECK(with(4.6, 0.15, 13).effects.front().label == "gravity");
    CHECK(with(6.0, 0.15, 14).verdict == "outside_catalogue"); // higher than any simulated ensemble
}

TEST_CASE("equal ensembles differ significantly in one case of twenty", "[diagnosis]") {
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

TEST_CASE("too small or incomplete ensembles are rejected with a reason", "[diagnosis]") {
    const Ensemble good = stacks("a", 1.0, 0.1, 10, 1), few = stacks("b", 1.0, 0.1, 3, 2);
    CHECK(diagnoseEnsembles(kQuantities, few, good, {}, 1).failure.find("at least 4") != std::string::npos);
    CHECK_FALSE(diagnoseEnsembles({"one"}, good, good, {}, 1).failure.empty());
}

TEST_CASE("inconclusive stacks are not reported as equal", "[diagnosis]") {
    const Ensemble nominal = stacks("nominal", 5.0, 0.15, 40, 1);
    int hints = 0, open = 0;
    for (std::uint64_t seed = 500; seed < 560; ++seed)
        for (const double height : {5.05, 5.1, 5.2}) {
            const EnsembleDiagnosis d = diagnoseEnsembles(kQuantities, stacks("recorded", height, 0.15, 12, seed),
                                                          nominal, {stacks("wear", 5.1, 0.15, 40, 3)}, 7);
            if (d.verdict != "inconclusive")
                continue;
            INFO(d.statement);
            CHECK_THAT(d.statement, !Catch::Contains("agrees"));
            CHECK_THAT(d.statement, Catch::Contains("the probability that no effect is missing is "));
            const bool stands = d.p <= kFamilyWise;
            CHECK((d.statement.find("The ensembles differ") == 0) == stands);
            ++(stands ? hints : open);
        }
    CHECK(hints > 0);
    CHECK(open > 0);
}

TEST_CASE("a bad ensemble file is rejected with line and column", "[diagnosis]") {
    const supercircle::test::Folder folder;
    const std::string head = "dissipation_ratio,snap_fits\n", rows = "0.1,1\n0.2,2\n0.15,1\n0.12,3\n";
    folder.write("good.csv", head + rows);
    folder.write("gap.csv", head + rows + ",2\n");
    folder.write("few.csv", head + "0.1,1\n");
    const auto said = [&](const std::string& rest) {
        const std::string file = folder.write("stacks.json", "{\n \"schema\": \"stack-ensembles/1\",\n" + rest + "}\n");
        const auto end =
            supercircle::test::start(std::string(SC_PROGRAM) + " diagnose " + file + " --out " + folder.path + "/out");
        CHECK((end.code == 2) == (end.text.find("stacks.json:") != std::string::npos));
        return end.text;
    };
    using Catch::Contains;
    const std::string both = " \"recorded\": \"good.csv\", \"nominal\": \"good.csv\"",
                      quantities = " \"quantities\": [\"dissipation_ratio\", \"snap_fits\"],\n";
    CHECK_THAT(said(quantities + both), !Contains("stacks.json:"));
    CHECK_THAT(said(quantities + " \"efects\": [],\n" + both),
               Contains("stacks.json:4:2: /efects: unknown key \"efects\"") && Contains("\"effects\"?"));
    CHECK_THAT(said(quantities + both + ",\n \"effects\": [{\"file\": \"good.csv\", \"lable\": \"wear\"}]"),
               Contains("stacks.json:5:35: /effects/0/lable: unknown key") && Contains("/effects/0"));
    CHECK_THAT(said(quantities + " \"nominal\": \"good.csv\""),
               Contains("stacks.json:1:1: \"recorded\" is missing") && Contains("CSV"));
    CHECK_THAT(said(quantities + " \"recorded\": 3, \"nominal\": \"good.csv\""),
               Contains("stacks.json:4:14: /recorded"));
    CHECK_THAT(said(quantities + " \"nominal\": \"good.csv\", \"recorded\": \"gap.csv\""),
               Contains("stacks.json:4:37: /recorded: ") && Contains("gap.csv:6: there is no dissipation_ratio"));
    CHECK_THAT(said(quantities + " \"nominal\": \"few.csv\", \"recorded\": \"good.csv\""),
               Contains("stacks.json:4:13: /nominal: ") && Contains("holds 1 stacks; expected at least 4"));
    CHECK_THAT(said(quantities + " \"nominal\": \"no.csv\", \"recorded\": \"good.csv\""),
               Contains("stacks.json:4:13: /nominal: ") && Contains("no.csv"));
    CHECK_THAT(said(" \"quantities\": \"dissipation_ratio\",\n" + both), Contains("stacks.json:3:16: /quantities"));
    CHECK_THAT(said(" \"quantities\": [],\n" + both), Contains("stacks.json:3:16: /quantities"));
}
