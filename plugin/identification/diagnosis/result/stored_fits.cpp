#include "plugin/identification/diagnosis/result/stored_fits.h"

namespace supercircle::diagnosis {

replay::StoredFits storedFitsOf(const ReplayModel& model, const experiment::Experiment& experiment,
                                const Diagnosis& d) {
    replay::StoredFits out{replay::checkSumOf(experiment), {}};
    const auto add = [&](const std::string& label, const ParameterPoint& point, bool drawn) {
        replay::Parameters parameters;
        std::string why = model.withoutParameters(point);
        if (const std::string wrong = model.parametersAt(point, parameters); why.empty())
            why = wrong;
        replay::StoredFit fit = replay::storedFit(experiment, parameters);
        fit.label = label;
        fit.drawn = drawn;
        fit.unrepeatable = why;
        out.fits.push_back(std::move(fit));
    };
    for (const FittedEffect& e : d.effects)
        add(e.label, e.point, d.improved && &e == &d.effects.front());
    for (const LearnedLaw& law : d.learned)
        add(law.label, law.point, false);
    add(replay::kNothing, d.baseline, !d.improved);
    return out;
}

} // namespace supercircle::diagnosis
