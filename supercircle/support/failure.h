#pragma once
// What happens when a program breaks a promise: an empty Result is read, a call with or_fail() fails, or an assertion
// does not hold. All call one handler. Bad input never comes here; it is answered by a Result.

#include <string_view>

namespace supercircle {

/// Called with the place and a sentence. It may throw or leave by other means; if it returns, the program is aborted.
using FailureHandler = void (*)(const char* file, int line, std::string_view message);

/// Replaces the handler for the whole process and returns the one before. Null: print `file:line: message` to stderr
/// and abort, which is the default. May be called from any thread.
FailureHandler set_failure_handler(FailureHandler handler);

/// Calls the handler. The defaults are the place of the call (std::source_location is not in all compilers yet).
[[noreturn]] void fail(std::string_view message, const char* file = __builtin_FILE(), int line = __builtin_LINE());

} // namespace supercircle

/// An invariant whose check costs next to nothing: on in every build.
#define SC_ASSERT(condition, message)                                                                                  \
    do {                                                                                                               \
        if (!(condition)) [[unlikely]]                                                                                 \
            ::supercircle::fail("assertion failed: " #condition ": " message);                                         \
    } while (false)

/// An invariant that is expensive to check: on where SUPERCIRCLE_CHECKED is defined, as in sanitizer builds.
#ifdef SUPERCIRCLE_CHECKED
#define SC_ASSERT_EXPENSIVE(condition, message) SC_ASSERT(condition, message)
#else
#define SC_ASSERT_EXPENSIVE(condition, message)                                                                        \
    do {                                                                                                               \
        if constexpr (false)                                                                                           \
            (void)(condition);                                                                                         \
    } while (false)
#endif
