#pragma once
// Description of a learned law in words, by rules.

#include "plugin/identification/diagnosis/result.h"

#include <string>

namespace supercircle::diagnosis {

/// Describes the law in the range of states that the runs cover: total change, extremum, half-way state, final slope,
/// and the usual name of such a law.
std::string describeLaw(const LearnedLaw& law);

} // namespace supercircle::diagnosis
