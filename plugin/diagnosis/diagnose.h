#pragma once
// From recordings and a model to a verdict: noise, nominal fit, where, what, how sure, and what to do next.

#include "plugin/diagnosis/data.h"
#include "plugin/diagnosis/evaluator.h"
#include "plugin/diagnosis/result.h"

#include <functional>
#include <string>

namespace supercircle::diagnosis {

struct Settings {
    std::uint64_t seed = 1;
    int draws = 999;      ///< of the null distribution
    std::size_t fits = 6; ///< effects that are fitted in full
    MisfitSettings misfit;
    std::function<void(double fraction, const std::string& stage)> progress;
};

/// @param data must fit the model's runs
Diagnosis diagnose(const Data& data, Evaluator& evaluator, const Settings& settings = {});

} // namespace supercircle::diagnosis
