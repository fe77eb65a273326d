#include "plugin/identification/diagnosis/evaluator.h"

#include <algorithm>
#include <cstring>
#include <map>

namespace supercircle::diagnosis {

namespace {

void put(std::string& to, const void* raw, std::size_t n) {
    to.append(static_cast<const char*>(raw), n);
}

/// The request as bytes: equal exactly if the simulations are.
std::string keyOf(const SimulationRequest& request) {
    std::string key;
    const std::uint64_t head[] = {request.run, static_cast<std::uint64_t>(request.fidelity),
                                  request.point.nominal.size()};
    put(key, head, sizeof head);
    put(key, request.point.nominal.data(), request.point.nominal.size() * sizeof(double));
    for (const Term& t : request.point.terms) {
        const std::uint64_t at[] = {t.candidate, t.values.size()};
        put(key, at, sizeof at);
        put(key, t.values.data(), t.values.size() * sizeof(double));
    }
    return key;
}

bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return a.size() == b.size() && (a.array() == b.array() || (a.array().isNaN() && b.array().isNaN())).all();
}

} // namespace

void Evaluator::checkCache(const ParameterPoint& point, Fidelity fidelity) {
    std::vector<char> differs(runs_, 0);
    forEach(runs_, [&](std::size_t r) {
        if (model_.replicateOf(r) != r)
            return;
        const SimulationRequest request{r, model_.simulated(r, point), fidelity};
        const auto known = cache_.find(keyOf(request));
        if (!known || stopped())
            return;
        const Response again = model_.simulate(r, request.point, fidelity, stop_.interrupt());
        differs[r] = again.failure != known->failure || !same(again.force, known->force) ||
                     !same(again.markers, known->markers) || !same(again.jumps, known->jumps) ||
                     !same(again.further, known->further);
    });
    stop_.poll();
    if (std::any_of(differs.begin(), differs.end(), [](char d) { return d != 0; }))
        cache_.clear();
}

std::vector<Response> Evaluator::simulate(const std::vector<SimulationRequest>& requests) {
    std::vector<std::string> keys;
    std::vector<SimulationRequest> internal;
    std::map<std::string, std::size_t> first; // replicates within a batch are simulated once
    std::vector<std::size_t> open;
    std::vector<Response> results(requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) {
        internal.push_back({model_.replicateOf(requests[i].run), model_.simulated(requests[i].run, requests[i].point),
                            requests[i].fidelity});
        keys.push_back(keyOf(internal[i]));
        distinctRequests_.insert(keys.back());
        if (auto known = cache_.find(keys[i]))
            results[i] = std::move(*known);
        else if (first.emplace(keys[i], i).second)
            open.push_back(i);
    }
    const auto work = [&](std::size_t n) {
        const std::size_t i = open[n];
        if (stopped())
            return;
        results[i] = model_.simulate(internal[i].run, internal[i].point, internal[i].fidelity, stop_.interrupt());
        if (stop_.interrupted()) // it may have ended early
            return;
        cache_.insert(keys[i], results[i]);
        if (onRun) {
            const std::lock_guard<std::mutex> lock(callbackMutex_);
            onRun();
        }
    };
    stop_.poll();
    forEach(open.size(), work);
    stop_.poll();
    for (std::size_t i = 0; i < requests.size(); ++i)
        if (const auto at = first.find(keys[i]); at != first.end() && at->second != i)
            results[i] = results[at->second];
    for (std::size_t i = 0; i < requests.size(); ++i)
        if (results[i].failure.empty())
            model_.read(requests[i].run, requests[i].point, results[i]);
    return results;
}

void Evaluator::forEach(std::size_t n, const std::function<void(std::size_t)>& work) const {
    if (loop_)
        loop_(n, work);
    else
        for (std::size_t i = 0; i < n; ++i)
            work(i);
}

std::vector<CandidateRunResponse> Evaluator::predict(std::size_t candidateRun,
                                                     const std::vector<ParameterPoint>& points) {
    std::vector<CandidateRunResponse> results(points.size());
    forEach(points.size(), [&](std::size_t i) {
        if (!stopped())
            results[i] = model_.simulateCandidateRun(candidateRun, points[i], stop_.interrupt());
    });
    stop_.poll();
    return results;
}

std::vector<std::vector<Response>> Evaluator::simulateAllRuns(const std::vector<ParameterPoint>& points,
                                                              Fidelity fidelity) {
    std::vector<SimulationRequest> requests;
    for (const ParameterPoint& p : points)
        for (std::size_t r = 0; r < runs_; ++r)
            requests.push_back({r, p, fidelity});
    std::vector<Response> flat = simulate(requests);
    std::vector<std::vector<Response>> results(points.size());
    for (std::size_t i = 0; i < flat.size(); ++i)
        results[i / runs_].push_back(std::move(flat[i]));
    return results;
}

} // namespace supercircle::diagnosis
