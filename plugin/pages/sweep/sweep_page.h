#pragma once
// Pictures and page of a sweep.

#include "plugin/lab/sweep/run_table.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/result.h"

#include <vector>

namespace supercircle::pages {

/// report.html and its pictures by name and content.
record::Result<std::vector<record::NamedText>> sweepPages(const sweep::SweepDefinition& sweep,
                                                          const sweep::RunTable& table, sweep::ResultStore& store);

} // namespace supercircle::pages
