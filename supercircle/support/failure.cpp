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

void fail(std::string_view message, const char* file, int line) {
    const FailureHandler handler = current.load();
    (handler != nullptr ? handler : print)(file, line, message);
    std::abort();
}

} // namespace supercircle
