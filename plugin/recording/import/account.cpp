// The report in words, and the files of the runs.

#include "plugin/recording/import/import.h"

#include "plugin/recording/table/csv.h"
#include "supercircle/support/printable.h"

#include <cmath>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

std::vector<double> scaled(const std::vector<double>& values, double factor) {
    std::vector<double> out(values);
    for (double& v : out)
        v *= factor;
    return out;
}

record::Series tableOf(const ImportedRun& run) {
    record::Series s;
    if (!run.atRest) {
        s.names = {"time_s"};
        s.columns = {*run.signals.find(Quantity::Time)};
    }
    const auto add = [&](const char* name, Quantity q, double factor) {
        if (const std::vector<double>* v = run.signals.find(q)) {
            s.names.emplace_back(name);
            s.columns.push_back(scaled(*v, factor));
        }
    };
    add("displacement_mm", Quantity::Displacement, 1e3);
    add("force_N", Quantity::Force, 1.0);
    add("angle_deg", Quantity::Angle, 180.0 / M_PI);
    add("spin_deg_s", Quantity::AngularVelocity, 180.0 / M_PI);
    return s;
}

record::Series markersOf(const ImportedRun& run) {
    record::Series s;
    s.names = {"time_s"};
    s.columns = {*run.markers.find(Quantity::Time)};
    for (const Channel& c : run.markers.channels)
        if (isMarker(c)) {
            s.names.push_back(c.marker + (c.quantity == Quantity::MarkerX ? "_x_mm" : "_y_mm"));
            s.columns.push_back(scaled(c.values, 1e3));
        }
    return s;
}

std::string atLine(const Remark& r) {
    return r.line > 0 ? "line " + std::to_string(r.line) + ": " : "";
}

void write(std::string& out, const std::vector<Remark>& remarks) {
    for (const Kind kind : {Kind::Understood, Kind::Assumed, Kind::Doubtful, Kind::Corrected, Kind::Omitted})
        for (const Remark& r : remarks)
            if (r.kind == kind)
                out += "  " + std::string(word(kind)) + std::string(11 - std::string(word(kind)).size(), ' ') +
                       atLine(r) + r.what + "\n";
}

/// Number of doubts, and the first.
std::string doubts(const Imported& all) {
    std::size_t count = 0;
    std::string first;
    const auto look = [&](const Source& source, const std::vector<Remark>& remarks) {
        for (const Remark& r : remarks)
            if (r.kind == Kind::Doubtful && count++ == 0)
                first = printable(source.file + ": " + atLine(r) + r.what);
    };
    for (const Source& source : all.sources)
        look(source, source.table.remarks);
    for (const ImportedRun& run : all.runs)
        look(all.sources[run.source], run.remarks);
    return count == 0 ? "" : (count == 1 ? "1 doubt: " : std::to_string(count) + " doubts, the first: ") + first;
}

} // namespace

std::string worst(const Imported& all) {
    std::size_t lost = 0, rows = 0, odd = 0, used = 0;
    for (const Source& s : all.sources) {
        lost += s.lost;
        rows += s.candidates;
        odd += s.table.odd;
    }
    for (const ImportedRun& run : all.runs) // means of angles and files of markers have other rows
        used += run.signals.find(Quantity::Force) != nullptr ? run.signals.rows() : rows;
    lost = used < rows && all.sources.size() <= all.runs.size() ? rows - used : lost;
    if (lost > 0)
        return std::to_string(lost) + " of " + std::to_string(rows) + " rows were left out";
    if (std::string doubtful = doubts(all); !doubtful.empty())
        return doubtful;
    return odd == 0 ? "every row is used, and nothing is doubtful"
                    : std::to_string(odd) +
                          (odd == 1 ? " line without the numbers of a row was"
                                    : " lines without the numbers of a row were") +
                          " left out; nothing is doubtful";
}

std::string account(const Imported& all) {
    std::string out;
    for (std::size_t i = 0; i < all.sources.size(); ++i) {
        const Source& s = all.sources[i];
        out += s.file + ": " + std::to_string(s.rows) + " rows" +
               (s.table.specimen.empty() ? "" : " of " + s.table.specimen) + "\n";
        write(out, s.table.remarks);
        for (const HeaderEntry& m : s.table.layout.metadata)
            out += "  header     line " + std::to_string(m.line) + ": " + m.key +
                   (m.value.empty() ? "" : ": " + m.value) + "\n";
        for (const ImportedRun& run : all.runs) {
            if (run.source != i)
                continue;
            const std::vector<double>& t = *run.signals.find(Quantity::Time);
            out += " -> " + run.file + ": " + std::to_string(t.size()) +
                   (run.atRest ? std::string(" points read at rest\n")
                               : " rows, " + shown(t.back() - t.front()) + " s at " + shown(run.rate) + " Hz\n");
            write(out, run.remarks);
        }
    }
    return printable(out);
}

Result<std::vector<record::NamedText>> runFiles(const Imported& all) {
    using Files = Result<std::vector<record::NamedText>>;
    std::vector<record::NamedText> files;
    for (const ImportedRun& run : all.runs) {
        auto text = record::csvText(tableOf(run));
        if (!text)
            return Files::failure(text.error());
        files.emplace_back(run.file, *std::move(text));
        if (run.markersFile.empty())
            continue;
        auto markers = record::csvText(markersOf(run));
        if (!markers)
            return Files::failure(markers.error());
        files.emplace_back(run.markersFile, *std::move(markers));
    }
    return files;
}

} // namespace supercircle::importing
