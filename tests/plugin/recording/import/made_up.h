#pragma once
// Made-up exports of six machines, each with ten faults, and the truth.

#include "tests/plugin/recording/import/support.h"

namespace importingtest {

struct Row {
    double time = 0.0, way = 0.0, force = 0.0; // s, mm, N
};

/// Rest, approach, contact at 1 mm, ramp, return; noise of 10 mN and 0.2 um, the same on every machine.
inline std::vector<Row> truth(double preload) {
    std::vector<Row> all;
    for (int i = 0; i < 600; ++i) {
        const double t = 0.05 * i;
        const double way = t < 2.0 ? 0.0 : t < 16.0 ? 0.5 * (t - 2.0) : 0.5 * (30.0 - t);
        const double noise = std::sin(12.9898 * i * i);
        const double force = preload != 0.0 ? preload + 6.0 * way : std::max(0.0, 6.0 * (way - 1.0));
        all.push_back({t, way + 2e-4 * noise, force + 0.01 * std::sin(78.233 * i * i + noise)});
    }
    return all;
}

struct Machine {
    const char* name;
    std::string above;              ///< lines above the headings
    std::vector<std::string> names; ///< of time, displacement, force and what else
    std::vector<std::string> units; ///< a line of them; empty: they stand in the names
    std::vector<std::string> bare;  ///< names without units
    char separator, decimal;
    double perSecond, perMillimetre, perNewton;
    int digits;
};

inline std::vector<Machine> machines() {
    return {{"load frame A",
             "Results Table 1\nSpecimen label,a\n\n",
             {"Time", "Extension", "Load"},
             {"(s)", "(mm)", "(N)"},
             {"Time", "Extension", "Load"},
             ',',
             '.',
             1.0,
             1.0,
             1.0,
             5},
            {"load frame B",
             "\"Pr\xFC"
             "fprotokoll\";\"7\"\n\"Vorkraft\";0,1;\"N\"\n\n",
             {"Pr\xFC"
              "fzeit",
              "Standardweg", "Standardkraft"},
             {"s", "mm", "kN"},
             {"Pr\xFC"
              "fzeit",
              "Standardweg", "Standardkraft"},
             ';',
             ',',
             1.0,
             1.0,
             1e-3,
             8},
            {"servo-hydraulic",
             "C:\\data\\1.TXT\nAxial Counts\t0\n",
             {"Elapsed Time ", "Disp 1", "Load 1 "},
             {"Sec  ", "mm   ", "N   "},
             {"Elapsed Time", "Disp 1", "Load 1"},
             '\t',
             '.',
             1.0,
             1.0,
             1.0,
             5},
            {"table-top",
             "Name;P1\nSpeed;30;mm/min\n",
             {"Temps (sec)", "Course_Traverse (mm)", "Force (N)"},
             {},
             {"Temps", "Course_Traverse", "Force"},
             ';',
             '.',
             1.0,
             1.0,
             1.0,
             5},
            {"imperial",
             "",
             {"\"Time, min\"", "\"Crosshead, in\"", "\"Load, lbf\""},
             {},
             {"Time", "Crosshead", "Load"},
             ',',
             '.',
             1.0 / 60.0,
             1.0 / 25.4,
             1.0 / 4.4482216152605,
             8},
            {"logger",
             "# logger 3\n",
             {"t_ms", "disp_um", "force_mN"},
             {},
             {"t", "disp", "force"},
             '\t',
             '.',
             1e3,
             1e3,
             1e3,
             3}};
}

enum Fault {
    Sound,
    NoUnits,
    LostDecimals,
    Preload,
    ClockSetBack,
    MixedMarks,
    BlocksAndFooter,
    OtherClock,
    Compression,
    Mangled,
    faults
};
inline const char* const faultNames[] = {"sound",          "no units",    "lost decimals",     "preload",
                                         "clock set back", "mixed marks", "blocks and footer", "other clock",
                                         "compression",    "mangled rows"};

/// A spreadsheet that took the decimal mark for one of thousands: trailing zeros go, groups are marked again.
inline std::string lostDecimal(const std::string& cell, char decimal) {
    std::string digits = cell;
    const std::size_t mark = digits.find(decimal);
    while (mark != std::string::npos && digits.back() == '0')
        digits.pop_back();
    digits.erase(std::remove(digits.begin(), digits.end(), decimal), digits.end());
    const std::size_t first = digits.find_first_not_of("-0");
    digits.erase(0, first == std::string::npos ? digits.size() - 1 : first);
    for (std::size_t at = digits.size(); at > 3; at -= 3)
        digits.insert(at - 3, 1, decimal == '.' ? ',' : '.');
    return (cell[0] == '-' ? "-" : "") + digits;
}

inline std::string written(const Machine& m, Fault fault, const std::vector<Row>& rowsOf) {
    const auto joined = [&](const std::vector<std::string>& cells) {
        std::string line;
        for (std::size_t i = 0; i < cells.size(); ++i)
            line += (i == 0 ? "" : std::string(1, m.separator)) + cells[i];
        return line + "\n";
    };
    std::vector<std::string> names = fault == NoUnits ? m.bare : m.names,
                             units = fault == NoUnits ? std::vector<std::string>{} : m.units;
    if (fault == OtherClock) {
        names.insert(names.begin(), units.empty() ? "Uhrzeit (d)" : "Uhrzeit");
        if (!units.empty())
            units.insert(units.begin(), "d");
    }
    std::string text = m.above + joined(names) + (units.empty() ? "" : joined(units));
    const double sign = fault == Compression ? -1.0 : 1.0;
    for (std::size_t i = 0; i < rowsOf.size(); ++i) {
        const Row& r = rowsOf[i];
        const double clock = r.time - (fault == ClockSetBack && i >= 250 ? rowsOf[250].time : 0.0);
        std::vector<std::string> cells = {printed(clock * m.perSecond, m.digits, m.decimal),
                                          printed(sign * r.way * m.perMillimetre, m.digits, m.decimal),
                                          printed(sign * r.force * m.perNewton, m.digits, m.decimal)};
        if (fault == LostDecimals)
            cells[1] =
                m.separator == ',' ? "\"" + lostDecimal(cells[1], m.decimal) + "\"" : lostDecimal(cells[1], m.decimal);
        if (fault == MixedMarks)
            cells[2] = m.separator == ',' ? "\"" + printed(r.force * m.perNewton, m.digits, ',') + "\""
                                          : printed(r.force * m.perNewton, m.digits, m.decimal == '.' ? ',' : '.');
        if (fault == Mangled && i % 25 == 24)
            cells.insert(cells.begin() + 1, "0");
        if (fault == OtherClock)
            cells.insert(cells.begin(), printed(0.4 + r.time / 86400.0, 9, m.decimal));
        if (fault == BlocksAndFooter && i > 0 && i % 200 == 0)
            text += (i == 400 ? joined(names) + (units.empty() ? "" : joined(units))
                              : "Block " + std::to_string(i / 200) + "\n");
        text += joined(cells);
    }
    if (fault == BlocksAndFooter)
        text += "\nMaximum load" + std::string(1, m.separator) + "36\nend of test\n";
    return text;
}

} // namespace importingtest
