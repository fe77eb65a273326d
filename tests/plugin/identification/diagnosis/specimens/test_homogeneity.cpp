// Runs that want different numbers.

#include "tests/plugin/identification/diagnosis/toy.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace supercircle::diagnosis;

namespace {

Diagnosis diagnosedAlone(const RecordedData& data, const Model& model) {
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    return diagnose(data, evaluator, toy::exact());
}

} // namespace

TEST_CASE("parameters that differ from run to run are detected", "[diagnosis]") {
    const RecordedData data = toy::recordings(14, "dashpot", 20.0);
    const toy::Spring spring(data);
    CHECK(diagnosedAlone(data, spring).homogeneity.p < 1e-3);
    const RecordedData same = toy::recordings(15);
    const toy::Spring other(same);
    CHECK(diagnosedAlone(same, other).homogeneity.p > 1e-3);
}

TEST_CASE("a report names the number that differs from run to run", "[diagnosis]") {
    // Three specimens whose stiffness differs by 3 %, described as one.
    RecordedData data = toy::recordings(15); // 103 N/m
    const double change[] = {-3.0, 0.0, 3.0};
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force += change[r] * data.runs[r].displacement;
    const toy::Spring spring(data);
    const Diagnosis d = diagnosedAlone(data, spring);
    INFO(d.statement);
    REQUIRE(d.homogeneity.differ());
    CHECK(d.homogeneity.number == "stiffness");
    REQUIRE(d.homogeneity.values.size() == 3);
    for (std::size_t r = 0; r < 3; ++r) // the noise of a run is 0.2 N/m
        CHECK(d.homogeneity.values[r].second == Approx(103.0 + change[r]).margin(1.0));
    if (d.verdict != "identified" && d.verdict != "ambiguous")
        CHECK(d.statement.find("The runs want different numbers") != std::string::npos);
}

namespace {

/// The spring, whose readings a second number scales, too.
class Scaled final : public toy::Spring {
public:
    explicit Scaled(const RecordedData& data) : Spring(data), nominal_(Spring::nominal()) {
        nominal_.push_back({"scale", "1", "", 0.0, -0.01, 0.01, 0.01, Scale::Logarithm, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity f,
                                    const std::atomic<bool>* stop) const override {
        ParameterPoint one = p;
        one.nominal.resize(2);
        Response out = Spring::simulate(r, one, f, stop);
        out.force *= std::exp(p.nominal[2]);
        return out;
    }

private:
    std::vector<Scalar> nominal_;
};

} // namespace

TEST_CASE("numbers that runs want differently stay near what is stated", "[diagnosis]") {
    // Three times the stiffness, which neither number reaches inside its interval, and 3 % from run to run.
    RecordedData data = toy::recordings(16);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force += (200.0 + 3.0 * static_cast<double>(r)) * data.runs[r].displacement;
    const Scaled model(data);
    const Diagnosis d = diagnosedAlone(data, model);
    INFO(d.statement);
    REQUIRE(d.homogeneity.differ());
    const bool scale = d.homogeneity.number == "scale";
    for (const auto& [run, value] : d.homogeneity.values) // 20 half-widths: 100 +- 120 N/m, or a factor of 1.22
        CHECK((scale ? std::abs(std::log(value)) < 0.201 : std::abs(value - 100.0) < 120.1));
}
