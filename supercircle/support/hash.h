#pragma once
// Check sum of bytes, for names and for comparing files; not against intent.
//
// Source: FNV-1a, G. Fowler, L. C. Noll, K.-P. Vo.

#include <cstdint>
#include <string_view>

namespace supercircle {

inline constexpr std::uint64_t kHashStart64 = 14695981039346656037ULL;

/// @param from the sum of the bytes before
constexpr std::uint64_t checkSum(std::string_view bytes, std::uint64_t from = kHashStart64) {
    for (const char c : bytes)
        from = (from ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    return from;
}

} // namespace supercircle
