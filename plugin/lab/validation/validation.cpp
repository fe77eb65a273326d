#include "plugin/lab/validation/validation.h"

#include "plugin/lab/validation/experiments.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

namespace supercircle::validation {

namespace {

ValidationExperiment run(const ExperimentDefinition& definition, const ValidationSettings& settings) {
    ValidationExperiment e;
    e.id = definition.id;
    e.title = definition.title;
    const auto start = std::chrono::steady_clock::now();
    try {
        definition.run(settings, e);
    } catch (const std::exception& error) {
        e.failure = error.what();
    }
    e.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return e;
}

/// The experiment with this id; else all whose id or title contains the filter.
std::vector<const ExperimentDefinition*> choose(const std::string& filter) {
    std::vector<const ExperimentDefinition*> chosen;
    for (const ExperimentDefinition& d : experiments()) {
        if (d.id == filter)
            return {&d};
        if (d.id.find(filter) != std::string::npos || d.title.find(filter) != std::string::npos)
            chosen.push_back(&d);
    }
    return chosen;
}

bool stopped(const ValidationSettings& settings) {
    return settings.interrupt != nullptr && settings.interrupt->load();
}

std::string progressLine(const ValidationExperiment& e) {
    std::size_t judged = 0, passed = 0;
    for (const Check& c : e.checks)
        if (c.target) {
            ++judged;
            passed += c.pass() ? 1 : 0;
        }
    std::string line = text("%-23s %3zu of %3zu within target, %4d runs, %6.1f s  (%s)", e.id.c_str(), passed, judged,
                            e.runs, e.seconds, e.title.c_str());
    return e.failure.empty() ? line : line + "\n    could not be finished: " + e.failure;
}

} // namespace

const std::vector<ExperimentDefinition>& experiments() {
    static const std::vector<ExperimentDefinition> all{
        {"snap_boundary", "boundary between smooth and abrupt snap-fit", 12.0, snapBoundary},
        {"shell_on_cylinder", "a shell on a rigid cylinder, tips sliding", 12.0, shellOnCylinder},
        {"shell_on_cylinder_stuck", "a shell on a rigid cylinder, tips stuck", 30.0, shellOnCylinderStuck},
        {"two_shells", "two shells, cap on cap", 20.0, twoShells},
        {"gravity_sag", "heavy cantilevers and vibrations of arcs", 5.0, gravitySag},
        {"plates", "a shell between plates; closed ring; pinning on a floor", 20.0, plates},
        {"statics", "struts and arches", 5.0, statics},
        {"pinning", "a strip pressed lengthwise on a rough floor", 10.0, pinning},
        {"closed_forms", "sliding, rolling, rocking: closed forms", 5.0, closedForms},
        {"capstan", "a stiff rope around a rough cylinder (capstan)", 10.0, capstan},
        {"grip", "does a shell pull itself in, and does it resist being pulled off?", 5.0, grip},
    };
    return all;
}

std::vector<ValidationExperiment> runAll(const ValidationSettings& settings) {
    const std::vector<const ExperimentDefinition*> chosen = choose(settings.filter);
    std::vector<ValidationExperiment> out(chosen.size());
    std::vector<std::size_t> order(chosen.size()); // expensive ones first, so that no core waits at the end
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return chosen[a]->cost > chosen[b]->cost; });
    std::atomic<std::size_t> next{0};
    std::mutex progressMutex;
    const auto work = [&] {
        for (std::size_t i = next++; i < order.size(); i = next++) {
            ValidationExperiment& e = out[order[i]];
            if (stopped(settings)) {
                e.id = chosen[order[i]]->id;
                e.title = chosen[order[i]]->title;
                e.failure = "interrupted before it began";
                continue;
            }
            e = run(*chosen[order[i]], settings);
            const std::lock_guard lock(progressMutex);
            if (settings.progress)
                settings.progress(progressLine(e));
        }
    };
    std::vector<std::thread> helpers;
    for (int i = 1; i < settings.jobs; ++i)
        helpers.emplace_back(work);
    work();
    for (std::thread& t : helpers)
        t.join();
    return out;
}

ValidationExperiment runOne(const ValidationSettings& settings, const std::string& id) {
    for (const ExperimentDefinition& d : experiments())
        if (d.id == id)
            return run(d, settings);
    ValidationExperiment e;
    e.id = id;
    e.failure = "there is no experiment \"" + id + "\"";
    return e;
}

int unexpectedMisses(const std::vector<ValidationExperiment>& all) {
    int count = 0;
    for (const ValidationExperiment& e : all) {
        count += e.failure.empty() ? 0 : 1;
        for (const Check& c : e.checks)
            count += c.pass() || c.knownDeviation ? 0 : 1;
    }
    return count;
}

} // namespace supercircle::validation
