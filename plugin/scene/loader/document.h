#pragma once
// A JSON text as a tree with the position of every key and value, for the line and column in messages.

#include "plugin/scene/loader/problem.h"
#include "supercircle/support/result.h"

#include <cstddef>
#include <string>
#include <vector>

namespace supercircle::scene {

struct Node {
    enum class Kind { Null, Boolean, Number, String, Array, Object };
    Kind kind = Kind::Null;
    bool boolean = false;
    double number = 0.0;
    std::string text;           ///< of a String
    std::string key;            ///< of a member of an object
    std::size_t keyOffset = 0;  ///< byte offset of the key; of the value if there is no key
    std::size_t offset = 0;     ///< byte offset of the value
    std::vector<Node> children; ///< items of an array, members of an object in the order of the file

    /// Member by key, nullptr if absent or not an object.
    [[nodiscard]] const Node* find(const std::string& name) const;
};

/// "a number", "a text", ...: for messages.
const char* kindName(Node::Kind kind);

/// One reference token of a JSON pointer: `~` and `/` escaped.
std::string pointerToken(const std::string& key);

struct Document {
    std::string file;
    std::string text;
    Node root;
    std::vector<std::size_t> lineStarts;

    /// Line and column, both from 1, of a byte offset; columns count characters.
    void position(std::size_t offset, int& line, int& column) const;
    /// A problem at a byte offset of this text.
    [[nodiscard]] Problem problemAt(std::size_t offset, std::string pointer, std::string what,
                                    std::string expected = {}) const;
};

/// Deepest nesting accepted.
inline constexpr int maxDepth = 100;
/// Largest file accepted, bytes.
inline constexpr std::size_t maxFileSize = std::size_t{64} << 20;
/// Most values accepted: a value takes up to 400 bytes while the tree grows, so 600 MB in all.
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
