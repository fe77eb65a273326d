#pragma once
// The replay of an experiment as the model that diagnosis works with.

#include "plugin/identification/diagnosis/model/menu.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/experiment.h"

#include <atomic>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

class ReplayModel final : public Model {
public:
    /// `experiment` must outlive the model. Simulates one run; interrupted, the model is good for nothing.
    explicit ReplayModel(const experiment::Experiment& experiment, const std::vector<std::string>& without = {},
                         const std::atomic<bool>* interrupt = nullptr);

    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<Candidate>& candidates() const override { return menu_.candidates; }
    [[nodiscard]] std::size_t twin(std::size_t run) const override { return twins_[run]; }
    [[nodiscard]] Response simulate(std::size_t run, const Point& point, Fineness fineness,
                                    const std::atomic<bool>* interrupt) const override;
    [[nodiscard]] Point simulated(const Point& point) const override;
    void read(std::size_t run, const Point& point, Response& response) const override;
    [[nodiscard]] std::vector<Design> designs() const override;
    [[nodiscard]] DesignResponse simulateDesign(std::size_t index, const Point& point,
                                                const std::atomic<bool>* interrupt) const override;
    [[nodiscard]] std::string identity() const override;

private:
    /// Empty, or why the point is none.
    void addReading(const Term& term, std::size_t run, const std::vector<double>& time, Eigen::VectorXd& force) const;
    std::string parametersAt(const Point& point, replay::Parameters& parameters) const;

    const experiment::Experiment& experiment_;
    std::vector<Scalar> nominal_;
    Menu menu_;
    std::vector<std::size_t> twins_;       ///< see twin()
    double travel_ = 1.0, duration_ = 1.0; ///< by which learned readings are measured: m, s
};

} // namespace supercircle::diagnosis
