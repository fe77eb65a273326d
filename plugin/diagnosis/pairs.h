#pragma once
// Two effects at a time. The second one is looked for in what the first leaves, because beside a strong effect a weak
// one does not rank among the best alone.

#include "plugin/diagnosis/screen.h"
#include "plugin/diagnosis/tried.h"

namespace supercircle::diagnosis {

/// Fits the best single effect with the two that explain most of what it leaves, and the second best with one.
/// @param singles best first; those whose pairs are tried
std::vector<Tried> fitPairs(Evaluator& evaluator, const Misfit& misfit, const std::vector<Screened>& screened,
                            const std::vector<Tried>& singles);

} // namespace supercircle::diagnosis
