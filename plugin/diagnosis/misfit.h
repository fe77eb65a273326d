#pragma once
// Residuals in noise units: the readings of all runs, stacked, with what is known about their errors divided out.
//
// Beside the sensors' noise there are
// - the simulation's own error. Most of it is that of finite elements, which falls with the square of their length, so
//   that the fine simulation's is 4/3 of its difference to one with half their length (L. F. Richardson, Phil. Trans.
//   R. Soc. A 210 (1911) 307): it is taken out, as it is near the recordings, and a quarter of it is left as doubt, all
//   of it where it changes quickly. Taken for an error of unknown sign it was as large as the noise on strips and
//   arches, and weak effects could not be seen behind it. Taken from the search's simulation, of 15 arcs in longer
//   steps, it blamed arcs for what steps do: .39 mN (90 % of the rows) were left on an arch of .6 N, .006 mN since both
//   take the same steps, and gravity gained 16 squares in a recording that lacks nothing. Beside it stand the force's
//   slope times the few micrometres to which contact places agree, and a share of the peak (shares of the peak within
//   which 68 % and 90 % of the rows agree with a simulator of another kind that knows the truth, tuning cases of
//   docs/proof.md: strips .22 and .24 % as simulated, .02 and .04 % corrected by the search's, arches .15 and .24, .05
//   and .08, shells on cylinders .05 and .09, .005 and .01);
// - snaps: there a curve's rows mean nothing, they are missing. Where the machine itself turns round or stops, only the
//   rows beside the turning point are, for a jump of any size that can be seen: no machine turns round in no time.
//   Where a jump of the force happens is a row of its own (jumps.h);
// - where a viscous specimen is touched its force is there at once, and which readings see it hangs on micrometres of
//   the head and on how soft a touch is, which is described nowhere: a reading 15 um behind it had half the 80 mN
//   foretold (third simulator of docs/proof.md, training case 01), and by that reading alone, 11 deviations, runs it
//   was foretold for got a viscosity 6 % too small. Rows within 20 um of such a touch are missing;
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
//   hundred rows, and was called adhesion, gravity or misalignment;
// - a specimen that is let go swings, and how that dies away nobody has described: two simulators with the true numbers
//   had the tip of a strip .4 mm apart there, and the few rows of its markers made adhesion of it. They are missing.

#include "plugin/diagnosis/data.h"
#include "plugin/diagnosis/jumps.h"
#include "plugin/diagnosis/model.h"
#include "plugin/diagnosis/noise.h"
#include "plugin/diagnosis/whitening.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct MisfitSettings {
    double contactPlace = 3e-6; ///< to which contact places agree, m
    double shareOfPeak = 4e-4; ///< accuracy of a corrected simulation, share of the peak force, as long as it remembers
    double scale = 1e-3;       ///< and of what a whole run has in common, share of the force
    /// Error of the fine simulation in the difference of the finer one to it: 1 / (1 - (31/61)^2).
    double refinement = 1.348;
    double uncorrected = 0.25;   ///< share of the correction that is left as doubt
    double repeated = 1.0;       ///< factor of all errors of a simulation: inEachOf()
    double markerPlace = 1.5e-5; ///< of a simulated marker, m, in single rows
    double markerShift = 5e-6;   ///< and in what they share over a stroke
    double clock = 0.1;          ///< rows by which clocks of reading and drive may differ
    double landing = 1e-4;       ///< to which the place after a snap is known, m
    double swing = 0.5;          ///< s for which a specimen swings when it is let go: markers are left out
    double free = 0.01;          ///< share of the peak force below which nothing is held any more
    double touchPlace = 2e-5;    ///< within which a force that is there at once where a specimen is touched appears, m
    double turnRows = 1.5;       ///< left out on either side of a jump where the machine turns round
    double snapBefore = 0.1;     ///< s left out ahead of a snap
    double snapAfter = 0.3;      ///< and behind it
    double snapShare = 0.15;     ///< of the force range within two rows
    double jumpPlace = 5e-3;     ///< to which a simulated jump's place is known, share of the travel, alike in a run
    double jumpNoise = 6.0;      ///< deviations of the noise that a recorded jump or snap has at least
    double jumpFarthest = 0.2;   ///< share of a stroke by which one event may lie apart in two curves

    /// In each of n runs that repeat one another. A simulation is wrong in all of them alike, which no number of
    /// repeats averages away: with errors sqrt(n) times as large in each, taken for independent, what they have in
    /// common is known no better than from one run.
    [[nodiscard]] MisfitSettings inEachOf(std::size_t n) const;
};

/// Error of a simulated force in row k for contact places that agree to micrometres, N.
/// @param way of the head from row to row, m
double placeError(const Eigen::VectorXd& force, Eigen::Index k, double way, const MisfitSettings& settings);

/// Rows that do not count, and the simulation's error in the others.
struct RowErrors {
    Eigen::VectorXd force;      ///< standard deviation, N; infinite: missing
    Eigen::VectorXd markers;    ///< m, noise included; infinite: missing
    Eigen::VectorXd correction; ///< what finer elements would add to a fine simulation's force, N
    double memory = 1.0;        ///< of the force error, s
    std::vector<double> snaps;  ///< their times, s
};
RowErrors rowErrors(const RecordedRun& run, const Noise& noise, const Response& fine, const Response& finer,
                    double peakForce, const MisfitSettings& settings);

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
