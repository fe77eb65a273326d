#pragma once
// The saved fields of effects (private to plugin/api), see snapshot_fields.h. Constants that follow from the model of
// an effect and its rod are computed again when loading; the state is checked against them.

#include "plugin/api/snapshot_archive.h"
#include "supercircle/effects/rod_effects.h"

#include <algorithm>
#include <cmath>

namespace supercircle::archive {

/// Numbers outside the ranges of the catalogue make loading fail.
template <class Ar>
void demand(Ar& ar, bool possible) {
    if constexpr (Ar::kLoads)
        if (!possible)
            ar.fail("an effect in it has values out of range");
}
inline bool within(double value, double least, double most) {
    return value >= least && value <= most; // false for NaN
}
template <std::size_t N>
bool possible(const std::array<double, N>& c, double least, double most) {
    return std::all_of(c.begin(), c.end(), [&](double v) { return within(v, least, most); });
}
inline constexpr double kFinite = std::numeric_limits<double>::max();
inline constexpr double kOrInfinite = std::numeric_limits<double>::infinity();

template <class Ar>
void io(Ar& ar, Is<effects::EffectEnergy> auto& b) {
    auto& [stored, dissipated] = b;
    ar(stored, dissipated);
}

template <class Ar>
void io(Ar& ar, Is<effects::Profile> auto& p) {
    auto& [cause, shape, centre, width, stiffness, curvature] = p;
    ar(cause, shape, centre, width, stiffness, curvature);
    demand(ar, cause < effects::Key::Count && shape <= effects::Profile::Shape::Thickness &&
                   within(width, 1e-9, kFinite) && within(centre, 0.0, 1.0) && within(stiffness, -0.99, 1e3) &&
                   within(curvature, -1e4, 1e4));
}

template <class Ar>
void io(Ar& ar, Is<effects::ElasticModel> auto& b) {
    auto& [law, knee, exponent, learned, table] = b;
    ar(law, knee, exponent, learned, table);
    demand(ar, possible(learned, -0.95, 100.0) && possible(table, -0.99, 1e3) &&
                   law <= effects::ElasticModel::Law::Table && within(knee, 1e-3, kOrInfinite) &&
                   within(exponent, 1.0, 50.0));
}

template <class Ar>
void io(Ar& ar, Is<effects::MaxwellBranch> auto& b) {
    auto& [stiffness, time] = b;
    ar(stiffness, time);
    demand(ar, within(stiffness, 0.0, 1e9) && within(time, 1e-9, 1e9));
}

template <class Ar>
void io(Ar& ar, Is<effects::MaterialModel> auto& m) {
    auto& [profiles, backbone, viscosity, branches, yield, hardening, kinematic, softening, softeningTime,
           softeningByDecades] = m;
    ar(profiles, backbone, viscosity, branches, yield, hardening, kinematic, softening, softeningTime,
       softeningByDecades);
    demand(ar, within(viscosity, 0.0, 1e4) && within(yield, 1e-6, kOrInfinite) && within(hardening, 0.0, 1e3) &&
                   within(softening, 0.0, 0.95) && within(softeningTime, 1e-6, 1e9));
}

template <class Ar>
void io(Ar& ar, Is<effects::DragModel> auto& m) {
    auto& [force, presliding] = m;
    ar(force, presliding);
    demand(ar, within(force, 0.0, 1e4) && within(presliding, 1e-9, 1e-2));
}

template <class Ar>
void io(Ar& ar, Is<effects::AirModel> auto& m) {
    auto& [linear, quadratic] = m;
    ar(linear, quadratic);
    demand(ar, within(linear, 0.0, 1e6) && within(quadratic, 0.0, 1e6));
}

template <class Ar>
void io(Ar& ar, Is<effects::FrictionModel> auto& m) {
    auto& [staticRatio, slipWeakening, healing, presliding, rate, rateStrength, rateSpeed, wearChange, wearDistance,
           wear, rateCurve, wearCurve, rateTable, wearTable, direct, evolution, stateSlip, stateSpeed, stateCreep,
           stateRest, stateBySlip] = m;
    ar(staticRatio, slipWeakening, healing, presliding, rate, rateStrength, rateSpeed, wearChange, wearDistance, wear,
       rateCurve, wearCurve, rateTable, wearTable, direct, evolution, stateSlip, stateSpeed, stateCreep, stateRest,
       stateBySlip);
    demand(ar, possible(rateCurve, -0.95, 100.0) && possible(wearCurve, -0.95, 100.0) &&
                   possible(rateTable, -0.99, 1e3) && possible(wearTable, -0.99, 1e3) &&
                   wear <= effects::FrictionModel::Wear::Table);
    demand(ar, within(staticRatio, 1.0, 100.0) && within(slipWeakening, 1e-7, 1.0) && within(healing, 1e-6, 1e9) &&
                   within(presliding, 0.0, 1e-2) && rate <= effects::FrictionModel::Rate::Table &&
                   within(rateStrength, -0.95, 100.0) && within(rateSpeed, 1e-9, 1e3) &&
                   within(wearChange, -0.95, 100.0) && within(wearDistance, 1e-6, 1e6));
    demand(ar, within(direct, 0.0, 1.0) && within(evolution, 0.0, 1.0) && within(stateSlip, 1e-9, 1.0) &&
                   within(stateSpeed, 1e-9, 1e3) && within(stateCreep, 1e-12, 1e3) && within(stateRest, 1e-6, 1e9));
}

template <class Ar>
void io(Ar& ar, Is<effects::AdhesionModel> auto& m) {
    auto& [law, force, range, spots, learned] = m;
    ar(law, force, range, spots, learned);
    demand(ar, possible(learned, -10.0, 10.0) && law <= effects::AdhesionModel::Law::Learned &&
                   within(force, 0.0, 1e6) && within(range, 1e-7, 1.0) && within(spots, 0.0, 1.0));
}

template <class Ar>
void io(Ar& ar, Is<effects::ContactComplianceModel> auto& m) {
    auto& [normal, tangential] = m;
    ar(normal, tangential);
    demand(ar, within(normal, 0.0, 1.0) && within(tangential, 0.0, 1.0));
}

template <class Ar>
void io(Ar& ar, Is<effects::ContactModel> auto& m) {
    auto& [friction, adhesion, compliance] = m;
    ar(friction, adhesion, compliance);
}

template <class Ar>
void io(Ar& ar, Is<effects::Site> auto& s) {
    auto& [weakened, slid, speed, age] = s;
    ar(weakened, slid, speed, age);
    demand(ar, within(weakened, 0.0, 1.0 + 1e-9) && within(slid, 0.0, kFinite) && within(speed, -kFinite, kFinite) &&
                   within(age, 0.0, kFinite));
}

template <class Ar>
void io(Ar& ar, Is<effects::Setting> auto& s) {
    auto& [key, shell, values, channel] = s;
    ar(key, shell, values, channel);
    const bool known = key < effects::Key::Count;
    demand(ar, known);
    if constexpr (Ar::kLoads)
        if (known) { // a choice is an index once the setting acts
            const std::vector<effects::Parameter>& all = effects::catalog()[static_cast<std::size_t>(key)].parameters;
            demand(ar, std::equal(values.begin(), values.end(), all.begin(), all.end(),
                                  [](double v, const effects::Parameter& p) {
                                      return within(v, p.min, p.max) && (p.choices.empty() || v == std::floor(v));
                                  }));
        }
}

/// `made`: the newly created effect of the rod; saved lists must be as long as its lists.
template <class Ar, class List>
void ioState(Ar& ar, List& list, const std::remove_const_t<List>& made) {
    ar(list);
    if constexpr (Ar::kLoads)
        if (list.size() != made.size()) {
            ar.fail("the state of an effect in it has the wrong size");
            list = made;
        }
}

template <class Ar>
void ioEffects(Ar& ar, const rod::RodModel& rod, Is<effects::RodEffects> auto& fx) {
    auto& [material, drag, air, surface, attraction, energies, settings] = fx;
    auto& [laws, upTo, age, plastic, hardened, overstress] = material;
    auto& [dragModel, dragPlace, dragWeight, stretch] = drag;
    auto& [contact, spacing, sites] = surface;
    effects::Model model;
    if constexpr (Ar::kLoads) {
        ar(model.material, model.drag, model.air, model.contact);
        if (ar.fault().empty())
            fx = effects::makeRodEffects(rod, model);
    } else {
        ar(laws, dragModel, air.model, contact);
    }
    const effects::RodEffects made = Ar::kLoads ? fx : effects::RodEffects{};
    ar(age, energies);
    ar.unhashed(settings); // the models say what they do
    ioState(ar, plastic, made.material.plastic);
    ioState(ar, hardened, made.material.hardened);
    ioState(ar, overstress, made.material.overstress);
    if constexpr (Ar::kLoads)
        for (auto& branch : overstress)
            if (branch.size() != plastic.size()) {
                ar.fail("the state of an effect in it has the wrong size");
                branch.assign(plastic.size(), 0.0);
            }
    ioState(ar, stretch, made.drag.stretch);
    ioState(ar, sites, made.surface.sites);
    (void)upTo, (void)dragPlace, (void)dragWeight, (void)spacing, (void)attraction; // follow from the models
}

} // namespace supercircle::archive
