#pragma once
// Gaussian likelihood of recordings: readings of all runs, stacked, as standardised residuals.
//
// The error model has sensor noise, model error and excluded rows (model_error.h). These are added:
// - nuisance parameters of each run with known priors, integrated out by shrinking their directions N, (1 + N
// N')^(-1/2) = 1 - N S N': zero of the force, clock, scale of the simulated force (decision 0073);
// - scatter of repeats in every row, with the correlation time of the model (LikelihoodSettings::forRepeats());
// - shifts of each marker coordinate between snaps and in each stroke.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/likelihood/jumps.h"
#include "plugin/identification/diagnosis/likelihood/model_error.h"
#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Difference of two sets of readings of one run: force, N, markers, m, and times of jumps, s.
struct RawDifference {
    Eigen::VectorXd rows;     ///< empty: a simulation failed or is incomplete
    std::vector<bool> masked; ///< rows between a recorded jump and the simulated one: interpolated
};

class Likelihood {
public:
    /// @param fine, finer simulations near the recordings, per run
    Likelihood(const RecordedData& data, const Noise& noise, const std::vector<Response>& fine,
               const std::vector<Response>& finer, const LikelihoodSettings& settings = {});

    /// Recorded minus simulated of one run.
    [[nodiscard]] RawDifference rawResidual(std::size_t run, const Response& simulated) const;
    /// Simulation a minus simulation b of one run; rows that either masks are interpolated.
    [[nodiscard]] RawDifference rawDifference(std::size_t run, const Response& a, const Response& b) const;
    /// Whitened residual of all runs; empty if a simulation failed or is incomplete.
    [[nodiscard]] std::optional<Eigen::VectorXd> residual(const std::vector<Response>& simulated) const;
    /// 1 in masked rows, 0 elsewhere: added to their squared residual, so that masking is not rewarded. No part of the
    /// residual, whose sign guides a search.
    [[nodiscard]] Eigen::VectorXd maskPenalty(const std::vector<Response>& simulated) const;
    /// Whitened a - b.
    [[nodiscard]] std::optional<Eigen::VectorXd> whitenedDifference(const std::vector<Response>& a,
                                                                    const std::vector<Response>& b) const;
    /// Whitens a difference of one run.
    [[nodiscard]] Eigen::VectorXd whiten(std::size_t run, const Eigen::VectorXd& rawResidual) const;
    /// The transposed map: sums of its result over rows are products with their whitened shifts.
    [[nodiscard]] Eigen::VectorXd whitenTransposed(std::size_t run, const Eigen::VectorXd& whitened) const;

    [[nodiscard]] const RecordedData& data() const { return data_; }
    [[nodiscard]] const Noise& noise() const { return noise_; }
    /// Prior standard deviation of the zero of a run's force, N.
    [[nodiscard]] double zeroStd(std::size_t run) const { return runModels_[run].zero; }
    [[nodiscard]] std::size_t runs() const { return data_.runs.size(); }
    [[nodiscard]] Eigen::Index rows() const { return start_.back(); }
    [[nodiscard]] Eigen::Index start(std::size_t run) const { return start_[run]; } ///< of a run in the stack
    [[nodiscard]] Eigen::Index rowsOf(std::size_t run) const { return start_[run + 1] - start_[run]; }
    /// Number of rows that count.
    [[nodiscard]] Eigen::Index countedRows() const;
    [[nodiscard]] Eigen::Index countedRowsIn(std::size_t run) const;
    [[nodiscard]] const ModelError& errors(std::size_t run) const { return runModels_[run].errors; }
    /// The rows of a run are those of its force, its markers, its further channels and its jumps, in this order.
    [[nodiscard]] bool isForce(std::size_t run, Eigen::Index row) const { return row < data_.runs[run].force.size(); }
    [[nodiscard]] bool isMarker(std::size_t run, Eigen::Index row) const { return channelOf(run, row) == 1; }
    /// 0: force and jumps, 1: markers, then the further channels.
    [[nodiscard]] std::size_t channelOf(std::size_t run, Eigen::Index row) const;
    /// Time of a row that is no jump, s.
    [[nodiscard]] double timeOfReading(std::size_t run, Eigen::Index row) const;
    [[nodiscard]] const ModelError& furtherErrors(std::size_t run, std::size_t channel) const {
        return runModels_[run].further[channel].errors;
    }
    [[nodiscard]] bool counts(std::size_t run, Eigen::Index row) const;
    [[nodiscard]] std::size_t stroke(std::size_t run, Eigen::Index row) const; ///< of the drive
    [[nodiscard]] bool isJump(std::size_t run, Eigen::Index row) const { return row >= data_.runs[run].rows(); }
    [[nodiscard]] const std::vector<replay::Landmark>& jumps(std::size_t run) const { return runModels_[run].jumps; }
    [[nodiscard]] const LikelihoodSettings& settings() const { return settings_; }
    /// Responses from which, with these as the fine ones, another likelihood has the discretisation error of this one.
    [[nodiscard]] std::vector<Response> finerThan(std::vector<Response> fine) const;
    /// Norm of the recorded readings about their mean of each run, over the noise: what a radian of phase changes.
    [[nodiscard]] double signalNorm() const;

private:
    /// Errors of one channel of a run.
    struct ChannelModel {
        ModelError errors;
        Whitening force;
        double zero = 0.0; ///< see zeroOf()
        /// Whitened effects of the nuisance parameters at one prior sigma: zero, clock, scale.
        Eigen::MatrixXd nuisance;
        Eigen::MatrixXd shrinkage; ///< u - nuisance shrinkage nuisance' u removes their part

        ChannelModel() = default;
        /// @param data of which this is the first channel
        ChannelModel(const RecordedData& data, const RecordedRun& run, const Noise& noise, const Response& fine,
                     const Response& finer, double peak, const LikelihoodSettings& settings);
        [[nodiscard]] Eigen::VectorXd whiten(Eigen::VectorXd raw) const;
        [[nodiscard]] Eigen::VectorXd transposed(Eigen::VectorXd whitened) const;
    };
    /// Recorded jumps of one channel that no channel before it shows.
    struct ChannelJumps {
        std::size_t channel = 0; ///< 0: the first one
        std::vector<replay::Landmark> jumps;
    };
    struct RunModel : ChannelModel {
        std::vector<ChannelModel> further;
        struct CommonShift {
            Eigen::Index from = 0, to = 0; ///< marker rows [from, to)
            double sigma = 0.0;            ///< m, prior standard deviation of their shift
        };
        std::vector<CommonShift> shifts;
        std::vector<ChannelJumps> jumping;
        std::vector<replay::Landmark> jumps; ///< all of them, one channel after the other
        Eigen::MatrixXd jumpFactor;          ///< L L' = covariance of their times, s
    };
    /// Times of the recorded jumps in a simulation, s (the farthest allowed if absent), and the masked intervals.
    struct SimulatedJumps {
        std::vector<double> time;
        std::vector<bool> found;
        TimeRanges maskedRanges;
    };
    [[nodiscard]] SimulatedJumps simulatedJumpsOf(std::size_t run, const Response& simulated) const;
    [[nodiscard]] bool complete(std::size_t run, const Response& simulated) const;
    /// A run with a channel in place of the force; 0: the run itself.
    [[nodiscard]] const RecordedRun& runOf(std::size_t run, std::size_t channel) const {
        return channel == 0 ? data_.runs[run] : further_[channel - 1].runs[run];
    }
    [[nodiscard]] static Response inChannel(const Response& all, std::size_t channel) {
        return channel == 0 ? all : all.withChannel(channel - 1);
    }
    void interpolateAllMasked(std::size_t run, const TimeRanges& maskedRanges, RawDifference& d) const;
    void addJumps(std::size_t run, const Response& fine, const Response& finer, const LikelihoodSettings& s,
                  RunModel& model) const;
    static void addSnapShifts(const RecordedRun& run, double sigma, RunModel& model);
    /// Rows of a further channel in a run.
    template <class Rows>
    [[nodiscard]] auto partOf(std::size_t run, std::size_t channel, Rows&& rows) const {
        const Eigen::Index n = data_.runs[run].force.size();
        return rows.segment(n + data_.runs[run].markers.size() + static_cast<Eigen::Index>(channel) * n, n);
    }
    static void removeShift(const RunModel& model, const RunModel::CommonShift& shift,
                            Eigen::Ref<Eigen::VectorXd> markers);
    static void addStrokeShifts(const RecordedRun& run, double sigma, RunModel& model);

    const RecordedData& data_;
    std::vector<RecordedData> further_; ///< RecordedData::withChannel() of each further one
    Noise noise_;
    LikelihoodSettings settings_;
    std::vector<RunModel> runModels_;
    std::vector<Eigen::Index> start_;
};

} // namespace supercircle::diagnosis
