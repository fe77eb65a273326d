// Decimal marks that a spreadsheet has taken for marks of thousands.

#include "tests/plugin/recording/import/support.h"

using namespace importingtest;
using Catch::Contains;

namespace {

/// As a spreadsheet with decimal commas shows a number of at most `digits` digits behind a point: what can be a group
/// of thousands loses its mark.
std::string reread(double value, int digits) {
    std::string text = printed(value, digits);
    while (digits > 0 && text.back() == '0')
        text.pop_back();
    if (text.back() == '.')
        text.pop_back();
    const std::size_t point = text.find('.');
    const bool lost = point != std::string::npos && text.size() - point > 3 && text[0] != '0' && text[0] != '-';
    if (!lost) { // two digits behind the mark are no group
        std::replace(text.begin(), text.end(), '.', ',');
        return text;
    }
    text.erase(point, 1);
    for (std::size_t at = text.size(); at > 3; at -= 3)
        text.insert(at - 3, ",");
    return text;
}

/// The head goes from 8 mm to 13 mm and on to 130 mm, at 0.0167 mm a row.
std::string spoiled(double from, int count) {
    std::string text = "Time;Displacement;Force\n(s);(mm);(kN)\n";
    for (int i = 0; i < count; ++i)
        text += printed(0.02 * i, 2, ',') + ";" + reread(from + 0.0167 * i, 4) + ";" +
                printed(0.02 + 0.0001 * i, 4, ',') + "\n";
    return text;
}

} // namespace

TEST_CASE("lost decimal marks are placed by the neighbours", "[importing]") {
    for (const double from : {8.0, 33.3973, 97.1}) { // over one, two and three digits
        const int count = 2000;                      // one cell in a hundred has two digits behind its mark
        const auto all = read(spoiled(from, count));
        INFO("from " << from << " mm: " << all.error());
        REQUIRE(all);
        const std::vector<double>& d = *all->runs[0].signals.find(Quantity::Displacement);
        REQUIRE(d.size() == static_cast<std::size_t>(count));
        CHECK(all->sources[0].lost == 0);
        for (int i = 0; i < count; ++i) // four digits are written
            REQUIRE(std::abs(1e3 * d[static_cast<std::size_t>(i)] - 0.0167 * i) < 1e-4 + 1e-9);
        CHECK_FALSE(all->runs[0].signals.displacementTurned);
        CHECK_THAT(importing::worst(*all), Contains("decimal marks of column 2 \"Displacement\""));
    }
}

TEST_CASE("the raw curve holds the numbers of the file, not those with marks placed", "[importing]") {
    const int count = 2000; // all are drawn
    const auto all = read(spoiled(33.3973, count));
    REQUIRE(all);
    const std::vector<double>& raw = *all->sources[0].raw.find(Quantity::Displacement);
    REQUIRE(raw.size() == static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        std::string text = reread(33.3973 + 0.0167 * i, 4);
        std::replace(text.begin(), text.end(), ',', '.');
        REQUIRE(raw[static_cast<std::size_t>(i)] == Approx(1e-3 * std::stod(text)).epsilon(1e-12)); // one rounding
    }
}

TEST_CASE("marks are taken as they stand if this is asked for", "[importing]") {
    importing::Hints hints;
    hints.accept = {"marks"};
    CHECK_THAT(errorOf(spoiled(33.3973, 2000), hints), Contains("jumps and comes back"));
}

TEST_CASE("marks that no cell shows beyond doubt are not placed", "[importing]") {
    std::string text = "Time;Displacement;Force\n(s);(mm);(kN)\n";
    for (int i = 0; i < 300; ++i) {
        const int digits = 333973 + 167 * i; // every third has lost its last zero
        const std::string whole = std::to_string(i % 3 == 0 ? digits / 10 : digits);
        text += printed(0.02 * i, 2, ',') + ";" + whole.substr(0, whole.size() - 3) + "," +
                whole.substr(whole.size() - 3) + ";" + printed(0.02 + 0.0001 * i, 4, ',') + "\n";
    }
    CHECK_THAT(errorOf(text), Contains("jumps and comes back"));
}

TEST_CASE("honest numbers with three digits behind the mark are left alone", "[importing]") {
    Style s;
    s.head = "time (s);displacement (mm);force (N)";
    s.separator = ';';
    s.decimal = ',';
    s.digits = 3;
    const auto all = read(exported(s));
    REQUIRE(all);
    checkValues(all->runs[0], 1e-3);
    CHECK_THAT(importing::account(*all), !Contains("decimal marks of"));
}
