#pragma once
// A value or the reason there is none.

#include <string>
#include <utility>

namespace supercircle::record {

/// Either a value (error is empty) or a message for the user.
template <typename T>
struct Result {
    T value{};
    std::string error;
    explicit operator bool() const { return error.empty(); }
    static Result fail(std::string message) { return Result{T{}, std::move(message)}; }
};

} // namespace supercircle::record
