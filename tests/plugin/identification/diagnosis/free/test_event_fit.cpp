// Events of free oscillations, and fits to them.

#include "plugin/identification/diagnosis/estimation/event_fit.h"
#include "tests/plugin/identification/diagnosis/free/swing.h"

#include <catch2/catch.hpp>

using namespace supercircle::diagnosis;

TEST_CASE("half swings of a cosine are found", "[diagnosis][free]") {
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(1001, 0.0, 10.0);
    const Eigen::VectorXd value = time.unaryExpr([](double t) { return 3.0 + 2.0 * std::cos(2.0 * M_PI * t); });
    const auto swings = halfSwingsOf(time, value, 3.0, 0.1);
    REQUIRE(swings.size() == 19); // the last one has no turning point
    for (std::size_t k = 0; k < swings.size(); ++k) {
        const double n = static_cast<double>(k);
        CHECK(swings[k].from == Approx(0.25 + 0.5 * n).margin(1e-9)); // passages lie on samples, by symmetry
        CHECK(swings[k].turn == Approx(0.5 + 0.5 * n).margin(1e-9));
        CHECK(swings[k].height == Approx(k % 2 == 0 ? -2.0 : 2.0).epsilon(1e-9));
    }
    CHECK(halfSwingsOf(time, value, 3.0, 2.5).empty());
}

TEST_CASE("an event fit finds a frequency that is whole turns off", "[diagnosis][free]") {
    for (const double frequency : {0.85, 0.93, 1.08, 1.17}) { // 1.4 to 3.4 turns in 20 s
        const RecordedData data = swing::recording(3, frequency, 0.1, 20.0);
        const swing::Oscillator model(data, 0.2);
        SimulationCache cache;
        Evaluator evaluator(model, 1, {}, cache);
        ParameterPoint at;
        at.nominal = {1.0, 40.0};
        at.terms = {{1, {0.3}}};
        const auto there = evaluator.simulateAllRuns({at}, Fidelity::Fine).front();
        const Likelihood likelihood(data, estimateNoise(data), there, there);
        const auto start = fitEvents(evaluator, likelihood, at);
        REQUIRE(start);
        // A radian of phase after 20 s keeps samples in their basin; events are used to a hundredth of a half swing.
        CHECK(start->nominal[0] == Approx(frequency).margin(0.001));
        CHECK(start->terms[0].values[0] == Approx(0.1).epsilon(0.02));
        const FitResult fitted = fit(evaluator, likelihood, at);
        CHECK(chiSquaredPerReading(likelihood, fitted) == Approx(1.0).margin(0.3)); // 500 rows: 0.06
    }
}

TEST_CASE("a start of shells in phase needs no fit of events", "[diagnosis][free]") {
    // A frequency off by df shifts the passages after t by 2 df t half swings: 0.2 and 0.4 at 20 s.
    for (const double off : {0.005, 0.01}) {
        RecordedData data = swing::recording(3, 1.0 + off, 0.0, 20.0);
        data.freeShells = true;
        const swing::Oscillator model(data, 0.2);
        SimulationCache cache;
        Evaluator evaluator(model, 1, {}, cache);
        ParameterPoint at;
        at.nominal = {1.0, 40.0};
        const auto there = evaluator.simulateAllRuns({at}, Fidelity::Fine).front();
        const Likelihood likelihood(data, estimateNoise(data), there, there);
        const auto start = fitEvents(evaluator, likelihood, at);
        REQUIRE(start);
        CHECK((start->nominal == at.nominal) == (off < 0.0075));
        CHECK((evaluator.distinctRequests() == 1) == (off < 0.0075));
        const FitResult fitted = fit(evaluator, likelihood, at);
        CHECK(fitted.point.nominal[0] == Approx(1.0 + off).margin(1e-4)); // a sigma of 500 rows is 1e-5
        CHECK(chiSquaredPerReading(likelihood, fitted) == Approx(1.0).margin(0.3));
    }
}
