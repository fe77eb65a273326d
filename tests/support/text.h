#pragma once
// Contents of files, and texts changed at one place.

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <string>

namespace supercircle::test {

/// Content of a file; fails the test if there is none.
inline std::string contentOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    INFO(path);
    REQUIRE(file.good());
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// `text` with the first occurrence of `what` replaced; fails the test if there is none.
inline std::string with(std::string text, const std::string& what, const std::string& instead) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), instead);
}

} // namespace supercircle::test
