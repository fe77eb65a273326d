#pragma once
// A value, or the reason why there is none.

#include "supercircle/support/failure.h"

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace supercircle {

/// Test it before reading: the value of a failed Result is answered by the failure handler (failure.h).
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : value_(std::move(value)) {}
    /// Done; only a Status has this.
    Result() requires std::is_same_v<T, std::monostate> : value_(T{}) {}
    /// `why` is a sentence for the user: what is wrong, where, and the remedy.
    static Result failure(std::string why) { return Result(Failed{}, std::move(why)); }

    explicit operator bool() const { return value_.has_value(); }
    [[nodiscard]] const T& value() const& { return checked(); }
    [[nodiscard]] T& value() & { return const_cast<T&>(checked()); }
    [[nodiscard]] T&& value() && { return std::move(const_cast<T&>(checked())); }
    [[nodiscard]] const T& operator*() const& { return checked(); }
    [[nodiscard]] T& operator*() & { return value(); }
    [[nodiscard]] T&& operator*() && { return std::move(*this).value(); }
    [[nodiscard]] const T* operator->() const { return &checked(); }
    [[nodiscard]] T* operator->() { return &value(); }
    /// For a call that cannot fail here: calls the failure handler with the caller's place if there is no value.
    void or_fail(const char* file = __builtin_FILE(), int line = __builtin_LINE()) const {
        if (!value_) [[unlikely]]
            fail("a call failed: " + error_, file, line);
    }
    /// Why there is no value; empty if there is one.
    [[nodiscard]] const std::string& error() const& { return error_; }
    [[nodiscard]] std::string error() && { return std::move(error_); }

private:
    struct Failed {};
    Result(Failed, std::string why) : error_(std::move(why)) {}
    [[nodiscard]] const T& checked() const {
        if (!value_) [[unlikely]]
            fail("the value of a failed result was read: " + error_);
        return *value_;
    }
    std::optional<T> value_;
    std::string error_;
};

/// Done, or the reason why not.
using Status = Result<std::monostate>;

} // namespace supercircle
