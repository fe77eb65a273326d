// Signs from the data: which way the crosshead goes first, which way the force goes first and furthest. Each piece of
// evidence multiplies the odds of "as it stands" against "reversed"; odds below 10 : 1 are asked for.

#include "plugin/recording/import/signals.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

constexpr double kDecisive = 10.0; ///< halved: contradictions of 5 : 1 pass; doubled: clear files are asked about
/// Odds of the first excursion. Halved: pull-offs larger than half of the push are asked about; doubled: a small start
/// the other way outweighs ten times the way.
constexpr double kFirst = 40.0;
constexpr double kMostOdds = 20.0; ///< of the extremes: a noisy zero is no proof; its size decides nothing else

struct Extent {
    double lo = 0.0, hi = 0.0; ///< relative to the rest
    std::size_t first = 0;     ///< row of the first excursion; rows: none
    [[nodiscard]] double span() const { return hi - lo; }
};

/// @param share of the span that is an excursion
Extent extentOf(const std::vector<double>& v, double rest, double share) {
    Extent e;
    for (const double x : v)
        if (std::isfinite(x)) {
            e.lo = std::min(e.lo, x - rest);
            e.hi = std::max(e.hi, x - rest);
        }
    const auto first =
        std::find_if(v.begin(), v.end(), [&](double x) { return std::abs(x - rest) > share * e.span(); });
    e.first = static_cast<std::size_t>(first - v.begin());
    return e;
}

/// Odds of rising against falling.
double odds(const Extent& e, const std::vector<double>& v, double rest) {
    if (e.first == v.size())
        return 1.0;
    const double extremes = std::clamp(e.hi / std::max(-e.lo, 1e-300), 1.0 / kMostOdds, kMostOdds);
    return (v[e.first] > rest ? kFirst : 1.0 / kFirst) * extremes;
}

void turn(std::vector<double>& values) {
    for (double& v : values)
        v = v == 0.0 ? v : -v;
}

double medianOfFirst(const std::vector<double>& v) {
    std::vector<double> first;
    const std::size_t few = std::max<std::size_t>(1, std::min<std::size_t>(v.size() / 50, 50));
    for (std::size_t i = 0; i < v.size() && first.size() < few; ++i)
        if (std::isfinite(v[i]))
            first.push_back(v[i]);
    return first.empty() ? 0.0 : lowerQuantile(std::move(first), 0.5);
}

Status unclear(std::size_t line, const std::string& why, const char* option, const char* when) {
    return Status::failure(std::to_string(line) + ":1: " + why + "; state the sign of the column while " + when +
                           ": --" + option + " positive or --" + option + " negative");
}

Decision decision(const std::string& quantity, bool reversed, int given, double ratio) {
    const auto sign = [](bool negative) { return negative ? "negative" : "positive"; };
    return {"sign of the " + quantity, sign(reversed), sign(!reversed), given != 0 ? 0.0 : std::max(ratio, 1.0 / ratio),
            "--" + quantity};
}

Remark understood(std::size_t line, const std::string& quantity, bool reversed, const std::string& why) {
    return {Kind::Understood, line,
            "the " + quantity + (reversed ? " falls" : " rises") + why + (reversed ? ", signs are reversed" : "")};
}

Status orientDisplacement(std::vector<double>& d, Signals& signals, int given, std::vector<Remark>& remarks) {
    const auto known = std::find_if(d.begin(), d.end(), [](double v) { return std::isfinite(v); });
    const double start = known == d.end() ? 0.0 : *known;
    for (double& v : d)
        v -= start;
    if (start != 0.0)
        remarks.push_back({Kind::Understood, signals.line.front(),
                           "the displacement starts at " + shown(1e3 * start) + " mm, which becomes 0"});
    const Extent e = extentOf(d, 0.0, 0.1);
    const double ratio = odds(e, d, 0.0);
    if (given == 0 && e.span() > 0.0 && ratio < kDecisive && ratio > 1.0 / kDecisive)
        return unclear(signals.line[e.first],
                       "the displacement first " + std::string(d[e.first] > 0.0 ? "rises" : "falls") +
                           " from its start, here, and then goes further the other way (from " + shown(1e3 * e.lo) +
                           " to " + shown(1e3 * e.hi) + " mm)",
                       "displacement", "the crosshead approaches the specimen");
    const bool down = given != 0 ? given < 0 : ratio < 1.0;
    if (down)
        turn(d);
    signals.displacementTurned = down;
    signals.decisions.push_back(decision("displacement", down, given, ratio));
    if (given == 0)
        remarks.push_back(
            understood(0, "displacement", down, " from its start: this direction is taken as towards the specimen"));
    return {};
}

Status orientForce(std::vector<double>& f, Signals& signals, int given, std::vector<Remark>& remarks) {
    const double rest = medianOfFirst(f);
    const Extent e = extentOf(f, rest, 0.2);
    const std::size_t line = e.first < f.size() ? signals.line[e.first] : 0;
    const double ratio = odds(e, f, rest);
    // a force that is there from the start and falls: an unloading preload, or a resisting specimen with an offset
    const bool loaded = std::abs(rest) > 0.2 * e.span() && e.first < f.size();
    if (given == 0 && loaded && (f[e.first] > rest) != (rest > 0.0))
        return unclear(line,
                       "the force starts at " + shown(rest) +
                           " N and first goes towards zero, here: a preload that is "
                           "taken off, or a zero that is wrong",
                       "force", "the specimen resists");
    if (given == 0 && e.first < f.size() && ratio < kDecisive && ratio > 1.0 / kDecisive)
        return unclear(line,
                       "the force first " + std::string(f[e.first] > rest ? "rises" : "falls") +
                           ", here, and then goes further the other way (from " + shown(rest + e.lo) + " to " +
                           shown(rest + e.hi) + " N)",
                       "force", "the specimen resists");
    const bool negative = given != 0 ? given < 0 : ratio < 1.0;
    if (negative)
        turn(f);
    signals.forceTurned = negative;
    signals.decisions.push_back(decision("force", negative, given, ratio));
    if (given == 0)
        remarks.push_back(understood(line, "force", negative, " at first: this is taken as the specimen's resistance"));
    return {};
}

} // namespace

Status orient(Signals& signals, const Hints& hints, std::vector<Remark>& remarks) {
    if (std::vector<double>* d = signals.find(Quantity::Displacement))
        if (Status done = orientDisplacement(*d, signals, hints.displacementSign, remarks); !done)
            return done;
    if (std::vector<double>* f = signals.find(Quantity::Force))
        return orientForce(*f, signals, hints.forceSign, remarks);
    return {};
}

} // namespace supercircle::importing
