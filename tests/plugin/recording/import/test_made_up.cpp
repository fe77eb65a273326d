// Made-up exports of six machines, each with ten faults. The truth is known: an export is understood if the values are
// the true ones, asked about if the import ends with a question or a remedy, and wrong otherwise.

#include "tests/plugin/recording/import/change_bytes.h"
#include "tests/plugin/recording/import/made_up.h"

#include <random>
#include <set>
#include <sstream>

using namespace importingtest;

namespace {

enum class Outcome { Understood, Asked, Wrong };

bool close(double a, double b, double slack) {
    return std::abs(a - b) <= slack;
}

Outcome judge(const Result<importing::Imported>& all, const std::vector<Row>& rowsOf, std::string& why) {
    if (!all) {
        why = all.error();
        for (const char* help : {"--", "xport again", "expected", "of its own"})
            if (why.find(help) != std::string::npos)
                return Outcome::Asked;
        return Outcome::Wrong; // a refusal that helps nobody
    }
    if (all->runs.size() != 1 || all->runs[0].signals.rows() != rowsOf.size()) {
        why = std::to_string(all->runs.size()) + " runs, " + std::to_string(all->runs[0].signals.rows()) + " rows";
        return Outcome::Wrong;
    }
    const importing::Signals& s = all->runs[0].signals;
    for (std::size_t i = 0; i < rowsOf.size(); ++i) {
        const Row& r = rowsOf[i];
        const double t = s.find(Quantity::Time)->at(i), d = 1e3 * s.find(Quantity::Displacement)->at(i),
                     f = s.find(Quantity::Force)->at(i);
        // the last digits, the row at which a clock was set back, and the zero of the force, known to its noise
        if (close(t, r.time, 0.051) && close(d, r.way - rowsOf[0].way, 1e-3) && close(f, r.force, 0.02))
            continue;
        why = "row " + std::to_string(i) + ": " + std::to_string(t) + " s, " + std::to_string(d) + " mm, " +
              std::to_string(f) + " N instead of " + std::to_string(r.time) + ", " + std::to_string(r.way) + ", " +
              std::to_string(r.force);
        return Outcome::Wrong;
    }
    return Outcome::Understood;
}

} // namespace

TEST_CASE("sixty made-up exports are understood or asked about", "[importing]") {
    int understood = 0, asked = 0;
    for (const Machine& m : machines())
        for (int k = 0; k < faults; ++k) {
            const auto fault = static_cast<Fault>(k);
            const std::vector<Row> rowsOf = truth(fault == Preload ? 8.0 : 0.0);
            std::string why;
            const Outcome outcome = judge(read(written(m, fault, rowsOf)), rowsOf, why);
            INFO(m.name << ", " << faultNames[k] << ": " << why);
            CHECK(outcome != Outcome::Wrong);
            // what the file says entirely must be understood
            if (fault == Sound || fault == Compression || fault == BlocksAndFooter || fault == OtherClock ||
                fault == ClockSetBack || fault == MixedMarks || fault == Preload)
                CHECK(outcome == Outcome::Understood);
            understood += outcome == Outcome::Understood ? 1 : 0;
            asked += outcome == Outcome::Asked ? 1 : 0;
        }
    CHECK(understood + asked == 60);
    CHECK(understood >= 42);
}

namespace {

/// Changes a few bytes, cells or lines.
std::string mutated(std::mt19937& random, std::string text) {
    const std::string spice = "\n\r\t;,.\"'-+eE0123456789 :#%[]()mkNnaA\xFF\xC3";
    for (auto k = 1 + random() % 4; k > 0 && !text.empty(); --k) {
        // half of the changes go where they hurt: into the head
        const std::size_t at = random() % (random() % 2 == 0 ? std::min<std::size_t>(text.size(), 200) : text.size());
        const std::size_t line = text.find('\n', at);
        switch (const auto kind = random() % 7; kind) {
        case 4: // a character everywhere, as editors and spreadsheets do
            if (const char from = spice[random() % spice.size()], to = spice[random() % spice.size()]; from != '\n')
                std::replace(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), from, to);
            break;
        case 5: // lines swapped, doubled or lost
            if (line != std::string::npos) {
                const std::size_t next = std::min(text.find('\n', line + 1), text.size() - 1);
                const std::string cut = text.substr(line, next - line);
                text.erase(line, next - line);
                for (auto copies = random() % 3; copies > 0; --copies)
                    text.insert(text.find('\n', random() % text.size()) == std::string::npos ? 0 : line, cut);
            }
            break;
        default:
            supercircle::test::changeBytes(text, at, kind, spice, random);
        }
    }
    return text;
}

/// Lines that no change has touched: what a reader must use, or tell about.
std::size_t rowsIn(const std::string& text, const std::set<std::string>& sound) {
    std::size_t rows = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        rows += sound.count(line);
    return rows;
}

/// Of an accepted export at most 1 % of the lines that are still whole are in no run and in no count of lost rows.
void fuzz(std::size_t files, unsigned seed) {
    std::vector<std::string> exports;
    std::vector<std::set<std::string>> sound;
    for (const Machine& m : machines())
        for (const Fault fault : {Sound, Preload, ClockSetBack, BlocksAndFooter, OtherClock, Compression, Mangled}) {
            std::vector<Row> some = truth(fault == Preload ? 8.0 : 0.0), few;
            // short exports are read faster; above a hundred rows a table is found in another way
            for (std::size_t i = 0; i < some.size(); i += exports.size() % 12 == 0 ? 4 : 15)
                few.push_back(some[i]);
            exports.push_back(written(m, fault, few));
            sound.emplace_back();
            std::istringstream lines(written(m, fault == Mangled ? Sound : fault, few));
            for (std::string line; std::getline(lines, line);) // three numbers have many digits, the lines above few
                if (std::count_if(line.begin(), line.end(), [](char c) { return c >= '0' && c <= '9'; }) >= 12)
                    sound.back().insert(line);
        }
    std::mt19937 random(seed); // the same on every machine
    std::size_t accepted = 0;
    for (std::size_t i = 0; i < files; ++i) {
        const std::size_t which = random() % exports.size();
        const std::string text = mutated(random, exports[which]);
        const auto all = importing::readTexts({{"x.csv", text}}, {});
        INFO("file " << i << " of seed " << seed);
        if (!all) {
            REQUIRE_FALSE(all.error().empty());
            continue;
        }
        ++accepted;
        std::size_t used = 0, lost = 0;
        for (const importing::ImportedRun& run : all->runs)
            used += run.signals.rows();
        for (const importing::Source& source : all->sources) {
            lost += source.lost;
            double ignored = 0.0;
            for (const importing::HeaderEntry& told :
                 source.table.layout.metadata) // rows that were pasted into the head
                lost += importing::readCell(told.key, {'.'}, ignored) == importing::Cell::Number ||
                                importing::readCell(told.key, {','}, ignored) == importing::Cell::Number
                            ? 1
                            : 0;
        }
        const std::size_t whole = rowsIn(text, sound[which]);
        if (static_cast<double>(used + lost) >= 0.99 * static_cast<double>(whole) - 1.0)
            continue;
        FAIL(used << " rows used and " << lost << " told as lost of " << whole << "\n"
                  << importing::account(*all) << text);
    }
    CHECK(10 * accepted > files); // else it tests refusals only
}

} // namespace

TEST_CASE("no row of a changed export is lost in silence", "[importing]") {
    fuzz(10000, 3);
}

TEST_CASE("no row of a million changed exports is lost in silence", "[importing][slow]") {
    fuzz(1000000, 4);
}
