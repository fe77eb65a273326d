#include "plugin/identification/diagnosis/model/batch_factors.h"

#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using experiment::Experiment;

/// Deviations whose changes of the readings are closer than this in direction are one: 11 degrees. At half that angle
/// two of them trade twice as much of their sum at the same noise; at twice of it, factors that runs tell apart at
/// twice the noise are merged.
constexpr double kAlike = 0.98; // cosine

/// The first run of each specimen that has one.
std::vector<std::size_t> firstRuns(const Experiment& e) {
    std::vector<std::size_t> out;
    for (std::size_t r = 0; r < e.runs.size(); ++r)
        if (std::none_of(out.begin(), out.end(),
                         [&](std::size_t k) { return e.runs[k].specimen == e.runs[r].specimen; }))
            out.push_back(r);
    return out;
}

Eigen::VectorXd readings(const Experiment& e, std::size_t run, const replay::Parameters& p,
                         const std::atomic<bool>* interrupt) {
    const replay::Simulated s = replay::simulate(e, run, p, replay::Resolution::coarse(), {interrupt, {}});
    return Eigen::Map<const Eigen::VectorXd>(s.readings.force.data(),
                                             static_cast<Eigen::Index>(s.readings.force.size()));
}

/// Change of the readings of a run by a small deviation of a common parameter; empty: it cannot be simulated.
Eigen::VectorXd changeBy(const Experiment& e, std::size_t run, const experiment::BatchParameter& b,
                         const std::atomic<bool>* interrupt) {
    constexpr double kSmall = 0.05; // of the scale: phases of long oscillations stay in the linear range
    const replay::Parameters nominal = replay::nominal(e);
    replay::Parameters moved = nominal;
    if (!replay::set(moved, e, b.name, replay::get(nominal, e, b.name).value_or(0.0) + kSmall * b.scale).empty())
        return {};
    const Eigen::VectorXd before = readings(e, run, nominal, interrupt), after = readings(e, run, moved, interrupt);
    return after.size() == before.size() ? Eigen::VectorXd(after - before) : Eigen::VectorXd();
}

/// Whether two factors change the readings of every specimen alike.
bool alike(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b) {
    for (std::size_t s = 0; s < a.size(); ++s) {
        const double size = a[s].norm() * b[s].norm();
        if (a[s].size() != b[s].size() || std::abs(a[s].dot(b[s])) < kAlike * size)
            return false;
    }
    return true;
}

} // namespace

std::vector<BatchFactor> batchFactorsOf(const Experiment& e, const std::atomic<bool>* interrupt) {
    std::vector<BatchFactor> out;
    if (!e.scene)
        return out;
    std::vector<std::vector<Eigen::VectorXd>> changes;
    for (const experiment::BatchParameter& b : e.scene->batch) {
        if (b.scale <= 0.0)
            continue;
        std::vector<Eigen::VectorXd> here;
        for (const std::size_t run : firstRuns(e))
            here.push_back(changeBy(e, run, b, interrupt));
        const auto first =
            std::find_if(changes.begin(), changes.end(), [&](const auto& other) { return alike(other, here); });
        if (first != changes.end()) {
            out[static_cast<std::size_t>(first - changes.begin())].merged.push_back(b.name);
            continue;
        }
        changes.push_back(std::move(here));
        BatchFactor f;
        f.name = b.name;
        f.scale = b.scale;
        for (const experiment::SceneParameter& p : e.scene->parameters)
            if (p.name == b.name) {
                f.unit = p.unit.empty() ? "1" : p.unit;
                f.stated = p.stated.value;
            }
        out.push_back(std::move(f));
    }
    return out;
}

std::vector<Scalar> deviationsOf(const Experiment& e, const BatchFactor& factor, int index) {
    std::vector<Scalar> out;
    for (std::size_t k = 0; k < e.scene->specimens.size(); ++k) {
        const int specimen = static_cast<int>(k);
        if (std::none_of(e.runs.begin(), e.runs.end(),
                         [&](const experiment::Run& run) { return run.specimen == specimen; }))
            continue;
        Scalar s;
        s.name = factor.name + "." + e.scene->specimens[k].id;
        s.unit = factor.unit;
        s.about = "deviation of specimen " + e.scene->specimens[k].id;
        s.step = factor.scale;
        s.specimen = specimen;
        s.batch = index;
        out.push_back(std::move(s));
    }
    return out;
}

} // namespace supercircle::diagnosis
