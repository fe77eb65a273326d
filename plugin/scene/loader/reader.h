#pragma once
// Reads one JSON object key by key. Every key that is asked for becomes known; other keys are reported with the nearest
// known name. A wrong value is reported and replaced by the default, so that the rest of the file is still checked.

#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/expression.h"

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

/// What every reading function needs: the text (for positions), the parameters, and the list of problems.
struct Context {
    const Document& document;
    std::vector<Problem>& problems;
    Scope& scope;

    void error(const Node& at, const std::string& pointer, const std::string& what, const std::string& expected = {},
               const std::string& nearest = {});
    /// Points at a byte of the text.
    void errorAt(std::size_t offset, const std::string& pointer, const std::string& what,
                 const std::string& expected = {}, const std::string& nearest = {});
    /// Points at the key of `at` instead of its value.
    void keyError(const Node& at, const std::string& pointer, const std::string& what, const std::string& expected = {},
                  const std::string& nearest = {});
    void note(const Node& at, const std::string& pointer, const std::string& what);
    /// A note that a key or name has a successor; once per old name and file.
    void noteRenamed(const Node& at, const std::string& pointer, const std::string& old, const std::string& successor);
    /// Errors so far. Notes do not count.
    [[nodiscard]] std::size_t errors() const { return errorCount; }
    /// Further errors are counted, not reported.
    [[nodiscard]] bool full() const { return errorCount >= maxErrors; }

    bool rubeExport = false; ///< absent keys of the rigid world are the zeros of b2dJson
    std::size_t errorCount = 0;
    std::size_t countAt = 0;                 ///< index of the problem that counts the unreported ones
    std::vector<std::string> renamedNoted{}; ///< old names that have their note
};

/// Accepted values: min <= value <= max, strictly above min if `above`.
struct Limits {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    bool above = false;
};
inline constexpr Limits anyNumber{};
inline constexpr Limits positive{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr Limits notNegative{0.0, std::numeric_limits<double>::infinity(), false};

/// An item of an array and its JSON pointer.
struct ArrayItem {
    Node node;
    std::string pointer;
};

/// Items of an array, to walk over.
class ArrayItems {
public:
    class Iterator {
    public:
        Iterator(const std::string& pointer, Node::Children::Iterator at) : pointer_(&pointer), at_(at) {}
        ArrayItem operator*() const { return {*at_, *pointer_ + "/" + std::to_string(index_)}; }
        Iterator& operator++() {
            ++at_;
            ++index_;
            return *this;
        }
        bool operator!=(const Iterator& other) const { return at_ != other.at_; }

    private:
        const std::string* pointer_;
        Node::Children::Iterator at_;
        std::size_t index_ = 0;
    };

    ArrayItems(Node::Children items, std::string pointer) : items_(items), pointer_(std::move(pointer)) {}
    [[nodiscard]] Iterator begin() const { return {pointer_, items_.begin()}; }
    [[nodiscard]] Iterator end() const { return {pointer_, items_.end()}; }
    [[nodiscard]] bool empty() const { return items_.empty(); }
    [[nodiscard]] std::size_t size() const { return items_.size(); } ///< takes a walk

private:
    Node::Children items_;
    std::string pointer_;
};

/// A number: JSON number, {"param": name}, {"expr": formula}, or, if `hex`, the eight hex digits that b2dJson writes
/// for the bits of a float. Empty after a report.
[[nodiscard]] std::optional<double> readNumber(Context& context, const Node& node, const std::string& pointer,
                                               const Limits& limits, bool hex = false);

/// "{x, y}" or 0 for the origin. Empty after a report.
[[nodiscard]] std::optional<Eigen::Vector2d> readVector(Context& context, const Node& node, const std::string& pointer,
                                                        bool hex = false);

class ObjectReader {
public:
    /// Reports if `node` is not an object; then no key is found in it. `hex`: numbers may be b2dJson hex floats.
    ObjectReader(Context& context, const Node& node, std::string pointer, bool hex = false);

    [[nodiscard]] bool valid() const { return node_.kind() == Node::Kind::Object; }
    [[nodiscard]] const std::string& pointer() const { return pointer_; }
    [[nodiscard]] const Node& node() const { return node_; }
    /// JSON pointer of a key as it stands in the file.
    [[nodiscard]] std::string pointerTo(const std::string& key) const;

    /// `now` was called `old` before. Call it before `now` is read: reading functions then find the member under either
    /// name. The old name gets a note; both names in one object are an error.
    void renamed(const std::string& old, const std::string& now);
    /// A key whose successor also has other values: its member, nullptr if absent. It gets a note that names the
    /// `successor`; the keys `old` and `now` in one object are an error.
    std::optional<Node> superseded(const std::string& old, const std::string& successor, const std::string& now);

    /// The member, nullptr if absent; the key is known from now on.
    std::optional<Node> find(const std::string& key);
    double number(const std::string& key, double fallback, const Limits& limits = anyNumber);
    std::int64_t integer(const std::string& key, std::int64_t fallback, std::int64_t min, std::int64_t max);
    bool boolean(const std::string& key, bool fallback);
    std::string string(const std::string& key, const std::string& fallback);
    Eigen::Vector2d vector(const std::string& key, const Eigen::Vector2d& fallback);
    /// Index of a word in `words`, `fallback` if absent or (reported) none of them.
    std::size_t choice(const std::string& key, const std::vector<std::string>& words, std::size_t fallback);
    /// Items of an array; empty if absent.
    ArrayItems array(const std::string& key);
    /// Array of numbers; empty if absent.
    std::vector<double> numbers(const std::string& key, const Limits& limits = anyNumber);
    /// Reports the absence of a key.
    bool require(const std::string& key, const std::string& expected);
    /// Makes keys known that have no effect.
    void ignore(std::initializer_list<const char*> keys);
    /// Reports every unknown key.
    void finish();

private:
    void makeKnown(const std::string& key);

    Context& context_;
    Node node_;
    std::string pointer_;
    bool hex_;
    std::vector<std::string> known_;
    std::vector<std::string> oldNames_;                        ///< known, but never suggested
    std::vector<std::pair<std::string, std::string>> aliases_; ///< present name, old name that stands in the file
};

} // namespace supercircle::scene
