#pragma once
// A formula with free names, outside of scenes: a law that a user writes down.

#include "supercircle/support/result.h"

#include <string>
#include <utility>
#include <vector>

namespace supercircle::scene {

class Formula {
public:
    /// Reads a formula in the language of scenes; `log` is the natural logarithm as well. Fails with what is wrong, and
    /// where in the text.
    static Result<Formula> parse(const std::string& text);

    [[nodiscard]] const std::string& text() const { return text_; }
    /// Names without a value, in the order of their first use.
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    /// Values at `points` of the name `over`, the other names given. Not finite where the formula is not.
    [[nodiscard]] std::vector<double> values(const std::vector<std::pair<std::string, double>>& given,
                                             const std::string& over, const std::vector<double>& points) const;

private:
    std::string text_;
    std::vector<std::string> names_;
};

} // namespace supercircle::scene
