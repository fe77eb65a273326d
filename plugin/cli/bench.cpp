#include "plugin/cli/verbs.h"

#include <cstdio>

namespace supercircle::cli {

int bench(const std::string&, const std::string&) {
    std::fprintf(stderr, "bench\n");
    return kDone;
}

} // namespace supercircle::cli
