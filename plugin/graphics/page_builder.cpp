#include "plugin/graphics/page_builder.h"

#include "plugin/graphics/svg_canvas.h"

namespace supercircle::graphics {

// Generated from page.css, tables.css and page_template.html (plugin/cmake/EmbedText.cmake).
extern const std::string_view kPageCss, kTablesCss, kPageTemplateHtml;

std::string fillTemplate(std::string_view text,
                         std::initializer_list<std::pair<std::string_view, std::string_view>> values) {
    std::string out;
    while (true) {
        const std::size_t open = text.find("{{"), close = text.find("}}", open);
        if (open == std::string_view::npos || close == std::string_view::npos)
            return out += text;
        const std::string_view name = text.substr(open + 2, close - open - 2);
        std::string_view value = text.substr(open, close + 2 - open);
        for (const auto& [known, replacement] : values)
            if (known == name)
                value = replacement;
        (out += text.substr(0, open)) += value;
        text.remove_prefix(close + 2);
    }
}

PageBuilder& PageBuilder::title(std::string_view text) {
    title_ = text;
    return *this;
}

PageBuilder& PageBuilder::style(std::string_view css) {
    style_ += css;
    return *this;
}

PageBuilder& PageBuilder::plainTables() {
    return style(kTablesCss);
}

PageBuilder& PageBuilder::introduction(std::string_view html) {
    introduction_ += html;
    return *this;
}

PageBuilder& PageBuilder::add(std::string_view html) {
    content_ += html;
    return *this;
}

PageBuilder& PageBuilder::section(std::string_view headingText, std::string_view html) {
    if (html.empty())
        return *this;
    content_ += "<div class=\"grid\"><section><h2>" + escaped(headingText) + "</h2>";
    (content_ += html) += "</section></div>\n";
    return *this;
}

PageBuilder& PageBuilder::script(std::string_view javaScript) {
    ((scripts_ += "<script>\n") += javaScript) += "</script>\n";
    return *this;
}

std::string PageBuilder::html() const {
    const std::string title = escaped(title_), heading = escaped(heading_), style = std::string(kPageCss) + style_;
    return fillTemplate(kPageTemplateHtml, {{"title", title},
                                            {"style", style},
                                            {"heading", heading},
                                            {"introduction", introduction_},
                                            {"content", content_},
                                            {"scripts", scripts_}});
}

} // namespace supercircle::graphics
