// How probable hypotheses are, and what is said of them.

#include "toy.h"

#include "plugin/identification/diagnosis/result/conclude.h"
#include "plugin/identification/diagnosis/selection/weigh.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace supercircle::diagnosis;

TEST_CASE("what leaves many times the noise is not named, and a broken forecast foretells nothing", "[diagnosis]") {
    HeldOut nothing;
    nothing.rows.setConstant(6, 100.0);
    nothing.volume.setZero(6);
    nothing.energy.setConstant(6, 1e6); // 100 times the noise
    HeldOut better = nothing, broken = nothing, failed;
    failed.failure = "the simulation of run 2 stopped"; // and there is nothing to count
    better.energy.setConstant(6, 2e3);                  // 99.8 % explained, and still 4.5 times the noise
    broken.energy[2] = std::numeric_limits<double>::quiet_NaN();
    Weighing given;
    given.catalogue = 20;
    given.p = 1e-6;
    const Weighed w = weigh(nothing, {better, usable(broken, nothing), usable(failed, nothing)}, given);
    CHECK(w.rejected);
    CHECK(w.effects[2] < 1e-6);
    CHECK(w.unknown > 0.5);
    CHECK(w.effects[1] < 1e-6);
    CHECK(w.nothing + w.unknown + w.effects[0] + w.effects[1] + w.effects[2] == Approx(1.0));
    // A pair that beats its part in some draws only counts for nothing, however far above all others it scores there.
    HeldOut pair = better;
    for (int k = 0; k < 6; ++k)
        pair.energy[k] = k == 0 ? 4e4 : 110.0; // by thousands
    given.parts = {{}, {}, {0}};
    const Weighed paired = weigh(nothing, {better, usable(broken, nothing), pair}, given);
    CHECK(paired.effects[2] == 0.0);
    CHECK(paired.nothing + paired.unknown + paired.effects[0] + paired.effects[1] == Approx(1.0));
    given.parts.clear();
    better.energy.setConstant(6, 120.0);
    const Weighed good = weigh(nothing, {better, usable(broken, nothing)}, given);
    CHECK_FALSE(good.rejected);
    CHECK(good.effects[0] > 0.9);
    // A peak in one place, of which nothing shows in the mean: what two simulators' differences leave there is no
    // reason.
    given.left = {7.6};
    CHECK(weigh(nothing, {better, usable(broken, nothing)}, given).effects[0] == good.effects[0]);
    given.left = {9.3};
    const Weighed peak = weigh(nothing, {better, usable(broken, nothing)}, given);
    CHECK(peak.rejected);
    CHECK(peak.unknown > 0.5);
    CHECK(peak.effects[0] < good.effects[0]);
    given.left = {0.0};
    given.swings = true; // what the runs are about goes on while the head stands still
    const Weighed beside = weigh(nothing, {better, usable(broken, nothing)}, given);
    CHECK(beside.rejected);
    CHECK(beside.unknown > 0.9);
}

TEST_CASE("a second effect counts beside a strong one that leaves too much by itself", "[diagnosis]") {
    HeldOut nothing;
    nothing.rows.setConstant(6, 100.0);
    nothing.volume.setZero(6);
    nothing.energy.setConstant(6, 3e4);
    HeldOut machine = nothing, pair = nothing;
    machine.energy.setConstant(6, 830.0); // 97.5 % explained, and 7.3 noise variances left
    pair.energy.setConstant(6, 100.0);
    Weighing given;
    given.catalogue = 20;
    given.p = 1e-6;
    given.prior = {0.03, 0.003};
    given.parts = {{}, {0}};
    const Weighed both = weigh(nothing, {machine, pair}, given);
    CHECK(both.best == 1);
    CHECK_FALSE(both.rejected);
    CHECK(both.effects[1] > 0.9);
    // As little beside one that leaves what two simulators differ by is no reason to believe in two causes, unless it
    // stands out in one place.
    machine.energy.setConstant(6, 300.0);
    const Weighed little = weigh(nothing, {machine, pair}, given);
    CHECK(little.effects[1] == 0.0);
    CHECK(little.best == 0);
    given.left = {4.6, 0.0};
    CHECK(weigh(nothing, {machine, pair}, given).effects[1] == 0.0);
    given.left = {7.4, 0.0};
    CHECK(weigh(nothing, {machine, pair}, given).effects[1] > 0.9);
}

TEST_CASE("an effect that leaves a third of the misfit stands for another one", "[diagnosis]") {
    HeldOut nothing;
    nothing.rows.setConstant(12, 100.0);
    nothing.volume.setZero(12);
    nothing.energy.setConstant(12, 220.0);
    Weighing given;
    given.catalogue = 20;
    given.p = 1e-3;
    const auto with = [&](double energy, double tails) {
        HeldOut effect = nothing;
        effect.energy.setConstant(12, energy);
        given.tails = tails;
        return weigh(nothing, {effect}, given);
    };
    // Noise of 1200 rows, its size known to 5 % and two standard errors of its energy: up to 1.18 a row.
    CHECK(with(137.0, 0.0).rejected); // relaxation, out of the catalogue, called softening left as much
    CHECK(with(137.0, 0.0).unknown > 0.5);
    CHECK_FALSE(with(115.0, 0.0).rejected);
    CHECK(with(115.0, 0.0).effects[0] > 0.8); // p = 0.001 is worth a factor of 53, no more
    CHECK_FALSE(with(125.0, 0.0).rejected);   // beyond the noise, but less than a tenth of what there was
    CHECK_FALSE(with(137.0, 30.0).rejected);  // where single readings scatter that much, it may be noise
}

TEST_CASE("a gain that chance does not give counts, however unevenly it is spread", "[diagnosis]") {
    // 24 blocks of 50 rows; an effect that shows in two of them and costs a little in all.
    const auto held = [](double inTwo, double elsewhere) {
        HeldOut h;
        h.rows = Eigen::VectorXd::Constant(24, 50.0);
        h.energy = Eigen::VectorXd::Constant(24, 50.0 - elsewhere);
        h.energy.head(2).array() -= inTwo; // of two blocks, half of it counts
        h.volume = Eigen::VectorXd::Zero(24);
        return h;
    };
    const HeldOut nothing = held(0.0, 0.0);
    Weighing given;
    given.catalogue = 25;
    given.p = 0.001;
    const Weighed shown = weigh(nothing, {held(17.6, -0.3)}, given); // gains 14 in log score
    CHECK(shown.gain[0] == Approx(14.0));
    CHECK(shown.gainLow[0] <= 0.0); // two blocks of 24: two standard errors do not hold
    CHECK(shown.nothing < 0.4);
    const Weighed chance = weigh(nothing, {held(6.6, -0.3)}, given); // z = 2.4, of some forty hypotheses
    CHECK(chance.nothing > 0.8);
    given.p = 0.3; // and nothing stands out of the noise: the family-wise bound holds mass back
    CHECK(weigh(nothing, {held(17.6, -0.3)}, given).nothing > 0.25);
}

TEST_CASE("p has paid for the whole search, however many effects were worth a fit", "[diagnosis]") {
    const auto held = [](double less) {
        HeldOut h;
        h.rows = Eigen::VectorXd::Constant(24, 50.0);
        h.energy = Eigen::VectorXd::Constant(24, 50.0 - less);
        h.volume = Eigen::VectorXd::Zero(24);
        return h;
    };
    Weighing given;
    given.catalogue = 20;
    given.p = 0.02;
    // The odds of 3 to 7 over the largest Bayes factor that p allows, 1 / (-e p ln p) = 4.70.
    const double odds = 3.0 / 7.0 * -std::exp(1.0) * 0.02 * std::log(0.02);
    for (const std::size_t fitted : {1, 3, 6})
        CHECK(weigh(held(0.0), std::vector<HeldOut>(fitted, held(5.0)), given).nothing ==
              Approx(odds / (1.0 + odds)).epsilon(1e-6));
}

TEST_CASE("a law learned alone leaves the catalogue's prior with nothing", "[diagnosis]") {
    HeldOut h;
    h.rows = Eigen::VectorXd::Constant(24, 50.0);
    h.energy = h.rows;
    h.volume = Eigen::VectorXd::Zero(24);
    Weighing given;
    given.catalogue = 1; // were the law an effect of it, nothing would be left
    given.prior = {0.05};
    given.parts = {{}};
    given.outside = {1};
    // Both foretell the same, so their shares are the priors': .3 and .6 to .05; "none of these" foretells worse.
    CHECK(weigh(h, {h}, given).nothing > 0.9 / (0.9 + 0.05 + 0.1) - 1e-9);
}

TEST_CASE("something is missing only where something stands out of the noise", "[diagnosis]") {
    Evidence e;
    e.any = true;
    e.p = 0.2;
    e.nothing = 0.3;
    e.bestGroup = 0.7;
    CHECK(verdictOf(e) == "not_enough_information");
    e.p = 0.01;
    CHECK(verdictOf(e) == "ambiguous");
    e.nothing = 0.9;
    CHECK(verdictOf(e) == "not_enough_information"); // a hint, though hardly believed
    e.p = 0.2;
    CHECK(verdictOf(e) == "nothing_missing");
    // A gain that chance does not give need not be spread over many blocks.
    e = {};
    e.any = true;
    e.p = 0.005;
    e.nothing = 0.03;
    e.bestGroup = 0.95;
    e.gainLow = -0.5;
    e.gain = 14.0;
    CHECK(verdictOf(e) == "named");
    e.gain = 5.0;
    CHECK(verdictOf(e) == "ambiguous");
}

TEST_CASE("an undecided verdict says how probable each rival is, effects that act together as one", "[diagnosis]") {
    Diagnosis d;
    d.verdict = "ambiguous";
    d.nothing = 0.1;
    d.unknown = 0.01;
    for (const char* label : {"sensor_drift", "planar_drag", "gravity"}) {
        FoundEffect f;
        f.label = label;
        f.group = {f.label};
        f.probability = 0.8;
        d.effects.push_back(f);
    }
    d.effects[0].with = {"planar_drag"};
    d.effects[1].with = {"sensor_drift"};
    d.effects[2].probability = 0.09;
    Evidence e;
    e.p = 0.01;
    const std::string said = statementOf(d, e);
    CHECK(said.find("sensor drift with planar drag 80 %, gravity 9 %, nothing missing 10 %.") != std::string::npos);
    CHECK(said.find("none of these") == std::string::npos); // 1 %
    CHECK_THAT(said, !Catch::Contains("further runs"));     // nobody has looked for one
    d.nextTried = 6;
    CHECK_THAT(statementOf(d, e), Catch::Contains("None of the 6 further runs that were looked at"));

    d.verdict = "named"; // values of both that act, and none of what is shown by another hypothesis
    d.effects[0].parameters = {{"a_N", "N", 0.25, {}}};
    d.effects[1].parameters = {{"f_N_m", "N/m", 0.5, {}}};
    CHECK(statementOf(d, e).find(
              "explained by sensor drift: a_N = 0.25 N; together with planar drag: f_N_m = 0.5 N/m;") !=
          std::string::npos);
    d.effects[1].with.clear();
    CHECK(statementOf(d, e).find("a_N = 0.25 N; together with planar drag; on runs") != std::string::npos);

    d.noise.white = 0.01; // N
    d.improvedHeldOut = 0.012;
    CHECK(statementOf(d, e).find("The runs are explained by") == 0);
    CHECK(statementOf(d, e).find("something else acts beside it") == std::string::npos);
    d.improvedHeldOut = 0.015;
    CHECK(statementOf(d, e).find("Most of what the runs show is explained by") == 0);
    CHECK(statementOf(d, e).find("something else acts beside it") != std::string::npos);

    // "The error falls from 0.00106 to 0.00106 N" is no reason to believe in anything.
    d.effects[0].gain = 12.0; // 10^5.2
    d.baselineHeldOut = 0.02;
    CHECK_THAT(statementOf(d, e),
               Catch::Contains("the error of a reading falls from 0.02 to 0.015") && !Catch::Contains("10^"));
    d.baselineHeldOut = 0.015003;
    CHECK_THAT(statementOf(d, e), Catch::Contains("stays at 0.015") && Catch::Contains("10^5 times as probable"));
    d.baselineHeldOut = 0.0145;
    CHECK_THAT(statementOf(d, e), Catch::Contains("rises from 0.0145 to 0.015") && Catch::Contains("10^5 times"));
}

TEST_CASE("what may be there too small to be seen is not nothing", "[diagnosis]") {
    const double inf = std::numeric_limits<double>::infinity();
    std::vector<SeenEffect> seen(6);
    const double visible[] = {0.0, 0.5, 1.0, 3.0, inf, 0.2};
    for (std::size_t k = 0; k < seen.size(); ++k) {
        seen[k].label = std::string(1, static_cast<char>('a' + k));
        seen[k].visible = visible[k];
    }
    // The last one was fitted. Shares of .6 / 6 = .1: 0, .05, .1, .1, .1 beside .3 for nothing.
    const double nothing = shareUnseen(0.8, {"f"}, seen);
    CHECK(nothing == Approx(0.8 * 0.3 / 0.65));
    CHECK(seen[0].unseen == 0.0);
    CHECK(seen[1].unseen == Approx(0.8 * 0.05 / 0.65));
    for (const std::size_t k : {2u, 3u, 4u})
        CHECK(seen[k].unseen == Approx(0.8 * 0.1 / 0.65));
    CHECK(seen[5].unseen == 0.0);
    double sum = nothing;
    for (const SeenEffect& s : seen)
        sum += s.unseen;
    CHECK(sum == Approx(0.8)); // nothing else has more or less of it
    std::vector<SeenEffect> none;
    CHECK(shareUnseen(0.8, {}, none) == Approx(0.8));
}
