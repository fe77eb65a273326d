// The small parts: bytes to text, cells, numbers, units and headings, statements of the header.

#include "tests/plugin/recording/import/support.h"

#include "plugin/recording/import/reading/metadata.h"

using namespace importingtest;
using namespace supercircle::importing;
using Catch::Contains;

namespace {

double numberOf(const std::string& cell, char decimal) {
    double v = 0.0;
    INFO(cell);
    REQUIRE(readCell(cell, {decimal}, v) == Cell::Number);
    return v;
}

Cell kindOf(const std::string& cell, char decimal = '.') {
    double v = 0.0;
    return readCell(cell, {decimal}, v);
}

} // namespace

TEST_CASE("encodings are recognised", "[importing]") {
    CHECK(decode("a;b\n").value().encoding == "UTF-8");
    CHECK(decode("\xEF\xBB\xBF"
                 "a\n")
              .value()
              .utf8 == "a\n");
    CHECK(decode("Pr\xFC"
                 "fkraft\r\n")
              .value()
              .utf8 == "Prüfkraft\r\n");
    CHECK(decode("10 \x80\n").value().utf8 == "10 €\n"); // Windows-1252 where Latin-1 has nothing
    CHECK(decode(std::string("\xFF\xFE"
                             "a\0\xB5\0\n\0",
                             8))
              .value()
              .utf8 == "aµ\n");
    CHECK(decode(std::string("\xFE\xFF"
                             "\0a\0\xB5\0\n",
                             8))
              .value()
              .utf8 == "aµ\n");
    CHECK(decode(std::string("1\0;\0002\0\n\0", 8)).value().encoding == "UTF-16 (little-endian)"); // no mark
    // a surrogate without its partner is no character, and the next one stays
    CHECK(decode(std::string("\xFF\xFE\x00\xD8"
                             "a\0",
                             6))
              .value()
              .utf8 == "\xEF\xBF\xBD"
                       "a");
    CHECK(decode("a\r\nb\n").value().lineEnds == "mixed");
    CHECK(linesOf("a\r\nb\rc\n\nd").size() == 5);
}

TEST_CASE("Cyrillic and Japanese texts are told from Western ones", "[importing]") {
    const std::string cyrillic = "\xC2\xF0\xE5\xEC\xFF, \xF1;\xD1\xE8\xEB\xE0, \xEA\xCD\n"; // Время, с;Сила, кН
    const std::string japanese = "\x8E\x9E\x8A\xD4(sec),\x8E\x8E\x8C\xB1\x97\xCD(N)\n";     // 時間(sec),試験力(N)
    const std::string kana = "\x83\x58\x83\x67\x83\x8D\x81\x5B\x83\x4E\n";                  // ストローク
    CHECK(decode(cyrillic).value().utf8 == "Время, с;Сила, кН\n");
    CHECK(decode(japanese).value().utf8 == "時間(sec),試験力(N)\n");
    CHECK(decode(kana).value().utf8 == "ストローク\n");
    CHECK(decode(cyrillic).value().encoding == "Windows-1251");
    CHECK(decode(japanese).value().encoding == "Shift-JIS");
    CHECK(decode(japanese).value().encodingOdds > 10.0);
    // Western words, with all the accents that other encodings make characters of
    for (const char* western : {"D\xE9placement", "Cr\xE9\xE9\xE9", "l\xE4ngs", "Ma\xDF", "\xD8 10",
                                "22 \xB0"
                                "C",
                                "\xB5m", "Velocit\xE0 \xE8", "\x93quoted\x94", "na\xEFve na\xEFve"}) {
        INFO(western);
        const auto text = decode(western);
        INFO(text.error());
        REQUIRE(text);
        CHECK(text->encoding == "Windows-1252");
    }
    // two letters may be either
    CHECK_THAT(decode("\xEC\xEC;1\n").error(), Contains("--encoding windows-") && Contains("1:1: the text may be"));
    CHECK(decode("\xEC\xEC;1\n", Encoding::Windows1251).value().utf8 == "мм;1\n");
    CHECK(decode("\xEC\xEC;1\n", Encoding::Windows1252).value().utf8 == "ìì;1\n");
    CHECK(decode("\x8E\x9E\xFF\n", Encoding::ShiftJis).value().utf8 == "時\xEF\xBF\xBD\n"); // 0xFF is no character
    for (const Encoding e : {Encoding::Windows1252, Encoding::Windows1251, Encoding::ShiftJis})
        CHECK(encodingOf(optionName(e)) == e);
    CHECK_FALSE(encodingOf("latin"));
}

TEST_CASE("other files than text are refused", "[importing]") {
    CHECK_THAT(decode("").error(), Contains("empty"));
    CHECK_THAT(decode("PK\x03\x04xyz").error(), Contains("spreadsheet") && Contains("export it as CSV"));
    CHECK_THAT(decode("MATLAB 5.0 MAT-file, ...").error(), Contains("MATLAB") && Contains("export it as CSV"));
    CHECK_THAT(decode("\x89HDF\r\n").error(), Contains("MATLAB"));
    CHECK_THAT(decode(std::string("ab\0\0\0\0\0\x01 cdefgh ijkl", 21)).error(), Contains("zero bytes"));
}

TEST_CASE("cells have positions", "[importing]") {
    CHECK(cellsOf("a; \"b;\"\"c\"\"\" ;d", ';') == std::vector<std::string>{"a", "b;\"c\"", "d"});
    CHECK(cellsOf("  1.5 \t 2 ", ' ') == std::vector<std::string>{"1.5", "2"});
    std::vector<std::string_view> cells;
    splitCells("1; 2 ;", ';', cells);
    CHECK(cells == std::vector<std::string_view>{"1", "2", ""});
    CHECK(columnOf("ab;\"c;d\"; e", ';', 0) == 1);
    CHECK(columnOf("ab;\"c;d\"; e", ';', 1) == 4);
    CHECK(columnOf("ab;\"c;d\"; e", ';', 2) == 11);
    CHECK(columnOf("ab;c", ';', 7) == 1);
    CHECK(columnOf(" 1  2", ' ', 1) == 5);
}

TEST_CASE("numbers are read as machines print them", "[importing]") {
    CHECK(numberOf("1234.5", '.') == 1234.5);
    CHECK(numberOf("-1.234,5", ',') == -1234.5);
    CHECK(numberOf("1,234.5", '.') == 1234.5);
    CHECK(numberOf("1'234.5", '.') == 1234.5);
    CHECK(numberOf("1 234,5", ',') == 1234.5);
    CHECK(numberOf("1\xC2\xA0"
                   "234,5",
                   ',') == 1234.5);
    CHECK(numberOf("\xE2\x88\x92"
                   "2.5",
                   '.') == -2.5);
    CHECK(numberOf("+1.2E-3", '.') == 1.2e-3);
    CHECK(numberOf("1,2E-3", ',') == 1.2e-3);
    CHECK(numberOf(".5", '.') == 0.5);
    CHECK(numberOf("-,5", ',') == -0.5);
    CHECK(numberOf("00:01:02.5", '.') == 62.5);
    CHECK(numberOf("1:02,5", ',') == 62.5);
    for (const char* missing : {"", " ", "-", "---", "NaN", "n/a", "null", "#NV"})
        CHECK(kindOf(missing) == Cell::Missing);
    for (const char* text : {"abc", "1.2.3", "12,34,5", "1e", "0x10", "inf", "-inf", "1e999", "5 mm", "1:2:3:4", "--5"})
        CHECK(kindOf(text) == Cell::Text);
    CHECK(kindOf("1.5", ',') == Cell::Text); // neither a decimal mark nor a group of three
}

TEST_CASE("units and their factors", "[importing]") {
    CHECK(unitOf("[mm]").factor == 1e-3);
    CHECK(unitOf("(in)").factor == 0.0254);
    CHECK(unitOf("kN").factor == 1e3);
    CHECK(unitOf("mN").factor == 1e-3);
    CHECK(unitOf("MN").factor == 1e6);
    CHECK(unitOf("lbf").factor == Approx(4.4482216)); // NIST SP 811
    CHECK(unitOf("gf").factor == Approx(9.80665e-3)); // the same
    CHECK(unitOf("µm").factor == 1e-6);
    CHECK(unitOf("min").measures == Quantity::Time);
    CHECK(unitOf("Sek.").factor == 1.0);
    CHECK(unitOf("parsec").measures == Quantity::None);
}

TEST_CASE("headings say quantity and unit", "[importing]") {
    struct Expected {
        const char *name, *unit;
        Quantity quantity;
        double factor;
    };
    const std::vector<Expected> all = {{"Time (s)", "", Quantity::Time, 1.0},
                                       {"Prüfzeit", "min", Quantity::Time, 60.0},
                                       {"Standardkraft [kN]", "", Quantity::Force, 1e3},
                                       {"Load, lbf", "", Quantity::Force, 4.4482216152605},
                                       {"Kraft in N", "", Quantity::Force, 1.0},
                                       {"force/mN", "", Quantity::Force, 1e-3},
                                       {"Compressive displacement (in)", "", Quantity::Displacement, 0.0254},
                                       {"Traversenweg", "mm", Quantity::Displacement, 1e-3},
                                       {"Déplacement (µm)", "", Quantity::Displacement, 1e-6},
                                       {"displacement_m", "", Quantity::Displacement, 1.0},
                                       {"m0_x_mm", "", Quantity::MarkerX, 1e-3},
                                       {"Marker 3 y [cm]", "", Quantity::MarkerY, 1e-2},
                                       {"Winkel", "°", Quantity::Angle, M_PI / 180.0},
                                       {"Extension from Preload (mm)", "", Quantity::Displacement, 1e-3},
                                       {"Time at load (s)", "", Quantity::Time, 1.0},
                                       {"Elapsed Time (hh:mm:ss)", "", Quantity::Time, 1.0},
                                       {"Elongation (microns)", "", Quantity::Displacement, 1e-6},
                                       {"s in mm", "", Quantity::Displacement, 1e-3},
                                       {"N", "", Quantity::Force, 1.0}};
    for (const Expected& e : all) {
        const Heading h = headingOf(e.name, e.unit);
        INFO(e.name << " is " << name(h.quantity) << " in " << h.unit.name);
        CHECK(h.quantity == e.quantity);
        CHECK(h.unitStated);
        CHECK(h.unit.factor == Approx(e.factor));
    }
    for (const char* other : {"Cycle", "Elapsed Cycles", "Temperature (C)", "Strain rate (1/s)", "Loading rate (N/s)",
                              "Tensile stress (MPa)", "Remark"})
        CHECK(headingOf(other, "").quantity == Quantity::None);
    for (const char* velocity : {"Crosshead speed (mm/s)", "velocity_mm_s", "v [mm/s]", "Geschwindigkeit in mm/s"}) {
        CHECK(headingOf(velocity, "").quantity == Quantity::Velocity);
        CHECK(headingOf(velocity, "").unit.factor == Approx(1e-3));
    }
    CHECK(headingOf("Traversengeschwindigkeit", "mm/min").unit.factor == Approx(1e-3 / 60.0));
    CHECK_FALSE(headingOf("Force", "").unitStated);
    CHECK(headingOf("Force", "").unit.factor == 1.0);
    CHECK(headingOf("Force (bananas)", "").unknownUnit == "bananas");
    CHECK(headingOf("Force (kN)", "N").unknownUnit == "kN and N"); // which of them?
    CHECK(headingOf("Force (N)", "N").unknownUnit.empty());
    CHECK(headingOf("Compressive displacement", "").rank > headingOf("Crosshead position", "").rank);
}

TEST_CASE("header entries are read with their units", "[importing]") {
    const std::vector<HeaderEntry> header = {{1, "Operator", "M. Speed"},
                                             {2, "Test speed", "6 mm/min"},
                                             {3, "Sampling rate", "0,1 kHz"},
                                             {4, "Fmax [kN]", "0.0032"},
                                             {5, "Number of points", "500"}};
    const auto speed = metadataValue(header, MetadataKey::Speed);
    REQUIRE(speed);
    CHECK(speed->value == Approx(1e-4));
    CHECK(speed->line == 2);
    CHECK(metadataValue(header, MetadataKey::Rate)->value == Approx(100.0));
    CHECK(metadataValue(header, MetadataKey::PeakForce)->value == Approx(3.2));
    CHECK(metadataValue(header, MetadataKey::Rows)->value == 500.0);
    CHECK_FALSE(metadataValue({{1, "Test speed", "6"}}, MetadataKey::Speed)); // 6 what?
    CHECK_FALSE(metadataValue({{1, "Test speed", "6 mm/N"}}, MetadataKey::Speed));
    CHECK_FALSE(metadataValue({{1, "Strain rate", "50 Hz"}}, MetadataKey::Rate));
    const auto bare = metadataValue({{1, "sample_rate", "1000"}}, MetadataKey::Rate);
    REQUIRE(bare);
    CHECK_FALSE(bare->unitStated);
}

TEST_CASE("headings in an unknown language are read by their units", "[importing]") {
    for (const char* head : {"Tijd [s];Verplaatsing [mm];Kracht [N]", "Χρόνος (s);Μετατόπιση (mm);Δύναμη (N)",
                             "Czas;Przemieszczenie;Siła\ns;mm;N"}) {
        Style s;
        s.head = head;
        s.separator = ';';
        s.decimal = ',';
        const auto all = read(exported(s));
        INFO(head << ": " << all.error());
        REQUIRE(all);
        checkValues(all->runs[0]);
    }
    Style s; // two lengths: which is it?
    s.head = "Tijd [s],Verplaatsing [mm],Breedte [mm]";
    CHECK_THAT(errorOf(exported(s)), Contains("--columns"));
    s.head = "Tijd [s],Verplaatsing [mm],Cycle force [N]"; // not a force of every row
    CHECK_THAT(errorOf(exported(s)), Contains("neither a force"));
}
