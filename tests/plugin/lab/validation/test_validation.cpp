// Every experiment of `supercircle validate` against its targets. What the figures are relative to and where each
// target comes from is written beside each check (Check::why) and shown here when one is missed.

#include "bridge/box2d/lab_world.h"
#include "plugin/lab/validation/validation.h"

#include <catch2/catch.hpp>

using namespace supercircle;
using namespace supercircle::validation;

namespace {

Settings laboratory(bool quick) {
    Settings s;
    s.host = [](const step::RigidWorldDefinition& d, std::string& error) {
        return std::shared_ptr<step::HostWorld>(bridge::makeWorld(d, error));
    };
    s.scenes = std::string(SC_SOURCE_DIR) + "/scenes";
    s.data = std::string(SC_TEST_DATA) + "/reference";
    s.quick = quick;
    return s;
}

/// Runs one experiment and asserts its checks; those that are missed for an understood reason only if `open`.
void hold(const std::string& id, bool quick, bool open = false) {
    const Experiment e = runOne(laboratory(quick), id);
    INFO(id << ": " << e.failure);
    REQUIRE(e.failure.empty());
    int judged = 0;
    for (const Check& c : e.checks) {
        if (!c.target || c.open != open)
            continue;
        ++judged;
        INFO(c.what << ": ours " << c.measured << ", solved " << c.wanted << ", error " << 100.0 * c.error << " % of "
                    << c.of << ", aimed at " << 100.0 * *c.target << " % (" << c.why << ")");
        CHECK(c.pass());
    }
    CHECK(judged > 0);
}

} // namespace

TEST_CASE("T1: boundary of Type I and II, some angles", "[validation]") {
    hold("T1", true);
}
TEST_CASE("T2: a shell on a cylinder, one curve", "[validation]") {
    hold("T2", true);
}
TEST_CASE("T2: stuck tips and unfolding, one friction", "[validation]") {
    hold("T2s", true);
}
TEST_CASE("T3: two shells, one curve", "[validation]") {
    hold("T3", true);
}
TEST_CASE("T4: cantilevers and frequencies", "[validation]") {
    hold("T4", true);
}
TEST_CASE("T5: plates, ring and floor, some curves", "[validation]") {
    hold("T5", true);
}
TEST_CASE("T6: struts and arches by statics", "[validation]") {
    hold("T6", true);
}
TEST_CASE("T7: a strip pressed lengthwise, one friction", "[validation]") {
    hold("T7", true);
}
TEST_CASE("T8: sliding, rolling, rocking", "[validation]") {
    hold("T8", true);
}
TEST_CASE("T8: a stiff rope round a cylinder, one friction", "[validation]") {
    hold("T8c", true);
}
TEST_CASE("T9: grip, one curve", "[validation]") {
    hold("T9", true);
}

TEST_CASE("all curves and boundaries of the validation", "[validation][slow]") {
    for (const Definition& d : experiments())
        DYNAMIC_SECTION(d.id << ", " << d.title) {
            hold(d.id, false);
        }
}

// What is missed and understood: the right physics is asserted all the same.
TEST_CASE("boundary at 15 arcs for a shallow shell, and by a finite indentation near mu* = 0",
          "[validation][slow][!mayfail]") {
    hold("T1", false, true);
}
TEST_CASE("closed ring at 31 arcs within one per cent", "[validation][slow][!mayfail]") {
    hold("T5", false, true);
}

TEST_CASE("the page holds every experiment and nothing from outside", "[validation]") {
    Settings s = laboratory(true);
    s.filter = "T6";
    const std::vector<Experiment> all = runAll(s);
    REQUIRE(all.size() == 1);
    const auto made = files(all, s);
    REQUIRE(made);
    bool page = false;
    for (const auto& [name, content] : made.value) {
        CHECK(content.size() > 100);
        if (name != "validation.html")
            continue;
        page = true;
        CHECK(content.find("http://www.w3.org/2000/svg") != std::string::npos); // a name space, not an address
        CHECK(content.find("src=") == std::string::npos);
        CHECK(content.find("<link") == std::string::npos);
        CHECK(content.find("id=\"T6\"") != std::string::npos);
    }
    CHECK(page);
}

TEST_CASE("a folder without reference curves is named", "[validation]") {
    Settings s = laboratory(true);
    s.data = "/nowhere/at/all";
    const Experiment e = runOne(s, "T6");
    CHECK(e.failure.find("/nowhere/at/all") != std::string::npos);
}
