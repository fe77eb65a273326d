#pragma once
// The report as one HTML page.

#include <string>

#include "plugin/recording/table/recording.h"

namespace supercircle::report {

/// One self-contained page: no external resource, opens from a file. Sections without data are left out.
[[nodiscard]] std::string pageHtml(const record::Recording& recording);

} // namespace supercircle::report
