#pragma once
// Batches of simulations on several threads, with cached results. Results are in the order of the requests, whatever
// the threads do.

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/simulation_cache.h"
#include "plugin/identification/diagnosis/stop.h"
#include "supercircle/support/parallel.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct SimulationRequest {
    std::size_t run = 0;
    ParameterPoint point;
    Fidelity fidelity = Fidelity::Coarse;
};

class Evaluator {
public:
    /// @param loop parallel loop; empty: sequential
    /// @param late whether the time limit is over (StopToken)
    Evaluator(const Model& model, std::size_t runs, parallel::For loop, SimulationCache& cache,
              const std::atomic<bool>* interrupt = nullptr, std::function<bool()> late = {})
        : model_(model), runs_(runs), loop_(std::move(loop)), cache_(cache), stop_(interrupt, std::move(late)) {}

    /// Throws Stopped, as all that simulates.
    std::vector<Response> simulate(const std::vector<SimulationRequest>& requests);
    /// All runs at each point: result[point][run].
    std::vector<std::vector<Response>> simulateAllRuns(const std::vector<ParameterPoint>& points, Fidelity fidelity);

    /// Predicts a candidate run at each point, without caching.
    std::vector<CandidateRunResponse> predict(std::size_t candidateRun, const std::vector<ParameterPoint>& points);

    /// Repeats the cached simulations of one point. If readings differ, the cache belongs to another program or
    /// experiment and is cleared.
    void checkCache(const ParameterPoint& point, Fidelity fidelity);

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] std::size_t runs() const { return runs_; }
    [[nodiscard]] std::size_t distinctRequests() const {
        return distinctRequests_.size();
    } ///< distinct simulations so far, cached ones included
    [[nodiscard]] const StopToken& stop() const { return stop_; }
    [[nodiscard]] bool stopped() const { return stop_.stopped(); }
    /// Called after each simulation, from any thread, never concurrently.
    std::function<void()> onRun;

private:
    void forEach(std::size_t n, const std::function<void(std::size_t)>& work) const;

    const Model& model_;
    std::size_t runs_;
    parallel::For loop_;
    SimulationCache& cache_;
    StopToken stop_;
    std::set<std::string> distinctRequests_;
    std::mutex callbackMutex_;
};

} // namespace supercircle::diagnosis
