#pragma once
// A learned curve in words, by rules.

#include "plugin/identification/diagnosis/result.h"

#include <string>

namespace supercircle::diagnosis {

/// Where it was visited: how much it changes from one end to the other, whether on the way it goes beyond either end,
/// where half of the change is done, whether it is flat or straight in the end, and what such a law is called.
std::string inWords(const LearnedLaw& law);

} // namespace supercircle::diagnosis
