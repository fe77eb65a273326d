// A diagnosis that is interrupted, or whose time is over, at every question of a small case.

#include "toy.h"

#include <catch2/catch.hpp>

using namespace supercircle::diagnosis;

namespace {

/// Counts the questions of the token and the simulations between and after them.
struct Watch {
    std::size_t asked = 0, at = 0;     ///< questions; the one with which it ends, 0: none
    std::size_t since = 0, most = 0;   ///< simulations since the last question, and the most of all
    std::size_t after = 0, worked = 0; ///< simulations that began after the end, and all
    std::vector<std::string> stages{}; ///< in their order
    std::atomic<bool> interrupt{false};
    [[nodiscard]] bool over() const { return at > 0 && asked >= at; }
};

/// A spring whose simulations are remembered, so that many diagnoses cost little.
class Watched final : public toy::Spring {
public:
    using Spring::Spring;
    Watch* watch = nullptr;

    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity f,
                                    const std::atomic<bool>* interrupt) const override {
        watch->most = std::max(watch->most, ++watch->since);
        watch->after += watch->over() ? 1 : 0;
        ++watch->worked;
        return Spring::simulate(r, p, f, interrupt);
    }
};

Diagnosis run(const RecordedData& data, Watched& model, Watch& watch, bool interrupts) {
    model.watch = &watch;
    SimulationCache cache; // its own: what is remembered is not simulated
    Evaluator evaluator(model, data.runs.size(), {}, cache, &watch.interrupt, [&watch, interrupts] {
        ++watch.asked;
        watch.since = 0;
        if (interrupts && watch.over())
            watch.interrupt = true;
        return !interrupts && watch.over();
    });
    DiagnosisSettings settings = toy::exact();
    settings.draws = 99;
    settings.progress = [&watch](double, const std::string& stage) { watch.stages.push_back(stage); };
    return diagnose(data, evaluator, settings);
}

double sum(const Diagnosis& d) {
    double all = d.adequate + d.undetectable();
    for (const FittedEffect& e : d.effects)
        all += e.jointWith.empty() ? e.probability : 0.0;
    return all;
}

/// Questions spread over a diagnosis, the first and the last among them.
std::vector<std::size_t> questions(std::size_t all, std::size_t count) {
    std::vector<std::size_t> out;
    for (std::size_t k = 1; k <= count && k <= all; ++k)
        out.push_back(1 + (k - 1) * (all - 1) / std::max<std::size_t>(1, std::min(count, all) - 1));
    return out;
}

RecordedData hidden() {
    return toy::recordings(41, "cubic", 4e5, 10.0);
}

} // namespace

TEST_CASE("an interrupt is heard at every question, and nothing is simulated after it", "[diagnosis]") {
    const RecordedData data = hidden();
    Watched spring(data);
    Watch whole;
    const Diagnosis complete = run(data, spring, whole, true);
    REQUIRE_FALSE(complete.stopped);
    REQUIRE(whole.stages.back().find("weights") != std::string::npos); // it went to the end
    CHECK(whole.most <= 1);                                            // one simulation between two questions
    for (const std::size_t n : questions(whole.asked, 60)) {
        INFO("question " << n << " of " << whole.asked);
        Watch watch;
        watch.at = n;
        const Diagnosis d = run(data, spring, watch, true);
        CHECK(d.stopped);
        CHECK(watch.after == 0);
        CHECK(watch.asked <= n + 100); // each of the 54 requests of the largest batch asks on the way out
    }
}

TEST_CASE("a time limit ends with a valid verdict wherever it falls", "[diagnosis]") {
    const RecordedData data = hidden();
    Watched spring(data);
    Watch whole;
    const Diagnosis complete = run(data, spring, whole, false);
    REQUIRE(complete.notes.empty());
    REQUIRE(complete.verdict == "identified");
    std::size_t same = 0;
    for (const std::size_t n : questions(whole.asked, 60)) {
        INFO("question " << n << " of " << whole.asked);
        Watch watch;
        watch.at = n;
        const Diagnosis d = run(data, spring, watch, false);
        CHECK_FALSE(d.stopped);
        CHECK(d.failure.empty());
        CHECK((d.verdict == "adequate" || d.verdict == "inconclusive" || d.verdict == "ambiguous" ||
               d.verdict == "identified" || d.verdict == "outside_catalogue"));
        CHECK_FALSE(d.statement.empty());
        CHECK(sum(d) + d.outsideCatalogue <= 1.0 + 1e-9);
        CHECK(watch.after <= whole.worked);
        if (d.notTried.empty()) { // nothing that matters came after it
            CHECK(d.verdict == complete.verdict);
            CHECK(d.effects.front().probability == complete.effects.front().probability);
        } else {
            REQUIRE(d.notes.size() == 1);
            CHECK(d.notes[0].find("Not tried: ") != std::string::npos);
        }
        same += d.verdict == complete.verdict ? 1 : 0;
        if (d.effects.empty()) // what acts is named only by a fit
            CHECK(d.verdict != "identified");
    }
    CHECK(same > 10); // what is found early stays found
}

TEST_CASE("an evaluator without a limit asks for nothing", "[diagnosis]") {
    const StopToken token;
    CHECK_FALSE(token.stopped());
    token.poll();
    CHECK(token.attempt([] {}));
    std::atomic<bool> interrupt{true};
    CHECK(StopToken(&interrupt).stopped());
    const StopToken limited(nullptr, [] { return true; });
    CHECK_FALSE(limited.stopped()); // what cannot be left out goes on
    bool worked = false;
    CHECK_FALSE(limited.attempt([&] { worked = true; }));
    CHECK_FALSE(worked);
    CHECK_THROWS_AS(StopToken(&interrupt).attempt([] {}), Stopped);
}
