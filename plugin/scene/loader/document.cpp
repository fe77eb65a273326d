// nlohmann-json checks the grammar, the numbers and the UTF-8, but its events have no positions. A scanner therefore
// walks the text in step with the events. An event arrives only for text that is known to be valid, so finding the
// start of the next token is simple (decision 0141).

#include "plugin/scene/loader/document.h"

#include "supercircle/support/regular_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <unordered_set>

#include <nlohmann/json.hpp>

namespace supercircle::scene {

namespace {

using nlohmann::json;

bool isAny(char c, const char* set) {
    return c != '\0' && std::strchr(set, c) != nullptr;
}

/// Start of the next token of valid JSON text, in the order in which the parser reports its events.
class TokenScanner {
public:
    explicit TokenScanner(const std::string& text) : text_(text) {
        if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0)
            at_ = 3;
    }

    std::size_t next() {
        while (at_ < text_.size() && isAny(text_[at_], " \t\r\n,:"))
            ++at_;
        const std::size_t start = at_;
        if (at_ >= text_.size())
            return start;
        if (text_[at_] == '"')
            skipString();
        else if (isAny(text_[at_], "{}[]"))
            ++at_;
        else
            while (at_ < text_.size() && !isAny(text_[at_], " \t\r\n,:{}[]"))
                ++at_;
        return start;
    }

    /// Items of the array that has just been opened if it holds no texts and nothing nested; 0: it does.
    [[nodiscard]] std::size_t flatItems() const {
        const std::size_t end = text_.find_first_of("[]{}\"", at_);
        if (end == std::string::npos || text_[end] != ']')
            return 0;
        return static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                                   text_.begin() + static_cast<std::ptrdiff_t>(end), ',')) +
               1;
    }

private:
    void skipString() {
        for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
            if (text_[at_] == '\\')
                ++at_;
        at_ = std::min(at_ + 1, text_.size());
    }

    const std::string& text_;
    std::size_t at_ = 0;
};

/// Receives the parser's events and builds the tree.
class TreeBuilder : public nlohmann::json_sax<json> {
public:
    TreeBuilder(Document& document, std::vector<Problem>& problems)
        : document_(document), problems_(problems), scanner_(document.text) {}

    bool null() override { return !tooMany() && add(Node::Kind::Null) != nullptr; }
    bool boolean(bool value) override {
        if (tooMany())
            return false;
        add(Node::Kind::Boolean)->boolean = value;
        return true;
    }
    bool number_integer(number_integer_t value) override { return number(static_cast<double>(value)); }
    bool number_unsigned(number_unsigned_t value) override { return number(static_cast<double>(value)); }
    bool number_float(number_float_t value, const string_t&) override { return number(value); }
    bool string(string_t& value) override {
        if (tooMany())
            return false;
        add(Node::Kind::String)->text = value;
        return true;
    }
    bool binary(binary_t&) override { return false; } // does not occur in JSON text
    bool start_object(std::size_t) override { return open(Node::Kind::Object); }
    bool start_array(std::size_t) override { return open(Node::Kind::Array); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& value) override {
        key_ = value;
        keyOffset_ = scanner_.next();
        if (!keys_.back().insert(value).second && ++duplicates_ <= maxErrors)
            problems_.push_back(document_.problemAt(keyOffset_, pointer() + "/" + pointerToken(value),
                                                    "duplicate key \"" + value + "\"", "every key once in an object"));
        return true;
    }

    bool parse_error(std::size_t position, const std::string& token, const json::exception& error) override {
        std::string what = error.what();
        const std::size_t read = what.find("; last read: ");
        std::string expected;
        const std::size_t marker = what.rfind("; expected ");
        if (marker != std::string::npos) {
            expected = what.substr(marker + 11);
            what.resize(marker);
        }
        if (read != std::string::npos && read < what.size())
            what.resize(read); // repeats the text, and its bytes may not be printable
        if (const std::size_t column = what.find("column "); column != std::string::npos)
            what.erase(0, what.find(": ", column) + 2);
        else if (const std::size_t bracket = what.find("] "); bracket != std::string::npos)
            what.erase(0, bracket + 2);
        problems_.push_back(document_.problemAt(errorOffset(position, token, what), pointer(), what, expected));
        return false;
    }

private:
    bool tooMany() {
        if (++values_ <= maxValues)
            return false;
        problems_.push_back(document_.problemAt(scanner_.next(), pointer(), "the file holds too many values",
                                                "at most " + std::to_string(maxValues)));
        return true;
    }

    bool number(double value) {
        if (tooMany())
            return false;
        add(Node::Kind::Number)->number = value;
        return true;
    }

    Node* add(Node::Kind kind) {
        Node node;
        node.kind = kind;
        node.offset = scanner_.next();
        node.keyOffset = node.offset;
        if (stack_.empty()) {
            document_.root = std::move(node);
            return &document_.root;
        }
        Node& parent = *stack_.back();
        if (parent.kind == Node::Kind::Object) {
            node.key = key_;
            node.keyOffset = keyOffset_;
        }
        parent.children.push_back(std::move(node));
        return &parent.children.back();
    }

    bool open(Node::Kind kind) {
        if (tooMany())
            return false;
        Node* node = add(kind);
        if (stack_.size() >= static_cast<std::size_t>(maxDepth)) {
            problems_.push_back(document_.problemAt(node->offset, {}, "nested too deeply",
                                                    "at most " + std::to_string(maxDepth) + " levels"));
            return false;
        }
        // A parent gets no further children while a child is open, so these pointers stay valid.
        stack_.push_back(node);
        keys_.emplace_back();
        if (kind == Node::Kind::Array) // growing would hold the items twice
            node->children.reserve(std::min(scanner_.flatItems(), maxValues));
        return true;
    }

    bool close() {
        scanner_.next();
        stack_.pop_back();
        keys_.pop_back();
        return true;
    }

    /// Pointer of the innermost open array or object.
    [[nodiscard]] std::string pointer() const {
        std::string result;
        for (std::size_t i = 1; i < stack_.size(); ++i)
            result += stack_[i - 1]->kind == Node::Kind::Object
                          ? "/" + pointerToken(stack_[i]->key)
                          : "/" + std::to_string(stack_[i - 1]->children.size() - 1);
        return result;
    }

    /// Start of an unexpected token; of a malformed token the first wrong character.
    [[nodiscard]] std::size_t errorOffset(std::size_t position, const std::string& token,
                                          const std::string& what) const {
        const std::size_t size = document_.text.size();
        if (what.find("unexpected end of input") != std::string::npos)
            return size;
        std::size_t back = 1; // a bracket, or the character at which a token broke
        if (what.find("overflow") != std::string::npos || what.find("unexpected number") != std::string::npos ||
            what.find("unexpected string") != std::string::npos)
            back = std::max<std::size_t>(token.size(), 1);
        else if (what.find("unexpected true") != std::string::npos || what.find("unexpected null") != std::string::npos)
            back = 4;
        else if (what.find("unexpected false") != std::string::npos)
            back = 5;
        return std::min(position >= back ? position - back : 0, size);
    }

    Document& document_;
    std::vector<Problem>& problems_;
    TokenScanner scanner_;
    std::vector<Node*> stack_;
    std::vector<std::unordered_set<std::string>> keys_;
    std::string key_;
    std::size_t keyOffset_ = 0;
    std::size_t duplicates_ = 0, values_ = 0;
};

} // namespace

const Node* Node::find(const std::string& name) const {
    if (kind != Kind::Object)
        return nullptr;
    for (const Node& child : children)
        if (child.key == name)
            return &child;
    return nullptr;
}

const char* kindName(Node::Kind kind) {
    switch (kind) {
    case Node::Kind::Null:
        return "null";
    case Node::Kind::Boolean:
        return "true or false";
    case Node::Kind::Number:
        return "a number";
    case Node::Kind::String:
        return "a text";
    case Node::Kind::Array:
        return "an array";
    case Node::Kind::Object:
        return "an object";
    }
    return "a value";
}

std::string pointerToken(const std::string& key) {
    std::string result;
    for (const char c : key) {
        if (c == '~')
            result += "~0";
        else if (c == '/')
            result += "~1";
        else
            result += c;
    }
    return result;
}

void Document::position(std::size_t offset, int& line, int& column) const {
    const auto after = std::upper_bound(lineStarts.begin(), lineStarts.end(), offset);
    const std::size_t index = static_cast<std::size_t>(after - lineStarts.begin()) - 1;
    line = static_cast<int>(index + 1);
    column = 1;
    for (std::size_t i = lineStarts[index]; i < offset && i < text.size(); ++i)
        if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U)
            ++column;
}

Problem Document::problemAt(std::size_t offset, std::string pointer, std::string what, std::string expected) const {
    Problem p;
    p.file = file;
    position(offset, p.line, p.column);
    p.pointer = std::move(pointer);
    p.what = std::move(what);
    p.expected = std::move(expected);
    return p;
}

Result<Document> parseDocument(std::string text, const std::string& file, std::vector<Problem>& problems) {
    const std::size_t before = problems.size();
    const auto failed = [&] { return Result<Document>::failure(errorText(problems, before)); };
    Document document;
    document.file = file;
    document.text = std::move(text);
    document.lineStarts.push_back(0);
    for (std::size_t i = 0; i < document.text.size(); ++i)
        if (document.text[i] == '\n')
            document.lineStarts.push_back(i + 1);
    if (document.text.find_first_not_of(" \t\r\n") == std::string::npos) {
        problems.push_back(document.problemAt(0, {}, "the file is empty", "a JSON object"));
        return failed();
    }
    // nlohmann-json takes a zero byte as the end of the text and would ignore what follows.
    if (const std::size_t zero = document.text.find('\0'); zero != std::string::npos) {
        problems.push_back(document.problemAt(zero, {}, "zero byte in the text", "JSON text in UTF-8"));
        return failed();
    }
    TreeBuilder builder(document, problems);
    const bool complete = json::sax_parse(document.text, &builder);
    if (!complete && problems.size() == before)
        problems.push_back(document.problemAt(0, {}, "not JSON"));
    if (!complete || problems.size() != before)
        return failed();
    return document;
}

Result<std::string> readFile(const std::string& path, std::vector<Problem>& problems) {
    const auto fail = [&](const std::string& what) {
        Problem p;
        p.file = path.empty() ? "(no file)" : path;
        p.what = what;
        problems.push_back(p);
        return Result<std::string>::failure(p.toString());
    };
    if (const std::string why = whyUnreadable(path, maxFileSize); !why.empty())
        return fail(why);
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    if (!in)
        return fail(std::string("cannot be opened: ") + std::strerror(errno));
    std::string text;
    std::vector<char> block(1 << 16);
    while (in) {
        in.read(block.data(), static_cast<std::streamsize>(block.size()));
        text.append(block.data(), static_cast<std::size_t>(in.gcount()));
        if (text.size() > maxFileSize)
            return fail("larger than " + std::to_string(maxFileSize >> 20) + " MiB");
    }
    if (in.bad())
        return fail("cannot be read to its end");
    return text;
}

} // namespace supercircle::scene
