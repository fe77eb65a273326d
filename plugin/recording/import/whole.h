#pragma once
// Whether a recording as a whole can be what the machine measured.

#include "plugin/recording/import/signals.h"

namespace supercircle::importing {

/// Whether values jump and come back within two rows in more than 0.5 % of the rows.
bool jumpsTooOften(const std::vector<double>& values, Quantity quantity);

/// Fails for values that jump and come back within two rows in more than 0.5 % of the rows, as numbers do whose decimal
/// mark was lost. "LINE:1: ..."; `--accept jumps` lets them pass with a remark.
Status checkWhole(const Signals& signals, Table& table, const Hints& hints);

/// Fails if more than 1 % of the lines that hold the numbers of a row are in no run. `--accept dropped` lets them pass.
Status checkLost(std::size_t lost, std::size_t candidates, std::size_t firstLine, const Hints& hints);

} // namespace supercircle::importing
