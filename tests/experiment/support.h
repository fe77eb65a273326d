#pragma once
// A small experiment to be spoilt, and folders that go away.

#include "plugin/experiment/load.h"
#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <unistd.h>

namespace experimenttest {

using namespace supercircle;
using test::Folder;

inline std::string baseline(int number) {
    return std::string(SC_TEST_DATA) + "/recordings/baseline/case_" + std::to_string(number) + "/experiment.json";
}

inline std::string contentOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    REQUIRE(in.good());
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// `text` with the first occurrence of `what` replaced; fails the test if there is none.
inline std::string with(std::string text, const std::string& what, const std::string& instead) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), instead);
}

/// All problems of a text, a line each; notes begin with "note: " after their place.
inline std::string problemsOf(const std::string& text) {
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::loadText(text, "e.json", problems);
    CHECK(loaded.has_value() == !scene::anyError(problems));
    std::string all;
    for (const scene::Problem& p : problems)
        all += p.toString() + "\n";
    return all;
}

} // namespace experimenttest
