#pragma once
// Coefficients of SDIRK2 (private to step/), which free motion and contact in motion share.

namespace supercircle::step {

constexpr double kGamma = 0.29289321881345247560;        ///< 1 - 1/sqrt(2), of a stage in the step
constexpr double kExtrapolate = (1.0 - kGamma) / kGamma; ///< of the first stage's way, to the start of the second

} // namespace supercircle::step
