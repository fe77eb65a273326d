#pragma once
// One entry of the catalogue of effects: physics that a simulation may leave out. An effect has a key, a slot and
// parameters; `apply` writes its values into the slot of a Model. The laws belong to the slots (laws/material.h,
// laws/drag.h, ...), because effects of one slot act together: plasticity and creep share one moment.
//
// An effect whose switches are all `off` is not applied: off is bitwise identical to absent.

#include "supercircle/effects/model.h"

#include <string>
#include <string_view>
#include <vector>

namespace supercircle::effects {

enum class Slot : std::uint8_t { Material, Load, Contact, Apparatus, Sensor };
const char* name(Slot slot);

struct Parameter {
    std::string name;
    std::string unit;
    double off = 0.0; ///< default; for a switch: the value without effect
    double min = 0.0;
    double max = std::numeric_limits<double>::infinity();
    double typical = 0.0;  ///< a value with a visible effect, as a scale for searches
    bool isSwitch = false; ///< the effect is off if all its switches are `off`
    std::string about;
    std::vector<std::string> choices; ///< names of a choice: value k means choices[k]
};

/// Values of an effect's parameters, in their order.
using Values = std::vector<double>;

struct Effect {
    Key key = Key::Count;
    std::string name; ///< label, as in scenes and results
    Slot slot = Slot::Material;
    std::string about;
    std::string law;
    std::string fingerprint; ///< what it changes in a force curve
    std::string literature;
    std::vector<Parameter> parameters;
    void (*apply)(const Values&, Model&) = nullptr;
    std::string (*check)(const Values&) = nullptr; ///< empty, or why the values are inconsistent
    bool perShell = false;                         ///< may be set for single shells
    bool repeatable = false;                       ///< may act several times on one shell
};

/// All effects, in the order of Key. The list is explicit, because the linker drops self-registering objects of static
/// libraries.
const std::vector<Effect>& catalog();
/// By label; nullptr if there is none.
const Effect* find(std::string_view label);

/// One effect with values, as given by a scene, a command line or a fit.
struct Setting {
    Key key = Key::Count;
    std::string shell = "all"; ///< name of a shell
    Values values;
    std::string channel{}; ///< of a sensor: name of a channel beside the first one; empty: the first one
    bool operator==(const Setting&) const = default;
};

/// The effect switched off.
Setting off(const Effect& effect);
/// Switches an effect on whose switches are off: each takes its typical value as far as the values go together.
void setTypical(Setting& setting);
/// Why there is no effect called `label`, with the nearest known one.
std::string unknownEffect(std::string_view label);
/// Sets a parameter from text: a number or one of its choices; parameter "shell" takes the name of a shell, "channel"
/// of a sensor that of a channel. Returns an empty string, or what is wrong and the nearest known name.
[[nodiscard]] std::string set(Setting& setting, std::string_view parameter, std::string_view value);
/// The same from a number.
[[nodiscard]] std::string set(Setting& setting, std::string_view parameter, double value);
bool isOff(const Setting& setting);
/// Reads "KEY:NAME=VALUE" into a list of settings; an existing key gets the value. Returns an empty string, or what is
/// wrong.
[[nodiscard]] std::string add(std::vector<Setting>& settings, std::string_view text);

/// Empty, or which settings are inconsistent.
[[nodiscard]] std::string validate(const std::vector<Setting>& settings);

/// The sensor of a channel; empty: of the first one.
SensorModel sensorOf(const std::vector<Setting>& settings, std::string_view channel);
/// The model of the shell called `shell`: its own settings and those of all shells.
Model modelFor(const std::vector<Setting>& settings, std::string_view shell);
/// Whether the effect acts on shells and their contacts, inside the step. Gravity is the host's; apparatus, sensor and
/// rigid bodies belong to whoever drives and measures.
bool actsOnShells(const Effect& effect);
/// Whether the effect acts on the joints and bodies of mechanisms, which the replay simulates.
bool actsOnMechanisms(const Effect& effect);
/// The settings of the shell called `shell` that act on it, given to "all": modelFor(...) of them is its model.
std::vector<Setting> settingsFor(const std::vector<Setting>& settings, std::string_view shell);
/// Names of the shells in the settings, for checks.
std::vector<std::string> shellsNamed(const std::vector<Setting>& settings);

} // namespace supercircle::effects
