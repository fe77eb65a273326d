// The draw list: its format, and what a world looks like in it.

#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/picture/world_picture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>

using namespace supercircle::picture;

namespace {

/// A quarter of a circle of radius 0.1 m about the origin.
Shell arc(double energy, int points = 9) {
    Shell shell;
    for (int i = 0; i < points; ++i) {
        const double a = 0.5 * M_PI * i / (points - 1);
        shell.line.push_back({0.1 * std::cos(a), 0.1 * std::sin(a)});
        shell.energy.push_back(energy);
    }
    shell.thickness = 0.005;
    return shell;
}

View view() {
    View v;
    v.width = 400.0;
    v.height = 300.0;
    v.pixelsPerMetre = 1000.0;
    return v;
}

std::map<Operation, int> counts(const DrawList& list) {
    std::map<Operation, int> out;
    list.each([&](const Item& item) { ++out[item.operation]; });
    return out;
}

DrawList drawn(const Content& content, const View& v = view()) {
    DrawList list;
    addGround(list, v);
    addWorld(list, v, content);
    return list;
}

} // namespace

TEST_CASE("operations tell how many numbers they have, and texts stand in their order", "[picture]") {
    DrawList list;
    list.polygon(std::vector<Point>{{0, 0}, {10, 0}, {10, 5}}, Colour::hex(0x102030, 0.5));
    list.band(std::vector<BandVertex>{{{0, 0}, 2.0, Colour::hex(0xff0000)}, {{8, 0}, 3.0, Colour::hex(0x00ff00)}},
              false);
    list.disc({1, 2}, 3, Colour::hex(0xffffff));
    list.glow({4, 5}, 6, Colour::hex(0x010203), 0.25);
    list.text({7, 8}, "\u00b5J", {12.0, Colour::hex(0x0a0b0c), Anchor::End, true});
    list.text({7, 8}, "", {});
    list.clip({1, 2, 30, 40});
    CHECK(list.operations() == std::vector<std::int32_t>{1, 8, 2, 10, 3, 5, 4, 5, 5, 8, 5, 8, 6, 4});
    CHECK(list.texts() == std::string("\u00b5J\0\0", 5));
    const std::vector<float> first{1056816, 0.5F, 0, 0, 10, 0, 10, 5, 1, 0, 0, 0, 2, 16711680, 8, 0, 3, 65280};
    CHECK(std::vector<float>(list.numbers().begin(), list.numbers().begin() + 18) == first);
    std::size_t numbers = 0;
    std::string texts;
    list.each([&](const Item& item) {
        numbers += item.numbers.size();
        texts += item.text;
    });
    CHECK(numbers == list.numbers().size());
    CHECK(texts == "\u00b5J");
}

TEST_CASE("numbers of a list are finite, whatever comes in", "[picture]") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    DrawList list;
    list.polygon(std::vector<Point>{{nan, inf}, {-inf, 1e300}, {0, 0}}, {nan, inf, -1.0, 2.0});
    list.disc({nan, nan}, -3.0, {});
    list.polygon(std::vector<Point>{{0, 0}, {1, 1}}, {}); // two corners are none
    list.line(std::vector<Point>{{0, 0}}, false, 1.0, {});
    for (const float x : list.numbers())
        CHECK((std::isfinite(x) && std::abs(x) <= 16777215.0F));
    CHECK(list.operations().size() == 4);
}

TEST_CASE("colours pass through their packed form unchanged", "[picture]") {
    for (const unsigned rgb : {0x000000U, 0xffffffU, 0x010203U, 0xfedcbaU}) {
        CHECK(packed(Colour::hex(rgb)) == static_cast<float>(rgb));
        CHECK(packed(unpacked(static_cast<float>(rgb))) == static_cast<float>(rgb));
    }
}

TEST_CASE("the energy colours get lighter by equal steps and are seen on the ground", "[picture]") {
    using supercircle::graphics::colourDistance;
    using supercircle::graphics::lightness;
    constexpr int kSteps = 23;
    const double step = colourDistance(energyOnDark(0, 1), energyOnDark(1, 1)) / kSteps;
    double longest = 0.0, shortest = 1e9;
    for (int i = 0; i < kSteps; ++i) {
        const double x = std::pow(static_cast<double>(i) / kSteps, 2), y = std::pow((i + 1.0) / kSteps, 2);
        CHECK(lightness(energyOnDark(y, 1)) > lightness(energyOnDark(x, 1)));
        const double d = colourDistance(energyOnDark(x, 1), energyOnDark(y, 1));
        longest = std::max(longest, d);
        shortest = std::min(shortest, d);
    }
    CHECK(shortest > step);           // the path is longer than its chord
    CHECK(longest < 1.25 * shortest); // rounding to 8 bits moves a step of 0.03 by 0.003 at each end
    CHECK(lightness(energyOnDark(0, 1)) - lightness(Colour::hex(0x151a22)) > 0.35);
    CHECK(packed(energyOnDark(7, 1)) == packed(energyOnDark(1, 1)));
    CHECK(packed(energyOnDark(-1, 1)) == packed(energyOnDark(0, 1)));
    CHECK(packed(energyOnDark(std::nan(""), 1)) == packed(Colour::hex(0x8a9099)));
}

TEST_CASE("a shell is shadow, outline, rim, body and highlight, a thin one shadow, outline and body", "[picture]") {
    Content content;
    content.shells.push_back(arc(0.0));
    CHECK(counts(drawn(content)) ==
          std::map<Operation, int>{{Operation::Polygon, 1}, {Operation::Clip, 2}, {Operation::Band, 5}});
    content.shells.front().thickness = 0.001;
    CHECK(counts(drawn(content))[Operation::Band] == 3);
    content.shells.front().line.assign(9, {5.0, 5.0}); // out of sight
    CHECK(counts(drawn(content))[Operation::Band] == 0);
}

TEST_CASE("what a world draws lies within the clip, but for shadows and round ends", "[picture]") {
    Content content;
    content.shells = {arc(0.0), arc(1.0)};
    content.bodies.push_back(
        {.points = {{-0.1, -0.1}, {0.1, -0.1}, {0.1, -0.05}, {-0.1, -0.05}}, .role = Role::Driven});
    content.bodies.push_back({.points = {{-0.1, 0.05}}, .radius = 0.02, .role = Role::Loose});
    content.contacts.push_back({{0.1, 0.0}, {1.0, 0.0}});
    content.holds.push_back({0.0, 0.1});
    const DrawList list = drawn(content);
    std::vector<float> clip;
    list.each([&](const Item& item) {
        if (item.operation == Operation::Clip)
            clip.assign(item.numbers.begin(), item.numbers.end());
        if (item.operation == Operation::Polygon || item.operation == Operation::Band) {
            const std::size_t head = item.operation == Operation::Polygon ? kPolygonHead : kBandHead;
            const std::size_t step = item.operation == Operation::Polygon ? kPolygonStep : kBandStep;
            for (std::size_t i = head; i < item.numbers.size(); i += step) {
                CHECK((item.numbers[i] >= 0.0F && item.numbers[i] <= 400.0F));
                CHECK((item.numbers[i + 1] >= 0.0F && item.numbers[i + 1] <= 300.0F));
            }
        }
    });
    CHECK(clip == std::vector<float>{0, 0, 400, 300});
}

TEST_CASE("colours of a shell rise with its energy, vertex by vertex", "[picture]") {
    Content content;
    Shell shell = arc(0.0, 24);
    shell.thickness = 0.001; // one coloured band
    for (std::size_t i = 0; i < shell.energy.size(); ++i)
        shell.energy[i] = std::pow(static_cast<double>(i) / 23.0, 2);
    content.shells.push_back(shell);
    std::vector<double> light;
    drawn(content).each([&](const Item& item) {
        if (item.operation != Operation::Band)
            return;
        light.clear(); // the last band
        for (std::size_t i = kBandHead; i < item.numbers.size(); i += kBandStep)
            light.push_back(supercircle::graphics::lightness(unpacked(item.numbers[i + 3])));
    });
    REQUIRE(light.size() == 24);
    for (std::size_t i = 1; i < light.size(); ++i)
        CHECK(light[i] > light[i - 1]);
}

TEST_CASE("pieces of one body have no edge between them", "[picture]") {
    Content content;
    Body left{.points = {{-0.1, 0}, {0, 0}, {0, 0.1}, {-0.1, 0.1}}, .id = 7};
    Body right{.points = {{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}}, .id = 7};
    content.bodies = {left, right};
    std::string order;
    const auto sequence = [&] {
        order.clear();
        drawn(content).each([&](const Item& i) { order += std::to_string(static_cast<int>(i.operation)); });
        return order;
    };
    CHECK(sequence() == "1622116"); // ground, clip, both edges, both fills, clip
    content.bodies[1].id = 8;
    CHECK(sequence() == "1621216");
}

TEST_CASE("energies are written with two digits and a prefix", "[picture]") {
    CHECK(energyText(0.0023) == "2.3 mJ");
    CHECK(energyText(0.0) == "0.0 pJ");
    CHECK(energyText(0.0995) == "100 mJ");
    CHECK(energyText(9.96e-6) == "10 \u00b5J");
    CHECK(energyText(0.9997) == "1.0 J");
    CHECK(energyText(12345.0) == "12 kJ");
}
