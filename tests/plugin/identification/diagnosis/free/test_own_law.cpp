// Laws that the user writes down, against the same laws of the catalogue.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/model/own_law.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/identification/replay/simulate.h"
#include "supercircle/effects/laws/elastic_law.h"
#include "supercircle/effects/surface.h"

#include "tests/plugin/identification/diagnosis/belt.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using namespace supercircle::diagnosis;
using Catch::Contains;

namespace {

effects::Model modelOf(const std::string& formula, const std::vector<double>& values, const OwnLawRange& range) {
    const auto law = readOwnLaw("mine", formula);
    INFO(law.error());
    REQUIRE(law);
    const auto setting = settingOf(*law, values, range);
    INFO(setting.error());
    REQUIRE(setting);
    return effects::modelFor({*setting}, "all");
}

std::string refusal(const std::string& formula, const std::vector<double>& values = {}) {
    const auto law = readOwnLaw("mine", formula);
    return law ? settingOf(*law, values, {}).error() : law.error();
}

/// At 1 and 10 mm/s.
experiment::Experiment twoSpeeds() {
    return belt(R"("mu": {"value": 0.4, "unc": 0.01})",
                R"("drive_time_s": [0, 2, 4, 6], "drive_displacement_mm": [0, 2, 22, 28])");
}

} // namespace

TEST_CASE("a friction law by formula is the catalogue's law of that formula", "[diagnosis][own_law]") {
    const OwnLawRange range{1e-3, 0.1, 100.0};
    const effects::FrictionModel mine = modelOf("mu*(1+a*log(1+v/v0))", {0.1, 2e-4}, range).contact.friction;
    effects::FrictionModel known;
    known.rate = effects::FrictionModel::Rate::Logarithmic;
    known.rateStrength = 0.1;
    known.rateSpeed = 2e-4;
    // A cubic spline with four knots a decade errs by 2e-6 here; the table covers 1e-6 to 1 m/s.
    for (const double v : {1e-6, 3e-5, 2e-4, 7.3e-4, 0.012, 0.9})
        CHECK(effects::frictionFactor(mine, {}, v, 0.0) ==
              Approx(effects::frictionFactor(known, {}, v, 0.0)).epsilon(0.0).margin(5e-6));
    const effects::FrictionModel worn = modelOf("mu*(1 + c*(1 - exp(-s/d)))", {-0.3, 0.03}, range).contact.friction;
    effects::Site site;
    for (const double s : {0.0, 0.004, 0.031, 0.099}) {
        site.slid = s;
        CHECK(effects::frictionFactor(worn, site, 0.0, 0.0) ==
              Approx(1.0 - 0.3 * (1.0 - std::exp(-s / 0.03))).epsilon(0.0).margin(1e-6));
    }
}

TEST_CASE("a moment by formula is the catalogue's law of that formula", "[diagnosis][own_law]") {
    const effects::ElasticModel mine = modelOf("B*u/sqrt(1+(u/uc)^2)", {40.0}, {1e-3, 0.1, 100.0}).material.elastic;
    const effects::ElasticModel known{effects::ElasticModel::Law::Softening, 40.0, 3.0};
    // Knots at every tenth of the knee: 1.4e-5 of the slope, and its integrals over 100 1/m.
    for (const double u : {-90.0, -13.0, 0.0, 0.7, 22.0, 41.0, 99.0}) {
        CHECK(effects::evaluate(mine, u).value == Approx(effects::evaluate(known, u).value).epsilon(0.0).margin(1e-4));
        CHECK(effects::evaluate(mine, u).slope == Approx(effects::evaluate(known, u).slope).epsilon(0.0).margin(3e-5));
        CHECK(effects::evaluate(mine, u).energy ==
              Approx(effects::evaluate(known, u).energy).epsilon(0.0).margin(3e-3));
    }
}

TEST_CASE("laws that say nothing, say two things or cannot be are refused with the reason", "[diagnosis][own_law]") {
    CHECK_THAT(refusal("a*v"), Contains("says of nothing known") && Contains("mu times a factor of v"));
    CHECK_THAT(refusal("mu*(1+v+s)"), Contains("two things"));
    CHECK_THAT(refusal("mu*(1+a*log(1+v/v0)"), Contains("cannot be read at character"));
    CHECK_THAT(refusal("mu*(1+a*lg(v))"), Contains("cannot be read"));
    CHECK_THAT(refusal("mu + a*v", {1.0}), Contains("not in proportion to mu"));
    CHECK_THAT(refusal("mu*(1+a*v/v0)", {1.0, 0.0}), Contains("has no value at v"));
    CHECK_THAT(refusal("mu*(1-2*v/v)"), Contains("not 0.05 to 100 times") || Contains("no value"));
    CHECK_THAT(refusal("B*u*(1-(u/uc)^2)", {10.0}), Contains("hardly rises with curvature"));
    CHECK_THAT(refusal("B*(u+5)"), Contains("another law for bending the other way"));
    CHECK_THAT(refusal("B*u*(1+a*u)", {0.001}), Contains("another law for bending the other way"));

    std::vector<StartedLaw> laws;
    const auto taken = [&](std::vector<std::string> texts) {
        laws.clear();
        return takeOwnLaws(texts, laws);
    };
    CHECK(taken({"gravity:x_m_s2=1", "mine:mu*(1+a*v/v0)", "mine:a=0.1", "mine:v0=1e-3"}) == "");
    REQUIRE(laws.size() == 1);
    CHECK(laws[0].values == std::vector<double>{0.1, 1e-3});
    CHECK_THAT(taken({"mine:mu*(1+a*v)"}),
               Contains("the parameter a has no value") && Contains("--effect mine:a=VALUE"));
    CHECK_THAT(taken({"mine:mu*(1+a*v)", "mine:b=1"}), Contains("no parameter \"b\""));
    CHECK_THAT(taken({"mine:mu*(1+a*v)", "mine:a=x"}), Contains("expected a number"));
    CHECK_THAT(taken({"mine:mu*(1+a*v)", "mien:a=1", "mine:a=2"}), Contains("mine"));
    CHECK_THAT(taken({"mine:mu*(1+v)", "mine:mu*(2+v)"}), Contains("given twice"));
    CHECK_THAT(taken({"my law:mu*(1+v)"}), Contains("no name for a law"));
    CHECK_THAT(taken({"nothing:mu*(1+v)"}), Contains("results use this one"));
    CHECK(taken({"mine:a=0.1", "mine:mu*(1+a*(v>=0.01))"}) == ""); // in any order, with comparisons
    REQUIRE(laws.size() == 1);
    CHECK(laws[0].values == std::vector<double>{0.1});
    // A slip in the name of an effect is still one of an effect.
    std::vector<std::string> texts{"plasticty:My_over_B_1_m=3"};
    replay::Parameters p;
    CHECK_THAT(addEffects(texts, twoSpeeds(), p), Contains("there is no effect \"plasticty\""));
}

TEST_CASE("a replay with a law of one's own is that with the catalogue's", "[diagnosis][own_law]") {
    const experiment::Experiment e = twoSpeeds();
    const auto forces = [&](const std::vector<std::string>& texts) {
        replay::Parameters p = replay::nominal(e);
        REQUIRE(addEffects(texts, e, p) == "");
        const replay::Simulated s = replay::simulate(e, 0, p, replay::Resolution::fine());
        REQUIRE(s.failure == "");
        return s.readings.force;
    };
    const auto mine = forces({"mine:mu*(1+a*log(1+v/v0))", "mine:a=0.03", "mine:v0=1e-3"}),
               known = forces({"rate_dependent_friction:law=logarithmic", "rate_dependent_friction:strength=0.03",
                               "rate_dependent_friction:speed_m_s=1e-3"});
    REQUIRE(mine.size() == known.size());
    for (std::size_t i = 0; i < mine.size(); ++i)
        REQUIRE(mine[i] == Approx(known[i]).margin(1e-4)); // 4 N times 0.03 times the error of the table
    replay::Parameters p = replay::nominal(e);
    CHECK_THAT(addEffects({"mine:B*u*(1+(u/a)^2)", "mine:a=10"}, e, p), Contains("nothing to act on"));
}

TEST_CASE("a law of one's own is found where it acts and its numbers with it", "[diagnosis][own_law]") {
    // The truth is the formula itself, played by the catalogue's law: 0.05 per e-fold, 7 % between both speeds.
    experiment::Experiment e = twoSpeeds();
    replay::Parameters truth = replay::nominal(e);
    for (const char* text : {"law=logarithmic", "strength=0.05", "speed_m_s=2e-3"})
        REQUIRE(effects::add(truth.effects, std::string("rate_dependent_friction:") + text).empty());
    e.runs.front().readings = replay::simulate(e, 0, truth, replay::Resolution::fine()).readings;
    std::uint64_t seed = 7;
    const auto uniform = [&] { // splitmix64
        std::uint64_t z = (seed += 0x9E3779B97F4A7C15ULL);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
        return (static_cast<double>((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
    };
    for (double& f : e.runs.front().readings.force)
        f += 0.003 * std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * M_PI * uniform());
    ReplayModel model(e, catalogueWithout({})); // alone: the catalogue has the same law and would share its probability
    std::vector<std::string> texts{"mine:mu*(1+a*log(1+v/v0))", "mine:a=0.2", "mine:v0=1e-3"};
    std::vector<StartedLaw> laws;
    REQUIRE(takeOwnLaws(texts, laws) == "");
    REQUIRE(model.add(laws.front()) == "");
    const Diagnosis d = shortDiagnosis(model, e);
    INFO(d.statement);
    REQUIRE(d.failure.empty());
    REQUIRE(!d.effects.empty());
    CHECK(d.effects.front().label == "mine");
    CHECK(d.effects.front().probability > 0.9);
    const StoredFits fits = storedFitsOf(model, e, d);
    replay::Parameters p = replay::nominal(e);
    REQUIRE(setTo(fits.fits.front(), e, p) == ""); // a stored law of one's own can be replayed
    const auto at = replay::simulate(e, 0, p, replay::Resolution::fine()).readings.force;
    double sum = 0.0, square = 0.0; // the zero of a run is a nuisance of the fit, not of a replay
    for (std::size_t i = 0; i < at.size(); ++i) {
        const double left = at[i] - e.runs.front().readings.force[i];
        sum += left;
        square += left * left;
    }
    const double rows = static_cast<double>(at.size());
    CHECK(std::sqrt(square / rows - sum * sum / rows / rows) < 1.1 * 0.003);

    StartedLaw stiff = laws.front();
    stiff.law = *readOwnLaw("stiff", "mu*(2+v/v0)");
    stiff.values = {1.0};
    CHECK_THAT(model.add(stiff), Contains("cannot be fitted"));
    // A scale inside an exponential is none of its amplitudes, although the law vanishes where it is 0.
    stiff.law = *readOwnLaw("stribeck", "mu*(1+a*exp(-v/v0))");
    stiff.values = {0.2, 1e-3};
    REQUIRE(model.add(stiff) == "");
    const CandidateEffect& added = model.candidates().back();
    REQUIRE(added.parameters.size() == 2);
    CHECK(added.parameters[0].amplitude);
    CHECK_FALSE(added.parameters[1].amplitude);
    CHECK(added.parameters[1].scale == Scale::Logarithm);
    stiff.values = {0.0, 1e-3};
    CHECK_THAT(model.add(stiff), Contains("says nothing with these values"));
}
