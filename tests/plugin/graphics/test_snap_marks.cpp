#include "plugin/graphics/picture/world_picture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

using namespace supercircle::picture;

TEST_CASE("a snap is shown for 0.8 s", "[picture]") {
    SnapMarks marks;
    CHECK(marks.at(5.0, 5.0).empty());
    marks.add({0.1, 0.2}, 0.0023, 5.05);
    const auto first = marks.at(5.1, 5.1);
    REQUIRE(first.size() == 1);
    CHECK((first[0].age == 0.0 && first[0].flash && first[0].released == 0.0023));
    CHECK(marks.at(5.5, 5.5)[0].age == Approx(0.5));
    CHECK(marks.at(5.89, 5.89).size() == 1);
    CHECK(marks.at(5.9, 5.9).empty());
}

TEST_CASE("a snap that no picture showed in time is not shown later", "[picture]") {
    SnapMarks marks;
    marks.add({}, 1.0, 5.0);
    marks.add({}, 2.0, 5.3);
    const auto shown = marks.at(77.0, 6.0); // a viewer's clock
    REQUIRE(shown.size() == 1);
    CHECK((shown[0].released == 2.0 && shown[0].age == 0.0));
}

TEST_CASE("at most three flashes begin in any second, however many shells snap", "[picture]") {
    SnapMarks marks;
    std::vector<double> begun;
    for (int frame = 0; frame < 1200; ++frame) { // 20 s of pictures
        const double clock = frame / 60.0;
        for (int i = 0; i < frame % 4; ++i)
            marks.add({0.01 * i, 0.0}, 1e-3 * (i + 1), clock);
        const auto shown = marks.at(clock, clock);
        CHECK(shown.size() <= kMostMarks);
        const auto fresh = [](const SnapMark& m) { return m.flash && m.age == 0.0; };
        const auto at = std::find_if(shown.begin(), shown.end(), fresh);
        if (at == shown.end())
            continue;
        CHECK(std::count_if(shown.begin(), shown.end(), fresh) == 1);
        for (const SnapMark& m : shown) // the largest of the new ones
            CHECK((m.age > 0.0 || m.released <= at->released));
        begun.push_back(clock);
    }
    REQUIRE(begun.size() > 50);
    for (std::size_t i = 3; i < begun.size(); ++i)
        CHECK(begun[i] - begun[i - 3] >= 1.0);
}

TEST_CASE("a clock that runs backwards forgets what is shown and does not flash at once", "[picture]") {
    SnapMarks marks;
    marks.add({}, 1.0, 100.0);
    CHECK(marks.at(100.0, 100.0).size() == 1);
    CHECK(marks.at(1.0, 1.0).empty());
    marks.add({}, 1.0, 1.05);
    REQUIRE(marks.at(1.1, 1.1).size() == 1);
    CHECK_FALSE(marks.at(1.1, 1.1)[0].flash);
    marks.add({}, 1.0, 1.4);
    CHECK(marks.at(1.4, 1.4).back().flash);
}

TEST_CASE("reduced motion shows the energy of a snap without light and at rest", "[picture]") {
    Content content;
    content.snaps = {{{0.0, 0.0}, 0.0023, 0.5, true}};
    for (const bool reduced : {false, true}) {
        View view;
        view.reducedMotion = reduced;
        DrawList list;
        addWorld(list, view, content);
        int glows = 0;
        float y = 0.0F, alpha = 0.0F;
        list.each([&](const Item& item) {
            glows += item.operation == Operation::Glow ? 1 : 0;
            if (item.operation == Operation::Text) {
                CHECK(item.text == "2.3 mJ");
                y = item.numbers[1];
                alpha = item.numbers[4];
            }
        });
        CHECK(glows == (reduced ? 0 : 1));
        CHECK(y == (reduced ? 284.0F : 273.0F));
        CHECK(alpha == (reduced ? 1.0F : 0.75F));
    }
}

TEST_CASE("texts of snaps do not cover each other: the larger one is shown", "[picture]") {
    Content content;
    content.snaps = {
        {{0.0, 0.0}, 0.001, 0.0, false}, {{0.05, 0.0}, 0.002, 0.0, false}, {{2.0, 0.0}, 0.0005, 0.0, false}};
    DrawList list;
    addWorld(list, {}, content);
    std::vector<std::string> texts;
    list.each([&](const Item& item) {
        if (item.operation == Operation::Text)
            texts.emplace_back(item.text);
    });
    CHECK(texts == std::vector<std::string>{"2.0 mJ", "2.0 mJ", "500 \u00b5J", "500 \u00b5J"}); // each with its shade
}
