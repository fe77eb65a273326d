#pragma once
// Pictures and page of a sweep.

#include "plugin/lab/sweep/run_table.h"
#include "plugin/recording/table/files.h"
#include "supercircle/support/result.h"

#include <vector>

namespace supercircle::pages {

/// report.html and its pictures by name and content.
Result<std::vector<record::NamedText>> sweepPages(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                                                  sweep::ResultStore& store);

} // namespace supercircle::pages
