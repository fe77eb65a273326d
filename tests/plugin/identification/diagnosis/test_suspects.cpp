// What a further run has to tell apart.

#include "toy.h"

#include "plugin/identification/diagnosis/next_experiment/suspects.h"
#include "plugin/identification/diagnosis/noise.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace supercircle::diagnosis;

TEST_CASE("a further run has to tell what explains nearly as much at first sight, too", "[diagnosis]") {
    Data data = toy::recordings(3);
    const toy::Spring model(data); // a dashpot, a drift and a cubic spring
    toy::hide(data, model, {{1, {2e-3}}});
    Store store;
    Evaluator evaluator(model, data.runs.size(), {}, store);
    const Point stated{{100.0, 0.1}, {}};
    const auto there = evaluator.everywhere({stated}, Fineness::Fine).front();
    const Misfit misfit(data, estimateNoise(data), there, there, {});
    const Fitted base = fit(evaluator, misfit, stated);
    std::vector<Screened> screened = screen(evaluator, misfit, base);
    REQUIRE(screened.size() == 3);
    Tried drift;
    drift.candidates = {1};
    drift.fit = fit(evaluator, misfit, Point{base.point.nominal, {{1, {2e-3}}}});
    const std::vector<Named> named = {{"drift", 0.6, &drift, true}};
    /// @param gains at first sight, in squares @param nothing how probable it is
    const auto asked = [&](const std::vector<double>& gains, double nothing) {
        for (std::size_t i = 0; i < screened.size(); ++i)
            screened[i].gain = gains[i];
        return suspects(evaluator, misfit, base, named, screened, nothing);
    };
    const auto labels = [](const std::vector<Rival>& rivals) {
        std::vector<std::string> out;
        for (const Rival& r : rivals)
            out.push_back(r.label);
        return out;
    };
    // The one that was worth a fit first, with its probability; what is six squares behind the best is none.
    const std::vector<Rival> weak = asked({7.0, 12.0, 5.0}, 0.25);
    CHECK(labels(weak) == std::vector<std::string>{"drift", "dashpot", "nothing"});
    CHECK(weak[0].weight == 0.6);
    CHECK(weak[1].weight > 0.0);
    CHECK(weak[1].weight <= 0.6); // it explains less, and cannot be more probable
    CHECK(weak[1].x.size() == weak[0].x.size());
    CHECK(labels(asked({12.0, 7.0, 9.0}, 0.25)) == std::vector<std::string>{"drift", "dashpot", "cubic", "nothing"});
    // Where one explains far more than all others it has no rivals but nothing.
    CHECK(labels(asked({7.0, 50.0, 5.0}, 0.01)) == std::vector<std::string>{"drift", "nothing"});
    // Where nothing is believed they come as they explain, the best one with a weight of one.
    const std::vector<Rival> none = asked({7.0, 12.0, 9.0}, 0.8);
    CHECK(labels(none) == std::vector<std::string>{"drift", "cubic", "dashpot", "nothing"});
    CHECK(none[0].weight == 1.0);
}
