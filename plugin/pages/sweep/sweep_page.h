#pragma once
// Pictures and page of a sweep.

#include "plugin/lab/sweep/table.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/result.h"

#include <vector>

namespace supercircle::cli {

/// report.html and its pictures by name and content.
record::Result<std::vector<record::NamedText>> sweepPages(const sweep::Definition& sweep, const sweep::Table& table,
                                                          sweep::Store& store);

} // namespace supercircle::cli
