#include "plugin/recording/import/force_zero.h"

#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

constexpr double kErrors = 3.0;    ///< standard errors of a slope; by the normal law 1 in 370 rests is taken as a ramp
constexpr std::size_t kFewest = 5; ///< rows; fewer have no slope to test
constexpr std::size_t kPart = 6;   ///< of the rows before contact; halved: nearer to it; doubled: 1.4 times the error
constexpr double kSmallOffset = 0.01; ///< of the range; as a preload it would be below what a contact shows

struct Line {
    double mean = 0.0, slope = 0.0, error = 0.0; ///< slope in 1/s with its standard error
    std::size_t rows = 0;
};

/// Least squares over rows first to last - 1.
Line lineThrough(const std::vector<double>& t, const std::vector<double>& v, std::size_t first, std::size_t last) {
    double n = 0.0, mt = 0.0, mv = 0.0, tt = 0.0, tv = 0.0, rest = 0.0;
    const auto each = [&](const auto& use) {
        for (std::size_t i = first; i < last; ++i)
            if (std::isfinite(v[i]))
                use(t[i], v[i]);
    };
    each([&](double x, double y) {
        n += 1.0;
        mt += x;
        mv += y;
    });
    Line line;
    line.rows = static_cast<std::size_t>(n);
    if (n < 1.0)
        return line;
    mt /= n;
    mv /= n;
    line.mean = mv;
    each([&](double x, double y) {
        tt += (x - mt) * (x - mt);
        tv += (x - mt) * (y - mv);
    });
    line.slope = tt > 0.0 ? tv / tt : 0.0;
    each([&](double x, double y) {
        const double r = y - mv - line.slope * (x - mt);
        rest += r * r;
    });
    line.error = n > 2.0 && tt > 0.0 ? std::sqrt(rest / (n - 2.0) / tt) : 0.0;
    return line;
}

/// First of three consecutive rows whose force is `level` away from the rest; rows: there is none.
std::size_t leaves(const std::vector<double>& f, double rest, double level) {
    std::size_t in = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
        in = std::abs(f[i] - rest) > level ? in + 1 : 0;
        if (in == 3)
            return i - 2;
    }
    return f.size();
}

double rangeOf(const std::vector<double>& f, double rest) {
    double most = 0.0;
    for (const double v : f)
        most = std::isfinite(v) ? std::max(most, std::abs(v - rest)) : most;
    return most;
}

/// First contact: the force exceeds 5 sigma and 1 % of its range.
std::size_t touchRow(const ImportedRun& run, const std::vector<double>& f, double rest) {
    return leaves(f, rest, std::max(5.0 * run.forceNoise, 0.01 * rangeOf(f, rest)));
}

/// The shortest decimal number above `low` and not above `high`.
double roundest(double low, double high) {
    for (double step = math::pow(10.0, std::floor(math::log10(high))); step > 1e-3 * (high - low); step /= 10.0)
        if (const double v = step * (std::floor(low / step + 1e-9) + 1.0); v <= high * (1.0 + 1e-12))
            return v;
    return high;
}

/// The crosshead moves without the force before contact: the line through the first forces meets the rest beyond most
/// of the way that the crosshead has made by then.
bool movesFreely(const ImportedRun& run, const std::vector<double>& f, double rest, std::size_t touch) {
    const std::vector<double>* d = run.signals.find(Quantity::Displacement);
    if (d == nullptr || touch >= f.size())
        return false;
    const std::size_t leave = leaves(f, rest, std::max(5.0 * run.forceNoise, 1e-3 * rangeOf(f, rest)));
    const double way = (*d)[leave], rise = f[touch] - f[leave];
    const double back = rise != 0.0 ? (f[leave] - rest) * ((*d)[touch] - way) / rise : 0.0;
    return std::abs(way) > 2.0 * run.drive.tolerance && std::abs(back) < 0.2 * std::abs(way);
}

void subtract(ImportedRun& run, std::vector<double>& f, double zero) {
    run.forceZero = zero;
    for (double& v : f)
        v -= zero;
}

void zeroFromData(ImportedRun& run, std::vector<double>& f, const std::vector<double>& time, std::size_t touch) {
    const std::size_t rows = std::max(kFewest, touch / kPart);
    const std::size_t line = run.signals.line.front();
    if (rows >= touch || rows >= f.size()) {
        run.remarks.push_back({Kind::Assumed, line,
                               "first contact is within the first rows: the zero of the force is that of the machine "
                               "(--force-zero states another)"});
        return;
    }
    const Line rest = lineThrough(time, f, 0, rows);
    const double range = rangeOf(f, rest.mean);
    if (rest.rows < kFewest || std::abs(rest.slope) > kErrors * rest.error + 1e-12 * range) {
        run.remarks.push_back({Kind::Assumed, line,
                               "the force changes from the first row on: its zero is that of the machine, " +
                                   shown(rest.mean) + " N there are kept (--force-zero states another)"});
        return;
    }
    if (std::abs(rest.mean) > kSmallOffset * range && !movesFreely(run, f, rest.mean, touch)) {
        run.remarks.push_back({Kind::Doubtful, line,
                               "the force rests at " + shown(rest.mean) +
                                   " N until the crosshead moves: it is kept as a preload (--force-zero 0.." +
                                   shown(time[rows]) + " if it is an offset)"});
        return;
    }
    run.forceZeroWindow = roundest(time[rows - 1], time[rows]);
    subtract(run, f, rest.mean);
    run.remarks.push_back({Kind::Corrected, line,
                           "the mean force of the first " + shown(run.forceZeroWindow) + " s, " + shown(rest.mean) +
                               " N, is taken as zero"});
}

} // namespace

double whiteNoise(const std::vector<double>& f) {
    std::vector<double> bends;
    for (std::size_t i = 1; i + 1 < f.size(); ++i)
        if (const double b = std::abs(f[i - 1] - 2.0 * f[i] + f[i + 1]); std::isfinite(b))
            bends.push_back(b);
    if (bends.size() < 10)
        return 0.0;
    return 1.4826 * upperMedian(std::move(bends)) / std::sqrt(6.0);
}

Status zeroForce(ImportedRun& run, const ForceZero& wanted) {
    std::vector<double>* force = run.signals.find(Quantity::Force);
    if (force == nullptr)
        return {};
    const std::vector<double>& time = *run.signals.find(Quantity::Time);
    std::vector<double>& f = *force;
    run.forceNoise = whiteNoise(f);
    const std::size_t touch = touchRow(run, f, lineThrough(time, f, 0, std::min(f.size(), kFewest)).mean);
    if (const std::vector<double>* d = run.signals.find(Quantity::Displacement))
        run.firstContact = touch < d->size() ? (*d)[touch] : std::numeric_limits<double>::quiet_NaN();
    const auto done = [&] {
        const std::string machine = "that of the machine", other = shown(run.forceZero) + " N";
        const bool kept = run.forceZero == 0.0;
        run.signals.decisions.push_back(
            {"zero of the force", kept ? machine : other, kept ? "the first rows" : machine, 0.0, "--force-zero"});
        return Status{};
    };
    const auto tell = [&](const std::string& what) { run.remarks.push_back({Kind::Corrected, 0, what}); };
    switch (wanted.kind) {
    case ForceZero::Kind::FromData:
        zeroFromData(run, f, time, touch);
        break;
    case ForceZero::Kind::None:
        tell("the zero of the force is that of the machine, as stated");
        break;
    case ForceZero::Kind::Value:
        subtract(run, f, run.signals.forceTurned ? -wanted.value : wanted.value);
        tell(shown(wanted.value) + " N are taken as the zero of the force, as stated");
        break;
    case ForceZero::Kind::Window: {
        const auto at = [&](double t) {
            return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t - 1e-9) - time.begin());
        };
        const Line rest = lineThrough(time, f, at(wanted.from), std::max(at(wanted.from), at(wanted.to)));
        if (rest.rows == 0)
            return Status::failure("no sample of the force lies between " + shown(wanted.from) + " and " +
                                   shown(wanted.to) + " s of a run of " + shown(time.back()) +
                                   " s; expected --force-zero T0..T1 within it");
        run.forceZeroWindow = wanted.from <= 0.0 ? wanted.to : 0.0;
        subtract(run, f, rest.mean);
        tell("the mean force from " + shown(wanted.from) + " to " + shown(wanted.to) + " s, " + shown(rest.mean) +
             " N, is taken as zero, as stated");
        break;
    }
    }
    return done();
}

} // namespace supercircle::importing
