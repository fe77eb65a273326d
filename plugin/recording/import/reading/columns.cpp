// Which column is what: headings from the file or the user, specimens side by side, a choice for each quantity.

#include "plugin/recording/import/reading/column_choice.h"

#include "plugin/recording/import/reading/metadata.h"
#include "plugin/recording/import/reading/text.h"

#include <algorithm>

namespace supercircle::importing {

namespace {

bool sameQuantity(const Heading& a, const Heading& b) {
    return a.quantity == b.quantity && a.marker == b.marker;
}

/// A column of numbers or names of specimens or tests, that is none of the quantities.
bool namesSpecimens(const Heading& h) {
    static const std::set<std::string> kThings = {
        "specimen",    "test",    "run",    "probe",   "prufling", "versuch", "lauf",   "eprouvette", "essai",
        "echantillon", "probeta", "ensayo", "muestra", "provino",  "prova",   "sample", "trial"};
    static const std::set<std::string> kNumbers = {"no", "nr",   "num",   "number", "nummer",
                                                   "id", "name", "label", "numero"};
    if ((h.quantity != Quantity::None && h.quantity != Quantity::Counter) || h.unit.measures != Quantity::None)
        return false;
    std::string word;
    bool thing = false, rest = true;
    for (const char c : folded(h.text) + " ")
        if (c >= 'a' && c <= 'z') {
            word += c;
        } else if (!word.empty()) {
            bool known = kThings.count(word) > 0;
            for (const std::string& n : kNumbers) // "specimenid", "probennummer"
                if (word.size() > n.size() && word.compare(word.size() - n.size(), n.size(), n) == 0) {
                    const std::string stem = word.substr(0, word.size() - n.size());
                    known = known || kThings.count(stem) > 0 || kThings.count(stem.substr(0, stem.size() - 1)) > 0;
                }
            thing = thing || known;
            rest = rest && (known || kNumbers.count(word) > 0);
            word.clear();
        }
    return thing && rest;
}

/// Reports the columns; many markers in one line.
void tellColumns(Draft& d, bool alone) {
    Table& t = d.table;
    const Layout& l = t.layout;
    const auto isMarker = [&](std::size_t c) {
        return t.headings[c].quantity == Quantity::MarkerX || t.headings[c].quantity == Quantity::MarkerY;
    };
    std::size_t count = 0, firstMarker = 0, lastMarker = 0;
    for (std::size_t c = 0; c < l.columns; ++c)
        if (t.channelOf[c] >= 0 && isMarker(c)) {
            firstMarker = count++ == 0 ? c : firstMarker;
            lastMarker = c;
        }
    std::string idle;
    for (std::size_t c = 0; c < l.columns; ++c) {
        const Heading& h = t.headings[c];
        if (c == t.specimenColumn)
            remark(t, Remark::Kind::Understood, l.namesLine, columnText(t, c) + " names specimens or tests");
        else if (alone && h.quantity == Quantity::None && !h.text.empty() && h.text != "-")
            idle += (idle.empty() ? "column " : ", ") + std::to_string(c + 1) + " \"" + h.text + "\"";
        if (t.channelOf[c] < 0)
            continue;
        if (count > 2 && lastMarker - firstMarker + 1 == count && isMarker(c) &&
            h.unit.name == t.headings[firstMarker].unit.name) {
            if (c == firstMarker)
                remark(t, Remark::Kind::Understood, l.namesLine,
                       "columns " + std::to_string(firstMarker + 1) + " to " + std::to_string(lastMarker + 1) +
                           " hold markers, " + h.marker + " to " + t.headings[lastMarker].marker + ", x and y [" +
                           h.unit.name + "]");
            continue;
        }
        const std::string unit = h.quantity == Quantity::Counter ? "" : " [" + h.unit.name + "]";
        const std::string what =
            columnText(t, c) + " is " + name(h.quantity) + (h.marker.empty() ? "" : " of " + h.marker) + unit;
        if (h.byUnit)
            remark(t, Remark::Kind::Assumed, l.namesLine, what + ", by its unit: the word is not known");
        else if (h.unitStated || h.quantity == Quantity::Counter)
            remark(t, Remark::Kind::Understood, l.unitsLine > 0 ? l.unitsLine : l.namesLine, what);
        else
            remark(t, Remark::Kind::Assumed, l.namesLine, what + ": no unit is stated, and its numbers have fractions");
    }
    if (!idle.empty())
        remark(t, Remark::Kind::Omitted, l.namesLine, idle + ": not needed here");
}

/// One velocity checks the displacement or stands for it; several are not worth a question.
void dropVelocities(Table& t) {
    std::size_t count = 0;
    for (std::size_t c = 0; c < t.layout.columns; ++c)
        count += t.headings[c].quantity == Quantity::Velocity && t.layout.numeric[c] ? 1 : 0;
    for (std::size_t c = 0; c < t.layout.columns; ++c)
        if (Heading& h = t.headings[c]; h.quantity == Quantity::Velocity && (count > 1 || !t.layout.numeric[c])) {
            h.quantity = Quantity::None;
            remark(t, Remark::Kind::Omitted, t.layout.namesLine,
                   columnText(t, c) +
                       (count > 1 ? " is one of several velocities: none is used" : " holds no numbers"));
        }
}

/// An angular velocity belongs to an angle that swings freely; several, or one beside a force, are not needed.
void dropAngularVelocities(Table& t) {
    const auto count = [&](Quantity q) {
        std::size_t n = 0;
        for (std::size_t c = 0; c < t.layout.columns; ++c)
            n += t.headings[c].quantity == q && t.layout.numeric[c] ? 1 : 0;
        return n;
    };
    const bool used =
        count(Quantity::AngularVelocity) == 1 && count(Quantity::Angle) == 1 && count(Quantity::Force) == 0;
    for (std::size_t c = 0; c < t.layout.columns; ++c)
        if (Heading& h = t.headings[c]; h.quantity == Quantity::AngularVelocity && (!used || !t.layout.numeric[c]))
            h.quantity = Quantity::None;
}

/// A file with a clock that cannot be read is not one without times.
Status checkClock(Draft& d, std::size_t unread, const Hints& hints) {
    const Table& t = d.table;
    const bool known = std::any_of(d.chosen.begin(), d.chosen.end(),
                                   [&](std::size_t c) { return t.headings[c].quantity == Quantity::Time; });
    if (unread == t.layout.columns || known || hints.rate > 0.0 || hints.speed > 0.0 ||
        metadataValue(t.layout.metadata, MetadataKey::Rate) || metadataValue(t.layout.metadata, MetadataKey::Speed))
        return {};
    d.wrong = unread;
    return Status::failure(columnText(t, unread) +
                           " is a time that cannot be read; expected numbers, hh:mm:ss, or rows of equal distance "
                           "with --rate HZ (or --speed MM_PER_S)");
}

/// Times are not made up beside a column that may hold them. What the user or the header states counts, with a doubt.
Status checkUnusedClock(Draft& d, const Hints& hints) {
    Table& t = d.table;
    const auto uses = [&](Quantity q) {
        return std::any_of(d.chosen.begin(), d.chosen.end(),
                           [&](std::size_t c) { return t.headings[c].quantity == q; });
    };
    if (uses(Quantity::Time) || !uses(Quantity::Displacement) || !hints.columns.empty() || hints.rate > 0.0 ||
        hints.speed > 0.0)
        return {};
    const bool stated =
        metadataValue(t.layout.metadata, MetadataKey::Rate) || metadataValue(t.layout.metadata, MetadataKey::Speed);
    for (std::size_t c = 0; c < t.layout.columns; ++c) {
        if (!t.layout.numeric[c] || t.headings[c].quantity != Quantity::None || !mayBeClock(d, c))
            continue;
        const std::string what = columnText(t, c) +
                                 (t.headings[c].unit.measures == Quantity::Time ? " has a unit of time"
                                                                                : " runs on evenly, as a clock does") +
                                 ", but no column is named a time; ";
        if (stated) {
            remark(t, Remark::Kind::Doubtful, t.layout.namesLine,
                   what + "the header gives the times instead (name the column with --columns " + columnsOf(t, c) +
                       ")");
            return {};
        }
        d.wrong = c;
        return Status::failure(
            what + "if it is one, state --columns " + columnsOf(t, c) +
            ", else --rate HZ or --speed MM_PER_S; rows that were read at rest, such as "
            "deflections at weights, need a scene, for instance --columns force[kgf],displacement[mm] "
            "--scene cantilever_weights");
    }
    return {};
}

Status choose(Draft& d, const Hints& hints, bool alone) {
    Table& t = d.table;
    const Layout& l = t.layout;
    dropVelocities(t);
    dropAngularVelocities(t);
    std::size_t unreadClock = l.columns;
    std::vector<char> done(l.columns, 0);
    for (std::size_t c = 0; c < l.columns; ++c) {
        if (done[c] || t.headings[c].quantity == Quantity::None)
            continue;
        std::vector<std::size_t> candidates;
        for (std::size_t k = c; k < l.columns; ++k) {
            if (!sameQuantity(t.headings[c], t.headings[k]))
                continue;
            done[k] = 1;
            if (l.numeric[k])
                candidates.push_back(k);
            else {
                unreadClock = t.headings[k].quantity == Quantity::Time ? k : unreadClock;
                remark(t, Remark::Kind::Omitted, l.namesLine, columnText(t, k) + " holds no numbers");
            }
        }
        if (candidates.empty())
            continue;
        if (Status usable = checkUnit(d, candidates); !usable)
            return usable;
        if (Status one = chooseOne(d, candidates); !one)
            return one;
    }
    const auto uses = [&](Quantity q) {
        return std::find_if(d.chosen.begin(), d.chosen.end(),
                            [&](std::size_t c) { return t.headings[c].quantity == q; });
    };
    if (uses(Quantity::Counter) != d.chosen.end() && (uses(Quantity::Time) != d.chosen.end() || d.chosen.size() == 1)) {
        t.headings[*uses(Quantity::Counter)].quantity = Quantity::None; // there is a clock
        d.chosen.erase(std::find_if(d.chosen.begin(), d.chosen.end(),
                                    [&](std::size_t c) { return t.headings[c].quantity == Quantity::None; }));
    }
    if (Status readable = checkClock(d, unreadClock, hints); !readable)
        return readable;
    if (Status asked = alone ? checkUnusedClock(d, hints) : Status(); !asked)
        return asked;
    if (Status complete = completeUnits(d, hints); !complete)
        return complete;
    std::sort(d.chosen.begin(), d.chosen.end());
    t.channelOf.assign(l.columns, -1);
    for (const std::size_t c : d.chosen) {
        t.channelOf[c] = static_cast<int>(t.signals.channels.size());
        t.signals.channels.push_back({t.headings[c].quantity, t.headings[c].marker, {}});
    }
    for (std::size_t c = 0; c < l.columns && alone; ++c)
        if (t.channelOf[c] < 0 && namesSpecimens(t.headings[c]))
            t.specimenColumn = c;
    tellColumns(d, alone);
    return {};
}

/// Names of half as many columns as the rows have cells, each pair a whole number and digits: unquoted decimal commas
/// between commas. Empty: they are none.
std::string tornNumbers(const std::vector<std::string_view>& lines, const Layout& l) {
    const auto isWhole = [](std::string_view cell, bool first) {
        if (first && !cell.empty() && (cell[0] == '-' || cell[0] == '+'))
            cell.remove_prefix(1);
        return !cell.empty() && cell.find_first_not_of("0123456789") == std::string_view::npos;
    };
    std::size_t names = 0;
    for (std::size_t i = l.firstDataLine - 1; i-- > 0 && i + 5 > l.firstDataLine && names == 0;) {
        const std::vector<std::string> cells = cellsOf(lines[i], ',');
        const bool words = std::none_of(cells.begin(), cells.end(), [&](const auto& c) { return isWhole(c, true); });
        names = words && 2 * cells.size() == l.columns ? i + 1 : 0;
    }
    if (l.separator != ',' || names == 0)
        return {};
    std::size_t rows = 0, torn = 0;
    for (const std::size_t i : sampledLines(lines.size())) {
        std::vector<std::string_view> cells;
        splitCells(lines[i], ',', cells);
        if (i + 1 < l.firstDataLine || cells.size() != l.columns)
            continue;
        ++rows;
        bool all = true;
        for (std::size_t c = 0; c < cells.size(); ++c)
            all = all && isWhole(cells[c], c % 2 == 0);
        torn += all ? 1 : 0;
    }
    if (rows < 2 || torn < rows)
        return {};
    return "line " + std::to_string(names) + " has " + std::to_string(l.columns / 2) + " cells, the rows have " +
           std::to_string(l.columns) +
           ": decimal commas cannot be told from the commas between cells; export again with semicolons or tabs "
           "between the cells, with decimal points, or with quotes around the numbers";
}

/// Headings from the file or from the hints.
Status readHeadings(Table& t, const Hints& hints) {
    const Layout& l = t.layout;
    if (!hints.columns.empty() && hints.columns.size() != l.columns)
        return Status::failure(std::to_string(hints.columns.size()) + " columns are named, but the table has " +
                               std::to_string(l.columns) +
                               "; expected one name per column, \"-\" for one that is not used");
    for (std::size_t c = 0; c < l.columns; ++c) {
        if (hints.columns.empty()) {
            t.headings.push_back(headingOf(l.names[c], l.units[c]));
            continue;
        }
        t.headings.push_back(headingOf(hints.columns[c], ""));
        if (hints.columns[c] != "-" && t.headings.back().quantity == Quantity::None)
            return Status::failure(
                "\"" + hints.columns[c] +
                "\" is no quantity; expected time, displacement, force, angle, NAME_x, NAME_y or -, with a unit in "
                "brackets: \"force[kN]\"");
    }
    return {};
}

bool isMeasured(Quantity q) {
    return q == Quantity::Time || q == Quantity::Displacement || q == Quantity::Force;
}

/// Headings in a language that is not known: the only column with a unit of time, length or force, where no heading
/// names the quantity.
void readUnits(Table& t) {
    for (const Quantity q : {Quantity::Time, Quantity::Displacement, Quantity::Force}) {
        std::size_t count = 0, found = 0;
        bool named = false;
        for (std::size_t c = 0; c < t.layout.columns; ++c) {
            const Heading& h = t.headings[c];
            named = named || h.quantity == q;
            if (h.quantity != Quantity::None || h.other || h.unit.measures != q || !t.layout.numeric[c])
                continue;
            ++count;
            found = c;
        }
        if (named || count != 1)
            continue;
        t.headings[found].quantity = q;
        t.headings[found].rank = 1;
        t.headings[found].unitStated = t.headings[found].byUnit = true;
    }
}

/// First column of each specimen where specimens stand side by side: the same quantities in the same order, each with
/// its own clock or under its own title. Empty: the table has one specimen.
std::vector<std::size_t> specimensOf(const Table& t) {
    std::vector<std::size_t> at;
    for (std::size_t c = 0; c < t.layout.columns; ++c)
        if (t.layout.numeric[c] && isMeasured(t.headings[c].quantity))
            at.push_back(c);
    for (const std::size_t period : {std::size_t{3}, std::size_t{2}}) {
        if (at.size() < 2 * period || at.size() % period != 0)
            continue;
        bool repeats = true, titled = true;
        std::set<Quantity> first;
        for (std::size_t i = 0; i < at.size(); ++i) {
            repeats = repeats && t.headings[at[i]].quantity == t.headings[at[i % period]].quantity;
            titled = titled && (i % period != 0 || !t.layout.titles[at[i]].empty());
            if (i < period)
                first.insert(t.headings[at[i]].quantity);
        }
        if (!repeats || first.size() != period || first.count(Quantity::Force) == 0 ||
            (first.count(Quantity::Time) == 0 && !titled))
            continue;
        std::vector<std::size_t> starts;
        for (std::size_t i = 0; i < at.size(); i += period)
            starts.push_back(at[i]);
        return starts;
    }
    return {};
}

std::string titleOf(const Layout& l, std::size_t from, std::size_t to, std::size_t number) {
    for (std::size_t c = from; c < to; ++c)
        if (!l.titles[c].empty())
            return l.titles[c];
    return "specimen " + std::to_string(number);
}

} // namespace

std::string columnText(const Table& t, std::size_t c) {
    const std::string& text = t.headings[c].text;
    return "column " + std::to_string(c + 1) + (text.empty() ? "" : " \"" + text + "\"");
}

Result<std::vector<Table>> chooseColumns(const std::vector<std::string_view>& lines, Layout&& layout,
                                         const Hints& hints) {
    using Tables = Result<std::vector<Table>>;
    Table whole;
    whole.layout = std::move(layout);
    const Layout& l = whole.layout;
    const std::size_t heading = l.namesLine > 0 ? std::max(l.namesLine, l.unitsLine) : l.firstDataLine;
    const auto failed = [&](const std::string& why, std::size_t column) {
        return Tables::failure(std::to_string(heading) + ":" +
                               std::to_string(columnOf(lines[heading - 1], l.separator, column)) + ": " + why);
    };
    if (l.namesLine == 0 && hints.columns.size() != l.columns)
        if (const std::string torn = tornNumbers(lines, l); !torn.empty())
            return failed(torn, 0);
    if (const Status read = readHeadings(whole, hints); !read)
        return failed(read.error(), 0);
    if (hints.columns.empty())
        readUnits(whole);
    std::vector<std::size_t> starts = specimensOf(whole);
    const bool alone = starts.empty();
    if (alone)
        starts = {0};
    starts.push_back(l.columns);
    std::vector<Table> tables;
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
        Draft d{lines, whole, {}, 0};
        for (std::size_t c = 0; c < l.columns && !alone; ++c)
            if (c < starts[k] || c >= starts[k + 1])
                d.table.headings[c].quantity = Quantity::None;
        if (!alone)
            d.table.specimen = titleOf(l, starts[k], starts[k + 1], k + 1);
        if (const Status chosen = choose(d, hints, alone); !chosen)
            return failed(chosen.error(), d.wrong);
        if (d.table.signals.channels.empty()) {
            std::string names;
            for (const std::string& n : l.names)
                names += (names.empty() ? "\"" : ", \"") + n + "\"";
            return failed((l.namesLine == 0 ? "there are no headings" : "no column is recognised among " + names) +
                              "; expected time, displacement and force, or name them with --columns " +
                              exampleOfColumns(l.columns),
                          0);
        }
        tables.push_back(std::move(d.table));
    }
    return tables;
}

} // namespace supercircle::importing
