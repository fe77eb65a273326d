// Fits of springs in closed form: derivatives beside jumps, intervals along bent valleys.

#include "toy.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/estimation/baseline_fit.h"
#include "plugin/identification/diagnosis/estimation/profile.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/result/report_values.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/hypothesis_search.h"

#include <catch2/catch.hpp>
#include <limits>

using namespace supercircle::diagnosis;

namespace {

/// A spring one of whose readings jumps by 5 N where the stiffness passes a value, like a snap that comes one reading
/// later.
class Snapping final : public toy::Spring {
public:
    Snapping(const RecordedData& data, double at) : Spring(data), at_(at) {}

private:
    void alter(std::size_t, const ParameterPoint& p, Response& out) const override {
        out.force[out.force.size() / 3] += p.nominal[0] > at_ ? 5.0 : 0.0;
    }

    double at_;
};

} // namespace

TEST_CASE("a jump beside the fit is no derivative", "[diagnosis]") {
    const RecordedData data = toy::recordings(3);
    const Snapping model(data, 103.5);
    const toy::Spring smooth(data);
    SimulationCache cache, other;
    Evaluator evaluator(model, data.runs.size(), {}, cache), plain(smooth, data.runs.size(), {}, other);
    const ParameterPoint at{{103.0, 0.08}, {}};
    const auto there = plain.simulateAllRuns({at}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    const Variables v(model, at);
    Eigen::MatrixXd truth, quieter;
    differentiate(plain, likelihood, v, v.of(at), 0.2, {0, 1}, truth);
    differentiate(evaluator, likelihood, v, v.of(at), 0.2, {0, 1}, quieter);
    const Eigen::MatrixXd careful = differentiateRobustly(evaluator, likelihood, v, v.of(at), 0.2);
    const double step = 0.2 * v.scalar(0).step;
    const auto change = likelihood.whitenedDifference(
        evaluator.simulateAllRuns({ParameterPoint{{103.0 + step, 0.08}, {}}}, Fidelity::Coarse).front(),
        evaluator.simulateAllRuns({ParameterPoint{{103.0 - step, 0.08}, {}}}, Fidelity::Coarse).front());
    REQUIRE(change);
    CHECK((*change / 0.4 - truth.col(0)).norm() > 10.0 * truth.norm()); // the central difference
    CHECK((careful - truth).norm() < 1e-9 * truth.norm());              // linear but for the jump: rounding only
    CHECK((quieter - truth).norm() < 1e-9 * truth.norm()); // 5 N exceed the limit, so only the other side is used
}

namespace {

/// A spring with a third stated parameter that only decides which solution branch the specimen is on. The branch ends
/// where the stiffness exceeds a value that grows with this parameter. From the stated values no step along one
/// parameter leads to the truth.
class Branching final : public toy::Spring {
public:
    explicit Branching(const RecordedData& data, double least)
        : Spring(data), least_(least), nominal_(Spring::nominal()) {
        nominal_.push_back({"passage", "1", "", 0.0, -1.0, 1.0, 1.0, Scale::Linear, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] double edge(double passage) const { return least_ + 4.0 * passage; }

private:
    void alter(std::size_t, const ParameterPoint& p, Response& out) const override {
        if (p.nominal[0] > edge(p.nominal[2]))
            out.force *= 0.2;
    }

    double least_;
    std::vector<Scalar> nominal_;
};

} // namespace

TEST_CASE("derivatives at the edge of a branch belong to that branch", "[diagnosis]") {
    const RecordedData data = toy::recordings(3);
    const Branching model(data, 101.0);
    const toy::Spring smooth(data);
    SimulationCache cache, other;
    Evaluator evaluator(model, data.runs.size(), {}, cache), plain(smooth, data.runs.size(), {}, other);
    const ParameterPoint at{{100.5, 0.08, 0.0}, {}}, toInternal{{100.5, 0.08}, {}};
    const auto there = plain.simulateAllRuns({toInternal}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    const Variables v(model, at), w(smooth, toInternal);
    Eigen::MatrixXd truth, found;
    CHECK_FALSE(differentiate(plain, likelihood, w, w.of(toInternal), 0.2, {0, 1}, truth));
    CHECK(differentiate(evaluator, likelihood, v, v.of(at), 0.2, {0, 1, 2},
                        found));                                     // .5 N/m ahead of the edge, 1.2 apart
    CHECK((found.leftCols(2) - truth).norm() < 1e-9 * truth.norm()); // linear but for the edge: rounding only
    CHECK(found.col(2).norm() < 1e-9 * truth.norm());
    const ParameterPoint inside{{98.0, 0.08, 0.0}, {}}; // differentiated over its whole half-width: edge at 97
    CHECK_FALSE(differentiate(evaluator, likelihood, v, v.of(inside), 0.2, {0, 1}, found));
}

TEST_CASE("a baseline fit held at the edge of a branch is restarted", "[diagnosis]") {
    // 103 N/m can be reached only for a third parameter above 0.2. The remaining misfit is not significant, so only the
    // branch edge triggers a restart.
    const RecordedData data = toy::recordings(11);
    const Branching model(data, 102.2);
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const Diagnosis d = diagnose(data, evaluator, toy::exact());
    CHECK(d.verdict == "adequate");
    REQUIRE(d.nominal.size() == 3);
    CHECK(d.nominal[0].fitted == Approx(103.0).margin(0.4)); // four sigma of a stiffness at such noise
}

namespace {

/// A spring with a third stated parameter of faint effect. Time steps end just before or after readings, so each
/// reading has one of two values half a sigma apart.
class Stepping final : public toy::Spring {
public:
    explicit Stepping(const RecordedData& data, double ripple = 0.005)
        : Spring(data), ripple_(ripple), nominal_(Spring::nominal()) {
        nominal_.push_back({"faint", "1", "", 0.0, -2.0, 2.0, 1.0, Scale::Linear, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
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

TEST_CASE("parameters with a faint effect are differentiated over a wider step", "[diagnosis]") {
    const RecordedData data = toy::recordings(3);
    const Stepping model(data), smooth(data, 0.0);
    SimulationCache cache, other;
    Evaluator evaluator(model, data.runs.size(), {}, cache), plain(smooth, data.runs.size(), {}, other);
    const ParameterPoint at{{103.0, 0.08, 0.0}, {}};
    const auto there = plain.simulateAllRuns({at}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    const Variables v(model, at);
    Eigen::MatrixXd truth, stepping;
    differentiate(plain, likelihood, v, v.of(at), 0.2, {1, 2}, truth);
    const auto before = evaluator.distinctRequests();
    differentiate(evaluator, likelihood, v, v.of(at), 0.2, {1, 2}, stepping);
    const double faint = truth.col(2).norm(), off = (stepping - truth).col(2).norm();
    CAPTURE(faint, off);
    // Two readings in a hundred change by half a sigma between any two points. Over 2 x 0.2 that exceeds the column
    // itself; over a step five times as wide it is a fifth.
    const auto change = likelihood.whitenedDifference(
        evaluator.simulateAllRuns({v.at(v.of({{103.0, 0.08, 0.2}, {}}))}, Fidelity::Coarse).front(),
        evaluator.simulateAllRuns({v.at(v.of({{103.0, 0.08, -0.2}, {}}))}, Fidelity::Coarse).front());
    const double near = (*change / 0.4 - truth.col(2)).norm();
    CAPTURE(near);
    CHECK(near > 4.0 * off);
    // Friction, with a clear effect, is differentiated at the given step, the other one again over a wider step.
    CHECK(evaluator.distinctRequests() - before == 6 * data.runs.size());
}

namespace {

/// A spring with a law of two correlated parameters, a (1 - exp(-x / b)); for x below b only a / b is determined.
class Saturating final : public toy::Spring {
public:
    using Spring::Spring;
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return candidates_; }

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        for (const Term& t : p.terms)
            out.force.array() +=
                t.values[0] *
                (1.0 - (-data_.runs[r].displacement.array() / toPhysical(Scale::Logarithm, t.values[1])).exp());
    }

    std::vector<CandidateEffect> candidates_ = {
        {"saturates",
         "",
         "",
         "",
         {{"a", "N", "", 0.0, 0.0, 50.0, 0.5, Scale::Linear, true},
          {"b", "m", "", toInternal(Scale::Logarithm, 0.01), toInternal(Scale::Logarithm, 1e-3),
           toInternal(Scale::Logarithm, 0.3), 0.5, Scale::Logarithm, false}},
         {{2.0, toInternal(Scale::Logarithm, 0.01)}}}};
};

/// Smallest chi-squared with a held, over b on a fine grid and nominal parameters inside their bounds: linear problems.
double leastWith(const Saturating& model, const Likelihood& likelihood, double a) {
    const auto at = [&](const ParameterPoint& p) {
        std::vector<Response> out;
        for (std::size_t r = 0; r < likelihood.runs(); ++r)
            out.push_back(model.simulate(r, p, Fidelity::Fine, nullptr));
        return out;
    };
    const std::vector<Scalar>& n = model.nominal();
    double least = std::numeric_limits<double>::infinity();
    for (double b = 2e-3; b < 0.3; b *= 1.01) {
        const std::vector<double> law = {a, toInternal(Scale::Logarithm, b)};
        const auto here = at({{n[0].value, n[1].value}, {{0, law}}});
        Eigen::MatrixXd J(likelihood.rows(), 2);
        J.col(0) = *likelihood.whitenedDifference(at({{n[0].upper, n[1].value}, {{0, law}}}), here);
        J.col(1) = *likelihood.whitenedDifference(at({{n[0].value, n[1].upper}, {{0, law}}}), here);
        const Eigen::VectorXd u = *likelihood.residual(here), one = Eigen::VectorXd::Ones(2);
        least = std::min(least, (u - J * solveBoxQp(J.transpose() * J, J.transpose() * u, -one, one)).squaredNorm());
    }
    return least;
}

} // namespace

namespace {

/// The same law with stated intervals.
class SaturatingStated final : public Model {
public:
    explicit SaturatingStated(const RecordedData& data) : law_(data), nominal_(law_.nominal()) {
        for (const Scalar& s : law_.candidates()[0].parameters)
            nominal_.push_back(s);
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override { return none_; }
    [[nodiscard]] std::string identity() const override { return "stated saturation"; }
    [[nodiscard]] Response simulate(std::size_t r, const ParameterPoint& p, Fidelity f,
                                    const std::atomic<bool>* interrupt) const override {
        const ParameterPoint split{{p.nominal[0], p.nominal[1]}, {{0, {p.nominal[2], p.nominal[3]}}}};
        return law_.simulate(r, split, f, interrupt);
    }

private:
    Saturating law_;
    std::vector<Scalar> nominal_;
    std::vector<CandidateEffect> none_;
};

/// Number of fits from twelve starts that end beside the minimum, and their total.
struct Lost {
    int effect = 0, behind = 0, stated = 0, all = 0;
    void count(double a, double b) {
        RecordedData data = toy::recordings(1);
        const Saturating model(data);
        toy::hide(data, model, {{0, {a, toInternal(Scale::Logarithm, b)}}});
        const SaturatingStated stating(data);
        SimulationCache cache, other;
        Evaluator evaluator(model, data.runs.size(), {}, cache), stated_(stating, data.runs.size(), {}, other);
        const auto there = evaluator.simulateAllRuns({ParameterPoint{{100.0, 0.1}, {}}}, Fidelity::Fine).front();
        const Likelihood likelihood(data, estimateNoise(data), there, there, toy::exact().likelihood);
        const FitResult base = fit(evaluator, likelihood, ParameterPoint{{100.0, 0.1}, {}});
        FitSettings known; // a competing fit at the minimum
        known.competitor = static_cast<double>(likelihood.countedRows());
        std::vector<double> ends, withRival, asStated;
        for (const double force : {0.1, 0.6, 3.0})
            for (const double length : {1.2e-3, 5e-3, 0.03, 0.2}) {
                const std::vector<double> law = {force, toInternal(Scale::Logarithm, length)};
                const ParameterPoint start{base.point.nominal, {{0, law}}};
                ends.push_back(fit(evaluator, likelihood, start, {}, base.jacobian).chiSquared);
                withRival.push_back(fit(evaluator, likelihood, start, known, base.jacobian).chiSquared);
                asStated.push_back(
                    fit(stated_, likelihood, ParameterPoint{{100.0, 0.1, law[0], law[1]}, {}}).chiSquared);
            }
        const double best = *std::min_element(ends.begin(), ends.end());
        const auto beside = [&](const std::vector<double>& these) { // two units of chi-squared per parameter
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

TEST_CASE("a fit converges along a bent valley from nearly every start", "[diagnosis]") {
    Lost lost;
    for (const double b : {1e-3, 5e-3})
        for (const double a : {0.6, 2.0, 5.0})
            lost.count(a, b);
    INFO(lost.effect << ", beside another effect " << lost.behind << ", in stated parameters " << lost.stated << " of "
                     << lost.all);
    // The residual starts at forty times the length of a small force, which drives the stiffness to its bound.
    CHECK(lost.effect <= lost.all / 15);
    CHECK(lost.stated <= lost.all / 10);    // without an effect there are no other derivatives to refresh
    CHECK(lost.behind <= 2 * lost.all / 5); // a slow search far above a competing fit is stopped
}

TEST_CASE("an interval follows the valley of two correlated parameters", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const Saturating model(data);
    toy::hide(data, model, {{0, {0.6, toInternal(Scale::Logarithm, 0.01)}}});
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const ParameterPoint stated{{100.0, 0.1}, {}};
    const auto there = evaluator.simulateAllRuns({stated}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, toy::exact().likelihood);
    const FitResult found =
        fit(evaluator, likelihood, ParameterPoint{stated.nominal, {{0, {0.5, toInternal(Scale::Logarithm, 0.01)}}}});
    const Variables v(model, found.point);
    const Eigen::MatrixXd J = differentiateRobustly(evaluator, likelihood, v, found.x, 0.2);
    const Eigen::VectorXd dispersions =
        dispersionsOf(likelihood, v, found.residual, J, chiSquaredPerReading(likelihood, found));
    const double dispersion = dispersions[2];
    const auto linear = linearIntervals(v, found, J, dispersions),
               profiled = profileIntervals(evaluator, likelihood, found, J, dispersions).intervals;
    const auto a = [&](double x) { return v.scalar(2).value + x * v.scalar(2).step; };
    const double least = leastWith(model, likelihood, a(found.x[2]));
    const auto outside = [&](double x) { return leastWith(model, likelihood, a(x)) - least > 2.706 * dispersion; };
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
    // Ends are bracketed to a tenth of their distance.
    CHECK(std::abs(a(profiled[0].low) - low) < 0.1 * width);
    CHECK(std::abs(a(profiled[0].high) - high) < 0.1 * width);
    CHECK(std::abs(a(linear[0].low) - low) > 0.2 * width); // the valley is bent
    CHECK(std::abs(a(linear[0].high) - high) > 0.2 * width);
    // From another point of the valley a profile finds a better fit and returns it.
    FitResult beside = found;
    beside.x[3] += 0.7;
    beside.point = v.at(beside.x);
    REQUIRE(evaluate(evaluator, likelihood, v, beside));
    REQUIRE(beside.chiSquared > found.chiSquared + 2.0 * dispersion);
    const Eigen::MatrixXd K = differentiateRobustly(evaluator, likelihood, v, beside.x, 0.2);
    const Profiled ended = profileIntervals(evaluator, likelihood, beside, K, dispersions, true);
    REQUIRE(ended.better);
    CHECK(ended.better->chiSquared < beside.chiSquared - dispersion);
    CHECK_FALSE(profileIntervals(evaluator, likelihood, found, J, dispersions, true).better);
}

namespace {

/// A spring whose cubic law has a threshold that is never reached.
class Unreached final : public toy::Spring {
public:
    using Spring::Spring;

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        for (const Term& t : p.terms)
            if (candidates()[t.candidate].label == "cubic")
                out.force -= (t.values[0] * data_.runs[r].displacement.array().cube()).matrix();
    }
};

/// Hypothesis search beside a baseline fit that ended `off` steps of stiffness from its minimum, with a large screening
/// gain of the cubic law.
struct Beside {
    FitResult right, base;
    SearchResult found;
};
Beside searchBeside(const RecordedData& data, const toy::Spring& model, double off) {
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const DiagnosisSettings settings = toy::exact();
    BaselineFit nominal =
        fitBaseline(data, evaluator, estimateNoise(data), settings, [](double, const std::string&) {});
    REQUIRE(nominal.failure.empty());
    Beside out{nominal.fit, nominal.fit, {}};
    const Variables v(model, out.base.point);
    out.base.x[0] += off;
    out.base.point = v.at(out.base.x);
    REQUIRE(evaluate(evaluator, *nominal.likelihood, v, out.base));
    ScreenedProbe probe;
    probe.candidate = 2;
    probe.values = {1e5};
    probe.factor = 1.0;
    probe.gain = 50.0;
    probe.norm = probe.independentNorm = 7.0;
    probe.simulated = true;
    probe.signature = -out.base.residual.normalized() * probe.norm;
    const Grouping grouping = groupingOf(*nominal.likelihood);
    const PredictiveScore held = predictiveScoreOf(evaluator, *nominal.likelihood, grouping, out.base, settings);
    const std::vector<ScreenedProbe> screened = {probe};
    const SearchInput input{data,     evaluator, settings, *nominal.likelihood, grouping, out.base, held,
                            screened, 1e-3,      0.0};
    out.found = search(input, [](double, const std::string&) {});
    if (out.found.elsewhere)
        CHECK(refitFrom(evaluator, *nominal.likelihood, *out.found.elsewhere, out.base));
    return out;
}

} // namespace

TEST_CASE("an effect that changes no reading is no hypothesis, its better baseline is kept", "[diagnosis]") {
    const RecordedData data = toy::recordings(78);
    const Unreached idle(data);
    REQUIRE(idle.candidates()[2].label == "cubic");
    const Beside without = searchBeside(data, idle, 0.3);
    CHECK(without.found.hypotheses.empty());
    REQUIRE(without.found.elsewhere);
    CHECK(without.found.elsewhere->terms.empty());
    // The baseline problem is linear; the tolerance of a fit is half a unit of chi-squared.
    CHECK(without.base.chiSquared == Approx(without.right.chiSquared).margin(0.5));

    const toy::Spring acting(data);
    const Beside with = searchBeside(data, acting, 0.3);
    CHECK(with.found.hypotheses.size() == 1);
    CHECK_FALSE(with.found.elsewhere);
}
