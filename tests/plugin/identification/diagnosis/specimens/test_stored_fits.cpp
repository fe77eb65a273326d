// Fits of a diagnosis in a replay: repeated, or their law carried to another section.

#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/pages/diagnosis/stored_fits_json.h"
#include "plugin/recording/experiment/load.h"
#include "tests/support/folder.h"
#include "tests/support/json.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

using namespace supercircle;
using Catch::Contains;

namespace {

std::string baselinePath(int number) {
    return std::string(SC_TEST_DATA) + "/recordings/baseline/case_" + std::to_string(number) + "/experiment.json";
}

experiment::Experiment baseline(int number) {
    auto loaded = experiment::load(baselinePath(number));
    REQUIRE(loaded);
    return *loaded;
}

effects::Setting effect(const std::string& key, const std::vector<std::pair<std::string, double>>& values) {
    effects::Setting s = effects::off(*effects::find(key));
    for (const auto& [name, value] : values)
        REQUIRE(effects::set(s, name, value).empty());
    return s;
}

double valueOf(const diagnosis::CarriedLaw& law, const std::string& key, const std::string& name) {
    const effects::Effect& e = *effects::find(key);
    for (const effects::Setting& s : law.effects)
        for (std::size_t i = 0; i < e.parameters.size() && s.key == e.key; ++i)
            if (e.parameters[i].name == name)
                return s.values[i];
    return std::nan("");
}

/// Writes a diagnosis.json with these fits.
std::string written(const test::Folder& folder, const diagnosis::StoredFits& fits) {
    const std::string file = folder.path + "/diagnosis.json";
    std::ofstream(file) << nlohmann::ordered_json{{"schema", "supercircle-diagnosis/2"},
                                                  {"replay", nlohmann::ordered_json::parse(cli::storedFitsJson(fits))}};
    return file;
}

test::CommandResult replayed(const std::string& arguments) {
    return test::start(std::string(SC_PROGRAM) + " replay " + arguments);
}

} // namespace

TEST_CASE("a stored fit is read back to the last bit", "[diagnosis]") {
    const test::Folder folder;
    const experiment::Experiment e = baseline(GENERATE(101, 103));
    replay::Parameters p = replay::nominal(e);
    for (const replay::ParameterInfo& info : replay::parameterList(e))
        if (info.stated.halfWidth > 0.0)
            REQUIRE(replay::set(p, e, info.name, info.stated.value + info.stated.halfWidth / 3.0).empty());
    p.effects = {effect("plasticity", {{"My_over_B_1_m", 100.0 / 3.0}, {"hardening", 1.0}}),
                 effect("sensor_drift", {{"a_N", 1.0 / 7.0}})};
    diagnosis::StoredFit fit = diagnosis::storedFit(e, p);
    fit.label = "plasticity";
    fit.drawn = true;
    const std::string file = written(folder, {diagnosis::checkSumOf(e), {fit}});
    const auto read = cli::readStoredFits(file);
    INFO(read.error());
    REQUIRE(read);
    CHECK(read->checkSum == diagnosis::checkSumOf(e));
    const auto drawn = diagnosis::fitCalled(*read, "");
    REQUIRE(drawn);
    replay::Parameters again = replay::nominal(e);
    CHECK(diagnosis::setTo(*drawn, e, again).empty());
    CHECK(again.effects == p.effects);
    for (const replay::ParameterInfo& info : replay::parameterList(e))
        CHECK(replay::get(again, e, info.name) == replay::get(p, e, info.name));
}

TEST_CASE("a stored fit that cannot be read says what to do", "[diagnosis]") {
    const test::Folder folder;
    const std::string file = folder.path + "/diagnosis.json";
    const auto refused = [&](const std::string& fit) {
        std::ofstream(file) << R"({"schema": "supercircle-diagnosis/2", "replay": {"fits": [)" << fit << "]}}";
        return cli::readStoredFits(file).error();
    };
    CHECK_THAT(refused(""), Contains("is empty; diagnose the experiment again"));
    CHECK_THAT(refused("{}"), Contains("without label, parameters or effects"));
    CHECK_THAT(refused(R"({"label": "wear", "parameters": {}, "effects": [{"key": "wear"}]})"),
               Contains("/replay/fits/0: an effect is not written as \"KEY:NAME=VALUE\""));
    CHECK_THAT(refused(R"({"label": "wear", "parameters": {}, "effects": ["waer:change=1"]})"), Contains("wear"));
    CHECK_THAT(refused(R"({"label": "wear", "parameters": {"friction": "0.3"}, "effects": []})"),
               Contains("parameter friction is no number"));
}

TEST_CASE("the check sum is that of description and runs", "[diagnosis]") {
    experiment::Experiment e = baseline(101), other = e;
    CHECK(diagnosis::checkSumOf(e) == diagnosis::checkSumOf(other));
    other.runs[0].readings.force.back() += 1e-15;
    CHECK(diagnosis::checkSumOf(e) != diagnosis::checkSumOf(other));
    other = e;
    other.text += " ";
    CHECK(diagnosis::checkSumOf(e) != diagnosis::checkSumOf(other));
}

TEST_CASE("a law is restated for another section of the same material", "[diagnosis]") {
    // M / (w t^2) = g(kappa t): a section twice as thick and three times as wide, whose B is 3 * 8 times as large.
    diagnosis::StoredFit fit;
    fit.label = "plasticity";
    fit.section = {2e-4, 0.01, 1e-3};
    fit.effects = {effect("plasticity", {{"My_over_B_1_m", 50.0}, {"H_over_B", 0.2}}),
                   effect("nonlinear_elasticity", {{"uc_1_m", 80.0}}),
                   effect("viscoelastic_bending", {{"eta_over_B_s", 0.5}}),
                   effect("adhesion", {{"F_a_N_m", 4.0}, {"range_m", 1e-4}}),
                   effect("contact_compliance", {{"normal_m_N", 6e-6}}),
                   effect("static_friction_excess", {{"mu_s_over_mu_k", 1.4}}),
                   effect("sensor_gain", {{"error", 0.02}}),
                   effect("local_damage", {{"stiffness_drop", 0.5}})};
    const bool stated = GENERATE(true, false); // without a width it follows from B
    const diagnosis::Section to{4e-4, stated ? 0.03 : 0.0, 24e-3};
    const auto law = diagnosis::carriedTo(to, fit);
    INFO(law.error());
    REQUIRE(law);
    // M_y = (M_y / B) B grows with w t^2, here twelvefold.
    CHECK(valueOf(*law, "plasticity", "My_over_B_1_m") * to.bendingModulus ==
          Approx(12.0 * 50.0 * fit.section.bendingModulus).epsilon(1e-14));
    CHECK(valueOf(*law, "plasticity", "H_over_B") == 0.2);
    CHECK(valueOf(*law, "nonlinear_elasticity", "uc_1_m") == Approx(40.0).epsilon(1e-14));
    CHECK(valueOf(*law, "viscoelastic_bending", "eta_over_B_s") == 0.5);
    CHECK(valueOf(*law, "adhesion", "F_a_N_m") == Approx(12.0).epsilon(1e-14));
    CHECK(valueOf(*law, "adhesion", "range_m") == 1e-4);
    CHECK(valueOf(*law, "contact_compliance", "normal_m_N") == Approx(2e-6).epsilon(1e-14));
    CHECK(valueOf(*law, "static_friction_excess", "mu_s_over_mu_k") == 1.4);
    CHECK(valueOf(*law, "sensor_gain", "error") == 0.02);
    CHECK(law->effects.size() + 1 == fit.effects.size()); // the crease is that of one specimen
    fit.effects = {effect("sensor_gain", {{"error", 0.02}})};
    fit.effects.back().channel = "acceleration"; // stays with its sensor
    CHECK(diagnosis::carriedTo(to, fit)->effects.front().channel == "acceleration");
    fit.effects = {effect("local_damage", {{"stiffness_drop", 0.5}})};
    CHECK_THAT(diagnosis::carriedTo(to, fit).error(), Contains("is a defect of one specimen"));
}

TEST_CASE("replay repeats a fit of its own experiment only", "[diagnosis]") {
    const test::Folder folder;
    const experiment::Experiment e = baseline(106);
    replay::Parameters p = replay::nominal(e);
    REQUIRE(replay::set(p, e, "friction", 0.31).empty());
    p.effects = {effect("static_friction_excess", {{"mu_s_over_mu_k", 1.2}})};
    diagnosis::StoredFit fit = diagnosis::storedFit(e, p), bare = diagnosis::storedFit(e, replay::nominal(e));
    fit.label = "static_friction_excess";
    fit.drawn = true;
    bare.label = diagnosis::kNothing;
    const std::string file = written(folder, {diagnosis::checkSumOf(e), {fit, bare}});
    const std::string out = " --fidelity coarse --quiet --out " + folder.path + "/out";
    REQUIRE(replayed(baselinePath(106) + " --with " + file + out).code == 0);
    const nlohmann::json with = test::jsonOf(folder.path + "/out/replay.json");
    CHECK(with["parameters"]["friction"] == 0.31);
    CHECK(with["effects"]["static_friction_excess"]["mu_s_over_mu_k"] == 1.2);
    CHECK(with["with"]["label"] == "static_friction_excess");
    REQUIRE(replayed(baselinePath(106) + " --with " + file + ":nothing" + out).code == 0);
    CHECK(test::jsonOf(folder.path + "/out/replay.json")["effects"].empty());
    const auto refused = [&](const std::string& options, const std::string& why) {
        const test::CommandResult end = replayed(options + out);
        INFO(end.text);
        CHECK(end.code == 2);
        CHECK_THAT(end.text, Contains(why));
    };
    refused(baselinePath(106) + " --with " + file + ":nothin", "did you mean \"nothing\"?");
    refused(baselinePath(105) + " --with " + file, "is of other recordings or another description");
    refused(baselinePath(106) + " --with " + baselinePath(106), "this is no diagnosis.json");
    refused(baselinePath(105) + " --carry " + file + ":nothing", "nothing has no law to carry");
    refused(baselinePath(105) + " --carry " + file + " --with " + file, "--with");
}
