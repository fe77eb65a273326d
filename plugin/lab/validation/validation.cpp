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

Experiment perform(const Definition& definition, const Settings& settings) {
    Experiment e;
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

bool stopped(const Settings& settings) {
    return settings.interrupt != nullptr && settings.interrupt->load();
}

std::string report(const Experiment& e) {
    std::size_t judged = 0, passed = 0;
    for (const Check& c : e.checks)
        if (c.target) {
            ++judged;
            passed += c.pass() ? 1 : 0;
        }
    std::string line = text("%-4s %-58s %3zu of %3zu within target, %4d runs, %6.1f s", e.id.c_str(), e.title.c_str(),
                            passed, judged, e.runs, e.seconds);
    return e.failure.empty() ? line : line + "\n     could not be finished: " + e.failure;
}

} // namespace

const std::vector<Definition>& experiments() {
    static const std::vector<Definition> all{
        {"T1", "boundary between smooth and abrupt snap-fit", 12.0, boundary},
        {"T2", "a shell on a rigid cylinder, tips sliding", 12.0, shellOnCylinder},
        {"T2s", "a shell on a rigid cylinder, tips stuck", 30.0, stuckShell},
        {"T3", "two shells, cap on cap", 20.0, twoShells},
        {"T4", "heavy cantilevers and vibrations of arcs", 5.0, underGravity},
        {"T5", "a shell between plates; closed ring; pinning on a floor", 20.0, betweenPlates},
        {"T6", "struts and arches", 5.0, archesAndStruts},
        {"T7", "a strip pressed lengthwise on a rough floor", 10.0, pinning},
        {"T8", "sliding, rolling, rocking: closed forms", 5.0, closedForms},
        {"T8c", "a stiff rope around a rough cylinder (capstan)", 10.0, capstan},
        {"T9", "does a shell pull itself in, and does it resist being pulled off?", 5.0, grip},
    };
    return all;
}

std::vector<Experiment> runAll(const Settings& settings) {
    std::vector<const Definition*> wanted;
    for (const Definition& d : experiments())
        if (d.id.find(settings.filter) != std::string::npos || d.title.find(settings.filter) != std::string::npos)
            wanted.push_back(&d);
    std::vector<Experiment> out(wanted.size());
    std::vector<std::size_t> order(wanted.size()); // the dear ones first, so that no core waits at the end
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return wanted[a]->cost > wanted[b]->cost; });
    std::atomic<std::size_t> next{0};
    std::mutex speaking;
    const auto work = [&] {
        for (std::size_t i = next++; i < order.size(); i = next++) {
            Experiment& e = out[order[i]];
            if (stopped(settings)) {
                e.id = wanted[order[i]]->id;
                e.title = wanted[order[i]]->title;
                e.failure = "interrupted before it began";
                continue;
            }
            e = perform(*wanted[order[i]], settings);
            const std::lock_guard lock(speaking);
            if (settings.progress)
                settings.progress(report(e));
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

Experiment runOne(const Settings& settings, const std::string& id) {
    for (const Definition& d : experiments())
        if (d.id == id)
            return perform(d, settings);
    Experiment e;
    e.id = id;
    e.failure = "there is no experiment \"" + id + "\"";
    return e;
}

int surprises(const std::vector<Experiment>& all) {
    int count = 0;
    for (const Experiment& e : all) {
        count += e.failure.empty() ? 0 : 1;
        for (const Check& c : e.checks)
            count += c.pass() || c.open ? 0 : 1;
    }
    return count;
}

} // namespace supercircle::validation
