#include "plugin/identification/diagnosis/result/report_values.h"

#include "plugin/identification/diagnosis/estimation/beside_stated.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace supercircle::diagnosis {

using Index = Eigen::Index;

FittedEffect presentEffect(const Model& model, const Likelihood& likelihood, const Grouping& grouping,
                           const FittedHypothesis& t, std::size_t shown, const ParameterIntervals& intervals,
                           double baselineChiSquared) {
    const std::vector<CandidateEffect>& candidates = model.candidates();
    const CandidateEffect& c = candidates[t.candidates[shown]];
    FittedEffect e;
    e.label = c.label;
    e.slot = c.slot;
    e.variant = c.variant;
    e.law = c.law;
    e.trainingRmse = forceRmse(likelihood, t.fit.responses);
    e.heldOutRmse = t.held.forceRmse;
    e.deltaChiSquared = baselineChiSquared - t.fit.chiSquared;
    e.chiSquaredPerReading = chiSquaredPerReading(likelihood, t.fit);
    e.starts = t.starts;
    e.startsAgreed = t.agreed;
    e.point = t.fit.point;
    const Variables v(model, t.fit.point);
    const std::vector<Index> atBound =
        t.learned ? std::vector<Index>{} : amplitudesAtBound(model, t.fit, std::max(1.0, e.chiSquaredPerReading));
    Index first = v.nominal;
    for (std::size_t term = 0; term < t.candidates.size(); ++term) {
        const auto n = static_cast<Index>(candidates[t.candidates[term]].parameters.size());
        if (term != shown)
            e.jointWith.push_back(candidates[t.candidates[term]].label);
        for (Index k = first; k < first + n && term == shown; ++k) {
            const Scalar& s = v.scalar(k);
            const Interval& ci = intervals.intervals[static_cast<std::size_t>(k - v.nominal)];
            const auto at = [&](double x) {
                return toPhysical(s.scale, s.value + std::clamp(x, v.lower[k], v.upper[k]) * s.step);
            };
            FittedParameter p{s.name,
                              s.unit,
                              at(t.fit.x[k]),
                              {at(ci.low), at(ci.high), ci.signAmbiguous, std::abs(at(ci.smallestMagnitude))},
                              {},
                              s.about};
            const auto number = static_cast<std::size_t>(k);
            if (!t.learned && number < t.held.identifiedOnlyBy.size() && t.held.identifiedOnlyBy[number] >= 0)
                p.identifiedOnlyBy = grouping.names[static_cast<std::size_t>(t.held.identifiedOnlyBy[number])];
            if (p.ci90.low > p.ci90.high)
                std::swap(p.ci90.low, p.ci90.high);
            e.parameters.push_back(p);
            if (std::find(atBound.begin(), atBound.end(), k) != atBound.end())
                e.atBound.push_back(s.name);
        }
        if (term == shown && term < intervals.derived.size())
            for (std::size_t i = 0; i < c.derived.size(); ++i)
                e.derived.push_back({c.derived[i].name,
                                     c.derived[i].unit,
                                     derivedValue(c.derived[i], v, t.fit.x, first),
                                     intervals.derived[term][i],
                                     {},
                                     {}});
        first += n;
    }
    return e;
}

std::vector<ScreenedEffect> presentScreening(const std::vector<CandidateEffect>& candidates,
                                             const std::vector<ScreenedProbe>& screened, double critical) {
    std::vector<ScreenedEffect> all;
    for (const ScreenedProbe& s : screened) {
        if (candidates[s.candidate].isNumber()) // no effect of the catalogue
            continue;
        const std::string& label = candidates[s.candidate].label;
        auto at = std::find_if(all.begin(), all.end(), [&](const ScreenedEffect& e) { return e.label == label; });
        if (at == all.end()) {
            at = all.insert(all.end(), ScreenedEffect{});
            at->label = label;
            at->detectable = std::numeric_limits<double>::infinity();
        }
        if (!s.simulated || s.norm <= 1e-6)
            continue;
        if (const double visible = s.detectable(critical); visible < at->detectable) {
            at->detectable = visible;
            at->absorbedFraction = 1.0 - std::min(1.0, s.independentNorm / s.norm);
            at->signatureNorm = s.norm / s.relativeAmplitude;
        }
        at->gain = std::max(at->gain, s.gain);
    }
    return all;
}

std::vector<NominalResult> presentNominal(const Model& model, const FitResult& nominal) {
    std::vector<NominalResult> out;
    const Variables v(model, nominal.point);
    for (Index i = 0; i < v.nominal; ++i) {
        const Scalar& s = v.scalar(i);
        if (s.batch >= 0)
            continue;
        const double stated = toPhysical(s.scale, s.value), fitted = nominal.point.nominal[static_cast<std::size_t>(i)];
        const bool logarithmic = s.scale == Scale::Logarithm;
        out.push_back({s.name, s.unit, stated, logarithmic ? stated * s.step : s.step, toPhysical(s.scale, fitted),
                       nominal.x[i], s.precision > 0.0 ? (logarithmic ? "log_normal" : "normal") : ""});
    }
    return out;
}

std::vector<std::vector<double>> presentSimilarity(const Likelihood& likelihood, const FitResult& nominal,
                                                   const std::vector<const FitResult*>& fits) {
    Eigen::MatrixXd signatures(likelihood.rows(), static_cast<Index>(fits.size()));
    for (std::size_t i = 0; i < fits.size(); ++i) {
        const auto s = likelihood.whitenedDifference(fits[i]->responses, nominal.responses);
        signatures.col(static_cast<Index>(i)) = s ? *s : Eigen::VectorXd::Zero(likelihood.rows());
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

/// @param unit s, natural unit of time
std::vector<TimeInterval> visibleIntervalsOf(const Eigen::VectorXd& time, const Eigen::VectorXd& change, double unit) {
    constexpr double kLevel = 0.7;                       // sigma
    const double reach = 0.125 * unit, gap = 0.3 * unit; // s
    std::vector<TimeInterval> all;
    Index a = 0, b = 0; // rows [a, b) lie within reach
    double sum = 0.0;
    for (Index k = 0; k < time.size(); ++k) {
        for (; b < time.size() && (time[b] <= time[k] + reach || b <= k + 1); ++b)
            sum += change[b];
        for (; a + 1 < k && time[a] < time[k] - reach; ++a)
            sum -= change[a];
        if (std::abs(sum) < kLevel * static_cast<double>(b - a))
            continue;
        if (!all.empty() && time[a] <= all.back().to + gap)
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
std::vector<MarkerCurve> markerCurves(const Likelihood& likelihood, std::size_t r, const FitResult& nominal,
                                      const FitResult* best) {
    const RecordedRun& run = likelihood.data().runs[r];
    const Index frames = run.markerTime.size(), n = run.force.size();
    std::vector<MarkerCurve> out;
    const auto add = [&](MarkerCurve m, Index first, Index count) { // `first` of the run's rows
        m.residual = list(nominal.residual.segment(likelihood.start(r) + first, count));
        if (best != nullptr)
            m.residualImproved = list(best->residual.segment(likelihood.start(r) + first, count));
        for (Index k = 0; k < count; ++k)
            m.counts.push_back(likelihood.counts(r, first + k));
        out.push_back(std::move(m));
    };
    for (Index c = 0; c < 2 * static_cast<Index>(run.markerCount); ++c) {
        MarkerCurve m;
        m.channel = likelihood.data().markerChannel(c);
        if (!likelihood.data().free)
            m.arcFraction = likelihood.data().arcFraction[static_cast<std::size_t>(c / 2)];
        add(std::move(m), n + c * frames, frames);
    }
    for (std::size_t c = 0; c < run.furtherCount; ++c) {
        MarkerCurve m;
        m.channel = likelihood.data().further[c].name;
        m.ofMarker = false;
        add(std::move(m), n + run.markers.size() + static_cast<Index>(c) * n, n);
    }
    return out;
}

/// Root mean square error of a further channel in rows that count, in its unit.
double furtherRmse(const Likelihood& likelihood, std::size_t channel, const std::vector<Response>& simulated) {
    double sum = 0.0, rows = 0.0;
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const RecordedRun& run = likelihood.data().runs[r];
        const RawDifference d = likelihood.rawResidual(r, simulated[r]);
        const Index first = run.force.size() + run.markers.size() + static_cast<Index>(channel) * run.force.size();
        for (Index k = first; k < first + run.force.size() && k < d.rows.size(); ++k)
            if (likelihood.counts(r, k) && !d.masked[static_cast<std::size_t>(k)]) {
                sum += d.rows[k] * d.rows[k];
                rows += 1.0;
            }
    }
    return rows > 0.0 ? std::sqrt(sum / rows) : 0.0;
}

} // namespace

Eigen::VectorXd forceResidual(const Likelihood& likelihood, std::size_t run, const Response& simulated) {
    const RawDifference d = likelihood.rawResidual(run, simulated);
    Eigen::VectorXd left =
        Eigen::VectorXd::Constant(likelihood.data().runs[run].force.size(), std::numeric_limits<double>::quiet_NaN());
    for (Eigen::Index k = 0; k < left.size() && d.rows.size() > 0; ++k)
        if (likelihood.counts(run, k))
            left[k] = d.rows[k];
    return left;
}

std::vector<ChannelError> furtherErrorsOf(const Likelihood& likelihood, const FitResult& nominal,
                                          const FitResult* best) {
    std::vector<ChannelError> out;
    for (std::size_t c = 0; c < likelihood.data().further.size(); ++c) {
        const FurtherColumn& column = likelihood.data().further[c];
        out.push_back({column.name, column.unit, likelihood.noise().further[c].total(),
                       furtherRmse(likelihood, c, nominal.responses),
                       best != nullptr ? furtherRmse(likelihood, c, best->responses) : 0.0});
    }
    return out;
}

std::vector<RunCurves> presentCurves(const Likelihood& likelihood, const FitResult& nominal, const FitResult* best) {
    std::vector<RunCurves> out;
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const RecordedRun& run = likelihood.data().runs[r];
        const Index n = run.force.size();
        RunCurves c;
        c.name = run.name;
        c.time = list(run.time);
        c.displacement = list(run.displacement);
        c.recorded = list(run.force);
        c.baseline = list(nominal.responses[r].force);
        c.residual = list(nominal.residual.segment(likelihood.start(r), n));
        if (best != nullptr) {
            c.improved = list(best->responses[r].force);
            c.residualImproved = list(best->residual.segment(likelihood.start(r), n));
            const double noise = std::max(likelihood.noise().total(), 1e-300);
            // Rows that do not count may lie after the end of a simulation.
            c.visibleIntervals = visibleIntervalsOf(
                run.time, (best->responses[r].force - nominal.responses[r].force).unaryExpr([&](double d) {
                    return std::isfinite(d) ? d / noise : 0.0;
                }),
                run.units.time);
        }
        for (Index k = 0; k < n; ++k)
            c.counts.push_back(std::isfinite(likelihood.errors(r).force[k]));
        c.markerTime = list(run.markerTime);
        c.markers = markerCurves(likelihood, r, nominal, best);
        out.push_back(std::move(c));
    }
    return out;
}

void addStatedBand(Evaluator& evaluator, const Likelihood& likelihood, std::vector<RunCurves>& curves) {
    if (likelihood.data().free)
        return;
    constexpr double kNormal = 1.645; // standard deviations of 90 %
    const Variables v(evaluator.model(), statedPoint(evaluator.model()));
    const BesideStated stated = simulateBesideStated(evaluator, v);
    for (std::size_t r = 0; r < curves.size(); ++r) {
        const Eigen::VectorXd& middle = stated.fine[r].force;
        if (!stated.fine[r].failure.empty() || middle.size() != static_cast<Index>(curves[r].time.size()))
            continue;
        Eigen::VectorXd spread = Eigen::VectorXd::Zero(middle.size());
        for (Index i = 0; i < v.size(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            const Eigen::VectorXd &up = stated.up[k][r].force, &down = stated.down[k][r].force;
            const double reach = std::min({v.upper[i], -v.lower[i], v.scalar(i).precision > 0.0 ? kNormal : 1.0});
            if (up.size() == middle.size() && down.size() == middle.size() && stated.span[i] > 0.0)
                spread += reach / stated.span[i] * (up - down).cwiseAbs();
        }
        curves[r].statedLow = list(middle - spread);
        curves[r].statedHigh = list(middle + spread);
    }
}

std::vector<ResidualWindow> windowsOfEffect(const RecordedData& data, const std::vector<RunCurves>& curves,
                                            const Localisation& found) {
    std::vector<ResidualWindow> all;
    for (std::size_t r = 0; r < curves.size(); ++r)
        for (const TimeInterval& s : curves[r].visibleIntervals) {
            const std::vector<double>& t = curves[r].time;
            const auto from = std::lower_bound(t.begin(), t.end(), s.from) - t.begin();
            const auto to = std::upper_bound(t.begin(), t.end(), s.to) - t.begin();
            ResidualWindow w{curves[r].name, "all", "time", data.channel, s.from, s.to, 0.0, 0.0, -1.0};
            setSpan(data.runs[r], from, to, w);
            w.z = found.largestSignature;
            w.p = found.p;
            w.kind = StatisticKind::Signature;
            all.push_back(std::move(w));
        }
    return all;
}

} // namespace supercircle::diagnosis
