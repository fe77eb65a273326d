// A stated number outside its interval is called wrong, and no physics.

#include "../toy.h"

#include "plugin/identification/diagnosis/model/stated_numbers.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/step/parallel.h"
#include "tests/support/folder.h"

#include <catch2/catch.hpp>

using namespace supercircle::diagnosis;
using Catch::Matchers::Contains;

namespace {

/// A material law that does what a wrong stiffness does, or what a wrong stiffness and a wrong friction do together, or
/// a second number that does what the stiffness does.
enum class Imitation : std::uint8_t { None, Stiffness, Both, Number };

/// The spring, whose stiffness and friction may be wrong.
class Doubted final : public toy::Spring {
public:
    explicit Doubted(const RecordedData& data, Imitation imitation = Imitation::None)
        : Spring(data), nominal_(Spring::nominal()) {
        if (imitation == Imitation::Number) {
            nominal_.push_back({"second_spring", "N/m", "", kSecond, kSecond - 6.0, kSecond + 6.0, 6.0, Scale::Linear});
            nominal_.back().doubtful = true;
        }
        CandidateEffects numbers;
        addStatedNumbers(nominal(), numbers);
        all_ = Spring::candidates();
        all_.insert(all_.end(), numbers.candidates.begin(), numbers.candidates.end());
        if (imitation != Imitation::Stiffness && imitation != Imitation::Both)
            return;
        CandidateEffect c;
        c.label = "foundation";
        c.slot = "material";
        c.law = "c x + d sign v";
        c.parameters = {{"c", "N/m", "", 0.0, -500.0, 500.0, 2.0, Scale::Linear, true}};
        c.probes = {{5.0}};
        if (imitation == Imitation::Both) {
            c.parameters.push_back({"d", "N", "", 0.0, -5.0, 5.0, 0.02, Scale::Linear, true});
            c.probes = {{5.0, 0.05}};
        }
        all_.push_back(c);
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override {
        return all_.empty() ? Spring::candidates() : all_;
    }
    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity f,
                                    const std::atomic<bool>* stop) const override {
        ParameterPoint without = p;
        for (Term& t : without.terms)
            if (const CandidateEffect& c = all_[t.candidate]; c.isNumber() || c.label == "foundation") {
                for (std::size_t i = 0; i < t.values.size(); ++i)
                    if (c.isNumber())
                        without.nominal[static_cast<std::size_t>(c.number)] +=
                            t.values[i] - nominal()[static_cast<std::size_t>(c.number)].value;
                    else
                        without.nominal[i] += t.values[i];
                t.values.assign(t.values.size(), 0.0);
            }
        if (without.nominal.size() > 2)
            without.nominal[0] += without.nominal[2] - kSecond;
        return Spring::simulate(r, without, f, stop);
    }

private:
    static constexpr double kSecond = 20.0; // N/m
    std::vector<Scalar> nominal_;
    std::vector<CandidateEffect> all_;
};

/// Recordings with these true numbers, and a cubic law.
RecordedData recorded(double stiffness, double friction, double cubic, std::uint64_t seed) {
    RecordedData data = toy::recordings(seed);
    const toy::Spring spring(data);
    ParameterPoint truth{{stiffness, friction}, {}};
    if (cubic != 0.0)
        truth.terms.push_back({2, {cubic}});
    Random random(seed);
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        data.runs[r].force = spring.simulate(r, truth, Fidelity::Fine, nullptr).force;
        toy::addNoise(data.runs[r], random);
    }
    return data;
}

Diagnosis diagnosed(const RecordedData& data, const Model& model) {
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), supercircle::step::threadLoop(1), cache);
    return diagnose(data, evaluator, toy::exact());
}

} // namespace

TEST_CASE("a number outside its stated interval is called wrong", "[diagnosis][numbers]") {
    for (const double stiffness : {125.0, 112.0, 70.0}) { // stated as 100 +- 6
        const RecordedData data = recorded(stiffness, 0.08, 0.0, 31);
        const Diagnosis d = diagnosed(data, Doubted(data));
        INFO(d.statement);
        CHECK(d.wrongNumber);
        CHECK(d.verdict == "inconclusive"); // on missing effects
        CHECK_THAT(d.statement, Contains("A stated number is wrong: stiffness is"));
        CHECK(titleOf(d) == "A stated number is wrong");
        REQUIRE_FALSE(d.effects.empty());
        // noise of 0.01 N over 900 rows of up to 1 N: 0.1 N/m
        CHECK(d.effects.front().parameters.front().value == Approx(stiffness).margin(0.4));
        CHECK(d.effects.front().parameters.front().ci90.low < stiffness + 0.3);
        CHECK(d.effects.front().parameters.front().ci90.high > stiffness - 0.3);
    }
}

TEST_CASE("two numbers outside their intervals are both called wrong", "[diagnosis][numbers]") {
    const RecordedData data = recorded(125.0, 0.25, 0.0, 32); // friction is stated as 0.1 +- 0.05
    const Diagnosis d = diagnosed(data, Doubted(data));
    INFO(d.statement);
    CHECK(d.wrongNumber);
    CHECK_THAT(d.statement, Contains("stiffness is") && Contains("friction is"));
}

TEST_CASE("a number that does as well as one of two wrong ones is named beside it", "[diagnosis][numbers]") {
    const RecordedData data = recorded(125.0, 0.25, 0.0, 32);
    const Diagnosis d = diagnosed(data, Doubted(data, Imitation::Number));
    INFO(d.statement);
    CHECK(d.wrongNumber);
    CHECK_THAT(d.statement, Contains("friction is") && Contains("stiffness is") && Contains("second_spring is") &&
                                Contains("or else"));
}

TEST_CASE("numbers inside their intervals change no verdict", "[diagnosis][numbers]") {
    const Diagnosis clean = diagnosed(recorded(103.0, 0.08, 0.0, 33), Doubted(recorded(103.0, 0.08, 0.0, 33)));
    CHECK(clean.verdict == "adequate");
    for (const ScreenedEffect& s : clean.screening)
        CHECK(s.label.rfind("stated_", 0) != 0); // they belong to no catalogue
    const RecordedData data = recorded(103.0, 0.08, 4e5, 34);
    const Diagnosis hidden = diagnosed(data, Doubted(data));
    INFO(hidden.statement);
    CHECK(hidden.verdict == "identified");
    CHECK(hidden.effects.front().label == "cubic");
}

TEST_CASE("an effect that wrong numbers imitate is not identified", "[diagnosis][numbers]") {
    struct Imitated {
        double friction; ///< N, stated as 0.1 +- 0.05
        Imitation imitation;
        std::size_t group; ///< the effect and each number
    };
    // With two wrong numbers one alone explains little, so that no fit of single ones competes with the effect.
    for (const Imitated& c : {Imitated{0.08, Imitation::Stiffness, 2}, Imitated{0.25, Imitation::Both, 3}}) {
        const RecordedData data = recorded(125.0, c.friction, 0.0, 35); // the stiffness is stated as 100 +- 6
        const Diagnosis d = diagnosed(data, Doubted(data, c.imitation));
        INFO(d.statement);
        CHECK(d.verdict == "ambiguous");
        CHECK_FALSE(d.wrongNumber);
        REQUIRE_FALSE(d.effects.empty());
        CHECK(d.effects.front().confoundedWith.size() == c.group);
    }
}

TEST_CASE("a wrong number of a batch leaves the deviations of its specimens", "[diagnosis][numbers]") {
    const supercircle::test::Folder folder;
    std::string rows = "time_s,y_mm\n";
    for (int k = 0; k < 40; ++k)
        rows += std::to_string(0.01 * k) + "," + std::to_string(k % 7) + "\n";
    folder.write("a.csv", rows);
    folder.write("b.csv", rows);
    const auto e = supercircle::experiment::load(
        folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "mass_on_spring", "scene_parameters": {"frequency": {"value": 2, "unc": 0.1}},
        "specimens": [{"id": "a"}, {"id": "b"}], "batch": {"frequency": {"std_rel": {"scale": 0.05}}},
        "channels": [{"observe": "position", "column": "y_mm"}],
        "runs": [{"file": "a.csv", "specimen": "a", "parameters": {"release_y": {"value": 0.05, "unc": 0.01}}},
                 {"file": "b.csv", "specimen": "b", "parameters": {"release_y": {"value": 0.05, "unc": 0.01}}}]})"));
    INFO(e.error());
    REQUIRE(e);
    const ReplayModel model(*e);
    ParameterPoint point;
    for (const Scalar& s : model.nominal()) {
        point.nominal.push_back(s.name == "frequency.b" ? 0.06 : s.value);
        const bool ofRecording = s.name.find("_run") != std::string::npos || s.name == "reading_zero";
        CHECK(s.doubtful == (!ofRecording && s.batch < 0));
    }
    for (std::size_t c = 0; c < model.candidates().size(); ++c)
        if (model.candidates()[c].label == "stated_frequency")
            point.terms.push_back({c, {3.0}});
    REQUIRE(point.terms.size() == 1);
    supercircle::replay::Parameters p;
    REQUIRE(model.parametersAt(point, p) == "");
    CHECK(supercircle::replay::get(p, *e, "frequency").value() == Approx(3.0).epsilon(1e-14));
    CHECK(supercircle::replay::get(p, *e, "frequency.b").value() == Approx(3.06).epsilon(1e-14));
}
