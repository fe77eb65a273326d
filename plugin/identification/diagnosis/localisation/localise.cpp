#include "plugin/identification/diagnosis/localisation/localise.h"

#include "plugin/identification/diagnosis/model/random.h"
#include "supercircle/support/dense.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

double signOf(const WindowRows& c, std::size_t row) {
    return c.sign.size() > 0 ? c.sign[static_cast<Eigen::Index>(row)] : 1.0;
}

/// Whitened unit shift of the window's raw readings.
Eigen::VectorXd shiftOf(const Likelihood& likelihood, const WindowRows& c) {
    Eigen::VectorXd raw = Eigen::VectorXd::Zero(likelihood.rows());
    for (std::size_t i = 0; i < c.rows.size(); ++i)
        raw[c.rows[i]] = signOf(c, i);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(likelihood.rows());
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const auto part = raw.segment(likelihood.start(r), likelihood.rowsOf(r));
        if (part.squaredNorm() > 0.0)
            out.segment(likelihood.start(r), likelihood.rowsOf(r)) = likelihood.whiten(r, part);
    }
    return out;
}

/// Clip of a reading in the decisive statistics, sigma. Heavy tails otherwise dominate windows of few rows. Which
/// significant windows are shown is decided without the clip (decision 0077).
constexpr double kReadingClip = 3.0;
/// Clip of the time of a jump, sigma. It is no sensor reading; beyond this two simulators may differ.
constexpr double kJumpClip = 6.0;

/// @param clip of each row, sigma
Eigen::MatrixXd clippedAt(const Eigen::MatrixXd& u, const Eigen::VectorXd& clip) {
    const Eigen::MatrixXd most = clip.replicate(1, u.cols());
    return u.cwiseMax(-most).cwiseMin(most);
}

/// Whitened noise of all runs in excess of the most probable one, as a posterior draw has it; none where that is
/// smaller. The slow part counts by its power at low frequencies, c^2 tau.
Eigen::VectorXd excessNoise(const Likelihood& likelihood, const Noise::PosteriorDraw& p, Random& random) {
    const Noise& n = likelihood.noise();
    const auto excess = [](double square) { return std::sqrt(std::max(0.0, square)); };
    const double white = excess(p.white * p.white - n.white * n.white);
    const double slow =
        excess(p.correlated * p.correlated - n.correlated * n.correlated * n.correlationTime / p.correlationTime);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(likelihood.rows());
    for (std::size_t r = 0; r < likelihood.runs() && white + slow > 0.0; ++r) {
        const RecordedRun& run = likelihood.data().runs[r];
        Eigen::VectorXd raw = Eigen::VectorXd::Zero(likelihood.rowsOf(r));
        double state = random.normal();
        for (Eigen::Index k = 0; k < run.force.size(); ++k) {
            const double keep = k > 0 ? math::exp(-(run.time[k] - run.time[k - 1]) / p.correlationTime) : 1.0;
            state = keep * state + std::sqrt(1.0 - keep * keep) * random.normal();
            raw[k] = slow * state + white * random.normal();
        }
        out.segment(likelihood.start(r), likelihood.rowsOf(r)) = likelihood.whiten(r, raw);
    }
    return out;
}

/// Every statistic by its mean and standard deviation under the null. A draw is judged by the other draws, as the
/// record is: its own extremes would widen its scale, and 8 % of pure noise would be significant at 5 %.
class Standardiser {
public:
    /// @param shifts so many statistics come first that have either sign
    Standardiser(const Eigen::MatrixXd& null, Eigen::Index shifts)
        : shifts_(shifts), draws_(static_cast<double>(null.cols())), mean_(null.rowwise().mean()),
          squares_((null.colwise() - mean_).rowwise().squaredNorm()) {}
    [[nodiscard]] Eigen::VectorXd record(const Eigen::VectorXd& t) const {
        return standardised(t, mean_, squares_, draws_);
    }
    [[nodiscard]] Eigen::VectorXd draw(const Eigen::VectorXd& t) const {
        const double others = std::max(1.0, draws_ - 1.0);
        const Eigen::VectorXd off = t - mean_;
        return standardised(t, mean_ - off / others, squares_ - draws_ / others * off.cwiseAbs2(), others);
    }

private:
    [[nodiscard]] Eigen::VectorXd standardised(const Eigen::VectorXd& t, const Eigen::VectorXd& mean,
                                               const Eigen::VectorXd& squares, double draws) const {
        Eigen::VectorXd sigma = (squares / std::max(1.0, draws - 1.0)).cwiseMax(1e-24).cwiseSqrt(), out = t - mean;
        out.head(shifts_) = t.head(shifts_);
        sigma.head(shifts_) = sigma.head(shifts_).cwiseMax(1e-3);
        return out.cwiseQuotient(sigma);
    }

    Eigen::Index shifts_;
    double draws_;
    Eigen::VectorXd mean_, squares_;
};

/// Distribution of one number over the draws of the null; large values are rare.
class NullDistribution {
public:
    explicit NullDistribution(std::vector<double> all) : sorted_(std::move(all)) {
        std::sort(sorted_.begin(), sorted_.end());
    }
    /// p-value of t; the recorded value counts as one more draw.
    [[nodiscard]] double p(double t) const {
        const auto above = sorted_.end() - std::lower_bound(sorted_.begin(), sorted_.end(), t);
        return (1.0 + static_cast<double>(above)) / (1.0 + static_cast<double>(sorted_.size()));
    }
    /// Value exceeded by a share p of the draws.
    [[nodiscard]] double critical(double p) const {
        const double n = static_cast<double>(sorted_.size());
        return sorted_[static_cast<std::size_t>(std::clamp(std::ceil((1.0 - p) * (n + 1.0)), 1.0, n)) - 1];
    }

private:
    std::vector<double> sorted_;
};

/// Two families, windows and signatures, each by its maximum over all statistics, combined by the smaller p (min-p). In
/// one common family the few signatures would need a larger statistic (decision 0077). Without signatures only windows
/// count.
struct StatisticFamilies {
    StatisticFamilies(const std::vector<double>& largestWindows, const std::vector<double>& largestSignatures)
        : windows(largestWindows), signatures(largestSignatures), both(smallerP(largestWindows, largestSignatures)) {}
    /// Family-wise p of a p within one family.
    [[nodiscard]] double overall(double p) const { return both.p(-p); }
    /// p within one family that corresponds to this family-wise p.
    [[nodiscard]] double within(double p) const { return -both.critical(p); }
    NullDistribution windows, signatures;

private:
    [[nodiscard]] NullDistribution smallerP(const std::vector<double>& w, const std::vector<double>& s) const {
        std::vector<double> out;
        for (std::size_t b = 0; b < w.size(); ++b)
            out.push_back(-std::min(windows.p(w[b]), s.empty() ? 1.0 : signatures.p(s[b])));
        return NullDistribution(std::move(out));
    }
    NullDistribution both; ///< -p: rare is large
};

/// Whether two windows are comparable: same run, channel and axis.
bool sameKind(const ResidualWindow& a, const ResidualWindow& b) {
    return a.run == b.run && a.channel == b.channel && a.axis == b.axis && (a.axis == "time" || a.phase == b.phase);
}

bool overlaps(const ResidualWindow& a, const ResidualWindow& b) {
    const bool byTime = a.axis == "time";
    const double a0 = byTime ? a.timeFrom : a.displacementFrom, a1 = byTime ? a.timeTo : a.displacementTo;
    const double b0 = byTime ? b.timeFrom : b.displacementFrom, b1 = byTime ? b.timeTo : b.displacementTo;
    const double shared = std::min(a1, b1) - std::max(a0, b0);
    return shared > 1e-3 * std::min(a1 - a0, b1 - b0);
}

/// Whether the window lies before the first motion, in readings whose mean there was taken as zero. A misfit elsewhere
/// shifts the zero of the run and makes this rest significant.
bool beforeFirstMotion(const ResidualWindow& w, const RecordedData& data) {
    if (data.zeroWindow <= 0.0 || w.axis != "time" || w.ofMarker())
        return false;
    return std::any_of(data.runs.begin(), data.runs.end(), [&](const RecordedRun& run) {
        return run.name == w.run && !run.strokes.empty() && run.strokes.front().phase == Phase::Hold &&
               w.timeTo <= run.strokes.front().to;
    });
}

/// Removes windows that do not pass, unless none does.
template <class Passes>
void prefer(std::vector<ResidualWindow>& all, const Passes& passes) {
    const auto others = std::stable_partition(all.begin(), all.end(), passes);
    if (others != all.begin())
        all.erase(others, all.end());
}

/// Disjoint windows, largest statistic first. Windows over all runs are used only if no window of a single run is
/// significant.
std::vector<ResidualWindow> largestDisjoint(std::vector<ResidualWindow> all) {
    prefer(all, [](const ResidualWindow& w) { return w.run != "all"; });
    std::stable_sort(all.begin(), all.end(),
                     [](const ResidualWindow& a, const ResidualWindow& b) { return std::abs(a.z) > std::abs(b.z); });
    // A large misfit of changing sign fills whole runs; windows inside one phase tell where it sits.
    std::stable_partition(all.begin(), all.end(),
                          [](const ResidualWindow& w) { return w.axis != "time" || w.phase != "all" || w.ofMarker(); });
    // Separate quotas for the reading and for markers, which are often larger.
    constexpr std::size_t kMost = 60;
    std::vector<ResidualWindow> kept;
    std::array<std::size_t, 2> count = {};
    for (const ResidualWindow& w : all) {
        std::size_t& n = count[w.ofMarker() ? 1 : 0];
        if (n < kMost && std::none_of(kept.begin(), kept.end(),
                                      [&](const ResidualWindow& k) { return sameKind(k, w) && overlaps(k, w); })) {
            kept.push_back(w);
            ++n;
        }
    }
    std::stable_sort(kept.begin(), kept.end(),
                     [](const ResidualWindow& a, const ResidualWindow& b) { return std::abs(a.z) > std::abs(b.z); });
    return kept;
}

} // namespace

Eigen::MatrixXd basisOf(const Eigen::MatrixXd& columns) {
    if (columns.cols() == 0)
        return columns;
    Eigen::MatrixXd scaled = columns;
    for (Eigen::Index c = 0; c < scaled.cols(); ++c)
        if (const double n = scaled.col(c).norm(); n > 0.0)
            scaled.col(c) /= n;
    return dense::rangeBasis(scaled, 1e-8);
}

namespace {

/// The statistics: windows, then signatures, projected as the residual is. Whitened window indicators are not stored,
/// because they fill whole runs. Their product with a projected residual u is e'W'u - (Q'W e)'(Q'u). W'u is computed
/// once, and e sums its rows.
class WindowScan {
public:
    WindowScan(const Likelihood& likelihood, const Eigen::MatrixXd& free, const Eigen::MatrixXd& signatures,
               const StopToken& stop)
        : likelihood_(likelihood), stop_(stop), windows_(windowsOf(likelihood)), absorbed_(basisOf(free)) {
        const Eigen::Index n = windows();
        perSize_ = Eigen::VectorXd::Zero(n);
        absorbedParts_.resize(n, absorbed_.cols());
        for (Eigen::Index i = 0; i < n; ++i) {
            stop_.poll();
            Eigen::VectorXd s = shiftOf(likelihood, spot(i));
            absorbedParts_.row(i) = (absorbed_.transpose() * s).transpose();
            perSize_[i] = inverseNorm(s, 0.0);
        }
        signatures_.resize(likelihood.rows(), signatures.cols());
        for (Eigen::Index i = 0; i < signatures.cols(); ++i) {
            Eigen::VectorXd s = signatures.col(i);
            // A signature that nominal parameters explain to 1 % is round-off, no evidence.
            const double scale = inverseNorm(s, 0.01);
            signatures_.col(i) = scale * s;
        }
        counted_ = Eigen::VectorXd::Zero(likelihood.rows());
        clip_.resize(likelihood.rows());
        for (std::size_t r = 0; r < likelihood.runs(); ++r)
            for (Eigen::Index k = 0; k < likelihood.rowsOf(r); ++k) {
                counted_[likelihood.start(r) + k] = likelihood.counts(r, k) ? 1.0 : 0.0;
                clip_[likelihood.start(r) + k] = likelihood.isJump(r, k) ? kJumpClip : kReadingClip;
            }
    }
    [[nodiscard]] Eigen::Index windows() const { return static_cast<Eigen::Index>(windows_.size()); }
    [[nodiscard]] Eigen::Index directions() const { return windows() + signatures_.cols(); } ///< and signatures
    [[nodiscard]] const WindowRows& spot(Eigen::Index window) const {
        return windows_[static_cast<std::size_t>(window)];
    }

    /// Removes the part that the fit could have absorbed.
    template <class Matrix>
    void project(Matrix& v) const {
        if (absorbed_.cols() > 0)
            v -= absorbed_ * (absorbed_.transpose() * v);
    }

    /// Statistics, one column each: shifts of windows and signatures, then energies of windows.
    struct Statistics {
        Eigen::MatrixXd clipped;   ///< with clipped readings: decide significance
        Eigen::MatrixXd unclipped; ///< without the clip: decide which windows are shown
    };
    [[nodiscard]] Statistics of(const Eigen::MatrixXd& projected) const {
        return {statistics(clippedAt(projected, clip_)), statistics(projected)};
    }

    /// Statistics of simulated noise.
    [[nodiscard]] Statistics null(std::uint64_t seed, int draws) const {
        const double excessKurtosis = likelihood_.noise().excessKurtosis;
        const double degrees =
            excessKurtosis > 0.0 ? 4.0 + 6.0 / excessKurtosis : 0.0; // Student's t with this kurtosis
        const auto& posterior = likelihood_.noise().posterior;       // in the order of its grid
        Random random(seed);
        Statistics out{Eigen::MatrixXd(directions() + windows(), draws),
                       Eigen::MatrixXd(directions() + windows(), draws)};
        // Draws in blocks, as matrix products of some tens of megabytes.
        constexpr Eigen::Index kNumbers = 2000000;
        const int kBlock = static_cast<int>(std::clamp<Eigen::Index>(kNumbers / likelihood_.rows(), 8, 64));
        for (int first = 0; first < draws; first += kBlock) {
            stop_.poll();
            const int count = std::min(kBlock, draws - first);
            Eigen::MatrixXd v(likelihood_.rows(), count);
            for (int b = 0; b < count; ++b) // missing rows stay 0
                for (Eigen::Index k = 0; k < v.rows(); ++k)
                    v(k, b) = counted_[k] *
                              (degrees > 0.0 && clip_[k] == kReadingClip ? random.student(degrees) : random.normal());
            for (int b = 0; b < count && !posterior.empty(); ++b)
                v.col(b) += excessNoise(
                    likelihood_, posterior[static_cast<std::size_t>(41 * (first + b)) % posterior.size()], random);
            project(v);
            const Statistics block = of(v);
            out.clipped.middleCols(first, count) = block.clipped;
            out.unclipped.middleCols(first, count) = block.unclipped;
        }
        return out;
    }

    [[nodiscard]] double largestWindow(const Eigen::VectorXd& t) const {
        return std::max(t.head(windows()).cwiseAbs().maxCoeff(), t.tail(windows()).maxCoeff());
    }
    /// At least one signature is needed.
    [[nodiscard]] double largestSignature(const Eigen::VectorXd& t) const {
        return t.segment(windows(), directions() - windows()).cwiseAbs().maxCoeff();
    }
    [[nodiscard]] bool signatures() const { return directions() > windows(); }

private:
    /// Projects s; returns 1 over its remaining norm, or 0 where that is round-off.
    double inverseNorm(Eigen::VectorXd& s, double share) const {
        const double whole = s.norm();
        project(s);
        const double left = s.norm();
        return left > 1e-9 && left > share * whole ? 1.0 / left : 0.0;
    }

    /// Transposed whitening of each column, stored transposed: rows of a window apart, draws together.
    [[nodiscard]] Eigen::ArrayXXd unwhitened(const Eigen::MatrixXd& u) const {
        Eigen::ArrayXXd out(u.cols(), u.rows());
        for (std::size_t r = 0; r < likelihood_.runs(); ++r) {
            const Eigen::Index from = likelihood_.start(r), n = likelihood_.rowsOf(r);
            for (Eigen::Index b = 0; b < u.cols(); ++b)
                out.row(b).segment(from, n) = likelihood_.whitenTransposed(r, u.col(b).segment(from, n)).transpose();
        }
        return out;
    }

    /// Statistics of residuals, one column each: shifts and signatures first, then energies.
    [[nodiscard]] Eigen::MatrixXd statistics(const Eigen::MatrixXd& u) const {
        const Eigen::Index n = windows(), m = directions();
        Eigen::MatrixXd t(m + n, u.cols());
        t.topRows(n).noalias() = -absorbedParts_ * (absorbed_.transpose() * u);
        t.middleRows(n, m - n).noalias() = signatures_.transpose() * u;
        const Eigen::ArrayXXd squares = u.array().square().transpose(), sums = unwhitened(u);
        for (Eigen::Index i = 0; i < n; ++i) {
            stop_.poll();
            Eigen::ArrayXd e = Eigen::ArrayXd::Zero(u.cols()), s = e;
            const WindowRows& c = spot(i);
            for (std::size_t k = 0; k < c.rows.size(); ++k) {
                e += squares.col(c.rows[k]);
                s += signOf(c, k) * sums.col(c.rows[k]);
            }
            t.row(i) = perSize_[i] * (t.row(i) + s.matrix().transpose());
            t.row(m + i) = e.unaryExpr([](double x) { return math::cbrt(x); }).matrix().transpose();
        }
        return t;
    }

    const Likelihood& likelihood_;
    const StopToken& stop_;
    std::vector<WindowRows> windows_;
    Eigen::MatrixXd absorbed_;      ///< Q, orthonormal
    Eigen::MatrixXd absorbedParts_; ///< of each window (Q'W e)'
    Eigen::VectorXd perSize_;       ///< of each window 1 / |(1 - QQ') W e|, or 0
    Eigen::MatrixXd signatures_;    ///< projected, of unit length, or 0
    Eigen::VectorXd counted_;       ///< of each row, 0 or 1
    Eigen::VectorXd clip_;
};

/// The largest statistics of every draw.
StatisticFamilies familiesOf(const WindowScan& scan, const Standardiser& standard, const Eigen::MatrixXd& null) {
    std::vector<double> windows, signatures;
    for (Eigen::Index b = 0; b < null.cols(); ++b) {
        const Eigen::VectorXd t = standard.draw(null.col(b));
        windows.push_back(scan.largestWindow(t));
        if (scan.signatures())
            signatures.push_back(scan.largestSignature(t));
    }
    return {windows, signatures};
}

/// Bonferroni's bound on the p of a number of normal deviates.
double bonferroni(Eigen::Index count, double deviate) {
    return static_cast<double>(count) * math::erfc(std::min(deviate, 35.0) / std::sqrt(2.0));
}

} // namespace

Localisation localise(const Likelihood& likelihood, const Eigen::VectorXd& residual, const Eigen::MatrixXd& free,
                      std::uint64_t seed, int draws, const Eigen::MatrixXd& signatures, const StopToken& stop) {
    const WindowScan scan(likelihood, free, signatures, stop);
    const Eigen::Index n = scan.windows(), m = scan.directions();
    Localisation out;
    out.familySize = static_cast<std::size_t>(m + n);
    if (n == 0) { // too few rows count: nothing can be significant
        out.critical = std::numeric_limits<double>::infinity();
        return out;
    }
    const WindowScan::Statistics null = scan.null(seed, draws);
    const Standardiser standard(null.clipped, m), standardUnclipped(null.unclipped, m);
    const StatisticFamilies families = familiesOf(scan, standard, null.clipped);
    out.critical = (scan.signatures() ? families.signatures : families.windows).critical(families.within(kFamilyWise));
    Eigen::VectorXd u = residual;
    scan.project(u);
    const WindowScan::Statistics recorded = scan.of(u);
    const Eigen::VectorXd t = standard.record(recorded.clipped),
                          unclipped = standardUnclipped.record(recorded.unclipped);
    std::vector<ResidualWindow> found;
    for (Eigen::Index i = 0; i < n; ++i) {
        ResidualWindow w = scan.spot(i).window;
        w.p = families.overall(families.windows.p(std::max(std::abs(t[i]), t[m + i])));
        w.kind = std::abs(unclipped[i]) >= unclipped[m + i] ? StatisticKind::Shift : StatisticKind::Energy;
        w.z = w.kind == StatisticKind::Shift ? unclipped[i] : unclipped[m + i];
        out.p = std::min(out.p, w.p);
        if (w.p <= kFamilyWise)
            found.push_back(w);
    }
    double tail = bonferroni(2 * n, scan.largestWindow(t));
    if (scan.signatures()) {
        const double largest = scan.largestSignature(t);
        out.p = std::min(out.p, families.overall(families.signatures.p(largest)));
        out.largestSignature = largest;
        tail = 2.0 * std::min(tail, bonferroni(m - n, largest));
    }
    out.extendedP = out.p * (draws + 1) < 1.5 ? std::min(out.p, tail) : out.p;
    prefer(found, [&](const ResidualWindow& w) { return !beforeFirstMotion(w, likelihood.data()); });
    out.significant = largestDisjoint(std::move(found));
    return out;
}

} // namespace supercircle::diagnosis
