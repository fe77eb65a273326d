// Model weights and the statement.

#include "toy.h"

#include "plugin/identification/diagnosis/result/verdict.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace supercircle::diagnosis;

TEST_CASE("a large residual is not identified, and a failed prediction has no weight", "[diagnosis]") {
    PredictiveScore baseline;
    baseline.rows.setConstant(6, 100.0);
    baseline.volume.setZero(6);
    baseline.energy.setConstant(6, 1e6); // 100 times the noise
    PredictiveScore better = baseline, broken = baseline, failed;
    failed.failure = "the simulation of run 2 stopped"; // and there are no rows
    better.energy.setConstant(6, 2e3);                  // 99.8 % explained, and still 4.5 times the noise
    broken.energy[2] = std::numeric_limits<double>::quiet_NaN();
    WeightingInput given;
    given.catalogue = 20;
    given.p = 1e-6;
    given.residualP = 1e-6;
    const ModelWeights w = modelWeights(baseline, {better, usable(broken, baseline), usable(failed, baseline)}, given);
    CHECK(w.rejected);
    CHECK(w.effects[2] < 1e-6);
    CHECK(w.outsideCatalogue > 0.5);
    CHECK(w.effects[1] < 1e-6);
    CHECK(w.adequate + w.outsideCatalogue + w.effects[0] + w.effects[1] + w.effects[2] == Approx(1.0));
    // A pair that beats its component in some draws only does not count, however large its score in those.
    PredictiveScore pair = better;
    for (int k = 0; k < 6; ++k)
        pair.energy[k] = k == 0 ? 4e4 : 110.0; // by thousands
    given.mustBeat = {{}, {}, {0}};
    const ModelWeights paired = modelWeights(baseline, {better, usable(broken, baseline), pair}, given);
    CHECK(paired.effects[2] == 0.0);
    CHECK(paired.adequate + paired.outsideCatalogue + paired.effects[0] + paired.effects[1] == Approx(1.0));
    given.mustBeat.clear();
    given.residualP = 1.0;
    better.energy.setConstant(6, 120.0);
    const ModelWeights good = modelWeights(baseline, {better, usable(broken, baseline)}, given);
    CHECK_FALSE(good.rejected);
    CHECK(good.effects[0] > 0.9);
    // What a law leaves is judged by its significance: no step from certain to refuted, and above 0.05 it counts
    // nothing.
    given.residualP = 1e-6; // two forms of one law: 2e-5 of the misfit
    CHECK(modelWeights(baseline, {better, usable(broken, baseline)}, given).effects[0] == good.effects[0]);
    better.energy.setConstant(6, 400.0); // 3e-4 of it
    given.residualP = 0.051;
    CHECK(modelWeights(baseline, {better, usable(broken, baseline)}, given).effects[0] > 0.9);
    double before = 0.5; // of equal scores 0.1 to 0.03 decide
    for (const double p : {0.05, 0.01, 0.001, 1e-6}) {
        given.residualP = p;
        const ModelWeights peak = modelWeights(baseline, {better, usable(broken, baseline)}, given);
        CHECK(peak.rejected);
        CHECK(peak.outsideCatalogue > before);
        // Odds: the ratio of the priors times the largest Bayes factor of p, where the score is that of the best.
        CHECK(peak.outsideCatalogue / peak.effects[0] == Approx(0.1 / (0.6 / 20) / -std::exp(1.0) / p / std::log(p)));
        before = peak.outsideCatalogue;
    }
    given.residualP = 1.0;
    better.energy.setConstant(6, 120.0);
    // More than any true effect leaves, and a forecast that fails: two reasons, and no coin is thrown between them.
    PredictiveScore fan = better;
    fan.energy.setConstant(6, 700.0);
    given.forecastFails = {1, 0};
    const ModelWeights refuted = modelWeights(baseline, {fan, usable(broken, baseline)}, given);
    CHECK(refuted.rejected);
    CHECK(refuted.outsideCatalogue > 0.98); // odds of exp(5)
    CHECK(modelWeights(baseline, {better, usable(broken, baseline)}, given).outsideCatalogue < 0.9);
    given.forecastFails.clear();
    given.periodicDisturbance = true; // the dominant disturbance continues while the crosshead rests
    const ModelWeights beside = modelWeights(baseline, {better, usable(broken, baseline)}, given);
    CHECK(beside.rejected);
    CHECK(beside.outsideCatalogue > 0.9);
}

TEST_CASE("a second effect counts beside a strong one with a large residual", "[diagnosis]") {
    PredictiveScore baseline;
    baseline.rows.setConstant(6, 100.0);
    baseline.volume.setZero(6);
    baseline.energy.setConstant(6, 3e4);
    PredictiveScore machine = baseline, pair = baseline;
    machine.energy.setConstant(6, 830.0); // 97.5 % explained, 7.3 noise variances remain
    pair.energy.setConstant(6, 100.0);
    WeightingInput given;
    given.catalogue = 20;
    given.p = 1e-6;
    given.prior = {0.03, 0.003};
    given.mustBeat = {{}, {0}};
    const ModelWeights both = modelWeights(baseline, {machine, pair}, given);
    CHECK(both.best == 1);
    CHECK_FALSE(both.rejected);
    CHECK(both.effects[1] > 0.9);
    // The same small gain beside an effect with a residual of simulator size does not support two effects, unless one
    // window is large.
    machine.energy.setConstant(6, 300.0);
    const ModelWeights little = modelWeights(baseline, {machine, pair}, given);
    CHECK(little.effects[1] == 0.0);
    CHECK(little.best == 0);
    given.largestZ = {4.6, 0.0};
    CHECK(modelWeights(baseline, {machine, pair}, given).effects[1] == 0.0);
    given.largestZ = {7.4, 0.0};
    CHECK(modelWeights(baseline, {machine, pair}, given).effects[1] > 0.9);
}

TEST_CASE("an effect that leaves a third of the misfit is worth another fit", "[diagnosis]") {
    PredictiveScore baseline;
    baseline.rows.setConstant(12, 100.0);
    baseline.volume.setZero(12);
    baseline.energy.setConstant(12, 220.0);
    const auto large = [&](double energy, double excessKurtosis, double largestZ) {
        PredictiveScore effect = baseline;
        effect.energy.setConstant(12, energy);
        return leavesTooLargeResidual(baseline, effect, excessKurtosis, 1.0, largestZ);
    };
    // Noise of 1200 rows, known to 5 %, with two standard errors: up to 1.18 per row.
    CHECK(large(137.0, 0.0, 0.0)); // relaxation, removed from the catalogue, imitated by softening left as much
    CHECK_FALSE(large(115.0, 0.0, 0.0));
    CHECK_FALSE(large(125.0, 0.0, 0.0));  // beyond the noise, but less than a tenth of the excess
    CHECK_FALSE(large(137.0, 30.0, 0.0)); // with such heavy tails it may be noise
    CHECK_FALSE(large(115.0, 0.0, 7.6));
    CHECK(large(115.0, 0.0, 9.3)); // a local peak without a visible mean, larger than simulator differences
}

TEST_CASE("a gain beyond chance counts in however few blocks", "[diagnosis]") {
    // 24 blocks of 50 rows; an effect visible in two of them and slightly worse in all.
    const auto held = [](double inTwo, double elsewhere) {
        PredictiveScore h;
        h.rows = Eigen::VectorXd::Constant(24, 50.0);
        h.energy = Eigen::VectorXd::Constant(24, 50.0 - elsewhere);
        h.energy.head(2).array() -= inTwo; // of two blocks, half of it counts
        h.volume = Eigen::VectorXd::Zero(24);
        return h;
    };
    const PredictiveScore baseline = held(0.0, 0.0);
    WeightingInput given;
    given.catalogue = 25;
    given.p = 0.001;
    const ModelWeights shown = modelWeights(baseline, {held(17.6, -0.3)}, given); // gains 14 in log score
    CHECK(shown.gain[0] == Approx(14.0));
    CHECK(shown.gainLow[0] <= 0.0); // two blocks of 24: not significant by two standard errors
    CHECK(shown.adequate < 0.4);
    const ModelWeights chance = modelWeights(baseline, {held(6.6, -0.3)}, given); // z = 2.4, of some forty hypotheses
    CHECK(chance.adequate > 0.8);
    given.p = 0.3; // and without a significant misfit the family-wise bound applies
    CHECK(modelWeights(baseline, {held(17.6, -0.3)}, given).adequate > 0.25);
}

TEST_CASE("the family-wise bound does not depend on the number of fitted effects", "[diagnosis]") {
    const auto held = [](double less) {
        PredictiveScore h;
        h.rows = Eigen::VectorXd::Constant(24, 50.0);
        h.energy = Eigen::VectorXd::Constant(24, 50.0 - less);
        h.volume = Eigen::VectorXd::Zero(24);
        return h;
    };
    WeightingInput given;
    given.catalogue = 20;
    given.p = 0.02;
    // The odds of 3 to 7 over the largest Bayes factor that p allows, 1 / (-e p ln p) = 4.70.
    const double odds = 3.0 / 7.0 * -std::exp(1.0) * 0.02 * std::log(0.02);
    for (const std::size_t fitted : {1, 3, 6})
        CHECK(modelWeights(held(0.0), std::vector<PredictiveScore>(fitted, held(5.0)), given).adequate ==
              Approx(odds / (1.0 + odds)).epsilon(1e-6));
}

TEST_CASE("a learned law alone leaves the catalogue's prior to the baseline", "[diagnosis]") {
    PredictiveScore h;
    h.rows = Eigen::VectorXd::Constant(24, 50.0);
    h.energy = h.rows;
    h.volume = Eigen::VectorXd::Zero(24);
    WeightingInput given;
    given.catalogue = 1; // if the law were a catalogue effect, no prior would remain
    given.prior = {0.05};
    given.mustBeat = {{}};
    given.outside = {1};
    // Both predict equally, so their shares are the priors, 0.3 and 0.6 to 0.05; "outside the catalogue" predicts
    // worse.
    CHECK(modelWeights(h, {h}, given).adequate > 0.9 / (0.9 + 0.05 + 0.1) - 1e-9);
}

TEST_CASE("an effect is missing only if the misfit is significant", "[diagnosis]") {
    Evidence e;
    e.any = true;
    e.p = 0.2;
    e.adequate = 0.3;
    e.groupProbability = 0.7;
    CHECK(verdictOf(e) == "inconclusive");
    e.p = 0.01;
    CHECK(verdictOf(e) == "ambiguous");
    e.adequate = 0.9;
    CHECK(verdictOf(e) == "inconclusive"); // weak evidence
    e.p = 0.2;
    CHECK(verdictOf(e) == "adequate");
    // A gain beyond chance may come from few blocks.
    e = {};
    e.any = true;
    e.p = 0.005;
    e.adequate = 0.03;
    e.groupProbability = 0.95;
    e.gainLow = -0.5;
    e.gain = 14.0;
    CHECK(verdictOf(e) == "identified");
    e.gain = 5.0;
    CHECK(verdictOf(e) == "ambiguous");
}

TEST_CASE("an ambiguous verdict lists the probabilities of the hypotheses", "[diagnosis]") {
    Diagnosis d;
    d.verdict = "ambiguous";
    d.adequate = 0.1;
    d.outsideCatalogue = 0.01;
    for (const char* label : {"sensor_drift", "planar_drag", "gravity"}) {
        FittedEffect f;
        f.label = label;
        f.confoundedWith = {f.label};
        f.probability = 0.8;
        d.effects.push_back(f);
    }
    d.effects[0].jointWith = {"planar_drag"};
    d.effects[1].jointWith = {"sensor_drift"};
    d.effects[2].probability = 0.09;
    Evidence e;
    e.p = 0.01;
    const std::string said = statementOf(d, e);
    CHECK(said.find("sensor drift with planar drag 80 %, gravity 9 %, no missing effect 10 %.") != std::string::npos);
    CHECK(said.find("outside the catalogue") == std::string::npos); // 1 %
    CHECK_THAT(said, !Catch::Contains("candidate runs"));           // none was searched
    d.candidateRunsConsidered = 6;
    CHECK_THAT(statementOf(d, e), Catch::Contains("None of the 6 candidate runs"));

    d.verdict = "identified"; // values of both joint effects, none of another hypothesis
    d.effects[0].parameters = {{"a_N", "N", 0.25, {}}};
    d.effects[1].parameters = {{"f_N_m", "N/m", 0.5, {}}};
    CHECK(
        statementOf(d, e).find("explained by sensor drift: a_N = 0.25 N; jointly with planar drag: f_N_m = 0.5 N/m;") !=
        std::string::npos);
    d.effects[1].jointWith.clear();
    CHECK(statementOf(d, e).find("a_N = 0.25 N; jointly with planar drag; on held-out runs") != std::string::npos);
    d.forecast.runs = {{"swing.csv", 1.0, 0.8, true}}; // free runs are not left out
    CHECK(statementOf(d, e).find("; in forecasts of the later part of each run") != std::string::npos);
    d.forecast.runs.clear();

    d.noise.white = 0.01; // N
    d.improvedHeldOut = 0.012;
    CHECK(statementOf(d, e).find("The runs are explained by") == 0);
    CHECK(statementOf(d, e).find("another effect acts too") == std::string::npos);
    d.residualAfterBest.p = 0.02; // one statistic for the sentence and the table of windows
    CHECK(statementOf(d, e).find("Most of the misfit is explained by") == 0);
    CHECK(statementOf(d, e).find("another effect acts too") != std::string::npos);

    // A fall below the printed accuracy is not reported.
    d.improvedHeldOut = 0.015;
    d.effects[0].gain = 12.0; // 10^5.2
    d.baselineHeldOut = 0.02;
    CHECK_THAT(statementOf(d, e),
               Catch::Contains("the error of a reading falls from 0.02 to 0.015") && !Catch::Contains("10^"));
    d.baselineHeldOut = 0.015003;
    CHECK_THAT(statementOf(d, e), Catch::Contains("stays at 0.015") && Catch::Contains("10^5 times as probable"));
    d.baselineHeldOut = 0.0145;
    CHECK_THAT(statementOf(d, e), Catch::Contains("rises from 0.0145 to 0.015") && Catch::Contains("10^5 times"));
}

TEST_CASE("effects too small to be detected have a probability of their own", "[diagnosis]") {
    const double inf = std::numeric_limits<double>::infinity();
    std::vector<ScreenedEffect> screening(6);
    const double visible[] = {0.0, 0.5, 1.0, 3.0, inf, 0.2};
    for (std::size_t k = 0; k < screening.size(); ++k) {
        screening[k].label = std::string(1, static_cast<char>('a' + k));
        screening[k].detectable = visible[k];
    }
    // The last one was fitted. Shares of 0.6 / 6 = 0.1: 0, 0.05, 0.1, 0.1, 0.1 beside 0.3 for adequate.
    const double baseline = splitUndetectable(0.8, {"f"}, screening);
    CHECK(baseline == Approx(0.8 * 0.3 / 0.65));
    CHECK(screening[0].undetectable == 0.0);
    CHECK(screening[1].undetectable == Approx(0.8 * 0.05 / 0.65));
    for (const std::size_t k : {2u, 3u, 4u})
        CHECK(screening[k].undetectable == Approx(0.8 * 0.1 / 0.65));
    CHECK(screening[5].undetectable == 0.0);
    double sum = baseline;
    for (const ScreenedEffect& s : screening)
        sum += s.undetectable;
    CHECK(sum == Approx(0.8)); // the others are unchanged
    std::vector<ScreenedEffect> none;
    CHECK(splitUndetectable(0.8, {}, none) == Approx(0.8));
}
