#pragma once
// Reading members of experiment.json: plain JSON numbers only, no parameters or formulas.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "plugin/scene/loader/reader.h"

#include <string>
#include <vector>

namespace supercircle::experiment {

using scene::ArrayItem;
using scene::Context;
using scene::Limits;
using scene::Node;
using scene::ObjectReader;

/// A number at a place; 0 after a report.
double numberAt(Context& context, const Node& node, const std::string& pointer, const Limits& limits);

/// A JSON object. Absent required keys are reported. Unknown keys are errors if they resemble an absent key, otherwise
/// notes.
class Object {
public:
    Object(Context& context, const Node& node, std::string pointer);
    Object(Context& context, const ArrayItem& place) : Object(context, place.node, place.pointer) {}

    [[nodiscard]] bool valid() const { return reader_.valid(); }
    [[nodiscard]] std::string pointerTo(const std::string& key) const { return reader_.pointerTo(key); }
    std::optional<Node> find(const std::string& key);
    /// Reports the absence of the key.
    std::optional<Node> required(const std::string& key, const std::string& expected);
    double number(const std::string& key, const Limits& limits);                  ///< required
    double number(const std::string& key, double fallback, const Limits& limits); ///< optional
    std::string text(const std::string& key);                                     ///< required
    std::string text(const std::string& key, const std::string& fallback);        ///< optional
    bool flag(const std::string& key, bool fallback);                             ///< optional
    std::vector<double> numbers(const std::string& key, const Limits& limits);    ///< required
    Point pair(const std::string& key);                                           ///< required, [x, y]
    std::size_t choice(const std::string& key,
                       const std::vector<std::string>& words);           ///< required; their number: none of them
    scene::ArrayItems array(const std::string& key, bool mustHaveItems); ///< required
    void error(const std::string& key, const std::string& what, const std::string& expected = {},
               const std::string& nearest = {});
    void note(const std::string& key, const std::string& what);
    void finish();

private:
    Context& context_;
    ObjectReader reader_;
    std::vector<std::string> known_;
};

} // namespace supercircle::experiment
