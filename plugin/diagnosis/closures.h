#pragma once
// Laws that are learned where no effect of the catalogue holds: penalised cubic B-splines of a state, added to the
// readings. Of time alone only where the sensor adds something.
//
// | what is learned | state | where it acts |
// | force of the machine, both ways the same | displacement | readings |
// | force of the machine against its motion | displacement | readings |
// | zero of the load cell | time | readings |
//
// Source: P. H. C. Eilers, B. D. Marx, Stat. Sci. 11 (1996) 89 (P-splines); S. N. Wood, M. Fasiolo, Biometrics 73
// (2017) 1071 (smoothing by generalised Fellner-Schall steps).

#include "plugin/diagnosis/menu.h"
#include "supercircle/effects/spline.h"

namespace supercircle::diagnosis {

/// Appends the learned candidates; the catalogue's come first.
void addClosures(Menu& menu, const Sizes& sizes);

} // namespace supercircle::diagnosis
