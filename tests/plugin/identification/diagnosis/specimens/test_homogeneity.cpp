// Runs that want different numbers.

#include "tests/plugin/identification/diagnosis/toy.h"

#include <catch2/catch.hpp>

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
