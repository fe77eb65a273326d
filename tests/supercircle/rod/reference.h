#pragma once
// Reads the solved reference curves of tests/data/reference (CSV: '#' comments, a header line, numbers).

#include "supercircle/support/cells.h"

#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace supercircle::rod::reference {

using Row = std::map<std::string, double>;

inline std::vector<Row> read(const std::string& name) {
    std::ifstream in(std::string(SC_TEST_DATA) + "/reference/" + name);
    if (!in)
        throw std::runtime_error("cannot open reference " + name);
    std::vector<std::string> header;
    std::vector<Row> rows;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#')
            continue;
        const std::vector<std::string> values = cellsOutsideParentheses(line);
        if (header.empty()) {
            header = values;
            continue;
        }
        Row row;
        for (std::size_t i = 0; i < header.size(); ++i)
            row[header[i]] = std::stod(values.at(i));
        rows.push_back(row);
    }
    if (rows.empty())
        throw std::runtime_error("reference " + name + " is empty");
    return rows;
}

} // namespace supercircle::rod::reference
