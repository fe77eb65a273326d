#include "plugin/cli/replay/taken_fit.h"

#include "plugin/identification/diagnosis/carried_score.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/pages/diagnosis/stored_fits_json.h"

#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace {

/// Splits "FILE:LABEL"; a file of that whole name has no label.
TakenFit named(const std::string& text) {
    TakenFit out;
    const std::size_t colon = text.rfind(':');
    std::error_code ignored;
    if (colon == std::string::npos || std::filesystem::exists(text, ignored)) {
        out.file = text;
        return out;
    }
    out.file = text.substr(0, colon);
    out.label = text.substr(colon + 1);
    return out;
}

/// The text of what is wrong, or nothing.
std::string take(TakenFit& taken, Replay& replay) {
    const auto fits = readStoredFits(taken.file);
    if (!fits)
        return fits.error();
    const auto fit = diagnosis::fitCalled(*fits, taken.label);
    if (!fit)
        return taken.file + ": " + fit.error();
    taken.label = fit->label;
    if (!taken.carried) {
        if (fits->checkSum != diagnosis::checkSumOf(replay.experiment))
            return taken.file + " is of other recordings or another description than " + replay.experiment.file +
                   "; diagnose this experiment, or take the law alone with --carry";
        return diagnosis::setTo(*fit, replay.experiment, replay.parameters);
    }
    auto law = diagnosis::carriedTo(diagnosis::sectionOf(replay.experiment, replay.parameters), *fit);
    if (!law)
        return taken.file + ": " + law.error();
    taken.notes = law->notes;
    replay.parameters.effects = std::move(law->effects);
    return replay::checkEffects(replay.parameters, replay.experiment);
}

} // namespace

bool takeFit(const ReplayArguments& a, Replay& replay) {
    if (a.with.empty() && a.carry.empty())
        return true;
    const bool carried = a.with.empty();
    TakenFit taken = named(carried ? a.carry : a.with);
    taken.carried = carried;
    if (const std::string why = take(taken, replay); !why.empty()) {
        std::fprintf(stderr, "%s: %s\n", carried ? "--carry" : "--with", why.c_str());
        return false;
    }
    replay.taken = std::move(taken);
    return true;
}

void scoreCarriedLaw(Replay& replay, bool quiet) {
    if (!replay.taken || !replay.taken->carried || interrupted)
        return;
    if (!quiet)
        std::fprintf(stderr, "fitting the stated numbers, without the law and with it\n");
    const auto score = diagnosis::scoreOfLaw(replay.experiment, replay.parameters.effects, &interrupted);
    replay.taken->failure = score.error();
    if (score)
        replay.taken->score = CarriedScore{score->rmseWithout, score->rmseWith, score->heldOutWithout,
                                           score->heldOutWith, score->gain,     score->gainError};
}

} // namespace supercircle::cli
