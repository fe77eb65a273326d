#include <catch2/catch.hpp>

#include <bit>
#include <cmath>

#include "plugin/recording/table/csv.h"
#include "tests/plugin/recording/table/example.h"

using namespace supercircle;
using namespace supercircle::record;

namespace {

std::string messageOf(const std::string& text, const CsvOptions& options = {}) {
    return parseCsv(text, "run.csv", options).error();
}

} // namespace

TEST_CASE("a series reads back bit for bit and is written the same again") {
    const Series series = test::smallRecording().series;
    const auto text = csvText(series);
    REQUIRE(text);
    const auto back = parseCsv(*text, "x");
    REQUIRE(back);
    CHECK(back->names == series.names);
    for (std::size_t c = 0; c < series.columns.size(); ++c)
        for (std::size_t i = 0; i < series.rows(); ++i) {
            const double a = series.columns[c][i], b = back->columns[c][i];
            CHECK((std::isnan(a) ? std::isnan(b) : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b)));
        }
    CHECK(csvText(*back).value() == *text);
}

TEST_CASE("what spreadsheets do to CSV is understood") {
    const auto r =
        parseCsv("\xEF\xBB\xBF# a comment\r\n\"force, N\", time_s ,note\r\n\r\n 1.5 ,2,\"a \"\"b\"\"\"\r\n,3,x", "x",
                 {',', {"time_s"}, {"note"}});
    REQUIRE(r.error().empty());
    CHECK(r->names == std::vector<std::string>{"force, N", "time_s"});
    CHECK(r->columns[0][0] == 1.5);
    CHECK(std::isnan(r->columns[0][1]));
    CHECK(r->columns[1] == std::vector<double>{2.0, 3.0});
    const auto tabs = parseCsv("a\tb\n1\t\n", "x", {'\t', {}, {}});
    REQUIRE(tabs);
    CHECK(std::isnan(tabs->columns[1][0]));
}

TEST_CASE("a cell is quoted where it would read back as another text") {
    CHECK(csvCell("a b#c") == "a b#c");
    CHECK(csvCell("a,b") == "\"a,b\"");
    CHECK(csvCell("say \"a\"") == "\"say \"\"a\"\"\"");
    CHECK(csvCell("a\nb") == "\"a b\"");
    CHECK(csvCell(" a") == "\" a\"");
    CHECK(csvCell("# a") == "\"# a\"");
    CHECK(csvCell("").empty());
    const std::vector<std::string> names = {"force, N", "# a", " b ", "c \"d\"", "e f"};
    const auto text = csvText({names, std::vector<std::vector<double>>(5, {1.0})});
    REQUIRE(text);
    const auto back = parseCsv(*text, "x");
    REQUIRE(back);
    CHECK(back->names == names);
}

TEST_CASE("errors name file, line and column") {
    CHECK(messageOf("") == "run.csv:1:1: no header line: expected the column names");
    CHECK(messageOf("a,b\n1,2\n3,x\n") == "run.csv:3:3: 'x' in column 'b' is not a number");
    CHECK(messageOf("a,b\n1\n") == "run.csv:2:2: 1 cells, but 2 columns");
    CHECK(messageOf("a,b\n1,2,3\n") == "run.csv:2:5: 3 cells, but 2 columns");
    CHECK(messageOf("a,a\n") == "run.csv:1:3: column 'a' appears twice");
    CHECK(messageOf("a,,b\n") == "run.csv:1:3: column without a name");
    CHECK(messageOf("a\n\"1\n") == "run.csv:2:1: quote is not closed");
    CHECK(messageOf("a,b\n", {',', {"force_N"}, {}}) == "run.csv:1:1: no column 'force_N'; there are 'a', 'b'");
    CHECK_THAT(readCsv("/nowhere/x.csv").error(),
               Catch::Contains("/nowhere/x.csv") && Catch::Contains("there is no such file"));
}

TEST_CASE("a series with columns of different lengths is refused") {
    CHECK_THAT(csvText({{"a", "b"}, {{1.0, 2.0}, {1.0}}}).error(), Catch::Contains("column 'b' has 1 rows"));
    CHECK_FALSE(csvText({{"a"}, {}}));
}

TEST_CASE("resampling a line is exact, ends hold and jumps take their last value") {
    const auto r = resample({0.0, 1.0, 1.0, 3.0}, {0.0, 2.0, 5.0, 9.0}, {-1.0, 0.0, 0.25, 1.0, 2.0, 3.0, 4.0});
    REQUIRE(r);
    CHECK(*r == std::vector<double>{0.0, 0.0, 0.5, 5.0, 7.0, 9.0, 9.0});
}

TEST_CASE("resampling refuses what has no order") {
    CHECK_THAT(resample({0.0, 2.0, 1.0}, {0.0, 0.0, 0.0}, {0.5}).error(), Catch::Contains("decreases at row 2"));
    CHECK_THAT(resample({0.0, std::nan("")}, {0.0, 0.0}, {0.5}).error(), Catch::Contains("not a number at row 1"));
    CHECK_FALSE(resample({}, {}, {0.5}));
    CHECK_FALSE(resample({0.0}, {0.0, 1.0}, {0.5}));
    CHECK_THAT(resampleSeries(Series{{"a"}, {{1.0}}}, "t", {}).error(),
               Catch::Contains("no column 't'; there are 'a'"));
    const auto all = resampleSeries(Series{{"t", "f"}, {{0.0, 1.0}, {0.0, 4.0}}}, "t", {0.5, 2.0});
    REQUIRE(all);
    CHECK(all->columns == std::vector<std::vector<double>>{{0.5, 2.0}, {2.0, 4.0}});
}
