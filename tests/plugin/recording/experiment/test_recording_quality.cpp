// Recordings with implausible readings: rejected with a reason, or corrected with a note.

#include "tests/plugin/recording/experiment/support.h"

#include "plugin/recording/experiment/recording_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

using namespace experimenttest;
using Catch::Contains;

namespace {

/// A baseline case without markers, with synthetic readings and stated noise: 26 s, 24 mm loading and unloading.
struct Made {
    double rate = 25.0;
    std::function<double(double)> force = [](double t) { return 0.06 * std::sin(M_PI * t / 26.0); };
    double displacementFactor = 1.0; ///< of the column against the commanded motion
};

double commanded(double t) {
    return t < 1.0 ? 0.0 : t < 13.0 ? 2.0 * (t - 1.0) : t < 25.0 ? 2.0 * (25.0 - t) : 0.0;
}

std::string csv(const Made& m) {
    std::string text = "time_s,displacement_mm,force_N\n";
    const int rows = static_cast<int>(26.0 * m.rate);
    text.reserve(static_cast<std::size_t>(rows) * 34);
    for (int i = 0; i < rows; ++i) {
        char line[96];
        const double t = i / m.rate;
        std::snprintf(line, sizeof line, "%.7f,%.6f,%.9g\n", t, m.displacementFactor * commanded(t), m.force(t));
        text += line;
    }
    return text;
}

std::string description(const std::string& rate = "25") {
    std::string text = contentOf(baseline(101));
    text = with(text, "\"markers_file\": \"run_1_markers.csv\",", "");
    text = with(text, "\"sampling_hz\": 25", "\"sampling_hz\": " + rate);
    return with(text, "\"force_noise_std_N_approx\": 1e-07", "\"force_noise_std_N_approx\": 0.001");
}

struct Loaded {
    Result<experiment::Experiment> experiment;
    std::string text; ///< all problems and notes
};

Loaded loadRuns(const std::string& runs, const std::string& text = description()) {
    const Folder folder;
    folder.write("run_1.csv", runs);
    std::vector<scene::Problem> problems;
    Loaded l{experiment::load(folder.write("experiment.json", text), problems), {}};
    for (const scene::Problem& p : problems)
        l.text += p.toString() + "\n";
    INFO(l.text);
    CHECK(bool(l.experiment) == !scene::anyError(problems));
    return l;
}

/// Rejected with these messages.
void refused(const Loaded& l, const std::string& words) {
    INFO(l.text);
    CHECK_FALSE(l.experiment);
    CHECK_THAT(l.text, Contains(words) && !Contains("note:"));
}

} // namespace

TEST_CASE("a valid recording has no remarks", "[experiment][health]") {
    const Loaded l = loadRuns(csv({}));
    INFO(l.text);
    REQUIRE(l.experiment);
    CHECK(l.text.empty());
}

TEST_CASE("an empty recording is refused", "[experiment][health]") {
    refused(loadRuns(""), "run_1.csv:1:1: no header line");
    refused(loadRuns("time_s,displacement_mm,force_N\n"), "a header and no rows");
    refused(loadRuns("time_s,displacement_mm,force_N\n0,0,0\n"), "one row");
}

TEST_CASE("a constant force is refused", "[experiment][health]") {
    Made m;
    m.force = [](double) { return 0.25; };
    refused(loadRuns(csv(m)), "force_N is 0.25 in every row; expected a force that changes");
}

TEST_CASE("a constant displacement is refused", "[experiment][health]") {
    Made m;
    m.displacementFactor = 0.0;
    refused(loadRuns(csv(m)), "displacement_mm is 0 in every row, though drive_displacement_mm moves by 24 mm");
}

TEST_CASE("missing samples are ignored, with a note", "[experiment][health]") {
    std::string text = csv({});
    text = with(text, "\n10.0000000,18.000000,", "\n10.0000000,nan,nan #");
    text = text.replace(text.find(" #"), text.find('\n', text.find(" #")) - text.find(" #"), "");
    const Loaded l = loadRuns(text);
    INFO(l.text);
    REQUIRE(l.experiment);
    CHECK_THAT(l.text, Contains("note: 1 of 650 values of force_N are missing") &&
                           Contains("note: 1 of 650 values of displacement_mm are missing"));
    const experiment::Readings& r = l.experiment->runs[0].readings;
    CHECK(std::isnan(r.force[250]));
    CHECK(r.displacement[250] == Approx(0.018)); // as commanded
}

TEST_CASE("a force that is mostly missing is refused", "[experiment][health]") {
    Made m;
    m.force = [](double t) { return t < 8.0 ? 0.01 * t : std::nan(""); };
    refused(loadRuns(csv(m)), "450 of 650 values of force_N are missing");
}

TEST_CASE("decreasing times are refused with their line", "[experiment][health]") {
    refused(loadRuns(with(csv({}), "\n10.0000000,", "\n9.0000000,")),
            "run_1.csv:252:1: time_s of row 251 (9) is not later than that of the row before it (9.96)");
    refused(loadRuns(with(csv({}), "\n10.0000000,", "\nnan,")), "run_1.csv:252:1: time_s of row 251 is missing");
}

TEST_CASE("another unit of length is recognised against the commanded motion", "[experiment][health]") {
    Made m;
    m.displacementFactor = 1e-3;
    refused(loadRuns(csv(m)), "displacement_mm is 0.001 times drive_displacement_mm: it appears to be in metres");
    m.displacementFactor = 1.0 / 25.4;
    refused(loadRuns(csv(m)), "it appears to be in inches");
    m.displacementFactor = -1.0;
    refused(loadRuns(csv(m)), "displacement_mm runs against drive_displacement_mm");
}

TEST_CASE("another unit of force is recognised by size and noise together", "[experiment][health]") {
    // kilonewtons; B/R^2 is 0.6 N, the stated noise 1 mN
    Made m;
    m.force = [](double t) { return 1e-3 * (0.06 * std::sin(M_PI * t / 26.0) + 1e-3 * std::sin(1e4 * t * t)); };
    refused(loadRuns(csv(m)), "it appears to be in kilonewtons");
    refused(loadRuns(csv(m)), "\"force_unit_confirmed\": true in /sensors (import: --accept units)");
    const Loaded confirmed = loadRuns(csv(m), with(description(), "\"force_noise_std_N_approx\"",
                                                   "\"force_unit_confirmed\": true, \"force_noise_std_N_approx\""));
    CHECK(confirmed.experiment);
    CHECK_THAT(confirmed.text, Contains("note: the largest force"));
    m.force = [](double t) { return 6e-5 * std::sin(M_PI * t / 26.0); }; // no noise: only a doubt
    const Loaded l = loadRuns(csv(m));
    CHECK(l.experiment);
    CHECK_THAT(l.text, Contains("note: the largest force") && Contains("is it in kilonewtons?"));
}

TEST_CASE("a motion other than commanded is refused where it differs most", "[experiment][health]") {
    const Loaded l = loadRuns(csv({}), with(description(), "    13.0,\n", "    19.0,\n"));
    INFO(l.text);
    CHECK_FALSE(l.experiment);
    CHECK_THAT(l.text, Contains("12 mm off the commanded motion at 19 s (12 mm, commanded 24 mm)"));
}

TEST_CASE("a wrong sampling rate is corrected from the times", "[experiment][health]") {
    const Loaded l = loadRuns(csv({}), description("100"));
    REQUIRE(l.experiment);
    CHECK_THAT(l.text, Contains("note: sampling_hz says 100 Hz, the times of the rows 25 Hz"));
    CHECK(l.experiment->runs[0].samplingRate == Approx(25.0));
}

TEST_CASE("very many rows are averaged in blocks, with a note", "[experiment][health]") {
    Made m;
    m.rate = 5000.0;
    const Loaded l = loadRuns(csv(m), description("5000"));
    INFO(l.text);
    REQUIRE(l.experiment);
    CHECK_THAT(l.text, Contains("note: 130000 rows are more than a simulation resolves: blocks of 3 are averaged"));
    const experiment::Readings& r = l.experiment->runs[0].readings;
    CHECK(r.time.size() == 43334);
    CHECK(l.experiment->runs[0].samplingRate == Approx(5000.0 / 3.0));
    for (std::size_t i = 0; i < r.time.size(); i += 1000) // the mean of a smooth curve over a block is its middle
        REQUIRE(r.force[i] == Approx(m.force(r.time[i])).margin(1e-9));
}

TEST_CASE("ten million rows are read", "[experiment][health][slow]") {
    Made m;
    m.rate = 1e7 / 26.0;
    const Loaded l = loadRuns(csv(m), description("384615.4"));
    INFO(l.text);
    REQUIRE(l.experiment);
    CHECK(l.experiment->runs[0].readings.time.size() <= experiment::maxRows);
}

TEST_CASE("a missing file is named", "[experiment][health]") {
    const Folder folder;
    const auto l = experiment::load(folder.write("experiment.json", description()));
    CHECK_THAT(l.error(), Contains("run_1.csv") && Contains("there is no such file"));
}

TEST_CASE("markers in metres are recognised", "[experiment][health]") {
    const Folder folder;
    const std::string source = std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/";
    folder.write("run_1.csv", contentOf(source + "run_1.csv"));
    std::string text = "time_s";
    for (int m = 0; m < 6; ++m)
        text += ",m" + std::to_string(m) + "_x_mm,m" + std::to_string(m) + "_y_mm";
    for (int i = 0; i < 100; ++i) {
        text += "\n" + std::to_string(0.2 * i);
        for (int m = 0; m < 12; ++m)
            text += ",0.0" + std::to_string(12 + m);
    }
    folder.write("run_1_markers.csv", text + "\n");
    const auto l = experiment::load(folder.write("experiment.json", contentOf(baseline(101))));
    CHECK_THAT(l.error(), Contains("with a specimen of 90.48 mm: they appear to be in metres; expected millimetres"));
}

TEST_CASE("statements that contradict each other are found", "[experiment][health]") {
    const std::string good = contentOf(baseline(101));
    CHECK_THAT(
        problemsOf(with(good, "\"bending_modulus_N_m2\": 0.0002291666666666667", "\"bending_modulus_N_m2\": 229.17")),
        Contains("/specimens/0/bending_modulus_N_m2: this is 1e+06 times E w h^3 / 12"));
    CHECK_THAT(problemsOf(with(good, "\"young_modulus_Pa\": 2200000000.0", "\"young_modulus_Pa\": 3200000000.0")),
               Contains("note: /specimens/0/bending_modulus_N_m2: E w h^3 / 12 of the same specimen is 0.0003333"));
    CHECK_THAT(problemsOf(with(good, "\"arc_length_m\": 0.09047786842338604", "\"arc_length_m\": 90.4778")),
               Contains("/specimens/0/arc_length_m: a specimen of 90.48 m"));
    CHECK_THAT(problemsOf(with(good, "\"thickness_m\": 0.0005", "\"thickness_m\": 0.5")),
               Contains("/specimens/0/thickness_m: a thickness of 0.5 m"));
    CHECK_THAT(problemsOf(with(good, "0.0466529", "0.0366529")), Contains("mm deep in obstacle 0"));
    CHECK_THAT(problemsOf(with(good, "\"name\": \"m1\"", "\"name\": \"m0\"")), Contains("two markers \"m0\""));
    CHECK_THAT(problemsOf(with(good, "-9.81", "-9810")), Contains("/gravity_m_s2: gravity of 9810 m/s^2"));
    CHECK_THAT(problemsOf(with(good, "    24,\n", "    24000,\n")),
               Contains("/runs/0/drive_displacement_mm: the crosshead moves"));
}

TEST_CASE("other file formats are reported with the tool that reads them", "[experiment][health]") {
    const std::string good = csv({});
    refused(loadRuns(std::string("t\0i\0m\0e\0", 8)), "run_1.csv:1:1: there are zero bytes in it");
    std::string text = good;
    std::replace(text.begin(), text.end(), ',', ';');
    refused(loadRuns(text),
            "run_1.csv:1:1: cells are separated by semicolons; expected commas; `supercircle import` reads");
    std::replace(text.begin(), text.end(), ';', '\t');
    refused(loadRuns(text), "cells are separated by tabs");
    text = good;
    std::replace(text.begin(), text.end(), '\n', '\r');
    refused(loadRuns(text), "run_1.csv:1:1: its lines end with a carriage return alone");
    refused(loadRuns("ab\x01" + good), "run_1.csv:1:3: a control character");
}

TEST_CASE("a single impossible force is refused with its row", "[experiment][health]") {
    Made m;
    m.force = [](double t) { return std::abs(t - 10.0) < 1e-9 ? 1e300 : 0.06 * std::sin(M_PI * t / 26.0); };
    refused(loadRuns(csv(m)),
            "run_1.csv:252:1: force_N is 1e+300 in this row, and below a hundredth of it in all others");
}

TEST_CASE("infinite values count as missing", "[experiment][health]") {
    const Loaded l = loadRuns(with(csv({}), "\n10.0000000,18.000000,", "\n10.0000000,-inf,"));
    CHECK_THAT(l.text, Contains("note: 1 of 650 values of displacement_mm are missing or infinite"));
}

TEST_CASE("intervals without samples are noted", "[experiment][health]") {
    const std::string good = csv({});
    Loaded l = loadRuns(good.substr(0, good.find("\n12.0000000,") + 1));
    CHECK(l.experiment);
    CHECK_THAT(l.text, Contains("note: there are samples from 0 to 11.96 s of a motion from 0 to 26 s"));
    std::string text = good;
    const std::size_t from = text.find("\n5.0000000,"), to = text.find("\n7.0000000,");
    l = loadRuns(text.erase(from, to - from));
    CHECK(l.experiment);
    CHECK_THAT(l.text, Contains("note: 1 gap in the samples, the longest from 4.96 to 7 s; nothing is compared there"));
}

TEST_CASE("a force with a wrong sign is noted", "[experiment][health]") {
    Made m;
    m.force = [](double t) { return -0.06 * std::sin(M_PI * t / 26.0); };
    const Loaded l = loadRuns(csv(m));
    CHECK(l.experiment);
    CHECK_THAT(l.text, Contains("note: force_N falls first") && Contains("is its sign wrong?"));
}

TEST_CASE("implausible uncertainties, masses and positions are found", "[experiment][health]") {
    const std::string good = contentOf(baseline(101));
    CHECK_THAT(problemsOf(with(good, "\"bending_modulus_rel_unc\": 0.06", "\"bending_modulus_rel_unc\": 1.5")),
               Contains("/specimens/0/bending_modulus_rel_unc: the interval reaches from -0.0001146 to 0.0005729"));
    CHECK_THAT(problemsOf(with(good, "0.006350000000000001", "6350.0")),
               Contains("note: /specimens/0/linear_mass_kg_m: with width and thickness this is a density of 1.27e+09"));
    CHECK_THAT(problemsOf(with(good, "\"coefficient\": 0.3", "\"coefficient\": 30.0")),
               Contains("note: /friction/coefficient: a friction coefficient of 30"));
    CHECK_THAT(problemsOf(with(good, "0.0466529", "3.0466529")), Contains("they never come into contact"));
}
