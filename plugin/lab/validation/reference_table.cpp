#include "plugin/lab/validation/reference_table.h"

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"
#include "supercircle/support/cells.h"

#include <limits>
#include <sstream>
#include <stdexcept>

namespace supercircle::validation {

ReferenceTable::ReferenceTable(const std::string& directory, const std::string& name) : file_(directory + "/" + name) {
    const auto text = record::readText(file_);
    if (!text)
        throw std::runtime_error(text.error());
    std::istringstream in(*text);
    std::vector<std::string> header;
    int number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        if (line.empty() || line[0] == '#')
            continue;
        const std::vector<std::string> row = cellsOutsideParentheses(line);
        if (header.empty()) {
            header = row;
            continue;
        }
        if (row.size() != header.size())
            throw std::runtime_error(file_ + ":" + std::to_string(number) + ": " + std::to_string(row.size()) +
                                     " cells, expected " + std::to_string(header.size()));
        labels_.push_back(row.front());
        for (std::size_t i = 0; i < row.size(); ++i) {
            double value = std::numeric_limits<double>::quiet_NaN();
            if (!record::parseNumber(row[i], value) && i > 0)
                throw std::runtime_error(file_ + ":" + std::to_string(number) + ": \"" + row[i] + "\" is not a number");
            columns_[header[i]].push_back(value);
        }
    }
    if (labels_.empty())
        throw std::runtime_error(file_ + ": there are no rows");
}

const std::vector<double>& ReferenceTable::column(const std::string& name) const {
    const auto it = columns_.find(name);
    if (it == columns_.end())
        throw std::runtime_error(file_ + ": there is no column \"" + name + "\"");
    return it->second;
}

} // namespace supercircle::validation
