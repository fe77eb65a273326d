// Draw lists of the C interface (docs/reference/picture.md).

#include "bridge/c/include/supercircle.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace {

struct List {
    std::vector<std::int32_t> operations;
    std::vector<float> numbers;
    std::string texts;
    bool operator==(const List&) const = default;
    [[nodiscard]] int count(std::int32_t code) const {
        int n = 0;
        for (std::size_t i = 0; i < operations.size(); i += 2)
            n += operations[i] == code ? 1 : 0;
        return n;
    }
};

List listOf(sc_world w) {
    std::int32_t n = 0;
    List out;
    const std::int32_t* operations = sc_picture_operations(w, &n);
    REQUIRE(operations != nullptr);
    out.operations.assign(operations, operations + n);
    const float* numbers = sc_picture_numbers(w, &n);
    REQUIRE(numbers != nullptr);
    out.numbers.assign(numbers, numbers + n);
    const char* texts = sc_picture_texts(w, &n);
    REQUIRE(texts != nullptr);
    out.texts.assign(texts, texts + n);
    return out;
}

sc_world weightlessWorld() {
    sc_world_def def;
    sc_world_def_init(&def);
    def.gravity = {0.0, 0.0};
    sc_world w{};
    REQUIRE(sc_world_create(&def, &w) == SC_OK);
    return w;
}

sc_shell thinShell(sc_world w, double x, double y) {
    sc_shell_def def;
    sc_shell_def_init(&def);
    def.position = {x, y};
    sc_shell s{};
    REQUIRE(sc_shell_create(w, &def, nullptr, nullptr, 0, &s) == SC_OK);
    return s;
}

} // namespace

TEST_CASE("a picture is the same list each time, and its numbers are those that its operations count", "[c][picture]") {
    sc_world w = weightlessWorld();
    thinShell(w, 0.0, 0.0);
    thinShell(w, 0.06, 0.0);
    sc_view view;
    sc_view_init(&view);
    std::int32_t n = 7;
    CHECK(sc_picture_operations(w, &n) == nullptr); // none was made
    CHECK(n == 7);
    CHECK(std::string(sc_error()).find("sc_picture_make") != std::string::npos);
    REQUIRE(sc_picture_make(w, &view) == SC_OK);
    const List first = listOf(w);
    std::size_t numbers = 0;
    for (std::size_t i = 1; i < first.operations.size(); i += 2)
        numbers += static_cast<std::size_t>(first.operations[i]);
    CHECK(numbers == first.numbers.size());
    CHECK(first.count(1) == 1);     // the ground
    CHECK(first.count(6) == 2);     // clip, and back
    CHECK(first.count(2) >= 2 * 3); // shadow, outline, body of two shells
    CHECK(first.texts.empty());
    REQUIRE(sc_picture_make(w, &view) == SC_OK);
    CHECK(listOf(w) == first);
    view.layers = SC_LAYER_BODIES;
    REQUIRE(sc_picture_make(w, &view) == SC_OK);
    CHECK(listOf(w).count(2) == 0);
    CHECK(sc_picture_numbers(w, nullptr) == nullptr);
    CHECK(sc_world_destroy(w) == SC_OK);
    CHECK(sc_picture_operations(w, &n) == nullptr);
}

TEST_CASE("a view of the first version draws, and bad ones are refused with the picture kept", "[c][picture]") {
    sc_world w = weightlessWorld();
    thinShell(w, 0.0, 0.0);
    sc_view view;
    sc_view_init(&view);
    REQUIRE(sc_picture_make(w, &view) == SC_OK);
    const List first = listOf(w);
    sc_view old = view;
    old.size = static_cast<std::int32_t>(offsetof(sc_view, pixel_ratio));
    old.pixel_ratio = std::numeric_limits<double>::quiet_NaN(); // what stands behind it is not read
    REQUIRE(sc_picture_make(w, &old) == SC_OK);
    CHECK(listOf(w) == first);
    for (const double bad : {0.0, -1.0, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
        sc_view v = view;
        v.pixel_ratio = bad;
        CHECK(sc_picture_make(w, &v) == SC_BAD_INPUT);
        CHECK(std::strstr(sc_error(), "pixel_ratio") != nullptr);
    }
    view.clock = std::numeric_limits<double>::infinity();
    CHECK(sc_picture_make(w, &view) == SC_BAD_INPUT);
    CHECK(listOf(w) == first);
    CHECK(sc_world_destroy(w) == SC_OK);
}

TEST_CASE("the sound of a world at rest is silence, and a shell that falls is heard", "[c][sound]") {
    sc_world w = weightlessWorld();
    std::int32_t n = 0;
    CHECK(sc_sound_samples(w, &n) == nullptr); // not yet on
    CHECK(sc_sound_make(w, 11.0) == SC_BAD_INPUT);
    CHECK(sc_sound_make(w, std::numeric_limits<double>::quiet_NaN()) == SC_BAD_INPUT);
    REQUIRE(sc_sound_make(w, 0.0) == SC_OK);
    REQUIRE(sc_sound_samples(w, &n) != nullptr);
    CHECK(n == 0);
    REQUIRE(sc_world_add(w, R"({"schema": "supercircle-scene/1", "body": [{"name": "floor", "type": 0,
        "position": {"x": 0, "y": 0}, "fixture": [{"polygon": {"vertices": {"x": [-1, 1, 1, -1],
        "y": [-0.1, -0.1, 0, 0]}}}]}]})",
                         -1) == SC_OK);
    REQUIRE(sc_world_set_gravity(w, {0.0, -9.81}) == SC_OK);
    thinShell(w, 0.0, 0.06);
    std::vector<float> all;
    std::size_t first = 0;
    for (int i = 0; i < 60; ++i) {
        REQUIRE(sc_world_step(w, 1.0 / 60.0, nullptr) == SC_OK);
        REQUIRE(sc_sound_make(w, 1.0 / 60.0) == SC_OK);
        const float* samples = sc_sound_samples(w, &n);
        REQUIRE(n == 800);
        for (int k = 0; k < n; ++k) {
            CHECK(std::abs(samples[k]) < 1.0F);
            if (first == 0 && samples[k] != 0.0F)
                first = all.size();
            all.push_back(samples[k]);
        }
    }
    // Its lowest point falls from 0.0215 m or more: not before 0.06 s, and heard.
    CHECK(first > 2880);
    CHECK(first < all.size());
    const std::int32_t bytes = sc_sound_wav(all.data(), static_cast<std::int32_t>(all.size()), nullptr, 0);
    CHECK(bytes == 58 + 4 * static_cast<std::int32_t>(all.size()));
    std::vector<std::uint8_t> file(static_cast<std::size_t>(bytes));
    CHECK(sc_sound_wav(all.data(), static_cast<std::int32_t>(all.size()), file.data(), bytes) == bytes);
    CHECK(std::memcmp(file.data() + 58, all.data(), 4 * all.size()) == 0);
    CHECK(sc_sound_wav(nullptr, 3, nullptr, 0) == -SC_BAD_INPUT);
    CHECK(sc_world_destroy(w) == SC_OK);
}
