#include "plugin/identification/calibration/switching.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::calibration {

namespace {

std::string number(double v) {
    std::string text = std::to_string(v);
    text.erase(text.find_last_not_of('0') + 1);
    return text.back() == '.' ? text + "0" : text;
}

} // namespace

Result<CriticalFriction> criticalFriction(double phiBar, const Simulate& simulate, const SwitchSettings& settings) {
    using Out = Result<CriticalFriction>;
    CriticalFriction c;
    c.phiBar = phiBar;
    const auto smooth = [&](double mu) -> std::optional<bool> {
        ++c.simulations;
        const auto snap = simulate(phiBar, mu);
        return snap ? std::optional<bool>(*snap == Snap::Smooth) : std::nullopt;
    };
    const auto fail = [&](double mu) {
        return Out::failure("the simulation at an opening angle of " + number(phiBar) +
                            " and a friction coefficient of " + number(mu) + " ended in no snap");
    };
    const auto atMost = smooth(settings.largest);
    if (!atMost)
        return fail(settings.largest);
    if (*atMost) {
        c.below = settings.largest;
        c.above = std::numeric_limits<double>::infinity();
        return c;
    }
    c.above = settings.largest;
    const auto atZero = smooth(0.0);
    if (!atZero)
        return fail(0.0);
    if (!*atZero) {
        c.above = 0.0;
        return c;
    }
    while (c.above - c.below > settings.tolerance) {
        const double middle = 0.5 * (c.below + c.above);
        const auto is = smooth(middle);
        if (!is)
            return fail(middle);
        (*is ? c.below : c.above) = middle;
    }
    return c;
}

Result<SwitchResult> frictionFromSwitch(const std::vector<Trial>& trials, const Simulate& simulate,
                                        const SwitchSettings& settings) {
    using Out = Result<SwitchResult>;
    double deepestSmooth = -1.0, shallowestAbrupt = std::numeric_limits<double>::infinity();
    for (const Trial& t : trials) {
        if (t.outcome == Snap::Smooth)
            deepestSmooth = std::max(deepestSmooth, t.phiBar);
        else
            shallowestAbrupt = std::min(shallowestAbrupt, t.phiBar);
    }
    if (trials.empty())
        return Out::failure("no trials");
    if (deepestSmooth - settings.angleUncertainty > shallowestAbrupt + settings.angleUncertainty)
        return Out::failure("the trials contradict each other: smooth at " + number(deepestSmooth) +
                            ", abrupt at the shallower " + number(shallowestAbrupt) +
                            "; deeper shells never snap more smoothly");
    const auto inside = [&](double phiBar) { return std::clamp(phiBar, settings.shallowest, settings.deepest); };
    SwitchResult out;
    out.high = std::numeric_limits<double>::infinity();
    if (std::isfinite(shallowestAbrupt)) {
        const auto c = criticalFriction(inside(shallowestAbrupt + settings.angleUncertainty), simulate, settings);
        if (!c)
            return Out::failure(c.error());
        if (std::isinf(c->above))
            return Out::failure("an abrupt snap at an opening angle of " + number(shallowestAbrupt) +
                                " takes more friction than " + number(settings.largest));
        out.fromAbrupt = *c;
        out.low = c->below;
    }
    if (deepestSmooth > 0.0) {
        const auto c = criticalFriction(inside(deepestSmooth - settings.angleUncertainty), simulate, settings);
        if (!c)
            return Out::failure(c.error());
        out.fromSmooth = *c;
        out.high = c->above;
    }
    return out;
}

} // namespace supercircle::calibration
