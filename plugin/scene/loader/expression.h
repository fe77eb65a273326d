#pragma once
// The names a scene's numbers may use (its parameters and constants) and the formulas over them.

#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/scene.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

struct Context;

/// A value for a parameter from the command line or the caller (`--param NAME=VALUE`).
struct Override {
    std::string name;
    double value = 0.0;
};

/// Parameters and constants by name. The value of a parameter and every constant may be a formula of others. They are
/// evaluated on demand: the order in the file does not matter, and circular definitions are reported.
class Scope {
public:
    Scope();
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

    /// Reads the blocks `parameters` and `constants` (either may be null) and the overrides; reports all errors.
    void declare(Context& context, const std::optional<Node>& parameters, const std::optional<Node>& constants,
                 const std::vector<Override>& overrides);

    /// Value of a parameter or constant; empty (after a report at `at`) if there is none.
    [[nodiscard]] std::optional<double> value(Context& context, const std::string& name, const Node& at,
                                              const std::string& pointer);
    /// Value of a formula; empty after a report at `at`.
    [[nodiscard]] std::optional<double> evaluate(Context& context, const std::string& formula, const Node& at,
                                                 const std::string& pointer);
    /// The parameters with their final values, in the order of the file.
    [[nodiscard]] std::vector<Parameter> parameters() const;

private:
    struct Entry;
    struct Calculator;

    bool isFunction(const std::string& name) const;
    [[nodiscard]] bool acceptName(Context& context, const Node& node, const std::string& pointer);
    void declareParameter(Context& context, const Node& node, const std::string& pointer);
    void declareConstant(Context& context, const Node& node, const std::string& pointer);
    std::string presentName(Context& context, const std::string& name, const Node& at) const;
    void override(Context& context, const std::vector<Override>& overrides, const std::optional<Node>& parameters);
    [[nodiscard]] bool resolve(Context& context, Entry& entry, const Node& at, const std::string& pointer);
    [[nodiscard]] bool checkParameter(Context& context, Entry& entry);
    std::vector<std::string> names() const;

    std::vector<std::unique_ptr<Entry>> entries_;
    std::map<std::string, Entry*> byName_;
    std::unique_ptr<Calculator> calculator_;
    int depth_ = 0; ///< names being evaluated
};

} // namespace supercircle::scene
