#include "supercircle/support/failure.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace supercircle {

namespace {

std::atomic<FailureHandler> current{nullptr};

void print(const char* file, int line, std::string_view message) {
    std::fprintf(stderr, "%s:%d: %.*s\n", file, line, static_cast<int>(message.size()), message.data());
}

} // namespace

FailureHandler set_failure_handler(FailureHandler handler) {
    return current.exchange(handler);
}

void fail(std::string_view message, std::source_location where) {
    const FailureHandler handler = current.load();
    (handler != nullptr ? handler : print)(where.file_name(), static_cast<int>(where.line()), message);
    std::abort();
}

} // namespace supercircle
