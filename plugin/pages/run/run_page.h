#pragma once
// The report of a run as one HTML page.

#include <string>

#include "plugin/recording/table/recording.h"

namespace supercircle::pages {

/// One self-contained page: no external resource, opens from a file. Sections without data are left out.
[[nodiscard]] std::string runPage(const record::Recording& recording);

} // namespace supercircle::pages
