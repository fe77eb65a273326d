#pragma once
// Changes of an export's bytes, for fuzz tests.

#include <cstddef>
#include <random>
#include <string>

namespace supercircle::test {

/// At a place of a text that is not empty: 0 any byte, 1 one of `spice`, 2 up to 29 bytes lost, 3 up to 59 doubled,
/// else one of `spice` put in.
inline void changeBytes(std::string& text, std::size_t at, std::mt19937::result_type kind, const std::string& spice,
                        std::mt19937& random) {
    switch (kind) {
    case 0:
        text[at] = static_cast<char>(random() % 256);
        break;
    case 1:
        text[at] = spice[random() % spice.size()];
        break;
    case 2:
        text.erase(at, random() % 30);
        break;
    case 3:
        text.insert(at, text.substr(random() % text.size(), random() % 60));
        break;
    default:
        text.insert(at, 1, spice[random() % spice.size()]);
    }
}

} // namespace supercircle::test
