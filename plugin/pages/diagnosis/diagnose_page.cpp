#include "plugin/pages/diagnosis/diagnose_page.h"

#include "plugin/pages/diagnosis/diagnose_figures.h"

#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace supercircle::cli {

namespace {

using record::fixed;
using record::rounded;

using diagnosis::Diagnosis;
using graphics::escaped;

std::string scroll(const std::string& figure) {
    return figure.empty() ? "" : "<div class=\"scroll wide\">" + figure + "</div>";
}

/// How far held-out errors are those of forecasts.
std::string forecastText(const diagnosis::Forecast& f) {
    std::string html;
    if (f.substituted > 0)
        html += "<p>In " + std::to_string(f.substituted) + " of " + std::to_string(f.of) +
                " forecasts the fit to all readings stands in for the forecast, which is not linear.</p>";
    if (f.runs.empty())
        return html;
    html += "<table><tr><th>run, forecast from its beginning</th><th>squared error a reading, in noise variances</th>"
            "<th>at least (95 %)</th><th></th></tr>";
    for (const diagnosis::RunForecast& run : f.runs)
        html += "<tr><td>" + escaped(run.run) + "</td><td>" + fixed(run.squares, 2) + "</td><td>" +
                fixed(run.atLeast, 2) + "</td><td>" +
                (run.holds ? "" : "the forecast does not hold for " + escaped(run.run)) + "</td></tr>";
    html += "</table><p>The laws are fitted to a third, half and two thirds of all runs, and forecast what follows.";
    if (f.nonlinear > 0)
        html += " In " + std::to_string(f.nonlinear) + " of " + std::to_string(f.of) +
                " forecasts the fit to all readings differs by more than a linear forecast explains.";
    return html + "</p>";
}

std::string errorTable(const Diagnosis& d) {
    const double floor = std::max(1e-300, d.noise.total());
    std::string html = "<table><tr><th></th><th>training error</th><th>held-out error</th>"
                       "<th>held-out error / noise</th></tr>";
    const auto row = [&](const std::string& what, double training, double held) {
        html += "<tr><td>" + what + "</td><td>" + rounded(training, 4) + " " + d.unit + "</td><td>" + rounded(held, 4) +
                " " + d.unit + "</td><td>" + fixed(held / floor, 2) + "</td></tr>";
    };
    row("without extra physics", d.baselineTraining, d.baselineHeldOut);
    if (d.improved) {
        std::string acting = diagnosis::plainWords(d.effects.front().label);
        for (const std::string& label : d.effects.front().jointWith)
            acting += " and " + diagnosis::plainWords(label);
        row("with " + escaped(acting), d.improvedTraining, d.improvedHeldOut);
    }
    html += "</table>";
    if (!d.further.empty()) {
        html +=
            "<table><tr><th>training error of</th><th>without extra physics</th><th>with it</th><th>noise</th></tr>";
        for (const diagnosis::ChannelError& c : d.further)
            html += "<tr><td>" + escaped(c.name) + "</td><td>" + rounded(c.baseline, 4) + " " + c.unit + "</td><td>" +
                    (d.improved ? rounded(c.improved, 4) + " " + c.unit : std::string()) + "</td><td>" +
                    rounded(c.noise, 4) + " " + c.unit + "</td></tr>";
        html += "</table>";
    }
    html += "<p>Sensor noise: " + rounded(floor, 4) + " " + d.unit + ", " + (d.table ? "" : "estimated from ") +
            escaped(d.noise.source) + ".";
    if (d.improved)
        html += " Weighted by noise, its correlation and the model error, the held-out error falls by " +
                fixed(100.0 * d.improvement, 0) + " % (90 % interval " + fixed(100.0 * d.improvementCi.low, 0) +
                " to " + fixed(100.0 * d.improvementCi.high, 0) + " %).";
    return html + "</p>" + forecastText(d.forecast);
}

std::string effectTable(const Diagnosis& d) {
    if (d.effects.empty())
        return {};
    std::string html = "<table><tr><th>effect</th><th>probability</th><th>held-out gain</th><th>law and fitted "
                       "values (90 % intervals)</th><th>confounded with</th></tr>";
    for (const diagnosis::FittedEffect& e : d.effects) {
        std::string values;
        const auto write = [&](const diagnosis::FittedParameter& p) {
            values += "<br>" + escaped(p.name) + " = " + rounded(p.value, 4) + " [" + rounded(p.ci90.low, 4) + ", " +
                      rounded(p.ci90.high, 4) + "]" + (p.unit == "1" ? "" : " " + escaped(p.unit));
            if (std::find(e.atBound.begin(), e.atBound.end(), p.name) != e.atBound.end())
                values += " (at the end of its plausible range; the runs require more)";
            if (p.ci90.signAmbiguous)
                values += " (or with the opposite sign, which these runs do not resolve)";
            if (!p.identifiedOnlyBy.empty())
                values += " (identified by " + escaped(p.identifiedOnlyBy) + " only)";
            if (!p.about.empty())
                values += " <small>" + escaped(p.about) + "</small>";
        };
        std::for_each(e.parameters.begin(), e.parameters.end(), write);
        if (!e.derived.empty())
            values += "<br>derived:";
        std::for_each(e.derived.begin(), e.derived.end(), write);
        if (e.starts > 0)
            values += "<br>" + std::to_string(e.startsAgreed) + " of " + std::to_string(e.starts) +
                      " fits from different starts agree";
        std::string group;
        for (std::size_t i = 1; i < e.confoundedWith.size(); ++i)
            group += (i > 1 ? ", " : "") + escaped(diagnosis::plainWords(e.confoundedWith[i]));
        std::string with;
        for (const std::string& label : e.jointWith)
            with += "<br>jointly with " + escaped(diagnosis::plainWords(label));
        html += "<tr><td>" + escaped(diagnosis::plainWords(e.label)) +
                (e.variant.empty() ? "" : "<br>(" + escaped(e.variant) + ")") + with + "</td><td>" +
                fixed(100.0 * e.probability, 1) + " %</td><td>" + fixed(e.gain, 0) + " ± " + fixed(e.gainError, 0) +
                "</td><td>" + escaped(e.law) + values + "</td><td>" + group + "</td></tr>";
    }
    return html + "</table>";
}

/// @param driven whether a drive defines a displacement
std::string windowTable(const diagnosis::Localisation& l, const Diagnosis& d) {
    static constexpr const char* kOf[] = {"", " (energy)", " (signature of the effect)"}; // diagnosis::Seen
    const bool none = l.significant.empty(),
               trace = !none && l.significant.front().kind == diagnosis::StatisticKind::Signature;
    std::string html;
    if (none || trace)
        html = std::string("<p>No single window is significant") +
               (l.p <= diagnosis::kFamilyWise ? ", but the signature of an effect in all readings is" : "") +
               " (p = " + fixed(l.p, 3) + " for the largest of " + std::to_string(l.familySize) + ")." +
               (trace ? " The most probable effect is visible here (blue bars in the figures):" : "") + "</p>";
    if (none)
        return html;
    html += "<table><tr><th>run</th><th>reading</th>" + std::string(d.table ? "" : "<th>time</th>") +
            (d.drive ? "<th>" + escaped(d.drive->name) + "</th>" : "") +
            "<th>phase</th><th>statistic (sigma)</th><th>p, family-wise</th></tr>";
    // Separate quotas for the reading and for markers.
    std::array<int, 2> count = {};
    for (const diagnosis::ResidualWindow& w : l.significant) {
        if (++count[w.ofMarker() ? 1 : 0] > 12)
            continue;
        html +=
            "<tr><td>" + escaped(w.run) + "</td><td>" + escaped(w.channel) +
            (w.ofMarker() ? " (arc fraction " + fixed(w.arcFraction, 2) + ")" : "") + "</td><td>" +
            (d.table ? "" : fixed(w.timeFrom, 2) + " to " + fixed(w.timeTo, 2) + " s</td><td>") +
            (d.drive ? fixed(d.drive->perUnit * w.displacementFrom, 2) + " to " +
                           fixed(d.drive->perUnit * w.displacementTo, 2) + " " + escaped(d.drive->unit) + "</td><td>"
                     : "") +
            w.phase + "</td><td>" + fixed(w.z, 1) + kOf[static_cast<std::size_t>(w.kind)] + "</td><td>" +
            fixed(w.p, 3) + "</td></tr>";
    }
    return html + "</table>";
}

/// How far each run is explained without extra physics.
std::string validityTable(const Diagnosis& d) {
    if (d.validity.empty() || !d.drive)
        return {};
    const auto place = [&](const diagnosis::ValidRange::Place& p) {
        return fixed(d.drive->perUnit * p.drive, 2) + (d.drive->unit.empty() ? "" : " " + escaped(d.drive->unit)) +
               (d.table ? "" : " at " + fixed(p.time, 2) + " s") + ", " + diagnosis::name(p.phase);
    };
    std::string html = "<p>How far each run is explained from its beginning, inside the stated intervals (p &gt; "
                       "0.05), and where it departs:</p><table><tr><th>run</th><th>explained up to</th>"
                       "<th>departs at</th><th>90 % interval</th></tr>";
    for (const diagnosis::ValidRange& r : d.validity) {
        html += "<tr><td>" + escaped(r.run) + "</td>";
        if (!r.known)
            html += "<td colspan=\"3\">cannot be simulated with the stated numbers</td></tr>";
        else if (r.whole)
            html += "<td colspan=\"3\">its end</td></tr>";
        else
            html += "<td>" + place(r.until) + "</td><td>" + place(r.departs) + "</td><td>" + place(r.departsFrom) +
                    " to " + place(r.departsTo) + "</td></tr>";
    }
    return html + "</table>";
}

std::string nominalTable(const Diagnosis& d) {
    std::string html = "<table><tr><th>parameter</th><th>stated</th><th>fitted</th><th>shift in half-widths (-1 to "
                       "1)</th></tr>";
    for (const diagnosis::NominalResult& n : d.nominal)
        html += "<tr><td>" + escaped(diagnosis::plainWords(n.name)) + "</td><td>" + rounded(n.stated, 4) + " ± " +
                rounded(n.uncertainty, 2) + " " + (n.unit == "1" ? "" : escaped(n.unit)) +
                (n.prior.empty() ? "" : ", three standard deviations") + "</td><td>" + rounded(n.fitted, 4) +
                "</td><td>" + fixed(n.standardisedShift, 2) + "</td></tr>";
    html += "</table>";
    if (d.homogeneity.degrees == 0.0) // one run
        return html;
    html += "<p>Homogeneity of the parameters over the runs: Q = " + fixed(d.homogeneity.q, 1) + " with " +
            fixed(d.homogeneity.degrees, 0) + " degrees of freedom, p = " + rounded(d.homogeneity.p, 2) +
            (d.homogeneity.differ() ? ". The runs require different parameters, most of all " +
                                          escaped(diagnosis::plainWords(d.homogeneity.number)) +
                                          ": specimens differ, or an effect that changes from run to run is missing."
                                    : ". All runs agree with the same parameters.") +
            "</p>";
    return html;
}

std::string learnedText(const Diagnosis& d) {
    std::string html;
    for (std::size_t i = 0; i < d.learned.size(); ++i) {
        const diagnosis::LearnedLaw& l = d.learned[i];
        html += "<p>" + escaped(diagnosis::plainWords(l.label)) + ": " + escaped(l.description) + ". Held-out gain " +
                fixed(l.gain, 0) + " ± " + fixed(l.gainError, 0) + ", held-out error " + rounded(l.heldOutRmse, 4) +
                " " + d.unit + ", probability " + fixed(100.0 * l.probability, 1) + " %.</p>" +
                scroll(learnedFigure(d, i));
    }
    return html;
}

/// Motion of the drive, row by row.
std::string driveTable(const diagnosis::CandidateRun& run, const experiment::DriveAxis& axis) {
    if (run.time.empty())
        return {};
    std::string html = "<table><tr>" + (run.table ? std::string() : "<th>time, s</th>") + "<th>" +
                       escaped(axis.label()) + "</th></tr>";
    for (std::size_t i = 0; i < run.time.size(); ++i)
        html += "<tr>" + (run.table ? std::string() : "<td>" + rounded(run.time[i], 4) + "</td>") + "<td>" +
                rounded(axis.perUnit * run.displacement[i], 4) + "</td></tr>";
    html += "</table>";
    if (run.table)
        return html;
    std::string markers;
    for (const double at : run.markers)
        markers += (markers.empty() ? " Markers at these arc fractions: " : ", ") + fixed(at, 2);
    return html + "<p>Readings at " + rounded(run.rate, 3) + " Hz" +
           (run.markerRate > 0.0 ? ", markers at " + rounded(run.markerRate, 2) + " Hz." : ".") + markers +
           (markers.empty() ? "" : ".") +
           (run.specimenReversed ? " Exchange the two ends of the specimen without turning it over; the run's entry in "
                                   "experiment.json has \"specimen_turned\": true."
                                 : "") +
           "</p>";
}

std::string nextText(const Diagnosis& d, const experiment::DriveAxis& axis) {
    if (!d.next)
        return d.candidateRunsConsidered > 0 ? "<p>" + escaped(diagnosis::noRunDiscriminates(d)) + "</p>"
                                             : std::string();
    std::string all;
    const std::vector<std::string>& labels = d.next->discriminates;
    for (std::size_t i = 0; i < labels.size(); ++i)
        all += (i == 0 ? "" : i + 1 == labels.size() ? " and " : ", ") + escaped(diagnosis::plainWords(labels[i]));
    std::string told = labels.size() > 1 ? "discriminate " + all : "";
    if (d.next->resolvesSign)
        told +=
            (told.empty() ? "" : " and ") + ("resolve the sign of " + escaped(diagnosis::plainWords(labels.front())));
    const bool several = d.next->runs.size() > 1;
    std::string html = "<p>" + escaped(diagnosis::describeNext(*d.next)) + (several ? ". Together they " : ". It ") +
                       (d.next->expectedConclusive ? "should " : "could ") + told + " with a power of at most " +
                       fixed(100.0 * d.next->power, 0) + " %.</p>";
    for (const diagnosis::FurtherRun& run : d.next->runs)
        html += (several ? "<p>" + escaped(diagnosis::describeRuns({run})) + ":</p>" : std::string()) +
                driveTable(run.candidateRun, axis);
    return html;
}

} // namespace

std::string diagnosisPage(const Diagnosis& d, const experiment::Experiment& e) {
    graphics::PageBuilder page(diagnosis::titleOf(d));
    page.title("Diagnosis").plainTables();
    std::string notes;
    for (const std::string& note : d.notes)
        notes += "<p>" + escaped(note) + "</p>";
    page.introduction("<p>" + escaped(d.statement) + "</p>" + notes + "<p>" + escaped(e.description) + "</p>");
    page.section("Probability of each explanation", scroll(probabilityFigure(d)) + effectTable(d));
    const bool looked = d.noise.total() > 0.0; // without a noise estimate nothing is simulated
    page.section("Errors", looked ? errorTable(d) : "");
    for (std::size_t r = 0; r < d.runs.size(); ++r)
        page.section(d.runs[r].name, scroll(runFigure(d, r)) + scroll(markerFigure(d, r)));
    page.section("Misfit of the simulation without extra physics",
                 looked ? windowTable(d.misfit, d) + validityTable(d) : "");
    if (d.improved)
        page.section("Misfit with " + improvedBy(d), windowTable(d.residualAfterBest, d));
    page.section("Position on the specimen", scroll(specimenFigure(d, e)));
    page.section("Laws learned from the runs", learnedText(d));
    page.section("Screening of the catalogue", looked ? scroll(screenFigure(d)) : "");
    page.section("Similarity of the effects in these runs (cosines; 1: equal)", scroll(similarityFigure(d)));
    page.section("Stated and fitted parameters", looked ? nominalTable(d) : "");
    page.section("Next experiment", nextText(d, experiment::driveAxis(e)));
    page.section("About this page", "<p>" + std::to_string(d.forwardRuns) + " simulated runs, seed " +
                                        std::to_string(d.seed) +
                                        ". Method: docs/theory/diagnosis.md. All numbers: "
                                        "diagnosis.json.</p>");
    return page.html();
}

} // namespace supercircle::cli
