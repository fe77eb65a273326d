#include "plugin/recording/import/whole.h"

#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>

namespace supercircle::importing {

namespace {

/// Shares that are refused. Halved: single faults of short files are; doubled: a fault of every fiftieth row passes.
constexpr double kMostLost = 0.01, kMostJumps = 0.005;

/// A jump, in usual steps (their lower quartile: a third of the rows may jump) and in shares of the range. Halved:
/// noise of five sigma counts; doubled: so do only the largest.
constexpr double kJumpSteps = 20.0;
double shareOfRange(Quantity q) {
    // a force may be noisy beside its range, a crosshead and a clock are not
    return q == Quantity::Displacement || q == Quantity::Time ? 0.01 : 0.1;
}

std::vector<double> finite(const std::vector<double>& values) {
    std::vector<double> out;
    std::copy_if(values.begin(), values.end(), std::back_inserter(out), [](double v) { return std::isfinite(v); });
    return out;
}

/// Rows that leave the values before them by a jump and are followed by values as before, one or two rows later.
std::vector<std::size_t> jumpsOf(const std::vector<double>& v, Quantity q) {
    std::vector<std::size_t> found;
    std::vector<double> steps;
    for (std::size_t i = 1; i < v.size(); ++i)
        if (const double s = std::abs(v[i] - v[i - 1]); std::isfinite(s))
            steps.push_back(s);
    const std::vector<double> known = finite(v);
    if (known.size() < 10 || steps.size() < 10)
        return found;
    const double range = lowerQuantile(known, 0.98) - lowerQuantile(known, 0.02);
    const double least = std::max(shareOfRange(q) * range, kJumpSteps * lowerQuantile(std::move(steps), 0.25));
    const auto near = [&](std::size_t a, std::size_t b, double jump) {
        return a < v.size() && b < v.size() && std::abs(v[a] - v[b]) < 0.25 * jump;
    };
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        const double jump = std::abs(v[i] - v[i - 1]);
        if (!(jump > least) || (i >= 2 && !near(i - 1, i - 2, jump)))
            continue;
        const bool one = near(i + 1, i - 1, jump) && (i + 2 >= v.size() || near(i + 2, i + 1, jump));
        const bool two = near(i + 1, i, jump) && near(i + 2, i - 1, jump);
        if (one || two) {
            found.push_back(i);
            i += two && !one ? 2 : 1;
        }
    }
    return found;
}

bool areMany(std::size_t jumps, std::size_t rows) {
    return jumps >= 3 && static_cast<double>(jumps) > kMostJumps * static_cast<double>(rows);
}

} // namespace

bool jumpsTooOften(const std::vector<double>& values, Quantity quantity) {
    return areMany(jumpsOf(values, quantity).size(), values.size());
}

Status checkWhole(const Signals& signals, Table& table, const Hints& hints) {
    for (const Channel& c : signals.channels) {
        if (c.quantity != Quantity::Displacement && c.quantity != Quantity::Force && c.quantity != Quantity::Angle)
            continue;
        const std::vector<std::size_t> jumps = jumpsOf(c.values, c.quantity);
        if (!areMany(jumps.size(), signals.rows()))
            continue;
        const std::string what = std::string("the ") + name(c.quantity) + " jumps and comes back within two rows " +
                                 std::to_string(jumps.size()) + " times in " + std::to_string(signals.rows()) + " rows";
        const std::size_t line = signals.line[jumps.front()];
        if (hints.accept.count("jumps") == 0)
            return Status::failure(std::to_string(line) + ":1: " + what +
                                   ", here first; expected at most 0.5 %. Has a spreadsheet changed the decimal marks? "
                                   "Export again from the machine's own software; --accept jumps imports it as it is");
        table.remarks.push_back({Remark::Kind::Doubtful, line, what + ", here first; accepted by --accept jumps"});
    }
    return {};
}

Status checkLost(std::size_t lost, std::size_t candidates, std::size_t firstLine, const Hints& hints) {
    if (static_cast<double>(lost) <= kMostLost * static_cast<double>(candidates) || hints.accept.count("dropped") > 0)
        return {};
    return Status::failure((firstLine > 0 ? std::to_string(firstLine) + ":1: " : std::string()) +
                           (firstLine > 0 ? "" : "in all, ") + std::to_string(lost) + " of " +
                           std::to_string(candidates) + " rows could not be used" +
                           (firstLine > 0 ? ", this one first" : ": their times are out of order") +
                           "; expected at most 1 %. Are decimal or thousands marks mixed? Export again with plain "
                           "numbers; --accept dropped imports the other rows");
}

} // namespace supercircle::importing
