#include "plugin/identification/diagnosis/localisation/windows.h"

#include "plugin/identification/diagnosis/likelihood/jumps.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

class Family {
public:
    explicit Family(const Likelihood& likelihood) : likelihood_(likelihood) {
        for (std::size_t r = 0; r < likelihood.runs(); ++r) {
            byTime(r);
            markers(r);
            further(r);
            jumps(r);
        }
        std::vector<std::size_t> every(likelihood.runs());
        for (std::size_t r = 0; r < every.size(); ++r)
            every[r] = r;
        for (const Phase phase : {Phase::Loading, Phase::Unloading, Phase::Hold})
            byDisplacement(every, phase);
        loadAgainstUnload(every);
    }
    std::vector<WindowRows> all;

private:
    [[nodiscard]] bool counts(std::size_t run, Eigen::Index k) const {
        return std::isfinite(likelihood_.errors(run).force[k]);
    }

    void add(WindowRows c) {
        if (c.rows.size() >= 4)
            all.push_back(std::move(c));
    }

    void byTime(std::size_t r) {
        const RecordedRun& run = likelihood_.data().runs[r];
        dyadic(r, 0, run.force.size(), 5);
        for (Eigen::Index from = 0, to = 0; from < run.force.size(); from = to) {
            while (to < run.force.size() && run.stroke(to) == run.stroke(from))
                ++to;
            if (to - from < run.force.size()) // effects begin and end at reversals
                dyadic(r, from, to, 4);
        }
    }

    void dyadic(std::size_t r, Eigen::Index from, Eigen::Index to, int levels) {
        const RecordedRun& run = likelihood_.data().runs[r];
        const Eigen::Index n = to - from;
        for (int level = 0; level <= levels; ++level) {
            const int pieces = 1 << level;
            for (int half = 0; half < (level == 0 ? 1 : 2 * pieces - 1); ++half) {
                const Eigen::Index a = from + n * half / (2 * pieces);
                const Eigen::Index b = std::min(to, from + n * (half + 2) / (2 * pieces));
                if (b - a < 4)
                    continue;
                WindowRows c;
                c.window = {run.name, "all", "time", likelihood_.data().channel, run.time[a], run.time[b - 1],
                            0.0,      0.0,   -1.0};
                setSpan(run, a, b, c.window);
                for (Eigen::Index k = a; k < b; ++k)
                    if (counts(r, k))
                        c.rows.push_back(likelihood_.start(r) + k);
                add(std::move(c));
            }
        }
    }

    /// Dyadic intervals of the largest displacement of all runs.
    template <class Use>
    void ofWay(const std::vector<std::size_t>& runs, int levels, const Use& use) {
        double most = 0.0;
        for (const std::size_t r : runs)
            most = std::max(most, likelihood_.data().runs[r].displacement.maxCoeff());
        for (int level = 0; level <= levels && most > 0.0; ++level)
            for (int piece = 0; piece < (1 << level); ++piece)
                use(most * piece / (1 << level), most * (piece + 1) / (1 << level));
    }

    void byDisplacement(const std::vector<std::size_t>& runs, Phase phase) {
        ofWay(runs, 3, [&](double from, double to) {
            WindowRows c;
            c.window = {"all", name(phase), "displacement", likelihood_.data().channel, 0.0, 0.0, from, to, -1.0};
            for (const std::size_t r : runs)
                collect(r, phase, from, to, c);
            add(std::move(c));
        });
    }

    void collect(std::size_t r, Phase phase, double from, double to, WindowRows& c) const {
        const RecordedRun& run = likelihood_.data().runs[r];
        for (Eigen::Index k = 0; k < run.force.size(); ++k) {
            const double d = run.displacement[k];
            if (run.phase(k) != phase || d < from || d > to || !counts(r, k))
                continue;
            c.window.timeFrom = c.rows.empty() ? run.time[k] : std::min(c.window.timeFrom, run.time[k]);
            c.window.timeTo = c.rows.empty() ? run.time[k] : std::max(c.window.timeTo, run.time[k]);
            c.rows.push_back(likelihood_.start(r) + k);
        }
    }

    void loadAgainstUnload(const std::vector<std::size_t>& runs) {
        ofWay(runs, 2, [&](double from, double to) {
            WindowRows load, unload;
            load.window = {
                "all", "loading against unloading", "contrast", likelihood_.data().channel, 0.0, 0.0, from, to, -1.0};
            for (const std::size_t r : runs) {
                collect(r, Phase::Loading, from, to, load);
                collect(r, Phase::Unloading, from, to, unload);
            }
            if (load.rows.size() < 4 || unload.rows.size() < 4)
                return;
            const auto n = static_cast<Eigen::Index>(load.rows.size());
            load.rows.insert(load.rows.end(), unload.rows.begin(), unload.rows.end());
            load.sign = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(load.rows.size()));
            load.sign.tail(load.sign.size() - n).setConstant(-1.0);
            add(std::move(load));
        });
    }

    void markers(std::size_t r) {
        const RecordedRun& run = likelihood_.data().runs[r];
        const Eigen::Index n = run.markerTime.size();
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
            for (int level = 0; level <= 2; ++level)
                for (int piece = 0; piece < (1 << level); ++piece) {
                    const Eigen::Index a = n * piece / (1 << level), b = n * (piece + 1) / (1 << level);
                    if (b - a < 4)
                        continue;
                    WindowRows w;
                    const auto m = static_cast<std::size_t>(c / 2);
                    w.window.run = run.name;
                    w.window.phase = "all";
                    w.window.axis = "time";
                    w.window.channel = likelihood_.data().markerChannel(c);
                    w.window.arcFraction = likelihood_.data().arcFraction[m];
                    w.window.timeFrom = run.markerTime[a];
                    w.window.timeTo = run.markerTime[b - 1];
                    w.window.displacementTo = run.displacement.maxCoeff();
                    for (Eigen::Index k = a; k < b; ++k)
                        if (std::isfinite(likelihood_.errors(r).markers[c * n + k]))
                            w.rows.push_back(likelihood_.start(r) + run.force.size() + c * n + k);
                    add(std::move(w));
                }
    }

    /// Each further channel over time.
    void further(std::size_t r) {
        constexpr int kLevels = 4;
        const RecordedRun& run = likelihood_.data().runs[r];
        const Eigen::Index n = run.force.size();
        for (std::size_t c = 0; c < run.furtherCount; ++c)
            for (int level = 0; level <= kLevels; ++level)
                for (int piece = 0; piece < (1 << level); ++piece) {
                    const Eigen::Index a = n * piece / (1 << level), b = n * (piece + 1) / (1 << level);
                    if (b - a < 4)
                        continue;
                    WindowRows w;
                    w.window.run = run.name;
                    w.window.axis = "time";
                    w.window.channel = likelihood_.data().further[c].name;
                    setSpan(run, a, b, w.window);
                    const Eigen::Index first = n + run.markers.size() + static_cast<Eigen::Index>(c) * n;
                    for (Eigen::Index k = a; k < b; ++k)
                        if (likelihood_.counts(r, first + k))
                            w.rows.push_back(likelihood_.start(r) + first + k);
                    add(std::move(w));
                }
    }

    /// The time residuals of its jumps.
    void jumps(std::size_t r) {
        const RecordedRun& run = likelihood_.data().runs[r];
        Eigen::Index row = likelihood_.start(r) + run.rows();
        for (const replay::Landmark& jump : likelihood_.jumps(r)) {
            WindowRows c;
            const LikelihoodSettings& s = likelihood_.settings();
            c.window = {run.name,
                        name(run.segmentAt(jump.time).phase),
                        "time",
                        likelihood_.data().channel,
                        jump.time - s.snapBefore,
                        jump.time + s.snapAfter,
                        jump.displacement,
                        jump.displacement,
                        -1.0};
            c.rows = {row++};
            all.push_back(std::move(c));
        }
    }

    const Likelihood& likelihood_;
};

} // namespace

std::vector<WindowRows> windowsOf(const Likelihood& likelihood) {
    return Family(likelihood).all;
}

void setSpan(const RecordedRun& run, Eigen::Index from, Eigen::Index to, ResidualWindow& w) {
    const auto d = run.displacement.segment(from, to - from);
    w.timeFrom = run.time[from];
    w.timeTo = run.time[to - 1];
    w.displacementFrom = d.minCoeff();
    w.displacementTo = d.maxCoeff();
    const Phase first = run.phase(from);
    bool one = true;
    for (Eigen::Index k = from; k < to; ++k)
        one = one && run.phase(k) == first;
    w.phase = one ? name(first) : "all";
}

} // namespace supercircle::diagnosis
