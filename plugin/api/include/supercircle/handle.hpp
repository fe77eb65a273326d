#pragma once
// What every public header needs: how a shell is named, and how a call says no.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace supercircle {

/// Names a shell; survives misuse: a stale or foreign handle gives an error, never a crash. Zero is nobody.
struct ShellHandle {
    std::uint32_t index = 0;
    std::uint32_t generation = 0;
    std::uint32_t world = 0; ///< which Shells it belongs to
    [[nodiscard]] bool null() const { return generation == 0; }
    friend bool operator==(const ShellHandle&, const ShellHandle&) = default;
};

/// A value or the reason why there is none.
template <class T>
class Result {
public:
    Result(T value) : value_(std::move(value)) {}
    static Result failure(std::string why) {
        Result r;
        r.error_ = std::move(why);
        return r;
    }
    explicit operator bool() const { return value_.has_value(); }
    [[nodiscard]] const T& value() const { return *value_; }
    [[nodiscard]] const T& operator*() const { return *value_; }
    [[nodiscard]] const T* operator->() const { return &*value_; }
    [[nodiscard]] const std::string& error() const { return error_; }

private:
    Result() = default;
    std::optional<T> value_;
    std::string error_;
};

/// Done, or the reason why not.
using Outcome = Result<std::monostate>;

} // namespace supercircle
