#pragma once
// Residuals in noise units: the readings of all runs, stacked, with what is known about their errors divided out.
//
// Beside the sensors' noise there are
// - what single rows are off by, and rows that say nothing (row_errors.h);
// - the force zero: the mean of the first stretch was subtracted from noise, which shifts the whole run; its clock,
//   which agrees with the drive's to a tenth of a row; and the scale of the simulated force, because what is left of a
//   simulator's error belongs to a run as a whole, fast ones before all (0.13 % in the fast run of a strip, 0.02 % in
//   the slow ones: eight memories in a row the same way, which was a defect of the natural curvature). They are normal
//   variables with known priors, integrated out by shrinking their directions N: (1 + N N')^(-1/2) = 1 - N S N';
// - repeats scatter by more than their sensors: in every row, remembered as long as the simulation's error is. What the
//   simulation is off by is the same in each of them (inEachOf());
// - where a specimen comes to rest after a snap depends on how it flew: from one snap to the next each coordinate of
//   each marker has a shift of its own, known to a tenth of a millimetre, integrated out in the same way;
// - so has each in each stroke of the drive, as far as a simulated marker's place can be trusted: where feet stick
//   depends on what they did before. Taken for noise that is new in every row, a shift of 10 um stood out of two
//   hundred rows, and was called adhesion, gravity or misalignment.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/likelihood/jumps.h"
#include "plugin/identification/diagnosis/likelihood/row_errors.h"
#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// One run's readings minus others', as measured: force, N, markers, m, and times of jumps, s.
struct Departure {
    Eigen::VectorXd rows;     ///< empty: a simulation failed or did not reach the end
    std::vector<bool> hidden; ///< rows between a recorded jump and the simulated one that it is: bridged
};

class Misfit {
public:
    /// @param fine, finer simulations near the recordings, per run
    Misfit(const Data& data, const Noise& noise, const std::vector<Response>& fine, const std::vector<Response>& finer,
           const MisfitSettings& settings = {});

    /// Recorded minus simulated of one run.
    [[nodiscard]] Departure departure(std::size_t run, const Response& simulated) const;
    /// a minus b of two simulations of one run; what either hides is bridged.
    [[nodiscard]] Departure change(std::size_t run, const Response& a, const Response& b) const;
    /// Recorded minus simulated of all runs, whitened; empty if a simulation failed or did not reach the end.
    [[nodiscard]] std::optional<Eigen::VectorXd> residual(const std::vector<Response>& simulated) const;
    /// 1 in rows that a simulation hides, 0 elsewhere: what is added to their squares, because what says nothing is not
    /// worth anything either. Not part of the residual, whose sign leads a search.
    [[nodiscard]] Eigen::VectorXd charge(const std::vector<Response>& simulated) const;
    /// Whitened a - b.
    [[nodiscard]] std::optional<Eigen::VectorXd> difference(const std::vector<Response>& a,
                                                            const std::vector<Response>& b) const;
    /// Of the rows of any departure of one run.
    [[nodiscard]] Eigen::VectorXd whiten(std::size_t run, const Eigen::VectorXd& departure) const;
    /// The transposed map: sums of its result over rows are products with whitened shifts of these rows.
    [[nodiscard]] Eigen::VectorXd whitenTransposed(std::size_t run, const Eigen::VectorXd& whitened) const;

    [[nodiscard]] const Data& data() const { return data_; }
    [[nodiscard]] const Noise& noise() const { return noise_; }
    /// Deviation to which the zero of a run's force is known, N.
    [[nodiscard]] double zeroOf(std::size_t run) const { return parts_[run].zero; }
    [[nodiscard]] std::size_t runs() const { return data_.runs.size(); }
    [[nodiscard]] Eigen::Index rows() const { return start_.back(); }
    [[nodiscard]] Eigen::Index start(std::size_t run) const { return start_[run]; } ///< of a run in the stack
    [[nodiscard]] Eigen::Index rowsOf(std::size_t run) const { return start_[run + 1] - start_[run]; }
    /// Rows that count.
    [[nodiscard]] Eigen::Index present() const;
    [[nodiscard]] Eigen::Index presentIn(std::size_t run) const;
    [[nodiscard]] const RowErrors& errors(std::size_t run) const { return parts_[run].errors; }
    /// Rows of a run are those of its force, of its markers and of its jumps, in this order.
    [[nodiscard]] bool isForce(std::size_t run, Eigen::Index row) const { return row < data_.runs[run].force.size(); }
    [[nodiscard]] bool isMarker(std::size_t run, Eigen::Index row) const {
        return !isForce(run, row) && row < data_.runs[run].rows();
    }
    [[nodiscard]] bool counts(std::size_t run, Eigen::Index row) const;
    [[nodiscard]] std::size_t stroke(std::size_t run, Eigen::Index row) const; ///< of the drive
    [[nodiscard]] bool isJump(std::size_t run, Eigen::Index row) const { return row >= data_.runs[run].rows(); }
    [[nodiscard]] const std::vector<replay::Landmark>& jumps(std::size_t run) const { return parts_[run].jumps; }
    [[nodiscard]] const MisfitSettings& settings() const { return settings_; }

private:
    struct Part {
        RowErrors errors;
        Whitening force;
        double zero = 0.0; ///< see zeroOf()
        /// Whitened changes by what each run has of its own, times their prior deviations: zero of the force, clock,
        /// scale.
        Eigen::MatrixXd own;
        Eigen::MatrixXd shrink; ///< u - own shrink own' u leaves out what they could have done
        struct Shared {
            Eigen::Index from = 0, to = 0; ///< marker rows [from, to)
            double deviation = 0.0;        ///< of their shift, m
        };
        std::vector<Shared> shifts;
        std::vector<replay::Landmark> jumps;
        Eigen::MatrixXd jumpFactor; ///< L L' = covariance of their times, s
    };
    /// Where a simulation has the recorded jumps, s (as late as may be: has none), and what lies between.
    struct Places {
        std::vector<double> time;
        std::vector<bool> there;
        Stretches between;
    };
    [[nodiscard]] Places placesOf(std::size_t run, const Response& simulated) const;
    [[nodiscard]] bool complete(std::size_t run, const Response& simulated) const;
    void bridgeAll(std::size_t run, const Stretches& between, Departure& d) const;
    void addJumps(const RecordedRun& run, const Response& fine, const Response& finer, const MisfitSettings& s,
                  Part& part) const;
    static void addLandings(const RecordedRun& run, double deviation, Part& part);
    static void takeShiftOut(const Part& part, const Part::Shared& shift, Eigen::Ref<Eigen::VectorXd> markers);
    static void addPlaces(const RecordedRun& run, double deviation, Part& part);

    const Data& data_;
    Noise noise_;
    MisfitSettings settings_;
    std::vector<Part> parts_;
    std::vector<Eigen::Index> start_;
};

} // namespace supercircle::diagnosis
