// nlohmann-json checks the grammar, the numbers and the UTF-8, but its events have no positions. A scanner therefore
// walks the text in step with the events. An event arrives only for text that is known to be valid, so finding the
// start of the next token is simple (decision 0141).

#include "plugin/scene/loader/document.h"

#include "supercircle/support/regular_file.h"
#include "supercircle/support/texts_in_memory.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <functional>
#include <string_view>

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

/// The string that begins at `offset` as it stands in valid JSON text, without its quotes.
std::string_view rawString(const std::string& text, std::size_t offset) {
    std::size_t end = offset + 1;
    for (; text[end] != '"'; ++end)
        if (text[end] == '\\')
            ++end;
    return std::string_view(text).substr(offset + 1, end - offset - 1);
}

std::string stringAt(const std::string& text, std::size_t offset) {
    const std::string_view raw = rawString(text, offset);
    if (raw.find('\\') == std::string_view::npos)
        return std::string(raw);
    return json::parse(raw.data() - 1, raw.data() + raw.size() + 1).get<std::string>(); // with its quotes
}

bool stringEquals(const std::string& text, std::size_t offset, const std::string& wanted) {
    const std::string_view raw = rawString(text, offset);
    return raw.find('\\') == std::string_view::npos ? raw == wanted : stringAt(text, offset) == wanted;
}

/// Values and keys of a text, exact if it is valid: growing would hold the tokens twice.
std::size_t countTokens(const std::string& text) {
    TokenScanner scanner(text);
    std::size_t count = 0;
    for (std::size_t at = scanner.next(); at < text.size(); at = scanner.next())
        count += isAny(text[at], "}]") ? 0 : 1;
    return count;
}

/// Keys of an open object, to find a key that stands twice. Holds their tokens in a table with open addressing.
class KeySet {
public:
    /// False if the key is there already.
    bool insert(const Document& document, std::uint32_t token, const std::string& key) {
        if (2 * (count_ + 1) > slots_.size())
            grow(document);
        std::uint32_t& slot = find(document, key);
        if (slot != none)
            return false;
        slot = token;
        ++count_;
        return true;
    }

private:
    static constexpr std::uint32_t none = ~0U;

    std::uint32_t& find(const Document& document, const std::string& key) {
        std::size_t at = std::hash<std::string>{}(key) & (slots_.size() - 1);
        while (slots_[at] != none && !stringEquals(document.text, document.tokens[slots_[at]].offset, key))
            at = (at + 1) & (slots_.size() - 1);
        return slots_[at];
    }

    void grow(const Document& document) {
        const std::vector<std::uint32_t> old = std::move(slots_);
        slots_.assign(std::max<std::size_t>(8, 2 * old.size()), none);
        for (const std::uint32_t token : old)
            if (token != none)
                find(document, stringAt(document.text, document.tokens[token].offset)) = token;
    }

    std::vector<std::uint32_t> slots_; ///< a power of two
    std::size_t count_ = 0;
};

/// Receives the parser's events and notes the tokens.
class TokenCollector : public nlohmann::json_sax<json> {
public:
    TokenCollector(Document& document, std::vector<Problem>& problems)
        : document_(document), problems_(problems), scanner_(document.text) {}

    bool null() override { return add(); }
    bool boolean(bool) override { return add(); }
    bool number_integer(number_integer_t) override { return add(); }
    bool number_unsigned(number_unsigned_t) override { return add(); }
    bool number_float(number_float_t, const string_t&) override { return add(); }
    bool string(string_t&) override { return add(); }
    bool binary(binary_t&) override { return false; } // does not occur in JSON text
    bool start_object(std::size_t) override { return open(); }
    bool start_array(std::size_t) override { return open(); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& value) override {
        const std::size_t offset = scanner_.next();
        const std::size_t token = push(offset);
        if (!open_.back().keys.insert(document_, static_cast<std::uint32_t>(token), value) &&
            ++duplicates_ <= maxErrors)
            problems_.push_back(document_.problemAt(offset, pointer() + "/" + pointerToken(value),
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
    /// An array or object that is not closed yet.
    struct Open {
        std::size_t token = 0;
        std::size_t items = 0;
        KeySet keys;
    };

    std::size_t push(std::size_t offset) {
        const std::size_t index = document_.tokens.size();
        document_.tokens.push_back({static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(index + 1)});
        return index;
    }

    bool add() {
        const std::size_t offset = scanner_.next();
        if (++values_ > maxValues) {
            problems_.push_back(document_.problemAt(offset, pointer(), "the file holds too many values",
                                                    "at most " + std::to_string(maxValues)));
            return false;
        }
        if (!open_.empty())
            ++open_.back().items;
        push(offset);
        return true;
    }

    bool open() {
        if (!add())
            return false;
        const std::size_t token = document_.tokens.size() - 1;
        if (open_.size() >= static_cast<std::size_t>(maxDepth)) {
            problems_.push_back(document_.problemAt(document_.tokens[token].offset, {}, "nested too deeply",
                                                    "at most " + std::to_string(maxDepth) + " levels"));
            return false;
        }
        open_.push_back({token, 0, {}});
        return true;
    }

    bool close() {
        scanner_.next();
        document_.tokens[open_.back().token].end = static_cast<std::uint32_t>(document_.tokens.size());
        open_.pop_back();
        return true;
    }

    /// Pointer of the innermost open array or object.
    [[nodiscard]] std::string pointer() const {
        std::string result;
        for (std::size_t i = 1; i < open_.size(); ++i)
            result += document_.text[document_.tokens[open_[i - 1].token].offset] == '{'
                          ? "/" + pointerToken(stringAt(document_.text, document_.tokens[open_[i].token - 1].offset))
                          : "/" + std::to_string(open_[i - 1].items - 1);
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
    std::vector<Open> open_;
    std::size_t duplicates_ = 0, values_ = 0;
};

/// Bytes between two noted places: what a message costs at most, so that many on one long line stay cheap.
constexpr std::size_t placeStep = 4096;

void advance(Document::Place& place, char c) {
    if (c == '\n')
        place = {place.line + 1, 1};
    else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U)
        ++place.column;
}

} // namespace

Node::Kind Node::kind() const {
    switch (document_->text[offset()]) {
    case '{':
        return Kind::Object;
    case '[':
        return Kind::Array;
    case '"':
        return Kind::String;
    case 't':
    case 'f':
        return Kind::Boolean;
    case 'n':
        return Kind::Null;
    default:
        return Kind::Number;
    }
}

bool Node::boolean() const {
    return document_->text[offset()] == 't';
}

double Node::number() const {
    if (kind() != Kind::Number)
        return 0.0;
    const std::string& text = document_->text;
    double value = 0.0; // stays for a number below the smallest; the parser refuses those above the largest
    std::from_chars(text.data() + offset(), text.data() + text.size(), value);
    return value;
}

std::string Node::text() const {
    return kind() == Kind::String ? stringAt(document_->text, offset()) : std::string();
}

std::string Node::key() const {
    return keyIndex_ == index_ ? std::string() : stringAt(document_->text, keyOffset());
}

std::size_t Node::keyOffset() const {
    return document_->tokens[keyIndex_].offset;
}

std::size_t Node::offset() const {
    return document_->tokens[index_].offset;
}

Node::Children Node::children() const {
    const bool keyed = kind() == Kind::Object;
    return {{*document_, index_ + 1, keyed}, {*document_, document_->tokens[index_].end, keyed}};
}

Node::Children::Iterator& Node::Children::Iterator::operator++() {
    index_ = document_->tokens[index_ + (keyed_ ? 1 : 0)].end;
    return *this;
}

std::size_t Node::Children::size() const {
    std::size_t count = 0;
    for (Iterator i = begin_; i != end_; ++i)
        ++count;
    return count;
}

std::optional<Node> Node::find(const std::string& name) const {
    if (kind() == Kind::Object)
        for (const Node& child : children())
            if (stringEquals(document_->text, child.keyOffset(), name))
                return child;
    return std::nullopt;
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

Document::Place Document::place(std::size_t offset) const {
    const std::size_t noted = std::min(offset / placeStep, places.size() - 1);
    Place at = places[noted];
    for (std::size_t i = noted * placeStep; i < std::min(offset, text.size()); ++i)
        advance(at, text[i]);
    return at;
}

Problem Document::problemAt(std::size_t offset, std::string pointer, std::string what, std::string expected) const {
    Problem p;
    p.file = file;
    const Place at = place(offset);
    p.line = at.line;
    p.column = at.column;
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
    document.places.reserve(document.text.size() / placeStep + 1);
    document.places.emplace_back();
    Document::Place at;
    for (std::size_t i = 0; i < document.text.size(); ++i) {
        advance(at, document.text[i]);
        if ((i + 1) % placeStep == 0)
            document.places.push_back(at);
    }
    if (document.text.find_first_not_of(" \t\r\n") == std::string::npos) {
        problems.push_back(document.problemAt(0, {}, "the file is empty", "a JSON object"));
        return failed();
    }
    // nlohmann-json takes a zero byte as the end of the text and would ignore what follows.
    if (const std::size_t zero = document.text.find('\0'); zero != std::string::npos) {
        problems.push_back(document.problemAt(zero, {}, "zero byte in the text", "JSON text in UTF-8"));
        return failed();
    }
    document.tokens.reserve(std::min(countTokens(document.text), 2 * maxValues));
    TokenCollector collector(document, problems);
    const bool complete = json::sax_parse(document.text, &collector);
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
    if (const std::string* text = TextsInMemory::find(path))
        return text->size() <= maxFileSize ? Result<std::string>(*text)
                                           : fail("larger than " + std::to_string(maxFileSize >> 20) + " MiB");
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
