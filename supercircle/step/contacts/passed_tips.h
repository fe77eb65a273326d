#pragma once
// Nodes that pass the tip of another rod within a step (private to step/; Settings::leavesTips, decision 0203).
//
// The distance of a node to a rod falls while its foot runs towards the rod's tip, and rises beyond it. The row of
// mid-step takes one slope for the whole step: the node seems to meet the tip and is held there, although the tip
// slides on. Beyond the tip the candidate of the tip itself is the nearer one, so the node's may go.

#include "supercircle/contact/detection.h"

#include <vector>

namespace supercircle::step {

/// Takes those out of `candidates`, framed in the middle of the step at `curves`, and of the list of their gaps. The
/// first of them belong to `start`, where the step begins.
void leaveOutPassedTips(const std::vector<contact::Candidate>& start, const std::vector<contact::RodCurve>& curves,
                        std::vector<contact::Candidate>& candidates, std::vector<double>& gaps);

} // namespace supercircle::step
