#pragma once
// A concealed case: recordings a diagnosis may see, and an answer it may not.

#include "tests/oracle/conceal/cases.h"

#include <string>
#include <utility>
#include <vector>

namespace supercircle::oracle {

struct Concealed {
    std::string failure;
    std::vector<std::pair<std::string, std::string>> files; ///< name and text, for the recordings' folder
    std::string answer;                                     ///< JSON
};

Concealed conceal(const Plan& plan);

} // namespace supercircle::oracle
