#include "plugin/identification/diagnosis/result/specimens.h"

#include "plugin/identification/diagnosis/estimation/scatter.h"
#include "plugin/recording/table/rounded.h"

#include <cmath>

namespace supercircle::diagnosis {

namespace {

using record::rounded;

/// log Bayes factor: odds of 20 to 1. Half of it are odds of 4, twice of it of 400; of the batches of decision 0192 all
/// three say the same.
constexpr double kDiffer = 3.0;

std::string namesOf(const BatchResult& b) {
    std::string names = plainWords(b.name);
    for (std::size_t i = 0; i < b.merged.size(); ++i)
        names += (i + 1 == b.merged.size() ? " and " : ", ") + plainWords(b.merged[i]);
    return names;
}

/// A standard deviation in per cent of the common value where that is large against it, else with its unit.
std::string shown(const BatchResult& b, double std, bool unit = true) {
    const bool relative = std::abs(b.common) > 2.0 * b.std;
    return rounded(relative ? 100.0 * std / std::abs(b.common) : std, 2) + (!unit           ? ""
                                                                            : relative      ? " %"
                                                                            : b.unit == "1" ? ""
                                                                                            : " " + b.unit);
}

} // namespace

std::vector<BatchResult> presentBatch(const Model& model, const Likelihood& likelihood, const FitResult& f) {
    std::vector<BatchResult> out;
    const std::vector<BatchFactor> factors = model.batch();
    if (factors.empty())
        return out;
    const std::vector<Scatter> scatters = scattersOf(model, likelihood, f);
    for (std::size_t k = 0; k < factors.size(); ++k) {
        const BatchFactor& factor = factors[k];
        const Scatter& s = scatters[k];
        BatchResult b{factor.name, factor.unit, factor.merged, factor.stated, factor.scale};
        b.std = factor.scale * s.median;
        b.ci90 = {factor.scale * s.low, factor.scale * s.high};
        b.isPrior = s.isPrior;
        b.evidence = s.evidence;
        const std::vector<Scalar>& nominal = model.nominal();
        for (std::size_t i = 0; i < nominal.size(); ++i) // the common value before its deviations
            if (const double value = toPhysical(nominal[i].scale, f.point.nominal[i]); nominal[i].name == factor.name)
                b.common = value;
            else if (nominal[i].batch == static_cast<int>(k))
                b.specimens.emplace_back(nominal[i].name.substr(factor.name.size() + 1), b.common + value);
        out.push_back(std::move(b));
    }
    return out;
}

std::string specimensSentence(const std::vector<BatchResult>& batch) {
    std::string text;
    for (const BatchResult& b : batch)
        if (!b.isPrior && b.evidence > kDiffer)
            text += (text.empty() ? " The specimens differ: " : "; ") + namesOf(b) + " by " + shown(b, b.std) +
                    " (90 % interval " + shown(b, b.ci90.low, false) + " to " + shown(b, b.ci90.high) + ")";
    return text.empty() ? text : text + ".";
}

std::vector<std::string> specimenNotes(const std::vector<BatchResult>& batch) {
    std::vector<std::string> notes;
    for (const BatchResult& b : batch) {
        const std::size_t n = b.specimens.size();
        if (b.isPrior)
            notes.push_back((n == 1 ? "One specimen tells" : "Two specimens tell") +
                            std::string(" no standard deviation: that of ") + namesOf(b) + " is the stated one, " +
                            shown(b, b.std) + ".");
        if (!b.merged.empty())
            notes.push_back("The readings do not tell deviations of " + namesOf(b) +
                            " apart: all of them are taken as deviations of " + plainWords(b.name) + ".");
    }
    return notes;
}

} // namespace supercircle::diagnosis
