#pragma once
// What formulas consist of beside numbers (private to the loader).

#include <string>
#include <vector>

namespace mu {
class Parser;
}

namespace supercircle::scene {

inline constexpr std::size_t kLongestFormula = 2000; // characters; deeper ones would exhaust the stack

/// Our own functions: those of muParser call the C library, whose last bits depend on the machine.
void defineFunctions(mu::Parser& parser);

struct NameUse {
    std::string name;
    std::size_t at = 0;
};
/// The names in a formula; `1e-3` is a number, not a name.
std::vector<NameUse> namesIn(const std::string& formula);
/// Whether a character begins a name, or goes on with one.
bool startsName(char c);
bool continuesName(char c);

} // namespace supercircle::scene
