#include "plugin/cli/replay/taken_fit.h"

#include "plugin/identification/diagnosis/carried_score.h"
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

} // namespace

bool takeFit(const ReplayArguments& a, Replay& replay) {
    if (a.with.empty() && a.carry.empty())
        return true;
    const bool carried = a.with.empty();
    TakenFit taken = named(carried ? a.carry : a.with);
    taken.carried = carried;
    auto done = takeFit(taken.file, taken.label, carried, replay.experiment, replay.parameters);
    if (!done) {
        std::fprintf(stderr, "%s: %s\n", carried ? "--carry" : "--with", done.error().c_str());
        return false;
    }
    taken.label = done->label;
    taken.notes = std::move(done->notes);
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
        replay.taken->score = *score;
}

} // namespace supercircle::cli
