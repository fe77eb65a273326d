#include "plugin/recording/import/release_state.h"

#include "supercircle/support/dense.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;
using Eigen::Index;

/// Rows of a twelfth of a period that a polynomial needs. Half of them leave its spin uncertain by 150 deg/s at
/// 16 rows a period; twice as many hand runs of 200 rows a period to the equation, whose half-width is then 3 deg/s
/// instead of 12.
constexpr std::size_t kPolynomialRows = 9;
/// Rows through which the equation of a swing is fitted, at least. 9 instead of 12 double the half-width of the spin.
constexpr std::size_t kSwingRows = 12;
/// Share of an encoder step below which no residual counts: uniform errors of rounding.
constexpr double kOfStep = 0.3;

/// First rows of a run: time from its start, angle, and angular velocity (empty: not recorded).
struct Beginning {
    std::vector<double> time, angle, spin;
    double angleStep = 0.0, spinStep = 0.0; ///< of the encoder
};

template <class More>
Beginning beginningOf(const Signals& signals, const More& more) {
    const std::vector<double>& t = *signals.find(Quantity::Time);
    const std::vector<double>& v = *signals.find(Quantity::Angle);
    const std::vector<double>* spin = signals.find(Quantity::AngularVelocity);
    Beginning out;
    out.angleStep = encoderStep(v);
    out.spinStep = spin != nullptr ? encoderStep(*spin) : 0.0;
    for (std::size_t i = 0; i < t.size() && (more(t[i] - t[0], out.time.size())); ++i)
        if (std::isfinite(v[i])) {
            out.time.push_back(t[i] - t[0]);
            out.angle.push_back(v[i]);
            if (spin != nullptr)
                out.spin.push_back((*spin)[i]);
        }
    return out;
}

/// Least squares of rows of angles and, weighted, of spins.
struct Fit {
    Eigen::VectorXd value;
    Eigen::MatrixXd covariance;           ///< of the values, for errors of one angle of size 1
    double angleRms = 0.0, spinRms = 0.0; ///< residuals, rad, rad/s
};

/// Weight of a spin against an angle, s.
double weightOf(double angleError, double spinError, const Beginning& b) {
    const double angle = std::max(angleError, kOfStep * b.angleStep), spin = std::max(spinError, kOfStep * b.spinStep);
    return spin > 0.0 ? std::max(angle, 1e-9) / spin : 0.0;
}

/// Coefficients of a polynomial of time / span. @param weight of a spin, in s; 0: angles alone
Fit polynomial(const Beginning& b, double span, Index powers, double weight) {
    const auto n = static_cast<Index>(b.time.size());
    const Index rows = weight > 0.0 ? 2 * n : n;
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(rows, powers);
    Eigen::VectorXd read = Eigen::VectorXd::Zero(rows);
    for (Index k = 0; k < n; ++k) {
        const double s = b.time[static_cast<std::size_t>(k)] / span;
        read[k] = b.angle[static_cast<std::size_t>(k)];
        for (Index p = 0; p < powers; ++p)
            basis(k, p) = math::pow(s, static_cast<double>(p));
        const double spin = weight > 0.0 ? b.spin[static_cast<std::size_t>(k)] : 0.0;
        if (weight <= 0.0 || !std::isfinite(spin))
            continue;
        read[n + k] = weight * spin;
        for (Index p = 1; p < powers; ++p)
            basis(n + k, p) = weight * static_cast<double>(p) * math::pow(s, static_cast<double>(p - 1)) / span;
    }
    Fit fit;
    fit.covariance = dense::inverseLdlt(basis.transpose() * basis);
    fit.value = fit.covariance * (basis.transpose() * read);
    const Eigen::VectorXd rest = read - basis * fit.value;
    fit.angleRms = std::sqrt(rest.head(n).squaredNorm() / static_cast<double>(std::max<Index>(1, n - powers)));
    if (weight > 0.0)
        fit.spinRms = rest.tail(n).norm() / weight / std::sqrt(static_cast<double>(n));
    return fit;
}

ReleaseState byPolynomial(const Beginning& b, double span, double weight) {
    // Within a twelfth of a swing the acceleration changes: a parabola would have an error of 0.2 rad/s.
    const Index powers = b.time.size() >= kPolynomialRows ? 5 : 3;
    const Fit fit = polynomial(b, span, powers, weight);
    const double sigma = std::max(fit.angleRms, kOfStep * b.angleStep);
    ReleaseState out;
    out.angle = fit.value[0];
    out.spin = fit.value[1] / span;
    out.angleHalfWidth = 3.0 * sigma * std::sqrt(fit.covariance(0, 0)) + 0.5 * b.angleStep;
    out.spinHalfWidth = 3.0 * sigma * std::sqrt(fit.covariance(1, 1)) / span;
    // A turn within an encoder step is invisible: the spin is uncertain by the acceleration over that time.
    if (weight <= 0.0)
        out.spinHalfWidth += std::sqrt(2.0 * b.angleStep * 2.0 * std::abs(fit.value[2])) / span + b.angleStep / span;
    return out;
}

/// Weight of the spins of a short beginning, from their scatter about a cubic.
double weightInShort(const Beginning& b, double span) {
    Beginning spins = b;
    spins.angle = b.spin;
    return weightOf(polynomial(b, span, 5, 0.0).angleRms, polynomial(spins, span, 4, 0.0).angleRms, b);
}

/// phi'' = -k phi - k3 phi^3 - c phi' with phi = angle - rest. The cubic term is that of gravity or of a spring, the
/// damping that of any friction over so short a time.
struct Swing {
    enum : Index { Angle, Spin, Rest, Stiffness, Cubic, Damping, Count };
    Eigen::VectorXd at = Eigen::VectorXd::Zero(Count);

    /// Angles and spins at increasing times from 0, by the classical Runge-Kutta method.
    void follow(const std::vector<double>& time, double step, std::vector<double>& angle,
                std::vector<double>& spin) const {
        const auto acceleration = [&](double a, double w) {
            const double phi = a - at[Rest];
            return -(at[Stiffness] + at[Cubic] * phi * phi) * phi - at[Damping] * w;
        };
        double a = at[Angle], w = at[Spin], now = 0.0;
        for (std::size_t k = 0; k < time.size(); ++k) {
            const auto steps = static_cast<int>(std::ceil((time[k] - now) / step));
            const double h = steps > 0 ? (time[k] - now) / steps : 0.0;
            for (int i = 0; i < steps; ++i) {
                const double a1 = acceleration(a, w), w2 = w + 0.5 * h * a1;
                const double a2 = acceleration(a + 0.5 * h * w, w2), w3 = w + 0.5 * h * a2;
                const double a3 = acceleration(a + 0.5 * h * w2, w3), w4 = w + h * a3;
                const double a4 = acceleration(a + h * w3, w4);
                a += h / 6.0 * (w + 2.0 * w2 + 2.0 * w3 + w4);
                w += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            }
            now = time[k];
            angle.push_back(a);
            spin.push_back(w);
        }
    }
};

/// Gauss-Newton steps from `swing` on. Priors as wide as any swing keep undetermined terms finite.
Fit fitSwing(const Beginning& b, Swing& swing, double period, double amplitude, double weight, double sigma) {
    constexpr int kSteps = 12;
    const auto n = static_cast<Index>(b.time.size());
    const Index rows = (weight > 0.0 ? 2 * n : n) + Swing::Count;
    const double k = 4.0 * M_PI * M_PI / (period * period);
    Eigen::VectorXd middle = swing.at, wide(Swing::Count);
    wide << 10.0 * amplitude, 10.0 * amplitude * std::sqrt(k), 0.5 * amplitude, k, k / (amplitude * amplitude),
        0.5 * std::sqrt(k);
    middle[Swing::Rest] = swing.at[Swing::Rest];
    const auto residual = [&](const Swing& s) {
        std::vector<double> angle, spin;
        s.follow(b.time, period / 100.0, angle, spin);
        Eigen::VectorXd out = Eigen::VectorXd::Zero(rows);
        for (Index i = 0; i < n; ++i) {
            const auto row = static_cast<std::size_t>(i);
            out[i] = b.angle[row] - angle[row];
            if (weight > 0.0 && std::isfinite(b.spin[row]))
                out[n + i] = weight * (b.spin[row] - spin[row]);
        }
        out.tail(Swing::Count) = sigma * (middle - s.at).cwiseQuotient(wide);
        return out;
    };
    Fit fit;
    Eigen::VectorXd now = residual(swing);
    for (int step = 0; step < kSteps; ++step) {
        Eigen::MatrixXd jacobian(rows, Swing::Count);
        for (Index i = 0; i < Swing::Count; ++i) {
            Swing other = swing;
            const double h = 1e-5 * wide[i];
            other.at[i] += h;
            jacobian.col(i) = (now - residual(other)) / h;
        }
        fit.covariance = dense::inverseLdlt(jacobian.transpose() * jacobian);
        const Eigen::VectorXd way = fit.covariance * (jacobian.transpose() * now);
        double share = 1.0;
        for (; share > 1e-3; share *= 0.5) {
            Swing other = swing;
            other.at += share * way;
            if (const Eigen::VectorXd there = residual(other);
                there.allFinite() && there.squaredNorm() < now.squaredNorm()) {
                swing = other;
                now = there;
                break;
            }
        }
        if (share <= 1e-3)
            break;
    }
    fit.value = swing.at;
    constexpr Index kFree = 4; // what 12 rows determine beyond the priors: the state, the stiffness, the rest
    fit.angleRms = std::sqrt(now.head(n).squaredNorm() / static_cast<double>(std::max<Index>(1, n - kFree)));
    if (weight > 0.0)
        fit.spinRms = now.segment(n, n).norm() / weight / std::sqrt(static_cast<double>(n));
    return fit;
}

ReleaseState bySwing(const Beginning& b, double period, double mean, double amplitude, bool withSpin) {
    Swing swing;
    const Fit start = polynomial(b, b.time.back(), std::min<Index>(5, static_cast<Index>(b.time.size()) - 1), 0.0);
    swing.at << start.value[0], start.value[1] / b.time.back(), mean, 4.0 * M_PI * M_PI / (period * period), 0.0, 0.0;
    double sigma = std::max(kOfStep * b.angleStep, 1e-3 * amplitude), weight = 0.0;
    Fit fit;
    for (int round = 0; round < 3; ++round) { // residuals weigh priors and spins
        fit = fitSwing(b, swing, period, amplitude, weight, sigma);
        sigma = std::max(fit.angleRms, kOfStep * b.angleStep);
        weight = withSpin ? weightOf(fit.angleRms, fit.spinRms, b) : 0.0;
    }
    ReleaseState out;
    out.angle = fit.value[Swing::Angle];
    out.spin = fit.value[Swing::Spin];
    out.angleHalfWidth = 3.0 * sigma * std::sqrt(fit.covariance(Swing::Angle, Swing::Angle)) + 0.5 * b.angleStep;
    out.spinHalfWidth = 3.0 * sigma * std::sqrt(fit.covariance(Swing::Spin, Swing::Spin));
    return out;
}

/// @param withSpin also by the recorded angular velocities
ReleaseState stateOf(const Signals& signals, bool withSpin) {
    const std::vector<double>& t = *signals.find(Quantity::Time);
    const std::vector<double>& v = *signals.find(Quantity::Angle);
    const double period = swingPeriod(t, v), span = period / 12.0; // short against the swing, long enough for a slope
    const Beginning first =
        beginningOf(signals, [&](double time, std::size_t rows) { return time <= span || rows < kPolynomialRows; });
    if (first.time.size() < 4)
        return {};
    if (first.time[std::min(first.time.size(), kPolynomialRows) - 1] <= span)
        return byPolynomial(first, span, withSpin ? weightInShort(first, span) : 0.0);
    const Beginning half =
        beginningOf(signals, [&](double time, std::size_t rows) { return time <= 0.5 * period || rows < kSwingRows; });
    double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0.0, known = 0.0;
    for (const double x : v)
        if (std::isfinite(x)) {
            least = std::min(least, x);
            most = std::max(most, x);
            sum += x;
            known += 1.0;
        }
    if (half.time.size() < kSwingRows || most <= least)
        return byPolynomial(first, span, 0.0);
    return bySwing(half, period, sum / known, 0.5 * (most - least), withSpin);
}

} // namespace

double encoderStep(const std::vector<double>& angle) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < angle.size(); ++i)
        if (const double d = std::abs(angle[i] - angle[i - 1]); d > 1e-9)
            least = std::min(least, d);
    return std::isfinite(least) ? least : 0.0;
}

double swingPeriod(const std::vector<double>& t, const std::vector<double>& v) {
    double mean = 0.0, known = 0.0, last = 0.0, first = 0.0;
    for (const double x : v)
        if (std::isfinite(x)) {
            mean += x;
            known += 1.0;
        }
    mean /= std::max(known, 1.0);
    const double level = 0.1 * (*std::max_element(v.begin(), v.end()) - mean); // noise crosses the mean many times
    std::size_t crossings = 0;
    int side = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const int now = v[i] > mean + level ? 1 : v[i] < mean - level ? -1 : side;
        if (side != 0 && now != side) {
            first = crossings++ == 0 ? t[i] : first;
            last = t[i];
        }
        side = now;
    }
    return crossings >= 2 ? 2.0 * (last - first) / static_cast<double>(crossings - 1) : t.back() - t.front();
}

ReleaseState releaseStateOf(const Signals& signals) {
    const ReleaseState alone = stateOf(signals, false);
    if (signals.find(Quantity::AngularVelocity) == nullptr)
        return alone;
    ReleaseState both = stateOf(signals, true);
    both.bySpin = true;
    if (const double apart = alone.spin - both.spin; std::abs(apart) > alone.spinHalfWidth + both.spinHalfWidth) {
        both = alone;
        both.spinApart = apart;
    }
    return both;
}

void dropDifferences(Signals& signals, std::vector<Remark>& remarks) {
    constexpr double kEqual = 1e-3; // of the usual spin: last digits
    const std::vector<double>* spin = signals.find(Quantity::AngularVelocity);
    if (spin == nullptr)
        return;
    const std::vector<double>& t = *signals.find(Quantity::Time);
    const std::vector<double>& v = *signals.find(Quantity::Angle);
    std::vector<double> size;
    for (const double w : *spin)
        if (std::isfinite(w))
            size.push_back(std::abs(w));
    const double usual = size.empty() ? 0.0 : upperMedian(std::move(size));
    const char* const kinds[] = {"the angle less that of the row before", "the angle of the next row less its own",
                                 "the difference of the angles before and after"};
    for (std::size_t kind = 0; kind < 3; ++kind) {
        std::vector<double> apart;
        for (std::size_t i = 1; i + 1 < v.size(); ++i) {
            const std::size_t a = kind == 1 ? i : i - 1, b = kind == 0 ? i : i + 1;
            if (const double d = (v[b] - v[a]) / (t[b] - t[a]) - (*spin)[i]; std::isfinite(d))
                apart.push_back(std::abs(d));
        }
        if (apart.empty() || !(upperMedian(std::move(apart)) <= kEqual * usual))
            continue;
        remarks.push_back({Kind::Omitted, 0,
                           std::string("the angular velocity is ") + kinds[kind] +
                               ", over the time between them: it measures nothing of its own"});
        std::erase_if(signals.channels, [](const Channel& c) { return c.quantity == Quantity::AngularVelocity; });
        return;
    }
}

} // namespace supercircle::importing
