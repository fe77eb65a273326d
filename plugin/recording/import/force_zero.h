#pragma once
// The zero of the force: a sensor's offset is subtracted, a preload is kept.

#include "plugin/recording/import/import.h"

namespace supercircle::importing {

/// Sets the zero and the run's noise, first contact and what was subtracted. From the data: the first sixth of the rows
/// before first contact, at least five, if their slope is below three standard errors, and if the crosshead moves there
/// without the force or the mean is below a hundredth of the range. Fails for a window without samples.
Status zeroForce(ImportedRun& run, const ForceZero& wanted);

/// White noise from second differences (median: jumps do not count), 0: too few values.
double whiteNoise(const std::vector<double>& values);

} // namespace supercircle::importing
