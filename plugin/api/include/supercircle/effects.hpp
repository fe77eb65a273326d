#pragma once
// The catalogue of effects: physics beyond inextensible rods, linear bending and Coulomb friction. Shells::set_effects
// switches them on. Keys, parameters and meaning are those of scenes ("effects"); docs/reference/effects.md has the
// laws and their sources.
//
//     shells.set_effects(shell, "planar_drag", {{"f_N_m", 0.2}});
//     shells.set_effects(all_shells, "plasticity");                  // with its default values
//     shells.remove_effect(shell, "planar_drag");

#include "handle.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace supercircle {

/// What an effect changes.
enum class EffectSlot : std::uint8_t {
    Material,  ///< moment and curvature of shells
    Load,      ///< forces along shells
    Contact,   ///< friction, attraction and compliance of contacts
    Apparatus, ///< the testing machine; in scenes and experiments only
    Sensor     ///< the load cell; in scenes and experiments only
};

/// One parameter of an effect.
struct EffectParameter {
    std::string name;           ///< as in scenes
    std::string unit;           ///< "1": a pure number or a choice
    std::string about;          ///< one sentence
    double default_value = 0.0; ///< taken when no switch is given; of a choice its index
    double neutral_value = 0.0; ///< taken when another switch is given, as in scenes
    double lowest = 0.0;        ///< bounds; both belong to the range
    double highest = 0.0;
    bool is_switch = false;           ///< an effect all of whose switches have their neutral value is off
    std::vector<std::string> choices; ///< words of a choice; empty: a number
};

/// One effect.
struct EffectInfo {
    std::string key; ///< as in scenes
    EffectSlot slot = EffectSlot::Material;
    std::string about;           ///< one sentence: what is missing without it
    std::string law;             ///< equation in words
    bool acts_on_shells = false; ///< can be given to Shells::set_effects
    std::vector<EffectParameter> parameters;
};

/// All effects, in a fixed order.
const std::vector<EffectInfo>& effect_catalog();

/// Value of a parameter: a number in the parameter's unit, or one of its choices.
struct EffectValue {
    EffectValue() = default;
    EffectValue(std::string parameter, double value) : name(std::move(parameter)), number(value) {}
    EffectValue(std::string parameter, std::string word) : name(std::move(parameter)), choice(std::move(word)) {}
    std::string name;    ///< of the parameter
    double number = 0.0; ///< used when `choice` is empty
    std::string choice;
};

/// One effect with values, as an entry of "effects" in a scene. No values: its default values.
struct EffectDef {
    std::string key;
    std::vector<EffectValue> parameters;
};

/// All shells: those there are and those created later.
struct AllShells {};
inline constexpr AllShells all_shells;

/// One shell, or all of them.
struct EffectTarget {
    EffectTarget() = default;
    EffectTarget(ShellHandle one) : shell(one) {}  // NOLINT: implicit
    EffectTarget(AllShells /*all*/) : all(true) {} // NOLINT: implicit
    ShellHandle shell;
    bool all = false;
};

} // namespace supercircle
