#include "plugin/cli/build_name.h"

#include "plugin/recording/table/files.h"

#include <cstdint>
#include <cstdio>

namespace supercircle::cli {

std::string checksum(std::string_view text) {
    std::uint64_t h = 14695981039346656037ULL;
    for (const char c : text)
        h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    char digits[20];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(h));
    return digits;
}

std::string buildName() {
    const auto program = record::readText("/proc/self/exe");
    return std::string(SC_VERSION) + " " + checksum(program ? *program : std::string{});
}

} // namespace supercircle::cli
