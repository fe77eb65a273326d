#pragma once
// Batches of simulations: spread over threads, each known one taken from the store, results in the order of the
// questions whatever the threads do.

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/store.h"
#include "supercircle/support/parallel.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct Question {
    std::size_t run = 0;
    Point point;
    Fineness fineness = Fineness::Coarse;
};

class Evaluator {
public:
    /// @param loop empty: one after the other
    Evaluator(const Model& model, std::size_t runs, parallel::For loop, Store& store,
              const std::atomic<bool>* interrupt = nullptr)
        : model_(model), runs_(runs), loop_(std::move(loop)), store_(store), interrupt_(interrupt) {}

    std::vector<Response> ask(const std::vector<Question>& questions);
    /// All runs at each point: result[point][run].
    std::vector<std::vector<Response>> everywhere(const std::vector<Point>& points, Fineness fineness);

    /// A run that was not made, at each point; they are not kept. `failure` says "interrupted" where it was.
    std::vector<DesignResponse> foretell(std::size_t design, const std::vector<Point>& points);

    /// Simulates what the store knows of a point once more, each run. Where readings differ the store is of another
    /// program or experiment, and it is emptied.
    void checkStore(const Point& point, Fineness fineness);

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] std::size_t runs() const { return runs_; }
    [[nodiscard]] std::size_t asked() const { return asked_.size(); } ///< different runs so far, known ones included
    [[nodiscard]] bool stopped() const { return interrupt_ != nullptr && interrupt_->load(); }
    /// Called after each simulation, from any thread, one at a time.
    std::function<void()> onRun;

private:
    void spread(std::size_t n, const std::function<void(std::size_t)>& work) const;

    const Model& model_;
    std::size_t runs_;
    parallel::For loop_;
    Store& store_;
    const std::atomic<bool>* interrupt_;
    std::set<std::string> asked_;
    std::mutex speaking_;
};

} // namespace supercircle::diagnosis
