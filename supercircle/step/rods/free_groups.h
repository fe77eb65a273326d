#pragma once
// Which rods may move freely together (private to step/): joints tie rods to one motion. What one of them touches
// binds all.

#include "supercircle/step/stages/trial_step.h"

namespace supercircle::step {

/// Groups of the rods that may be `free`: t.groups. Those that joints bind to something else are taken out of `free`.
void listFreeGroups(const World& world, std::vector<char>& free, TrialStep& t);

} // namespace supercircle::step
