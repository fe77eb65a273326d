#include "plugin/identification/diagnosis/result/present.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

using Index = Eigen::Index;

FoundEffect presentEffect(const Model& model, const Misfit& misfit, const Grouping& grouping, const Tried& t,
                          std::size_t shown, const Spread& spread) {
    const std::vector<Candidate>& candidates = model.candidates();
    const Candidate& c = candidates[t.candidates[shown]];
    FoundEffect e;
    e.label = c.label;
    e.slot = c.slot;
    e.form = c.form;
    e.law = c.law;
    e.trainingRmse = forceRmse(misfit, t.fit.responses);
    e.heldOutRmse = t.held.forceRmse;
    e.misfitPerRow = misfitPerRow(misfit, t.fit);
    const Variables v(model, t.fit.point);
    const std::vector<Index> pressed =
        t.learned ? std::vector<Index>{} : pressedAmplitudes(model, t.fit, std::max(1.0, e.misfitPerRow));
    Index first = v.nominal;
    for (std::size_t term = 0; term < t.candidates.size(); ++term) {
        const auto n = static_cast<Index>(candidates[t.candidates[term]].parameters.size());
        if (term != shown)
            e.with.push_back(candidates[t.candidates[term]].label);
        for (Index k = first; k < first + n && term == shown; ++k) {
            const Scalar& s = v.scalar(k);
            const Interval& ci = spread.intervals[static_cast<std::size_t>(k - v.nominal)];
            const auto at = [&](double x) {
                return outer(s.scale, s.value + std::clamp(x, v.lower[k], v.upper[k]) * s.step);
            };
            FittedParameter p{
                s.name, s.unit, at(t.fit.x[k]), {at(ci.low), at(ci.high), ci.eitherSide, std::abs(at(ci.least))},
                {},     s.about};
            const auto number = static_cast<std::size_t>(k);
            if (!t.learned && number < t.held.only.size() && t.held.only[number] >= 0)
                p.only = grouping.names[static_cast<std::size_t>(t.held.only[number])];
            if (p.ci90.low > p.ci90.high)
                std::swap(p.ci90.low, p.ci90.high);
            e.parameters.push_back(p);
            if (std::find(pressed.begin(), pressed.end(), k) != pressed.end())
                e.pressed.push_back(s.name);
        }
        if (term == shown && term < spread.products.size())
            for (std::size_t i = 0; i < c.products.size(); ++i)
                e.products.push_back({c.products[i].name,
                                      c.products[i].unit,
                                      productOf(c.products[i], v, t.fit.x, first),
                                      spread.products[term][i],
                                      {},
                                      {}});
        first += n;
    }
    return e;
}

std::vector<NominalResult> presentNominal(const Model& model, const Fitted& nominal) {
    std::vector<NominalResult> out;
    const Variables v(model, nominal.point);
    for (Index i = 0; i < v.nominal; ++i) {
        const Scalar& s = v.scalar(i);
        out.push_back(
            {s.name, s.unit, s.value, s.step, nominal.point.nominal[static_cast<std::size_t>(i)], nominal.x[i]});
    }
    return out;
}

std::vector<std::vector<double>> presentSimilarity(const Misfit& misfit, const Fitted& nominal,
                                                   const std::vector<const Fitted*>& fits) {
    Eigen::MatrixXd signatures(misfit.rows(), static_cast<Index>(fits.size()));
    for (std::size_t i = 0; i < fits.size(); ++i) {
        const auto s = misfit.difference(fits[i]->responses, nominal.responses);
        signatures.col(static_cast<Index>(i)) = s ? *s : Eigen::VectorXd::Zero(misfit.rows());
    }
    std::vector<std::vector<double>> out;
    for (Index i = 0; i < signatures.cols(); ++i) {
        out.emplace_back();
        for (Index j = 0; j < signatures.cols(); ++j) {
            const double n = signatures.col(i).norm() * signatures.col(j).norm();
            out.back().push_back(n > 0.0 ? signatures.col(i).dot(signatures.col(j)) / n : 0.0);
        }
    }
    return out;
}

namespace {

std::vector<Stretch> stretchesOf(const Eigen::VectorXd& time, const Eigen::VectorXd& change) {
    constexpr double kReach = 0.125, kLevel = 0.7, kGap = 0.3; // s, noise units, s
    std::vector<Stretch> all;
    Index a = 0, b = 0; // rows [a, b) lie within reach
    double sum = 0.0;
    for (Index k = 0; k < time.size(); ++k) {
        for (; b < time.size() && (time[b] <= time[k] + kReach || b <= k + 1); ++b)
            sum += change[b];
        for (; a + 1 < k && time[a] < time[k] - kReach; ++a)
            sum -= change[a];
        if (std::abs(sum) < kLevel * static_cast<double>(b - a))
            continue;
        if (!all.empty() && time[a] <= all.back().to + kGap)
            all.back().to = time[b - 1];
        else
            all.push_back({time[a], time[b - 1]});
    }
    return all;
}

std::vector<double> list(const Eigen::Ref<const Eigen::VectorXd>& v) {
    return {v.data(), v.data() + v.size()};
}

/// Whitened rows of each marker coordinate of a run.
std::vector<MarkerCurve> markerCurves(const Misfit& misfit, std::size_t r, const Fitted& nominal, const Fitted* best) {
    const RecordedRun& run = misfit.data().runs[r];
    const Index seen = run.markerTime.size();
    std::vector<MarkerCurve> out;
    for (Index c = 0; c < 2 * static_cast<Index>(run.markerCount); ++c) {
        MarkerCurve m;
        m.channel = misfit.data().markerChannel(c);
        if (!misfit.data().free)
            m.arcFraction = misfit.data().arcFraction[static_cast<std::size_t>(c / 2)];
        const Index first = run.force.size() + c * seen; // of the run's rows
        m.residual = list(nominal.residual.segment(misfit.start(r) + first, seen));
        if (best != nullptr)
            m.residualImproved = list(best->residual.segment(misfit.start(r) + first, seen));
        for (Index k = 0; k < seen; ++k)
            m.counts.push_back(misfit.counts(r, first + k));
        out.push_back(std::move(m));
    }
    return out;
}

} // namespace

std::vector<RunCurves> presentCurves(const Misfit& misfit, const Fitted& nominal, const Fitted* best) {
    std::vector<RunCurves> out;
    for (std::size_t r = 0; r < misfit.runs(); ++r) {
        const RecordedRun& run = misfit.data().runs[r];
        const Index n = run.force.size();
        RunCurves c;
        c.name = run.name;
        c.time = list(run.time);
        c.displacement = list(run.displacement);
        c.recorded = list(run.force);
        c.baseline = list(nominal.responses[r].force);
        c.residual = list(nominal.residual.segment(misfit.start(r), n));
        if (best != nullptr) {
            c.improved = list(best->responses[r].force);
            c.residualImproved = list(best->residual.segment(misfit.start(r), n));
            const double noise = std::max(misfit.noise().total(), 1e-300);
            // Rows that are not looked at may lie behind the end of a simulation.
            c.shows =
                stretchesOf(run.time, (best->responses[r].force - nominal.responses[r].force).unaryExpr([&](double d) {
                    return std::isfinite(d) ? d / noise : 0.0;
                }));
        }
        for (Index k = 0; k < n; ++k)
            c.counts.push_back(std::isfinite(misfit.errors(r).force[k]));
        c.markerTime = list(run.markerTime);
        c.markers = markerCurves(misfit, r, nominal, best);
        out.push_back(std::move(c));
    }
    return out;
}

std::vector<Window> windowsOfEffect(const Data& data, const std::vector<RunCurves>& curves, const Localisation& found) {
    std::vector<Window> all;
    for (std::size_t r = 0; r < curves.size(); ++r)
        for (const Stretch& s : curves[r].shows) {
            const std::vector<double>& t = curves[r].time;
            const auto from = std::lower_bound(t.begin(), t.end(), s.from) - t.begin();
            const auto to = std::upper_bound(t.begin(), t.end(), s.to) - t.begin();
            Window w{curves[r].name, "all", "time", data.channel, s.from, s.to, 0.0, 0.0, -1.0};
            setSpan(data.runs[r], from, to, w);
            w.z = found.signature;
            w.p = found.p;
            w.by = Seen::Trace;
            all.push_back(std::move(w));
        }
    return all;
}

} // namespace supercircle::diagnosis
