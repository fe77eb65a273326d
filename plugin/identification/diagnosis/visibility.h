#pragma once
// What runs could show before anything is fitted: how well they determine the stated numbers, and which effects of a
// noticeable size they tell from these numbers. Linearised about the stated numbers, with coarse simulations and the
// likelihood of the diagnosis.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/noise.h"

#include <functional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct VisibleNumber {
    std::string name, unit;
    double halfWidth = 0.0;          ///< of the stated interval, its unit
    double known = 0.0;              ///< standard deviation of what is stated, the same unit
    double left = 0.0;               ///< standard deviation that the runs would leave, the same unit
    [[nodiscard]] bool seen() const; ///< less than half of what is known is left
};

struct VisibleEffect {
    std::string label;
    double change = 0.0;                 ///< of all readings by a noticeable size, in standard deviations
    double own = 0.0;                    ///< the part of it that stated numbers inside their intervals cannot imitate
    std::string like;                    ///< the number that imitates most of it; empty: none does
    [[nodiscard]] bool seen() const;     ///< told from noise and numbers with a power of 80 %
    [[nodiscard]] bool imitated() const; ///< it would be seen if the numbers were known
};

struct Visibility {
    std::string failure; ///< why the runs cannot be simulated; empty: they can
    std::vector<VisibleNumber> numbers;
    std::vector<VisibleEffect> effects; ///< of the whole catalogue that could act, best seen first
    std::vector<std::string> untried;   ///< effects that an interrupt left out
};

/// Throws Stopped where an interrupt comes before the numbers are known; later ones leave out effects.
/// @param next asked before each effect: false leaves out the others. It may take back an interrupt
Visibility visibilityOf(const RecordedData& data, const Noise& noise, Evaluator& evaluator,
                        const std::function<bool()>& next = {});

} // namespace supercircle::diagnosis
