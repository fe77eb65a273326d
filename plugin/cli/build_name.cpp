#include "plugin/cli/build_name.h"

#include "plugin/recording/table/files.h"
#include "supercircle/support/hash.h"

#include <cstdio>

namespace supercircle::cli {

std::string checksum(std::string_view text) {
    char digits[20];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(checkSum(text)));
    return digits;
}

std::string buildName() {
    const auto program = record::readText("/proc/self/exe");
    return std::string(SC_VERSION) + " " + checksum(program ? *program : std::string{});
}

} // namespace supercircle::cli
