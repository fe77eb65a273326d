// Fits on springs in closed form: derivatives beside jumps, intervals along bent valleys.

#include "toy.h"

#include "plugin/identification/diagnosis/box.h"
#include "plugin/identification/diagnosis/estimation/nominal.h"
#include "plugin/identification/diagnosis/estimation/profile.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/result/present.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/search.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace supercircle::diagnosis;

namespace {

/// A spring one of whose readings jumps by 5 N where the stiffness passes a value, as by a snap that comes later.
class Snapping final : public toy::Spring {
public:
    Snapping(const Data& data, double at) : Spring(data), at_(at) {}

private:
    void alter(std::size_t, const Point& p, Response& out) const override {
        out.force[out.force.size() / 3] += p.nominal[0] > at_ ? 5.0 : 0.0;
    }

    double at_;
};

} // namespace

TEST_CASE("a reading that jumps beside the fit does not count as a derivative", "[diagnosis]") {
    const Data data = toy::recordings(3);
    const Snapping model(data, 103.5);
    const toy::Spring smooth(data);
    Store store, other;
    Evaluator evaluator(model, data.runs.size(), {}, store), plain(smooth, data.runs.size(), {}, other);
    const Point at{{103.0, 0.08}, {}};
    const auto there = plain.everywhere({at}, Fineness::Fine).front();
    const Misfit misfit(data, estimateNoise(data), there, there, {});
    const Variables v(model, at);
    Eigen::MatrixXd truth, quieter;
    differentiate(plain, misfit, v, v.of(at), 0.2, {0, 1}, truth);
    differentiate(evaluator, misfit, v, v.of(at), 0.2, {0, 1}, quieter);
    const Eigen::MatrixXd careful = differentiateCarefully(evaluator, misfit, v, v.of(at), 0.2);
    const double step = 0.2 * v.scalar(0).step;
    const auto change =
        misfit.difference(evaluator.everywhere({Point{{103.0 + step, 0.08}, {}}}, Fineness::Coarse).front(),
                          evaluator.everywhere({Point{{103.0 - step, 0.08}, {}}}, Fineness::Coarse).front());
    REQUIRE(change);
    CHECK((*change / 0.4 - truth.col(0)).norm() > 10.0 * truth.norm()); // what a central difference makes of it
    CHECK((careful - truth).norm() < 1e-9 * truth.norm());              // linear but for the jump: rounding only
    CHECK((quieter - truth).norm() < 1e-9 * truth.norm()); // 5 N are so much that the other side alone is looked at
}

namespace {

/// A spring with a third stated number that changes no reading, but decides whether the specimen is on the branch that
/// was recorded: it leaves it where the stiffness is beyond a value that grows with this number. From the stated values
/// every way towards the truth along one number alone leads off the branch.
class Branching final : public toy::Spring {
public:
    explicit Branching(const Data& data, double least) : Spring(data), least_(least), nominal_(Spring::nominal()) {
        nominal_.push_back({"passage", "1", "", 0.0, -1.0, 1.0, 1.0, Scale::Linear, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] double edge(double passage) const { return least_ + 4.0 * passage; }

private:
    void alter(std::size_t, const Point& p, Response& out) const override {
        if (p.nominal[0] > edge(p.nominal[2]))
            out.force *= 0.2;
    }

    double least_;
    std::vector<Scalar> nominal_;
};

} // namespace

TEST_CASE("derivatives at the edge of a branch are those of the branch", "[diagnosis]") {
    const Data data = toy::recordings(3);
    const Branching model(data, 101.0);
    const toy::Spring smooth(data);
    Store store, other;
    Evaluator evaluator(model, data.runs.size(), {}, store), plain(smooth, data.runs.size(), {}, other);
    const Point at{{100.5, 0.08, 0.0}, {}}, inner{{100.5, 0.08}, {}};
    const auto there = plain.everywhere({inner}, Fineness::Fine).front();
    const Misfit misfit(data, estimateNoise(data), there, there, {});
    const Variables v(model, at), w(smooth, inner);
    Eigen::MatrixXd truth, found;
    CHECK_FALSE(differentiate(plain, misfit, w, w.of(inner), 0.2, {0, 1}, truth));
    CHECK(differentiate(evaluator, misfit, v, v.of(at), 0.2, {0, 1, 2}, found)); // .5 N/m ahead of the edge, 1.2 apart
    CHECK((found.leftCols(2) - truth).norm() < 1e-9 * truth.norm()); // linear but for the edge: rounding only
    CHECK(found.col(2).norm() < 1e-9 * truth.norm());
    const Point inside{{98.0, 0.08, 0.0}, {}}; // the passage is looked at over its whole half-width: edge at 97
    CHECK_FALSE(differentiate(evaluator, misfit, v, v.of(inside), 0.2, {0, 1}, found));
}

TEST_CASE("a nominal fit that ends at the edge of a branch is looked for elsewhere before anything is missing",
          "[diagnosis]") {
    // 103 N/m are in reach where the passage is beyond .2. What is left in front of it is so little that the fit alone
    // looks nowhere else, and it raises no alarm, because a stiffness could do it.
    const Data data = toy::recordings(11);
    const Branching model(data, 102.2);
    Store store;
    Evaluator evaluator(model, data.runs.size(), {}, store);
    const Diagnosis d = diagnose(data, evaluator, toy::exact());
    CHECK(d.verdict == "nothing_missing");
    REQUIRE(d.nominal.size() == 3);
    CHECK(d.nominal[0].fitted == Approx(103.0).margin(0.4)); // four deviations of a stiffness behind such noise
}

namespace {

/// A spring with a third stated number, which hardly changes any reading, and with steps that end just before or just
/// behind readings: each of them has one of two values, half a noise unit apart, another one at every place.
class Stepping final : public toy::Spring {
public:
    explicit Stepping(const Data& data, double ripple = 0.005)
        : Spring(data), ripple_(ripple), nominal_(Spring::nominal()) {
        nominal_.push_back({"faint", "1", "", 0.0, -2.0, 2.0, 1.0, Scale::Linear, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }

private:
    void alter(std::size_t r, const Point& p, Response& out) const override {
        const RecordedRun& run = data_.runs[r];
        for (Eigen::Index k = 0; k < out.force.size(); ++k) {
            const double chance = 1e4 * std::sin(12.9898 * static_cast<double>(k) + 78.233 * p.nominal[2]);
            const bool rare = chance - std::floor(chance) < 0.01;
            out.force[k] += 0.8 * run.displacement[k] * p.nominal[2] + (rare ? ripple_ : 0.0);
        }
    }

    double ripple_;
    std::vector<Scalar> nominal_;
};

} // namespace

TEST_CASE("of a number that hardly shows derivatives are taken over more of its interval", "[diagnosis]") {
    const Data data = toy::recordings(3);
    const Stepping model(data), smooth(data, 0.0);
    Store store, other;
    Evaluator evaluator(model, data.runs.size(), {}, store), plain(smooth, data.runs.size(), {}, other);
    const Point at{{103.0, 0.08, 0.0}, {}};
    const auto there = plain.everywhere({at}, Fineness::Fine).front();
    const Misfit misfit(data, estimateNoise(data), there, there, {});
    const Variables v(model, at);
    Eigen::MatrixXd truth, stepping;
    differentiate(plain, misfit, v, v.of(at), 0.2, {1, 2}, truth);
    const auto before = evaluator.asked();
    differentiate(evaluator, misfit, v, v.of(at), 0.2, {1, 2}, stepping);
    const double faint = truth.col(2).norm(), off = (stepping - truth).col(2).norm();
    CAPTURE(faint, off);
    // Two readings of a hundred change by half a noise unit between any two places. Over 2 x 0.2 that is more than the
    // column itself; over five times as much a fifth of it.
    const auto change =
        misfit.difference(evaluator.everywhere({v.at(v.of({{103.0, 0.08, 0.2}, {}}))}, Fineness::Coarse).front(),
                          evaluator.everywhere({v.at(v.of({{103.0, 0.08, -0.2}, {}}))}, Fineness::Coarse).front());
    const double near = (*change / 0.4 - truth.col(2)).norm();
    CAPTURE(near);
    CHECK(near > 4.0 * off);
    // Friction, which shows well, is taken where it was asked for, the other one twice.
    CHECK(evaluator.asked() - before == 6 * data.runs.size());
}

namespace {

/// A spring with a law of two numbers that do each other's work: a (1 - exp(-x / b)), of which little more than a / b
/// shows where x stays below b.
class Saturating final : public toy::Spring {
public:
    using Spring::Spring;
    [[nodiscard]] const std::vector<Candidate>& candidates() const override { return candidates_; }

private:
    void alter(std::size_t r, const Point& p, Response& out) const override {
        for (const Term& t : p.terms)
            out.force.array() +=
                t.values[0] *
                (1.0 - (-data_.runs[r].displacement.array() / outer(Scale::Logarithm, t.values[1])).exp());
    }

    std::vector<Candidate> candidates_ = {{"saturates",
                                           "",
                                           "",
                                           "",
                                           {{"a", "N", "", 0.0, 0.0, 50.0, 0.5, Scale::Linear, true},
                                            {"b", "m", "", inner(Scale::Logarithm, 0.01), inner(Scale::Logarithm, 1e-3),
                                             inner(Scale::Logarithm, 0.3), 0.5, Scale::Logarithm, false}},
                                           {{2.0, inner(Scale::Logarithm, 0.01)}}}};
};

/// Smallest misfit with a held, over b on a fine grid and the nominal numbers in their box: a linear problem each.
double leastWith(const Saturating& model, const Misfit& misfit, double a) {
    const auto at = [&](const Point& p) {
        std::vector<Response> out;
        for (std::size_t r = 0; r < misfit.runs(); ++r)
            out.push_back(model.simulate(r, p, Fineness::Fine, nullptr));
        return out;
    };
    const std::vector<Scalar>& n = model.nominal();
    double least = std::numeric_limits<double>::infinity();
    for (double b = 2e-3; b < 0.3; b *= 1.01) {
        const std::vector<double> law = {a, inner(Scale::Logarithm, b)};
        const auto here = at({{n[0].value, n[1].value}, {{0, law}}});
        Eigen::MatrixXd J(misfit.rows(), 2);
        J.col(0) = *misfit.difference(at({{n[0].upper, n[1].value}, {{0, law}}}), here);
        J.col(1) = *misfit.difference(at({{n[0].value, n[1].upper}, {{0, law}}}), here);
        const Eigen::VectorXd u = *misfit.residual(here), one = Eigen::VectorXd::Ones(2);
        least = std::min(least, (u - J * boxMinimum(J.transpose() * J, J.transpose() * u, -one, one)).squaredNorm());
    }
    return least;
}

} // namespace

namespace {

/// The same law as something that is stated, with intervals.
class SaturatingStated final : public Model {
public:
    explicit SaturatingStated(const Data& data) : law_(data), nominal_(law_.nominal()) {
        for (const Scalar& s : law_.candidates()[0].parameters)
            nominal_.push_back(s);
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<Candidate>& candidates() const override { return none_; }
    [[nodiscard]] std::string identity() const override { return "stated saturation"; }
    [[nodiscard]] Response simulate(std::size_t r, const Point& p, Fineness f,
                                    const std::atomic<bool>* interrupt) const override {
        const Point split{{p.nominal[0], p.nominal[1]}, {{0, {p.nominal[2], p.nominal[3]}}}};
        return law_.simulate(r, split, f, interrupt);
    }

private:
    Saturating law_;
    std::vector<Scalar> nominal_;
    std::vector<Candidate> none_;
};

/// How many searches of the law from twelve starts end beside the best place, and how many there are.
struct Lost {
    int effect = 0, behind = 0, stated = 0, all = 0;
    void count(double a, double b) {
        Data data = toy::recordings(1);
        const Saturating model(data);
        toy::hide(data, model, {{0, {a, inner(Scale::Logarithm, b)}}});
        const SaturatingStated stating(data);
        Store store, other;
        Evaluator evaluator(model, data.runs.size(), {}, store), stated_(stating, data.runs.size(), {}, other);
        const auto there = evaluator.everywhere({Point{{100.0, 0.1}, {}}}, Fineness::Fine).front();
        const Misfit misfit(data, estimateNoise(data), there, there, toy::exact().misfit);
        const Fitted base = fit(evaluator, misfit, Point{{100.0, 0.1}, {}});
        FitSettings known; // a rival that is as good as can be
        known.rival = static_cast<double>(misfit.present());
        std::vector<double> ends, withRival, asStated;
        for (const double force : {0.1, 0.6, 3.0})
            for (const double length : {1.2e-3, 5e-3, 0.03, 0.2}) {
                const std::vector<double> law = {force, inner(Scale::Logarithm, length)};
                const Point start{base.point.nominal, {{0, law}}};
                ends.push_back(fit(evaluator, misfit, start, {}, base.jacobian).misfit);
                withRival.push_back(fit(evaluator, misfit, start, known, base.jacobian).misfit);
                asStated.push_back(fit(stated_, misfit, Point{{100.0, 0.1, law[0], law[1]}, {}}).misfit);
            }
        const double best = *std::min_element(ends.begin(), ends.end());
        const auto beside = [&](const std::vector<double>& these) { // two units are what one number more is worth
            return static_cast<int>(
                std::count_if(these.begin(), these.end(), [&](double m) { return m > best + 2.0; }));
        };
        effect += beside(ends);
        behind += beside(withRival);
        stated += beside(asStated);
        all += static_cast<int>(ends.size());
    }
};

} // namespace

TEST_CASE("a search finds its way along a bent valley from nearly everywhere", "[diagnosis]") {
    Lost lost;
    for (const double b : {1e-3, 5e-3})
        for (const double a : {0.6, 2.0, 5.0})
            lost.count(a, b);
    INFO(lost.effect << ", beside a rival " << lost.behind << ", as stated numbers " << lost.stated << " of "
                     << lost.all);
    // What is left starts with forty times the length of a small force, where the stiffness is driven to its bound.
    CHECK(lost.effect <= lost.all / 15);
    CHECK(lost.stated <= lost.all / 10);    // no effect's derivatives to take anew first
    CHECK(lost.behind <= 2 * lost.all / 5); // far above a rival a search is given up where it creeps
}

TEST_CASE("an interval follows the valley of two numbers that do each other's work", "[diagnosis]") {
    Data data = toy::recordings(3);
    const Saturating model(data);
    toy::hide(data, model, {{0, {0.6, inner(Scale::Logarithm, 0.01)}}});
    Store store;
    Evaluator evaluator(model, data.runs.size(), {}, store);
    const Point stated{{100.0, 0.1}, {}};
    const auto there = evaluator.everywhere({stated}, Fineness::Fine).front();
    const Misfit misfit(data, estimateNoise(data), there, there, toy::exact().misfit);
    const Fitted found = fit(evaluator, misfit, Point{stated.nominal, {{0, {0.5, inner(Scale::Logarithm, 0.01)}}}});
    const Variables v(model, found.point);
    const Eigen::MatrixXd J = differentiateCarefully(evaluator, misfit, v, found.x, 0.2);
    const Eigen::VectorXd dispersions = dispersionsOf(misfit, v, found.residual, J, misfitPerRow(misfit, found));
    const double dispersion = dispersions[2];
    const auto linear = linearIntervals(v, found, J, dispersions),
               profiled = profileIntervals(evaluator, misfit, found, J, dispersions).intervals;
    const auto a = [&](double x) { return v.scalar(2).value + x * v.scalar(2).step; };
    const double least = leastWith(model, misfit, a(found.x[2]));
    const auto outside = [&](double x) { return leastWith(model, misfit, a(x)) - least > 2.706 * dispersion; };
    const auto endTowards = [&](double far) {
        double in = found.x[2], out = far;
        REQUIRE(outside(out));
        for (int i = 0; i < 7; ++i)
            (outside(0.5 * (in + out)) ? out : in) = 0.5 * (in + out);
        return a(0.5 * (in + out));
    };
    const double low = endTowards(v.lower[2] + 0.1), high = endTowards(found.x[2] + 4.0), width = high - low;
    INFO("truth " << low << " to " << high << ", linear " << a(linear[0].low) << " to " << a(linear[0].high)
                  << ", profile " << a(profiled[0].low) << " to " << a(profiled[0].high));
    // Ends are closed in on to a tenth of their distance, of which the search for them stops anywhere.
    CHECK(std::abs(a(profiled[0].low) - low) < 0.1 * width);
    CHECK(std::abs(a(profiled[0].high) - high) < 0.1 * width);
    CHECK(std::abs(a(linear[0].low) - low) > 0.2 * width); // the valley is bent
    CHECK(std::abs(a(linear[0].high) - high) > 0.2 * width);
    // From somewhere else in the valley a profile comes upon a better fit, and hands it over.
    Fitted beside = found;
    beside.x[3] += 0.7;
    beside.point = v.at(beside.x);
    REQUIRE(evaluate(evaluator, misfit, v, beside));
    REQUIRE(beside.misfit > found.misfit + 2.0 * dispersion);
    const Eigen::MatrixXd K = differentiateCarefully(evaluator, misfit, v, beside.x, 0.2);
    const Profiled ended = profileIntervals(evaluator, misfit, beside, K, dispersions, true);
    REQUIRE(ended.better);
    CHECK(ended.better->misfit < beside.misfit - dispersion);
    CHECK_FALSE(profileIntervals(evaluator, misfit, found, J, dispersions, true).better);
}

namespace {

/// A spring whose cubic law has a threshold that nothing reaches.
class Unreached final : public toy::Spring {
public:
    using Spring::Spring;

private:
    void alter(std::size_t r, const Point& p, Response& out) const override {
        for (const Term& t : p.terms)
            if (candidates()[t.candidate].label == "cubic")
                out.force -= (t.values[0] * data_.runs[r].displacement.array().cube()).matrix();
    }
};

/// What a search finds beside a nominal fit that ended `off` steps of the stiffness from where it should, when the
/// first look promises much of the cubic law.
struct Beside {
    Fitted right, base;
    Searched found;
};
Beside searchBeside(const Data& data, const toy::Spring& model, double off) {
    Store store;
    Evaluator evaluator(model, data.runs.size(), {}, store);
    const Settings settings = toy::exact();
    Nominal nominal = fitNominal(data, evaluator, estimateNoise(data), settings, [](double, const std::string&) {});
    REQUIRE(nominal.failure.empty());
    Beside out{nominal.fit, nominal.fit, {}};
    const Variables v(model, out.base.point);
    out.base.x[0] += off;
    out.base.point = v.at(out.base.x);
    REQUIRE(evaluate(evaluator, *nominal.misfit, v, out.base));
    Screened probe;
    probe.candidate = 2;
    probe.values = {1e5};
    probe.stretch = 1.0;
    probe.gain = 50.0;
    probe.size = probe.own = 7.0;
    probe.simulated = true;
    probe.signature = -out.base.residual.normalized() * probe.size;
    const Grouping grouping = groupingOf(*nominal.misfit);
    const HeldOut held = heldOutOf(evaluator, *nominal.misfit, grouping, out.base, settings);
    const std::vector<Screened> screened = {probe};
    const Ground ground{data, evaluator, settings, *nominal.misfit, grouping, out.base, held, screened, 1e-3, 0.0};
    out.found = search(ground, [](double, const std::string&) {});
    if (out.found.elsewhere)
        CHECK(searchFrom(evaluator, *nominal.misfit, *out.found.elsewhere, out.base));
    return out;
}

} // namespace

TEST_CASE("an effect that changes no reading is no hypothesis, and its better nominal numbers are kept",
          "[diagnosis]") {
    const Data data = toy::recordings(78);
    const Unreached idle(data);
    REQUIRE(idle.candidates()[2].label == "cubic");
    const Beside without = searchBeside(data, idle, 0.3);
    CHECK(without.found.tried.empty());
    REQUIRE(without.found.elsewhere);
    CHECK(without.found.elsewhere->terms.empty());
    // The nominal problem is linear: a fit ends where its end is uncertain by half a square.
    CHECK(without.base.misfit == Approx(without.right.misfit).margin(0.5));

    const toy::Spring acting(data);
    const Beside with = searchBeside(data, acting, 0.3);
    CHECK(with.found.tried.size() == 1);
    CHECK_FALSE(with.found.elsewhere);
}
