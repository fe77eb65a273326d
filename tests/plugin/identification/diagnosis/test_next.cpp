// Which further run is asked for, on models whose readings are sines and straight lines.

#include "plugin/identification/diagnosis/next.h"
#include "plugin/identification/diagnosis/next_experiment/sight.h"

#include <Eigen/QR>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

using namespace supercircle::diagnosis;

namespace {

/// A model of designs alone.
class Designs : public Model {
public:
    Designs(std::vector<Design> designs, std::vector<Candidate> candidates)
        : designs_(std::move(designs)), candidates_(std::move(candidates)) {}
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<Candidate>& candidates() const override { return candidates_; }
    [[nodiscard]] std::string identity() const override { return "designs"; }
    [[nodiscard]] Response simulate(std::size_t, const Point&, Fineness, const std::atomic<bool>*) const override {
        return {};
    }
    [[nodiscard]] std::vector<Design> designs() const override { return designs_; }

protected:
    /// An effect of one linear amplitude.
    static Candidate effect(const std::string& label, const std::string& unit, double lower, double upper,
                            double step) {
        return {label, "", "", "", {{"a", unit, "", 0.0, lower, upper, step, Scale::Linear, true}}, {{step}}};
    }

private:
    std::vector<Design> designs_;
    std::vector<Scalar> nominal_ = {{"slope", "N/s", "", 0.0, -50.0, 50.0, 50.0, Scale::Linear, false}};
    std::vector<Candidate> candidates_;
};

/// Two designs and two effects beside a straight line, 200 readings in ten seconds.
class Pairs : public Designs {
public:
    /// What one newton of an effect does in a design.
    using Shape = std::function<Eigen::ArrayXd(std::size_t design, std::size_t effect, const Eigen::ArrayXd& time)>;
    Pairs(const char* oneRun, const char* otherRun, const char* oneEffect, const char* otherEffect, Shape shape)
        : Designs({{oneRun, 0}, {otherRun, 0}},
                  {effect(oneEffect, "N", -9.0, 9.0, 1.0), effect(otherEffect, "N", -9.0, 9.0, 1.0)}),
          shape_(std::move(shape)) {}
    [[nodiscard]] DesignResponse simulateDesign(std::size_t i, const Point& p,
                                                const std::atomic<bool>*) const override {
        DesignResponse out;
        out.time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0);
        out.force = p.nominal[0] * out.time;
        for (const Term& t : p.terms)
            out.force += t.values[0] * shape_(i, t.candidate, out.time.array()).matrix();
        return out;
    }

private:
    Shape shape_;
};

/// In the first design an effect looks like the nominal parameter, and large; in the second like nothing else. The
/// other effect does nothing.
class TwoDesigns final : public Pairs {
public:
    TwoDesigns()
        : Pairs("alike", "apart", "swing", "other",
                [](std::size_t design, std::size_t effect, const Eigen::ArrayXd& time) -> Eigen::ArrayXd {
                    if (effect == 1)
                        return 0.0 * time;
                    return design == 0 ? Eigen::ArrayXd(10.0 * time) : Eigen::ArrayXd(time.sin());
                }) {}
};

/// The second of them alone.
class OneDesign final : public Designs {
public:
    OneDesign() : Designs({{"apart", 0}}, {effect("swing", "N", -9.0, 9.0, 1.0)}) {}
    [[nodiscard]] DesignResponse simulateDesign(std::size_t, const Point& p,
                                                const std::atomic<bool>* i) const override {
        return TwoDesigns().simulateDesign(1, p, i);
    }
};

/// Each effect shows in one design, a sine each.
class EachItsOwn final : public Pairs {
public:
    EachItsOwn()
        : Pairs("left", "right", "first", "second",
                [](std::size_t design, std::size_t effect, const Eigen::ArrayXd& time) -> Eigen::ArrayXd {
                    return (design == effect ? 1.0 : 0.0) * (2.0 * time).sin();
                }) {}
};

/// The first effect shows in both designs, the second in the second one only.
class TwoSuspects final : public Pairs {
public:
    TwoSuspects()
        : Pairs("one", "both", "first", "second",
                [](std::size_t design, std::size_t effect, const Eigen::ArrayXd& time) -> Eigen::ArrayXd {
                    return (effect == 1 && design == 0 ? 0.0 : 1.0) * ((effect == 0 ? 2.0 : 3.0) * time).sin();
                }) {}
};

/// A sensor that may be late, in a run that is read twenty times a second and in the same one read four hundred times.
class TwoRates final : public Designs {
public:
    TwoRates() : Designs({{"slow", 0}, {"quick", 0}}, {effect("late", "s", 0.0, 1.0, 0.01)}) {}
    [[nodiscard]] DesignResponse simulateDesign(std::size_t i, const Point& p,
                                                const std::atomic<bool>*) const override {
        DesignResponse out;
        out.time = Eigen::VectorXd::LinSpaced(i == 0 ? 200 : 4000, 0.0, 10.0);
        const double late = p.terms.empty() ? 0.0 : p.terms.front().values[0];
        out.force = 30.0 * (out.time.array() - late).sin().matrix();
        return out;
    }
};

/// Two effects that no force shows, and one marker that moves by .1 mm for the first: filmed in the second design only.
class TwoCameras final : public Designs {
public:
    TwoCameras()
        : Designs({{"blind", 0, {0.0, 5.0, 10.0}, {0.0, 0.01, 0.0}}, {"filmed", 0, {0.0, 5.0, 10.0}, {0.0, 0.01, 0.0}}},
                  {effect("first", "1", -9.0, 9.0, 1.0), effect("second", "1", -9.0, 9.0, 1.0)}) {}
    [[nodiscard]] DesignResponse simulateDesign(std::size_t i, const Point& p,
                                                const std::atomic<bool>*) const override {
        DesignResponse out;
        out.time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0);
        out.force = p.nominal[0] * out.time;
        if (i == 0)
            return out;
        out.markerTime = Eigen::VectorXd::LinSpaced(40, 0.0, 10.0);
        out.markers = Eigen::VectorXd::Zero(80);
        if (!p.terms.empty() && p.terms.front().candidate == 0)
            // What a shift of the way there and one of the way back do not take up.
            out.markers.head(40) = 1e-4 * p.terms.front().values[0] * (3.0 * out.markerTime.array()).sin();
        return out;
    }
};

/// Two sines that are late, each by a number of its own, and in the second design a swing that only the first has.
class TwoPhases final : public Designs {
public:
    TwoPhases()
        : Designs({{"phase", 0}, {"swing", 0}},
                  {effect("one", "s", 0.0, 3.0, 1.0), effect("other", "s", 0.0, 3.0, 1.0)}) {}
    [[nodiscard]] DesignResponse simulateDesign(std::size_t i, const Point& p,
                                                const std::atomic<bool>*) const override {
        DesignResponse out;
        out.time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0);
        out.force = (out.time.array() - p.terms.front().values[0]).sin().matrix();
        if (i == 1 && p.terms.front().candidate == 0)
            out.force += (5.0 * out.time.array()).sin().matrix();
        return out;
    }
};

/// A floor that is met at once, 1 N at 2 mm, by one effect 50 um later than by the other.
class TwoTouches final : public Designs {
public:
    TwoTouches()
        : Designs({{"press", 0, {0.0, 10.0}, {0.0, 0.01}}},
                  {effect("high", "1", -9.0, 9.0, 1.0), effect("low", "1", -9.0, 9.0, 1.0)}) {}
    [[nodiscard]] DesignResponse simulateDesign(std::size_t, const Point& p, const std::atomic<bool>*) const override {
        DesignResponse out;
        out.time = Eigen::VectorXd::LinSpaced(400, 0.0, 10.0);
        const double touch = p.terms.front().candidate == 0 ? 2.0 : 2.05;
        out.force = (out.time.array() >= touch).select(1.0 + 0.1 * out.time.array(), 0.0);
        return out;
    }
};

Noise quiet() {
    Noise noise;
    noise.white = 0.1;
    noise.coloured = 0.0;
    noise.memory = 0.25;
    return noise;
}

/// The first effect, the second, or nothing, all numbers known.
std::vector<Rival> known(const Model& model, double size, double first, double second) {
    std::vector<Rival> rivals = {{"first", {{0.0}, {{0, {size}}}}, {}, {}, first},
                                 {"second", {{0.0}, {{1, {size}}}}, {}, {}, second},
                                 {"nothing", {{0.0}, {}}, {}, {}, 0.0}};
    for (Rival& r : rivals) {
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = 1e-6 * Eigen::MatrixXd::Identity(r.x.size(), r.x.size());
    }
    return rivals;
}

} // namespace

TEST_CASE("a further run shows whatever it may be, not only what is likeliest", "[diagnosis]") {
    const TwoSuspects model;
    // A sine of .08 N in 200 readings of .1 N: eight deviations.
    std::vector<Rival> rivals = known(model, 0.08, 0.6, 0.4);
    Store store;
    Evaluator evaluator(model, 1, {}, store);
    const auto next = nextExperiment(evaluator, rivals, quiet(), 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().design.what == "both");
    CHECK(next->runs.front().repeats == 1);
    CHECK(next->separates == std::vector<std::string>{"first", "second", "nothing"});
    CHECK(next->power > 0.99);
    // The likeliest alone would do with the first.
    const auto narrow = nextExperiment(evaluator, {rivals[0], rivals[2]}, quiet(), 0.0);
    REQUIRE(narrow);
    CHECK(narrow->runs.front().design.what == "one");
    // Where one is a part of the other, the other cannot be refuted if it acts alone, and is not waited for.
    rivals[1].point.terms.push_back({0, {0.05}}); // "second" beside the first
    rivals[1].x = Variables(model, rivals[1].point).of(rivals[1].point);
    rivals[1].covariance = 1e-6 * Eigen::MatrixXd::Identity(rivals[1].x.size(), rivals[1].x.size());
    const auto nested = nextExperiment(evaluator, rivals, quiet(), 0.0);
    REQUIRE(nested);
    CHECK(nested->runs.front().design.what == "both");
    CHECK(nested->power > 0.99);
    CHECK_FALSE(nextExperiment(evaluator, {rivals[0]}, quiet(), 0.0));
}

TEST_CASE("a further run is worth what its own clock does not take up", "[diagnosis]") {
    // 5 ms in 200 readings on slopes of 30 N/s are 15 deviations of .1 N, and a tenth of a row, to which a clock is
    // known; in rows of 2.5 ms they are two.
    const TwoRates model;
    const Noise noise = quiet();
    Rival late{"late", {{0.0}, {{0, {0.005}}}}, {}, {}}, nothing{"nothing", {{0.0}, {}}, {}, {}};
    for (Rival* r : {&late, &nothing}) {
        r->x = Variables(model, r->point).of(r->point);
        r->covariance = 1e-8 * Eigen::MatrixXd::Identity(r->x.size(), r->x.size());
    }
    Store store;
    Evaluator evaluator(model, 1, {}, store);
    const auto next = nextExperiment(evaluator, {late, nothing}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().design.what == "quick");
    CHECK(next->power > 0.99);
}

TEST_CASE("what no single run tells is told by as many as it takes", "[diagnosis]") {
    const OneDesign model;
    const Noise noise = quiet();
    constexpr double kSize = 0.025; // N
    /// Between a swing and nothing, the slope open. @param known of the swing, N
    const auto asked = [&](const Model& of, double slope, double known) {
        Rival swing{"swing", {{0.0}, {{0, {kSize}}}}, {}, {}}, nothing{"nothing", {{0.0}, {}}, {}, {}};
        for (Rival* r : {&swing, &nothing}) {
            r->x = Variables(of, r->point).of(r->point);
            r->covariance = Eigen::MatrixXd::Identity(r->x.size(), r->x.size()) * known * known;
            r->covariance(0, 0) = slope * slope; // how far it is open, in its steps
        }
        Store store;
        Evaluator evaluator(of, 1, {}, store);
        return nextExperiment(evaluator, {swing, nothing}, noise, 0.0);
    };
    // A sine in 200 readings, a constant and a slope taken out, n runs sqrt(n) times as well.
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(200, 0.0, 10.0), sine = time.array().sin();
    Eigen::MatrixXd taken(200, 2);
    taken << Eigen::VectorXd::Ones(200), time;
    const double one = (sine - taken * taken.colPivHouseholderQr().solve(sine)).norm() * kSize / 0.1;
    REQUIRE(one > 2.0);
    REQUIRE(one < 2.5);
    const auto several = asked(model, 1.0, 1e-6);
    REQUIRE(several);
    REQUIRE(several->runs.size() == 1);
    CHECK(several->runs[0].design.what == "apart");
    CHECK(several->runs[0].repeats == static_cast<std::size_t>(std::ceil(std::pow(5.0 / one, 2))));
    CHECK(inWords(*several) == "apart, made " + std::to_string(several->runs[0].repeats) + " times");
    // A swing that is known to an eighth may be smaller: more runs, and a power below one, its mean over that.
    const auto more = asked(model, 1.0, kSize / 8.0);
    REQUIRE(more);
    CHECK(more->runs[0].repeats > several->runs[0].repeats);
    const double d = std::sqrt(static_cast<double>(more->runs[0].repeats)) * one;
    const double power = 0.5 * std::erfc(-(d - 1.645) / std::hypot(1.0, d / 8.0) / std::sqrt(2.0));
    CHECK(more->power == Approx(power).margin(0.005)); // clock, scale and contact places take little of it
    // Another design shows the swing ten times as large: one run of it where the slope is known.
    const TwoDesigns two;
    const auto large = asked(two, 1e-6, 1e-6);
    REQUIRE(large);
    CHECK(inWords(*large) == "alike");
    // Where the slope is open that one alone tells nothing, the swing is part of a slope of .25 N/s to it. The run in
    // which it is not knows the slope to .0025 N/s: one of each does what the latter does in six.
    const auto both = asked(two, 1.0, 1e-6);
    REQUIRE(both);
    CHECK(inWords(*both) == "alike, and apart");
    CHECK(both->settles);
}

TEST_CASE("what shows in two kinds of run only asks for both", "[diagnosis]") {
    const EachItsOwn model;
    const auto asked = [&](double size) { // N; of the other effect as much
        Store store;
        Evaluator evaluator(model, 1, {}, store);
        return nextExperiment(evaluator, known(model, size, 0.5, 0.5), quiet(), 0.0);
    };
    // A sine of .08 N in 200 readings of .1 N: eight deviations, where it shows.
    const auto once = asked(0.08);
    REQUIRE(once);
    CHECK(inWords(*once) == "left, and right");
    CHECK(once->settles);
    CHECK(once->power > 0.99);
    // A third of it: two and a half deviations each, so that five units take four runs each, and what is weaker more
    // than eight.
    const auto often = asked(0.0275);
    REQUIRE(often);
    CHECK(inWords(*often) == "left, made 4 times, and right, made 4 times");
    const auto weak = asked(0.016);
    REQUIRE(weak);
    CHECK_FALSE(weak->settles);
    CHECK(weak->runs.size() == 2);
    CHECK_THAT(inWords(*weak), Catch::Contains("they may not settle the matter"));
}

TEST_CASE("a further run is worth what refitting does not take up", "[diagnosis]") {
    const TwoDesigns model;
    const Noise noise = quiet();
    const auto rival = [&](const std::string& label, std::size_t candidate, double slope) {
        Rival r{label, {{0.0}, {{candidate, {1.0}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = Eigen::Vector2d(slope * slope, 1e-4).asDiagonal(); // of the slope in its steps, of the amplitude
        return r;
    };
    Store store;
    Evaluator evaluator(model, 1, {}, store);
    // The slope is open: the first run's large difference would be taken up by it.
    auto next = nextExperiment(evaluator, {rival("swing", 0, 0.5), rival("other", 1, 0.5)}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().design.what == "apart");
    CHECK(next->power > 0.99); // a sine of 1 N, noise .1 N, 200 readings
    // It is known: the first one listed will do.
    next = nextExperiment(evaluator, {rival("swing", 0, 1e-6), rival("other", 1, 1e-6)}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().design.what == "alike");
    // Who interrupts gets none, and soon.
    const std::atomic<bool> stop{true};
    Evaluator stopped(model, 1, {}, store, &stop);
    CHECK_FALSE(nextExperiment(stopped, {rival("swing", 0, 0.5), rival("other", 1, 0.5)}, noise, 0.0));
}

TEST_CASE("a further run that is filmed tells what no force shows", "[diagnosis]") {
    const TwoCameras model;
    const auto rival = [&](const std::string& label, std::size_t candidate) {
        Rival r{label, {{0.0}, {{candidate, {1.0}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = Eigen::Vector2d(0.25, 1e-4).asDiagonal();
        return r;
    };
    Store store;
    Evaluator evaluator(model, 1, {}, store);
    Noise noise = quiet();
    noise.marker = 3e-5;
    const auto next = nextExperiment(evaluator, {rival("first", 0), rival("second", 1)}, noise, 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().design.what == "filmed");
    // A sine of .1 mm in 40 frames, each to 30 um beside 15 um of the simulation: 13 deviations.
    CHECK(next->runs.front().repeats == 1);
    CHECK(next->power > 0.99);
    // So is to which side an effect acts: its mirror image is no part of it.
    Rival here = rival("first", 0), there = rival("first", 0);
    CHECK_FALSE(nextExperiment(evaluator, {here, there}, noise, 0.0)); // twice the same
    there.point.terms[0].values[0] = -1.0;
    there.x = Variables(model, there.point).of(there.point);
    there.otherSide = true;
    const auto side = nextExperiment(evaluator, {here, there}, noise, 0.0);
    REQUIRE(side);
    CHECK(side->runs.front().design.what == "filmed");
    CHECK(side->power > 0.99);
    CHECK(side->side);
    CHECK(side->separates == std::vector<std::string>{"first"});
    CHECK_FALSE(next->side);
    noise.marker = 3e-3; // a poor camera
    const auto poor = nextExperiment(evaluator, {rival("first", 0), rival("second", 1)}, noise, 0.0);
    CHECK((!poor || poor->power < 0.5));
}

TEST_CASE("a further run is worth what refitting does not take up where derivatives mislead", "[diagnosis]") {
    // Sines that are a radian apart: moved by its derivative the one is half a newton beside the other (1 - cos 1,
    // noise .1 N); moved along the circle, it is the other.
    const TwoPhases model;
    const auto rival = [&](const std::string& label, std::size_t candidate, double late) {
        Rival r{label, {{0.0}, {{candidate, {late}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = Eigen::Vector2d(1e-6, 1.0).asDiagonal(); // of the slope, of how late it is
        return r;
    };
    Store store;
    Evaluator evaluator(model, 1, {}, store);
    const auto next = nextExperiment(evaluator, {rival("one", 0, 0.5), rival("other", 1, 1.5)}, quiet(), 0.0);
    REQUIRE(next);
    CHECK(next->runs.front().design.what == "swing");
    CHECK(next->settles);
    // Derivatives lead beyond what is possible (3 s); inside it the search goes on from there.
    const auto bounded = nextExperiment(evaluator, {rival("one", 0, 2.9), rival("other", 1, 1.9)}, quiet(), 0.0);
    REQUIRE(bounded);
    CHECK(bounded->runs.front().design.what == "swing");
}

TEST_CASE("a snap that a rival has not says nothing by itself, what follows does", "[diagnosis]") {
    const Design press{"press", 0, {0.0, 10.0}, {0.0, 0.01}};
    DesignResponse smooth;
    smooth.time = Eigen::VectorXd::LinSpaced(401, 0.0, 10.0);
    smooth.force = 0.1 * smooth.time;
    DesignResponse snaps = smooth; // to and back within what is left out around a snap
    for (Eigen::Index k = 0; k < snaps.time.size(); ++k)
        snaps.force[k] += snaps.time[k] >= 5.0 && snaps.time[k] < 5.2 ? 1.0 : 0.0;
    const Sight sight(press, snaps, quiet(), 0.0, 1);
    const auto apart = sight.apart(snaps, smooth);
    REQUIRE(apart);
    CHECK(apart->norm() < 1.0);
    smooth.force.array() += (smooth.time.array() >= 5.0).select(Eigen::ArrayXd::Constant(401, 1.0), 0.0); // stays
    const auto stays = sight.apart(snaps, smooth);
    REQUIRE(stays);
    CHECK(stays->norm() > 5.0);
    smooth.force.conservativeResize(100);
    CHECK_FALSE(sight.apart(snaps, smooth));
}

TEST_CASE("a further run is not worth what no fit looks at", "[diagnosis]") {
    // Two readings of 11 noise units; where a floor is touched is known to a share of the way only, and what is read
    // while it is touched does not count.
    const TwoTouches model;
    const auto rival = [&](const std::string& label, std::size_t candidate) {
        Rival r{label, {{0.0}, {{candidate, {1.0}}}}, {}, {}};
        r.x = Variables(model, r.point).of(r.point);
        r.covariance = 1e-6 * Eigen::MatrixXd::Identity(2, 2);
        return r;
    };
    Store store;
    Evaluator evaluator(model, 1, {}, store);
    const auto next = nextExperiment(evaluator, {rival("high", 0), rival("low", 1)}, quiet(), 0.0);
    CHECK((!next || !next->settles));
    if (next)
        CHECK(inWords(*next).find("may not settle the matter") != std::string::npos);
}
