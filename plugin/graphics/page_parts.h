#pragma once
// The page's constant parts.

#include <string_view>

namespace supercircle::report {

[[nodiscard]] std::string_view pageStyle();  ///< CSS
[[nodiscard]] std::string_view pageScript(); ///< the player, plain JavaScript

} // namespace supercircle::report
