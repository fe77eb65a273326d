#pragma once
// How noisy the sensors are, learnt where no physics acts: while the head stands still, and from what neighbouring
// rows do against each other. Never from the misfit, or every missing effect would be called noise.
//
// White part s and coloured part c (AR(1), memory tau) maximise the restricted likelihood of the resting stretches
// (mean, slope and logarithm of time taken out: a rest may relax) times that of the robust scale of second differences
// over all rows, whose expectation is 6 s^2 + c^2 (6 - 8 phi + 2 phi^2), with two priors: the stated total is right
// within about 30 % (a normal of 20 % in its logarithm), and c/s lies within a factor of about 1.6 around 0.55. Rests
// hold few memories of the coloured part, so c is known to some 25 %: what is possible beside the most probable values
// is kept, for the null of the localisation.
//
// Where the most probable size lies 2.2 times above the stated one or 2.7 times below it (which only rests can tell),
// and fourth differences, of rests where there are any, lie to the same side, what is stated is refuted and no prior
// any more; the source says so. Nothing is less noisy than the steps in which readings come, evenly distributed around
// the truth; where nothing is stated and nothing rests, fourth differences of all rows have to do.
//
// Runs that repeat another one (same drive, same rows) may differ by more than their sensors: half the variance of
// their difference, its mean and the sensor's part taken out, is the scatter from run to run, where it is more than
// three deviations of what noise alone may seem to be (few memories in a pair, a size of the noise that is not quite
// known). It counts in every row with the simulation's long memory, and hides what is weak and lasts: by a pair of
// readings in steps of .46 mN, the median of whose differences was two steps and should have been 1.7, a scatter of .56
// mN that was none made "nothing" of a friction of six deviations. Without repeats it is unknown and taken as zero; the
// source says so.
//
// Where a sine in the rests makes them so much more probable that there is no doubt, it is taken out first: a
// disturbance that never rests would count as noise, and hide itself. Rests that are too short to show one say that
// noise is large instead; what a fit leaves of whole runs shows it (swings.h), and the estimate is made once more.
//
// Source: restricted likelihood: D. A. Harville, J. Am. Stat. Assoc. 72 (1977) 320; scale by the median of absolute
// values: P. J. Huber, E. M. Ronchetti, "Robust Statistics", 2nd ed. (2009), 5.1.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/recorded/swings.h"

#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct Noise {
    double white = 0.0;    ///< N
    double coloured = 0.0; ///< N
    double memory = 0.25;  ///< s
    double marker = 0.0;   ///< m, per coordinate
    std::string source;    ///< in words
    double quietSeconds = 0.0;
    double runToRun = 0.0;   ///< scatter of repeats beyond the sensor's noise, N; 0: none that shows
    double tails = 0.0;      ///< excess kurtosis of the white part, 0: not told from a normal distribution
    std::size_t repeats = 0; ///< runs that repeat another one
    /// What rests (or whole runs) show beyond noise, a sine of the reading: no part of it. N, s; 0: none.
    double swing = 0.0, swingPeriod = 0.0;
    bool swingInMisfit = false; ///< whole runs show it, in what the nominal fit leaves of them; else rests
    /// What the readings leave open of the first three: equally probable draws of their posterior. Empty: nothing.
    struct Possible {
        double white = 0.0, coloured = 0.0, memory = 0.0;
    };
    std::vector<Possible> possible{};
    [[nodiscard]] double total() const;
    /// As large, without memory: what the diagnosis would work with if it did not whiten (an ablation).
    [[nodiscard]] Noise asWhite() const;
    /// Standard deviation of the mean over `span` seconds with rows `dt` apart, N.
    [[nodiscard]] double ofMean(double span, double dt) const;
};

/// @param seen a sine that whole runs show (swingOfMisfit()): taken out
Noise estimateNoise(const Data& data, const Swing& seen = {});

/// Mean square of whitened readings, 1 by the most probable noise, where the noise is larger than thought: a fortieth
/// of what is possible has more. 1 where nothing is open.
double mostSquares(const Data& data, const Noise& noise, std::uint64_t seed);

} // namespace supercircle::diagnosis
