#pragma once
// A small experiment for invalid variants, and temporary folders.

#include "plugin/recording/experiment/load.h"
#include "tests/support/folder.h"
#include "tests/support/text.h"

#include <catch2/catch.hpp>
#include <string>

namespace experimenttest {

using namespace supercircle;
using test::contentOf;
using test::Folder;
using test::with;

inline std::string baseline(int number) {
    return std::string(SC_TEST_DATA) + "/recordings/baseline/case_" + std::to_string(number) + "/experiment.json";
}

/// All problems of a text, a line each; notes begin with "note: " after their place.
inline std::string problemsOf(const std::string& text) {
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::loadText(text, "e.json", problems);
    CHECK(bool(loaded) == !scene::anyError(problems));
    std::string all;
    for (const scene::Problem& p : problems)
        all += p.toString() + "\n";
    return all;
}

} // namespace experimenttest
