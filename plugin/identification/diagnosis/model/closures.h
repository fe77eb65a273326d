#pragma once
// Laws that are learned where no effect of the catalogue holds: penalised cubic B-splines of a state, in the slots of
// the simulator. Never of time alone, except for what the sensor adds to its readings.
//
// | what is learned | state | where it acts |
// | bending stiffness dM/d kappa | curvature change | material |
// | friction coefficient | speed of sliding (logarithm) | contact |
// | friction coefficient | way slid | contact |
// | attraction of surfaces | gap | contact |
// | force of the machine, both ways the same | displacement | readings |
// | force of the machine against its motion | displacement | readings |
// | zero of the load cell | time | readings |
//
// Source: P. H. C. Eilers, B. D. Marx, Stat. Sci. 11 (1996) 89 (P-splines); S. N. Wood, M. Fasiolo, Biometrics 73
// (2017) 1071 (smoothing by generalised Fellner-Schall steps).

#include "plugin/identification/diagnosis/model/menu.h"

namespace supercircle::diagnosis {

/// Appends the learned candidates; the catalogue's come first.
void addClosures(Menu& menu, const Sizes& sizes);

} // namespace supercircle::diagnosis
