#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>

#include <cairo/cairo.h>

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_builder.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/motion_data.h"
#include "plugin/pages/run/report.h"
#include "plugin/pages/run/run_page.h"
#include "plugin/recording/table/files.h"
#include "tests/plugin/pages/run/synthetic.h"
#include "tests/support/folder.h"

// Fontconfig keeps its configuration until the process ends; the leak checker of sanitizer builds is told so.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libfontconfig\n";
}

using namespace supercircle;
using namespace supercircle::graphics;
using namespace supercircle::pages;
namespace fs = std::filesystem;

namespace {

using supercircle::test::Folder;

struct Picture {
    int width = 0, height = 0;
    double inked = 0.0; ///< share of pixels that are not white
};

Picture readPicture(const std::string& path) {
    Picture picture;
    cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
    REQUIRE(cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS);
    picture.width = cairo_image_surface_get_width(surface);
    picture.height = cairo_image_surface_get_height(surface);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    std::size_t count = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const unsigned char* p = data + y * cairo_image_surface_get_stride(surface) + 4 * x;
            count += p[0] != 255 || p[1] != 255 || p[2] != 255 ? 1 : 0;
        }
    picture.inked = static_cast<double>(count) / (picture.width * picture.height);
    cairo_surface_destroy(surface);
    return picture;
}

/// First nesting error of a page's elements; empty if there is none.
std::string unbalanced(const std::string& html) {
    static const std::vector<std::string> alone{"meta", "br", "input", "!DOCTYPE"};
    std::vector<std::string> open;
    for (std::size_t i = html.find('<'); i != std::string::npos; i = html.find('<', i)) {
        const bool closing = html[i + 1] == '/';
        const std::size_t start = i + (closing ? 2 : 1);
        const std::string name = html.substr(start, html.find_first_of(" >\n/", start) - start);
        std::size_t end = start;
        for (char quote = 0; html[end] != '>' || quote != 0; ++end)
            if (html[end] == '"')
                quote = quote == 0 ? '"' : 0;
        i = end + 1;
        if (closing) {
            if (open.empty() || open.back() != name)
                return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
            open.pop_back();
        } else if (html[end - 1] != '/' && std::find(alone.begin(), alone.end(), name) == alone.end()) {
            open.push_back(name);
            if (name == "script" || name == "style") // raw text
                i = html.find("</" + name, i);
        }
    }
    return open.empty() ? std::string{} : "<" + open.back() + "> stays open";
}

/// A reference that makes a page not self-contained; empty if there is none.
std::string outsideReference(std::string html) {
    const std::string space = "xmlns=\"http://www.w3.org/2000/svg\"";
    for (std::size_t i = html.find(space); i != std::string::npos; i = html.find(space))
        html.erase(i, space.size());
    for (const char* word : {"http://", "https://", "src=", "<link", "@import", "url(http", "fetch(", "XMLHttpRequest"})
        if (html.find(word) != std::string::npos)
            return word;
    return {};
}

std::string problemsOf(const std::string& html) {
    if (std::string problem = unbalanced(html); !problem.empty())
        return problem;
    if (html.find("NaN") < html.find("<script") || html.find("=\"nan") != std::string::npos ||
        html.find("=\"inf") != std::string::npos)
        return "a number that is not finite";
    std::map<std::string, int> ids;
    const std::string body = html.substr(0, html.rfind("<script>")); // the player's text is no markup
    for (std::size_t i = body.find(" id=\""); i != std::string::npos; i = body.find(" id=\"", i + 1))
        if (++ids[body.substr(i + 5, body.find('"', i + 5) - i - 5)] > 1)
            return "an id twice: " + body.substr(i, 30);
    return outsideReference(html);
}

} // namespace

TEST_CASE("the checker of pages finds errors") {
    CHECK(unbalanced("<p>a<br>b</p>").empty());
    CHECK_FALSE(unbalanced("<p><b></p></b>").empty());
    CHECK_FALSE(unbalanced("<p>").empty());
    CHECK(unbalanced("<script>if (a<b) c();</script>").empty());
    CHECK_FALSE(outsideReference("<img src=\"x\">").empty());
}

TEST_CASE("a stack's report is complete, self-contained and the same twice") {
    const auto recording = test::squeezedStack(30, 120, 4000, 2);
    const Folder a, b;
    REQUIRE(writeReport(recording, a.path).empty());
    REQUIRE(writeReport(recording, b.path).empty());
    for (const auto& entry : fs::directory_iterator(a.path)) {
        const std::string name = entry.path().filename();
        CHECK(record::readText(a.path + "/" + name).value() == record::readText(b.path + "/" + name).value());
    }
    const std::string html = record::readText(a.path + "/report.html").value();
    CHECK(problemsOf(html).empty());
    for (const char* part : {"id=\"force-figure\"", "id=\"energy-figure\"", "id=\"view-before\"", "id=\"view-peak\"",
                             "id=\"view-after\"", "id=\"stage\"", "id=\"scrub\"", "<h2>Results</h2>",
                             "<h2>Parameters</h2>", "<h2>Events</h2>", "<h2>Cycles</h2>", "data-plot="})
        CHECK_THAT(html, Catch::Contains(part));
    struct Expected {
        const char* name;
        int width, height;
        double inked; ///< least share of pixels: frame, ticks and curve alone give several percent
    };
    for (const Expected& e : {Expected{"force.png", 1280, 800, 0.02},
                              {"energy.png", 1280, 800, 0.02},
                              {"before.png", 1200, 0, 0.04},
                              {"peak.png", 1200, 0, 0.04},
                              {"after.png", 1200, 0, 0.04},
                              {"overview.png", 1600, 0, 0.04}}) {
        INFO(e.name);
        const Picture picture = readPicture(a.path + "/" + e.name);
        CHECK(picture.width == e.width);
        CHECK((e.height == 0 ? picture.height > 300 : picture.height == e.height));
        CHECK(picture.inked > e.inked);
        CHECK(picture.inked < 0.6);
    }
}

TEST_CASE("1500 frames of 30 shells of 15 elements stay below 6 MB") {
    const auto recording = test::squeezedStack(30, 1500, 2000);
    const auto frames = keptFrames(recording, 5'000'000);
    CHECK(frames.size() == 1500);
    CHECK(runPage(recording).size() < 6'000'000);
}

TEST_CASE("frames are thinned when they do not fit, but key frames stay") {
    const auto recording = test::squeezedStack(200, 100, 100);
    const auto frames = keptFrames(recording, 100'000);
    CHECK(frames.size() < 40);
    CHECK(frames.front() == 0);
    CHECK(frames.back() == 99);
    for (const auto key : recording.keyFrames)
        CHECK(std::binary_search(frames.begin(), frames.end(), static_cast<std::size_t>(key)));
    CHECK_THAT(runPage(test::squeezedStack(1000, 300, 100)), Catch::Contains(" of 300 frames"));
}

TEST_CASE("a free scene has no force curve and an old one is removed") {
    const Folder folder;
    REQUIRE(writeReport(test::squeezedStack(3, 12, 200), folder.path).empty());
    CHECK(folder.has("force.png"));
    REQUIRE(writeReport(test::rollingRing(), folder.path).empty());
    CHECK_FALSE(folder.has("force.png"));
    CHECK_FALSE(folder.has("peak.png"));
    CHECK(folder.has("start.png"));
    CHECK(folder.has("overview.png"));
    const std::string html = record::readText(folder.path + "/report.html").value();
    CHECK(problemsOf(html).empty());
    CHECK(html.find("force-figure\"") == std::string::npos);
    CHECK(html.find("Force against displacement") == std::string::npos);
}

TEST_CASE("degenerate recordings make reports") {
    record::Recording recording;
    SECTION("nothing at all") {}
    SECTION("one frame") {
        recording = test::rollingRing(1);
    }
    SECTION("no frames but a curve") {
        recording = test::squeezedStack(5, 30, 500);
        recording.frames.clear();
    }
    SECTION("frames but no shells") {
        recording = test::squeezedStack(5, 30, 500);
        recording.shells.clear();
        for (auto& frame : recording.frames)
            frame.shells.clear();
    }
    SECTION("no bodies, outlines, events, numbers") {
        recording = test::squeezedStack(1, 5, 10);
        recording.outlines.clear();
        recording.events.clear();
        recording.summary.clear();
        recording.energy.clear();
        for (auto& frame : recording.frames)
            frame.bodies.clear();
    }
    SECTION("one row") {
        recording = test::squeezedStack(2, 3, 1);
    }
    SECTION("no rows") {
        recording = test::squeezedStack(2, 3, 0);
    }
    SECTION("numbers that are not finite, everywhere") {
        const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
        recording = test::squeezedStack(4, 20, 300);
        for (auto& column : recording.series.columns)
            for (std::size_t i = 0; i < column.size(); i += 3)
                column[i] = i % 2 == 0 ? nan : inf;
        auto& frame = recording.frames[15];
        frame.shells[1].curvature[3] = std::numeric_limits<float>::quiet_NaN();
        frame.shells[2].start[0] = inf;
        frame.shells[3].bending_energy = nan;
        frame.bodies[1].y = nan;
        frame.force = nan;
        frame.contacts.push_back({nan, 0.0, inf, nan, true});
        recording.events.push_back({nan, nan, inf, "snap_fit", "?"});
        recording.energy.emplace_back("odd_J", nan);
    }
    SECTION("all values equal") {
        recording = test::squeezedStack(2, 3, 50);
        for (std::size_t c = 1; c < recording.series.columns.size(); ++c)
            std::fill(recording.series.columns[c].begin(), recording.series.columns[c].end(), 0.0);
    }
    SECTION("key frames that do not exist") {
        recording = test::squeezedStack(2, 3, 50);
        recording.keyFrames = {7, -5, 100};
    }
    SECTION("no scales and markup in names") {
        recording = test::squeezedStack(2, 10, 50);
        recording.R = 0.0;
        recording.B = 0.0;
        recording.scene = "</title><script>alert(1)</script>";
        recording.shells[0].name = "</script><b>";
        recording.events[0].text = "<i>\"&";
        recording.frames[5].phase = "<u>";
        for (auto& shell : recording.shells)
            shell.element_length.clear();
    }
    const Folder folder;
    CHECK(writeReport(recording, folder.path).empty());
    const std::string html = record::readText(folder.path + "/report.html").value();
    CHECK(problemsOf(html).empty());
    CHECK(html.find("alert(1)</script>") == std::string::npos);
}

TEST_CASE("a spike in a million rows is drawn, quickly and small") {
    auto recording = test::squeezedStack(2, 10, 10);
    auto& columns = recording.series.columns;
    for (auto& column : columns)
        column.assign(1'000'000, 0.0);
    for (std::size_t i = 0; i < columns[0].size(); ++i) {
        columns[0][i] = 1e-4 * static_cast<double>(i);
        columns[1][i] = 1e-7 * static_cast<double>(i);
        columns[2][i] = 0.1;
    }
    columns[2][654'321] = 7.0;
    recording.events.clear();
    const std::string html = runPage(recording);
    CHECK(html.size() < 1'000'000);
    CHECK_THAT(html, Catch::Contains("peak 7.00 N"));
    CHECK(problemsOf(html).empty());
}

TEST_CASE("an unwritable place is an error message") {
    CHECK_THAT(writeReport(test::rollingRing(1), "/proc/nowhere"), Catch::Contains("/proc/nowhere"));
}

TEST_CASE("templates are filled once, and unknown names stay") {
    CHECK(fillTemplate("a {{x}} b {{y}}{{z}} {{", {{"x", "1"}, {"y", "{{x}}"}}) == "a 1 b {{x}}{{z}} {{");
    PageBuilder page("<heading>");
    page.section("<a>", "<p>b</p>").section("empty", "").script("c();\n");
    const std::string html = page.html();
    CHECK(problemsOf(html).empty());
    CHECK_THAT(html, Catch::Contains("<h1>&lt;heading&gt;</h1>") && Catch::Contains("<h2>&lt;a&gt;</h2><p>b</p>") &&
                         Catch::Contains("<script>\nc();\n</script>") && !Catch::Contains("empty"));
}

TEST_CASE("a picture that is too large for Cairo is an error, not a crash") {
    CairoCanvas canvas(1e6, 1e6, 1.0);
    canvas.circle({1.0, 1.0}, 1.0, {.fill = Colour::hex(0)});
    CHECK_THAT(canvas.png().error(), Catch::Contains("cannot draw the PNG"));
}

TEST_CASE("the view holds the shells, and not a floor of ten metres") {
    const auto recording = test::squeezedStack(30, 12, 100);
    const View view = viewOf(recording, {6, 11});
    CHECK(view.x.span() < 0.5);
    CHECK(view.y.span() < 0.5);
    CHECK(view.y.lo < 0.0);
}

TEST_CASE("the driven body is found by its travel where no outline says so") {
    auto recording = test::squeezedStack(30, 120, 100);
    for (auto& outline : recording.outlines)
        outline.driven = false;
    CHECK(drivenBodies(recording) == std::vector<bool>{false, true});
}
