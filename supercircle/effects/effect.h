#pragma once
// One physical effect that a simulation may leave out, as the catalogue describes it. An effect has a key, a slot and
// parameters; `apply` writes its values into the slot of a Model. The laws themselves live with the slots (material.h,
// drag.h, ...), because effects of one slot act together: plasticity and creep share one moment.
//
// An effect whose switches are all at `off` is not applied at all: off is bit-identical to absent.

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
    double off = 0.0; ///< default; of a switch: the value without effect
    double min = 0.0;
    double max = std::numeric_limits<double>::infinity();
    double typical = 0.0;  ///< a value that shows, as a scale for searches
    bool switches = false; ///< the effect is off where all its switches are at `off`
    std::string about;
    std::vector<std::string> words; ///< of a choice: value k means words[k]
};

/// Values of an effect's parameters, in their order.
using Values = std::vector<double>;

struct Effect {
    Key key = Key::Count;
    std::string name; ///< the fixed label
    Slot slot = Slot::Material;
    std::string about;
    std::string law;
    std::string fingerprint; ///< what a force curve shows
    std::string literature;
    std::vector<Parameter> parameters;
    void (*apply)(const Values&, Model&) = nullptr;
    std::string (*check)(const Values&) = nullptr; ///< values that do not go together: why
    bool perShell = false;                         ///< may be given to single shells
    bool several = false;                          ///< may act several times on one shell
};

/// All effects, in the order of Key. An explicit list: objects that register themselves from a static library register
/// nothing.
const std::vector<Effect>& catalog();
/// By label; nullptr if there is none.
const Effect* find(std::string_view label);

/// One effect with values, as a scene, a command line or a fit asks for it.
struct Setting {
    Key key = Key::Count;
    std::string shell = "all"; ///< name of a shell
    Values values;
};

/// The effect switched off.
Setting off(const Effect& effect);
/// Sets a parameter from text: a number or one of its words. `shell` is a name too. Empty, or what is wrong, with the
/// nearest known name.
std::string set(Setting& setting, std::string_view parameter, std::string_view value);
/// The same from a number.
std::string set(Setting& setting, std::string_view parameter, double value);
bool isOff(const Setting& setting);
/// Reads "KEY:NAME=VALUE" into a list of settings: a key that is there already gets the value. Empty or what is wrong.
std::string add(std::vector<Setting>& settings, std::string_view text);

/// Empty, or what does not go together.
std::string validate(const std::vector<Setting>& settings);

/// What the settings amount to for the shell called `shell` (shell-specific ones) and for the world (all others).
Model modelFor(const std::vector<Setting>& settings, std::string_view shell);
/// Names of shells that settings ask for, for checks.
std::vector<std::string> shellsNamed(const std::vector<Setting>& settings);

/// The known name nearest to `name` by edit distance, empty if none is near.
std::string nearest(std::string_view name, const std::vector<std::string>& known);

} // namespace supercircle::effects
