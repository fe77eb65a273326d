#pragma once
// Writes down the candidates of an experiment, one call after the other (private to the model of a diagnosis).

#include "plugin/identification/diagnosis/model/candidate_effects.h"
#include "plugin/identification/replay/parameters.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Drift and gain act on readings, not on the specimen.
inline ReadingEffect readingOf(const std::string& label) {
    return label == "sensor_drift"  ? ReadingEffect::Drift
           : label == "sensor_gain" ? ReadingEffect::Gain
                                    : ReadingEffect::None;
}

/// Builds candidates. Physical values are given and converted to internal ones here.
class CandidateBuilder {
public:
    CandidateBuilder(CandidateEffects& candidateEffects, const experiment::Experiment& e,
                     const std::vector<std::string>& without)
        : candidateEffects_(candidateEffects), experiment_(e), without_(without) {}

    /// Begins a candidate; all following calls refer to it.
    /// @param shell name of a specimen
    CandidateBuilder& variant(const std::string& label, const std::string& words = {},
                              const std::string& shell = "all") {
        finish();
        effect_ = effects::find(label);
        if (effect_ == nullptr || !replay::acts(experiment_, effect_->key, channel_) ||
            std::find(without_.begin(), without_.end(), label) != without_.end()) {
            effect_ = nullptr;
            return *this;
        }
        candidate_ = {};
        candidate_.label = label;
        candidate_.slot = effects::name(effect_->slot);
        candidate_.variant = words;
        const auto add = [&](const std::string& more) {
            candidate_.variant += (candidate_.variant.empty() ? "" : ", ") + more;
        };
        if (shell != "all")
            add("specimen " + shell);
        if (channel_ > 0)
            add("channel " + experiment::furtherChannels(experiment_)[channel_ - 1].observe);
        candidate_.law = effect_->law;
        mapping_ = {effects::off(*effect_), {}, readingOf(label)};
        mapping_.base.shell = shell;
        if (channel_ > 0)
            mapping_.base.channel = experiment::furtherChannels(experiment_)[channel_ - 1].observe;
        return *this;
    }
    /// Fixes a parameter of the effect.
    CandidateBuilder& with(const std::string& name, double value) {
        if (effect_ != nullptr)
            mapping_.base.values[find(name)] = value;
        return *this;
    }
    CandidateBuilder& amplitude(const std::string& name, double lower, double upper, double step,
                                Scale scale = Scale::Linear) {
        // A reciprocal amplitude has its largest internal value at its smallest physical one.
        if (effect_ == nullptr)
            return *this;
        const bool reciprocal = scale != Scale::Linear;
        add(name, reciprocal ? 0.0 : effect_->parameters[find(name)].off, reciprocal ? 0.0 : lower,
            reciprocal ? toInternal(scale, lower) : upper, toInternal(scale, step), scale);
        candidate_.parameters.back().amplitude = true;
        return *this;
    }
    /// A time, length or speed on a logarithmic scale; one step is a factor of two.
    CandidateBuilder& extent(const std::string& name, double lower, double upper) {
        if (effect_ != nullptr)
            add(name, math::log(std::sqrt(lower * upper)), math::log(lower), math::log(upper), math::log(2.0),
                Scale::Logarithm);
        return *this;
    }
    CandidateBuilder& share(const std::string& name, double lower, double upper, double step) {
        if (effect_ != nullptr)
            add(name, 0.5, lower, upper, step, Scale::Linear, true);
        return *this;
    }
    /// A derived quantity; both parameters must be added before.
    CandidateBuilder& derived(const std::string& name, const std::string& unit, double factor,
                              const std::string& amplitude, const std::string& extent) {
        if (effect_ == nullptr)
            return *this;
        DerivedQuantity p{name, unit, factor, 0, 0};
        for (std::size_t i = 0; i < candidate_.parameters.size(); ++i) {
            p.amplitude = candidate_.parameters[i].name == amplitude ? i : p.amplitude;
            p.extent = candidate_.parameters[i].name == extent ? i : p.extent;
        }
        candidate_.derived.push_back(p);
        return *this;
    }
    CandidateBuilder& probe(const std::vector<double>& values) {
        if (effect_ == nullptr)
            return *this;
        std::vector<double> in;
        for (std::size_t i = 0; i < values.size() && i < candidate_.parameters.size(); ++i) {
            const Scalar& s = candidate_.parameters[i];
            in.push_back(std::clamp(toInternal(s.scale, values[i]), s.lower, s.upper));
        }
        candidate_.probes.push_back(in);
        return *this;
    }
    /// The candidate corrects what the description states.
    void correction() { candidate_.corrects = true; }
    /// Following candidates are sensors of this channel; 0: the first one.
    void ofChannel(std::size_t channel) {
        finish();
        channel_ = channel;
    }
    void finish() {
        if (effect_ != nullptr && !candidate_.probes.empty()) {
            candidateEffects_.candidates.push_back(candidate_);
            candidateEffects_.mappings.push_back(mapping_);
        }
        effect_ = nullptr;
    }

private:
    std::size_t find(const std::string& name) const {
        std::size_t i = 0;
        while (i + 1 < effect_->parameters.size() && effect_->parameters[i].name != name)
            ++i;
        return i;
    }
    void add(const std::string& name, double value, double lower, double upper, double step, Scale scale,
             bool position = false) {
        const std::size_t at = find(name);
        const effects::Parameter& p = effect_->parameters[at];
        candidate_.parameters.push_back({name, p.unit, p.about, value, lower, upper, step, scale, false, position});
        mapping_.parameterAt.push_back(at);
    }

    CandidateEffects& candidateEffects_;
    const experiment::Experiment& experiment_;
    const std::vector<std::string>& without_;
    const effects::Effect* effect_ = nullptr;
    std::size_t channel_ = 0;
    CandidateEffect candidate_;
    EffectMapping mapping_;
};

} // namespace supercircle::diagnosis
