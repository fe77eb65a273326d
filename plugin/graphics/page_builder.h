#pragma once
// The one builder of HTML pages: head, style, header, sections, scripts. A page is self-contained and works from a
// file.

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace supercircle::graphics {

/// `text` with every {{name}} replaced by its value; values are not searched again. A name without a value stays.
[[nodiscard]] std::string fillTemplate(std::string_view text,
                                       std::initializer_list<std::pair<std::string_view, std::string_view>> values);

/// Collects the parts of a page. Arguments called `text` are escaped; the others are markup.
class PageBuilder {
public:
    explicit PageBuilder(std::string_view headingText) : heading_(headingText), title_(headingText) {}

    /// Text of the browser's tab; by default the heading.
    PageBuilder& title(std::string_view text);
    /// CSS in addition to that of every page.
    PageBuilder& style(std::string_view css);
    /// Dense tables with left-aligned cells (tables.css).
    PageBuilder& plainTables();
    /// Below the heading.
    PageBuilder& introduction(std::string_view html);
    PageBuilder& add(std::string_view html);
    /// A section of full width; nothing if `html` is empty.
    PageBuilder& section(std::string_view headingText, std::string_view html);
    PageBuilder& script(std::string_view javaScript);

    [[nodiscard]] std::string html() const;

private:
    std::string heading_, title_, style_, introduction_, content_, scripts_;
};

} // namespace supercircle::graphics
