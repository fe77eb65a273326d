// What a JSON text takes while it is read, and how its values are found again.

#include "plugin/scene/loader/reader.h"
#include "tests/support/allocations.h"

#include <catch2/catch.hpp>

using namespace supercircle;
using namespace supercircle::scene;

namespace {

std::string repeated(const std::string& what, std::size_t count) {
    std::string text;
    text.reserve(what.size() * count + 64);
    for (std::size_t i = 0; i < count; ++i)
        text += what;
    return text;
}

std::string array(const std::string& item, std::size_t count) {
    return "{\"a\": [" + repeated(item + ",", count) + item + "]}";
}

std::string members(std::size_t count, const std::string& value) {
    std::string text = "{";
    for (std::size_t i = 0; i < count; ++i)
        text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":" + value;
    return text + "}";
}

} // namespace

TEST_CASE("a JSON text takes at most twelve times its size") {
    if (!test::countsAllocations())
        return;
    std::string words = array("1", 100000);
    words.insert(words.size() - 2, ",\"\""); // a text among numbers
    const std::pair<const char*, std::string> shapes[] = {
        {"numbers of one digit", array("1", 700000)},
        {"numbers and a text", words},
        {"numbers of many digits", array("-1.2345678901234e-5", 100000)},
        {"literals", array("true", 100000)},
        {"empty texts", array("\"\"", 200000)},
        {"empty arrays", array("[]", 200000)},
        {"empty objects", array("{}", 200000)},
        {"arrays of one number", array("[1]", 200000)},
        {"deep arrays", array(repeated("[", 90) + "1" + repeated("]", 90), 1000)},
        {"objects of one member", array("{\"\":1}", 200000)},
        {"objects of ten members", array(members(10, "0"), 20000)},
        {"an object of many members", members(300000, "1")},
        {"one long text", "{\"a\":\"" + repeated("x", 2000000) + "\"}"},
        {"one long text of escapes", "{\"a\":\"" + repeated("\\n", 1000000) + "\"}"},
        {"one long key", "{\"" + repeated("x", 2000000) + "\":1}"},
        {"line ends", repeated("\n", 2000000) + "{}"},
        {"an array that does not end", "[" + repeated("1,", 500000)},
        {"wrong in all its values", repeated("{\"a\":[{\"", 1) + repeated("\":1,\"", 200000)},
    };
    for (const auto& [name, text] : shapes) {
        INFO(name);
        std::vector<Problem> problems;
        const std::int64_t before = test::heldBytes();
        test::restartPeak();
        const auto document = parseDocument(text, "x", problems);
        const auto taken = static_cast<double>(test::peakBytes() - before);
        const double times = taken / static_cast<double>(text.size());
        INFO(times << " times its size");
        CHECK(times < 12.0);
    }
}

TEST_CASE("an array of numbers is read without an object for each item") {
    if (!test::countsAllocations())
        return;
    std::vector<Problem> problems;
    const auto document = parseDocument(array("1", 100000), "x", problems);
    REQUIRE(document);
    Scope scope;
    Context context{*document, problems, scope};
    ObjectReader reader(context, document->root(), "");
    test::restartPeak();
    const std::int64_t before = test::heldBytes();
    CHECK(reader.numbers("a").size() == 100001);
    CHECK(test::peakBytes() - before < 8 * 100001 + 4096); // the numbers themselves
}

TEST_CASE("values of a JSON text are found again with their places") {
    std::vector<Problem> problems;
    const std::string text = "\n{\"a\": [0, -2.5e3 , [1, {}], \"]\\u00e4\\\"\"], \"k\\ney\\\\\": {\"b\": null, \"c\": "
                             "true}, \"c\": false, \"e\": [], \"f\": 1e-400, \"g\": -0.1}";
    const auto document = parseDocument(text, "x", problems);
    REQUIRE(document);
    const Node root = document->root();
    CHECK(root.kind() == Node::Kind::Object);
    CHECK(root.offset() == 1);
    CHECK(root.children().size() == 6);
    std::vector<Node> items;
    for (const Node& item : root.find("a")->children())
        items.push_back(item);
    REQUIRE(items.size() == 4);
    CHECK(items[1].number() == -2500.0);
    CHECK(text.substr(items[1].offset(), 6) == "-2.5e3");
    CHECK(items[1].keyOffset() == items[1].offset());
    CHECK(items[1].key().empty());
    CHECK(items[2].children().size() == 2);
    CHECK(items[3].text() == "]\xC3\xA4\"");
    const auto escaped = root.find("k\ney\\");
    REQUIRE(escaped);
    CHECK(escaped->key() == "k\ney\\");
    CHECK(text.substr(escaped->keyOffset(), 3) == "\"k\\");
    CHECK(escaped->find("b")->kind() == Node::Kind::Null);
    CHECK(escaped->find("c")->boolean());
    CHECK_FALSE(root.find("c")->boolean());
    CHECK(root.find("c")->kind() == Node::Kind::Boolean);
    CHECK(root.find("e")->children().empty());
    CHECK(root.find("f")->number() == 0.0);
    CHECK(root.find("g")->number() == -0.1);
    CHECK_FALSE(root.find("key"));
    CHECK_FALSE(items[0].find("a"));
}

TEST_CASE("a key that stands twice is found among many keys") {
    std::vector<Problem> problems;
    std::string text = members(5000, "1");
    text.insert(text.size() - 1, ",\"4\\u0031\":2"); // "41" again, written with an escape
    CHECK_FALSE(parseDocument(text, "x", problems));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].what == "duplicate key \"41\"");
    CHECK(problems[0].column == static_cast<int>(text.rfind(",\"")) + 2);
}

TEST_CASE("line and column are right after the noted places too") {
    std::string text = "[";
    for (int line = 0; line < 3000; ++line)
        text += line % 7 == 0 ? "\"\xC3\xA4\",\n" : "1, 2,";
    text += "3]";
    std::vector<Problem> problems;
    const auto document = parseDocument(text, "x", problems);
    REQUIRE(document);
    int line = 1, column = 1;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const Document::Place at = document->place(i);
        if (at.line != line || at.column != column)
            FAIL("byte " << i);
        if (text[i] == '\n') {
            ++line;
            column = 1;
        } else if (i + 1 < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) {
            ++column;
        }
    }
}
