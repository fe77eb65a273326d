#pragma once
// A JSON text with the position of every key and value, for the line and column in messages (decision 0141).

#include "plugin/scene/loader/problem.h"
#include "supercircle/support/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

struct Document;

/// A value of a document: a handle that is copied freely and lives as long as the document stays where it is.
class Node {
public:
    enum class Kind { Null, Boolean, Number, String, Array, Object };
    class Children;

    [[nodiscard]] Kind kind() const;
    [[nodiscard]] bool boolean() const;          ///< of a Boolean
    [[nodiscard]] double number() const;         ///< of a Number
    [[nodiscard]] std::string text() const;      ///< of a String, its escapes resolved; empty for other kinds
    [[nodiscard]] std::string key() const;       ///< of a member of an object; empty for an item and the root
    [[nodiscard]] std::size_t keyOffset() const; ///< byte offset of the key; of the value if there is no key
    [[nodiscard]] std::size_t offset() const;    ///< byte offset of the value
    /// Items of an array, members of an object in the order of the file; none of other kinds.
    [[nodiscard]] Children children() const;
    /// Member by key; empty if absent or not an object.
    [[nodiscard]] std::optional<Node> find(const std::string& name) const;

private:
    friend struct Document;
    Node(const Document& document, std::size_t index, std::size_t keyIndex)
        : document_(&document), index_(index), keyIndex_(keyIndex) {}

    const Document* document_;
    std::size_t index_, keyIndex_; ///< tokens of the value and of its key; the same if there is no key
};

/// Children of a node, to walk over. `size` takes a walk.
class Node::Children {
public:
    class Iterator {
    public:
        Iterator(const Document& document, std::size_t index, bool keyed)
            : document_(&document), index_(index), keyed_(keyed) {}
        Node operator*() const { return {*document_, index_ + (keyed_ ? 1 : 0), index_}; }
        Iterator& operator++();
        bool operator!=(const Iterator& other) const { return index_ != other.index_; }

    private:
        const Document* document_;
        std::size_t index_;
        bool keyed_;
    };

    Children(Iterator begin, Iterator end) : begin_(begin), end_(end) {}
    [[nodiscard]] Iterator begin() const { return begin_; }
    [[nodiscard]] Iterator end() const { return end_; }
    [[nodiscard]] bool empty() const { return !(begin_ != end_); }
    [[nodiscard]] std::size_t size() const;

private:
    Iterator begin_, end_;
};

/// "a number", "a text", ...: for messages.
const char* kindName(Node::Kind kind);

/// One reference token of a JSON pointer: `~` and `/` escaped.
std::string pointerToken(const std::string& key);

/// A text and where its values are. Numbers, texts and keys are read from the text when they are asked for, so that a
/// value takes 8 bytes, and a text less than 7 times its size while it is read.
struct Document {
    /// A value or a key.
    struct Token {
        std::uint32_t offset = 0; ///< its first byte in the text
        std::uint32_t end = 0;    ///< token after this value and all in it
    };
    /// A place in the text.
    struct Place {
        int line = 1, column = 1;
    };

    std::string file;
    std::string text;
    std::vector<Token> tokens;
    std::vector<Place> places; ///< of every `placeStep`-th byte

    [[nodiscard]] Node root() const { return {*this, 0, 0}; }
    /// Line and column, both from 1, of a byte offset; columns count characters.
    [[nodiscard]] Place place(std::size_t offset) const;
    /// A problem at a byte offset of this text.
    [[nodiscard]] Problem problemAt(std::size_t offset, std::string pointer, std::string what,
                                    std::string expected = {}) const;
};

/// Deepest nesting accepted.
inline constexpr int maxDepth = 100;
/// Largest file accepted, bytes.
inline constexpr std::size_t maxFileSize = std::size_t{64} << 20;
/// Most values accepted: what is made of a value (a body, a segment) takes up to some 100 bytes.
inline constexpr std::size_t maxValues = 1500000;
/// Most errors of a file that are reported one by one; of the others the number.
inline constexpr std::size_t maxErrors = 20;

/// Parses strict JSON (RFC 8259: no comments, no trailing commas). Of syntax errors the first is reported, of duplicate
/// keys the first `maxErrors`. Fails if there was any error.
Result<Document> parseDocument(std::string text, const std::string& file, std::vector<Problem>& problems);

/// Reads a whole file. Fails, with one problem, if it is missing, no regular file (a device, a pipe), unreadable or
/// larger than `maxFileSize`.
Result<std::string> readFile(const std::string& path, std::vector<Problem>& problems);

} // namespace supercircle::scene
