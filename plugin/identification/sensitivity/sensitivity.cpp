// Finite differences instead of derivatives of the simulator: a step solves a complementarity problem whose active set
// changes hundreds of times a run, and at a slip-off the derivative does not exist. Steps must be large against these
// events and small against the curvature.

#include "plugin/identification/sensitivity/sensitivity.h"

#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/sensitivity/batch.h"
#include "plugin/identification/sensitivity/derivative.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::sensitivity {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kNoisePoints = 7;        ///< with the centre
constexpr double kNoiseSpacing = 0.02; ///< share of the scales

/// Step search for one column of one run.
struct ColumnSearch {
    std::size_t run = 0, column = 0;
    double step = 0.0, longest = 0.0;
    int side = 0;
    bool done = false;
    bool any = false; ///< `best` is set
    Derivative best;
    double bestError = 0.0;
    std::string failure;
};

/// Distance to the bound on one side, at most the scale.
double room(const Column& c, int side) {
    return side > 0 ? std::min(c.scale, c.upper - c.value) : std::min(c.scale, c.value - c.lower);
}

ColumnSearch begin(const Column& c, std::size_t run, std::size_t column, const SensitivitySettings& settings) {
    ColumnSearch s;
    s.run = run;
    s.column = column;
    const double up = room(c, 1), down = room(c, -1);
    if (std::min(up, down) >= settings.firstStep * c.scale) {
        s.longest = std::min(up, down);
    } else {
        s.side = up >= down ? 1 : -1;
        s.longest = std::max(up, down);
    }
    s.step = std::min(s.longest, settings.firstStep * c.scale);
    if (!(s.step > 0.0)) {
        s.failure = "the bounds leave no room for a step";
        s.done = true;
    }
    return s;
}

class Differentiator {
public:
    Differentiator(const Model& model, const experiment::Experiment& experiment, const SensitivitySettings& settings)
        : model_(model), settings_(settings), units_(replay::naturalUnits(experiment)),
          batch_(model, experiment, settings) {}

    Sensitivities run() {
        Sensitivities out;
        out.columns = model_.columns;
        batch_.expect(model_.runs * (kNoisePoints + 6 * model_.columns.size()));
        batch_.runBases(out);
        for (std::size_t i = 0; i < out.runs.size(); ++i)
            if (const std::string& why = out.runs[i].base.failure; !why.empty() && out.failure.empty())
                out.failure = "run " + std::to_string(i + 1) + ": " + why;
        if (!out.failure.empty() || stopped(out))
            return out;
        for (const RunSensitivity& run : out.runs) {
            bases_.push_back(numbersOf(run.base, run.base));
            bases_.back().landmarks = run.landmarks;
        }
        measureNoise(out);
        std::vector<ColumnSearch> searches;
        for (std::size_t r = 0; r < model_.runs; ++r)
            for (std::size_t c = 0; c < model_.columns.size(); ++c)
                searches.push_back(begin(model_.columns[c], r, c, settings_));
        for (int round = 0; round < std::max(1, settings_.rounds) && !stopped(out); ++round)
            probe(searches, round + 1 < settings_.rounds, out);
        if (!stopped(out))
            collect(searches, out);
        return out;
    }

private:
    bool stopped(Sensitivities& out) const { return out.stopped = batch_.stopped(); }

    [[nodiscard]] std::vector<double> centre() const {
        std::vector<double> values;
        for (const Column& c : model_.columns)
            values.push_back(c.value);
        return values;
    }

    /// Noise is measured along a short line in all columns at once.
    void measureNoise(Sensitivities& out) {
        std::vector<SimulationJob> jobs;
        for (std::size_t r = 0; r < model_.runs; ++r)
            for (int k = 1; k < kNoisePoints; ++k) {
                SimulationJob job{r, centre()};
                for (std::size_t c = 0; c < job.values.size(); ++c) {
                    const double up = room(model_.columns[c], 1), down = room(model_.columns[c], -1);
                    job.values[c] += k * kNoiseSpacing * (up >= down ? up : -down);
                }
                jobs.push_back(std::move(job));
            }
        const std::vector<SimulatedValues> seen = batch_.run(jobs, out);
        for (std::size_t r = 0; r < model_.runs; ++r) {
            std::vector<const SimulatedValues*> curves{&bases_[r]};
            for (int k = 1; k < kNoisePoints; ++k) {
                const SimulatedValues& o = seen[r * (kNoisePoints - 1) + static_cast<std::size_t>(k) - 1];
                if (!o.failure.empty())
                    break; // later points are not equally spaced with earlier ones
                curves.push_back(&o);
            }
            noise_.push_back(noiseOf(curves, bases_[r].landmarks, out.runs[r].base.readings.time, units_));
        }
    }

    static std::vector<double> offsets(const ColumnSearch& s) {
        if (s.side == 0)
            return {s.step, 0.5 * s.step, -s.step, -0.5 * s.step};
        return {s.side * s.step, 0.5 * s.side * s.step};
    }

    /// One round: the simulations of all active searches in one batch.
    void probe(std::vector<ColumnSearch>& searches, bool more, Sensitivities& out) {
        std::vector<SimulationJob> jobs;
        std::vector<std::size_t> first(searches.size(), 0);
        for (std::size_t i = 0; i < searches.size(); ++i) {
            first[i] = jobs.size();
            if (searches[i].done)
                continue;
            for (const double offset : offsets(searches[i])) {
                jobs.push_back({searches[i].run, centre()});
                jobs.back().values[searches[i].column] += offset;
            }
        }
        std::vector<SimulatedValues> seen = batch_.run(jobs, out);
        if (batch_.stopped())
            return;
        for (std::size_t i = 0; i < searches.size(); ++i)
            if (!searches[i].done)
                judge(searches[i], probesOf(searches[i], seen.data() + first[i]), more, out);
    }

    /// Difference points of a search without a failed side.
    static Probes probesOf(ColumnSearch& s, SimulatedValues* seen) {
        Probes p;
        p.step = s.step;
        p.side = s.side;
        SimulatedValues* whole[] = {&p.wholePlus, &p.halfPlus, &p.wholeMinus, &p.halfMinus};
        const std::size_t begin = s.side < 0 ? 2 : 0, count = s.side == 0 ? 4 : 2;
        for (std::size_t k = 0; k < count; ++k)
            *whole[begin + k] = std::move(seen[k]);
        const auto failed = [](const SimulatedValues& a, const SimulatedValues& b) {
            return !a.failure.empty() ? a.failure : b.failure;
        };
        const std::string plus = s.side >= 0 ? failed(p.wholePlus, p.halfPlus) : "not probed";
        const std::string minus = s.side <= 0 ? failed(p.wholeMinus, p.halfMinus) : "not probed";
        s.failure.clear();
        if (!plus.empty() && !minus.empty())
            s.failure = s.side >= 0 ? plus : minus;
        else if (s.side == 0 && (!plus.empty() || !minus.empty()))
            p.side = plus.empty() ? 1 : -1;
        return p;
    }

    /// Keeps the better derivative and chooses the next step, if worthwhile.
    void judge(ColumnSearch& s, const Probes& p, bool more, const Sensitivities& out) {
        if (!s.failure.empty()) { // retry with a smaller step
            s.step *= 0.25;
            return;
        }
        const RunSensitivity& run = out.runs[s.run];
        Derivative d = derivativeOf(p, bases_[s.run], run.base.readings, noise_[s.run], settings_, units_);
        const Quality q = d.quality;
        const double error = math::hypot(q.twoStepError, q.noiseError) + (q.belowNoise ? 10.0 : 0.0);
        if (!s.any || error < s.bestError) {
            s.best = std::move(d);
            s.bestError = error;
            s.any = true;
        }
        s.done = true;
        if (!more)
            return;
        if (q.belowNoise && s.step < s.longest) {
            const double factor = std::clamp(2.0 * settings_.smallestSignal / std::max(q.signal, 1e-3), 1.5, 16.0);
            s.step = std::min(s.longest, factor * s.step);
            s.done = false;
        } else if ((q.twoStepError > settings_.disagreement || q.changesJumps) &&
                   q.signal > 4.0 * settings_.smallestSignal) {
            s.step *= std::max(0.25, 1.5 * settings_.smallestSignal / q.signal);
            s.done = false;
        }
    }

    void collect(std::vector<ColumnSearch>& searches, Sensitivities& out) const {
        const Index columns = static_cast<Index>(model_.columns.size());
        for (std::size_t r = 0; r < model_.runs; ++r) {
            RunSensitivity& run = out.runs[r];
            const SimulatedValues& base = bases_[r];
            const Index marks = static_cast<Index>(base.landmarks.values.size());
            run.force = Eigen::MatrixXd::Zero(base.force.size(), columns);
            run.usable = Mask::Constant(base.force.size(), columns, false);
            run.markers = Eigen::MatrixXd::Zero(base.markers.size(), columns);
            run.landmarkJacobian = Eigen::MatrixXd::Zero(marks, columns);
            run.landmarkError = Eigen::MatrixXd::Zero(marks, columns);
            run.forceNoise = noise_[r].force;
            run.forceNoiseRms = noise_[r].forceRms;
            run.markerNoiseRms = noise_[r].markerRms;
            run.landmarkNoise = noise_[r].landmarks;
            run.quality.resize(model_.columns.size());
        }
        for (ColumnSearch& s : searches) {
            RunSensitivity& run = out.runs[s.run];
            const Index c = static_cast<Index>(s.column);
            Quality& q = run.quality[s.column];
            if (!s.any) {
                q.failure = s.failure;
                continue;
            }
            q = s.best.quality;
            run.force.col(c) = s.best.force;
            run.usable.col(c) = s.best.usable;
            run.markers.col(c) = s.best.markers;
            run.landmarkJacobian.col(c) = s.best.landmarks;
            run.landmarkError.col(c) = s.best.landmarkError;
        }
    }

    const Model& model_;
    const SensitivitySettings& settings_;
    experiment::NaturalUnits units_;
    Batch batch_;
    std::vector<SimulatedValues> bases_;
    std::vector<RunNoise> noise_;
};

} // namespace

Sensitivities differentiate(const Model& model, const experiment::Experiment& experiment,
                            const SensitivitySettings& settings) {
    return Differentiator(model, experiment, settings).run();
}

Eigen::MatrixXd similarity(const Sensitivities& all) {
    const Index n = static_cast<Index>(all.columns.size());
    Eigen::MatrixXd cosines = Eigen::MatrixXd::Zero(n, n);
    for (Index a = 0; a < n; ++a)
        for (Index b = a; b < n; ++b) {
            double aa = 0.0, bb = 0.0, ab = 0.0;
            for (const RunSensitivity& run : all.runs) {
                const Quality &qa = run.quality[static_cast<std::size_t>(a)],
                              &qb = run.quality[static_cast<std::size_t>(b)];
                if (qa.belowNoise || qb.belowNoise || !qa.failure.empty() || !qb.failure.empty())
                    continue;
                double peak = 1e-300;
                for (const double f : run.base.readings.force)
                    peak = std::max(peak, std::abs(f));
                for (Index i = 0; i < run.force.rows(); ++i) {
                    if (!run.usable(i, a) || !run.usable(i, b))
                        continue;
                    const double x = run.force(i, a) / peak, y = run.force(i, b) / peak;
                    aa += x * x;
                    bb += y * y;
                    ab += x * y;
                }
            }
            cosines(a, b) = cosines(b, a) = aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
        }
    return cosines;
}

} // namespace supercircle::sensitivity
