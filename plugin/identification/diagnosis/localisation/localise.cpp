#include "plugin/identification/diagnosis/localisation/localise.h"

#include "plugin/identification/diagnosis/model/random.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

double signOf(const Spot& c, std::size_t row) {
    return c.sign.size() > 0 ? c.sign[static_cast<Eigen::Index>(row)] : 1.0;
}

/// Whitened unit shift of the window's raw readings.
Eigen::VectorXd shiftOf(const Misfit& misfit, const Spot& c) {
    Eigen::VectorXd raw = Eigen::VectorXd::Zero(misfit.rows());
    for (std::size_t i = 0; i < c.rows.size(); ++i)
        raw[c.rows[i]] = signOf(c, i);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(misfit.rows());
    for (std::size_t r = 0; r < misfit.runs(); ++r) {
        const auto part = raw.segment(misfit.start(r), misfit.rowsOf(r));
        if (part.squaredNorm() > 0.0)
            out.segment(misfit.start(r), misfit.rowsOf(r)) = misfit.whiten(r, part);
    }
    return out;
}

/// In statistics that decide a reading counts as no more than this many noise units, either way. Noise with heavy tails
/// otherwise has its largest statistics in windows of four rows: taken for normal it raised an alarm in a third of all
/// cases, and known for what it is it raised the bar for all other windows. Whether tails are heavy is hard to tell
/// from readings that have kinks wherever friction turns. Which of the windows that pass are shown is decided by
/// statistics in which readings count in full.
constexpr double kLoudest = 3.0;
/// So does the place of a jump, which is no reading of a sensor; beyond this two simulators may differ.
constexpr double kLoudestJump = 6.0;

/// @param loudest of each row
Eigen::MatrixXd quieted(const Eigen::MatrixXd& u, const Eigen::VectorXd& loudest) {
    const Eigen::MatrixXd most = loudest.replicate(1, u.cols());
    return u.cwiseMax(-most).cwiseMin(most);
}

/// Whitened noise of all runs beyond the most probable one, as large as a draw of its posterior has it; where that is
/// smaller, none. Of slow noise counts c^2 tau, its power at low frequencies.
Eigen::VectorXd beyondProbable(const Misfit& misfit, const Noise::Possible& p, Random& random) {
    const Noise& n = misfit.noise();
    const auto excess = [](double square) { return std::sqrt(std::max(0.0, square)); };
    const double white = excess(p.white * p.white - n.white * n.white);
    const double slow = excess(p.coloured * p.coloured - n.coloured * n.coloured * n.memory / p.memory);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(misfit.rows());
    for (std::size_t r = 0; r < misfit.runs() && white + slow > 0.0; ++r) {
        const RecordedRun& run = misfit.data().runs[r];
        Eigen::VectorXd raw = Eigen::VectorXd::Zero(misfit.rowsOf(r));
        double state = random.normal();
        for (Eigen::Index k = 0; k < run.force.size(); ++k) {
            const double keep = k > 0 ? std::exp(-(run.time[k] - run.time[k - 1]) / p.memory) : 1.0;
            state = keep * state + std::sqrt(1.0 - keep * keep) * random.normal();
            raw[k] = slow * state + white * random.normal();
        }
        out.segment(misfit.start(r), misfit.rowsOf(r)) = misfit.whiten(r, raw);
    }
    return out;
}

/// Mean and deviation of every statistic under the null.
struct Standard {
    explicit Standard(const Eigen::MatrixXd& null, Eigen::Index shifts)
        : mean(null.rowwise().mean()), deviation(((null.colwise() - mean).rowwise().squaredNorm() /
                                                  std::max<double>(1.0, static_cast<double>(null.cols() - 1)))
                                                     .cwiseSqrt()
                                                     .cwiseMax(1e-12)) {
        mean.head(shifts).setZero(); // they are of either sign
        deviation.head(shifts) = deviation.head(shifts).cwiseMax(1e-3);
    }
    [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& t) const {
        return (t - mean).cwiseQuotient(deviation);
    }
    Eigen::VectorXd mean, deviation;
};

/// What the draws of the null have, each one number; large ones are rare.
class Draws {
public:
    explicit Draws(std::vector<double> all) : sorted_(std::move(all)) { std::sort(sorted_.begin(), sorted_.end()); }
    /// Of a number as large as t; what was recorded counts as one more draw.
    [[nodiscard]] double p(double t) const {
        const auto above = sorted_.end() - std::lower_bound(sorted_.begin(), sorted_.end(), t);
        return (1.0 + static_cast<double>(above)) / (1.0 + static_cast<double>(sorted_.size()));
    }
    /// The number beyond which a share p of the draws lies.
    [[nodiscard]] double critical(double p) const {
        const double n = static_cast<double>(sorted_.size());
        return sorted_[static_cast<std::size_t>(std::clamp(std::ceil((1.0 - p) * (n + 1.0)), 1.0, n)) - 1];
    }

private:
    std::vector<double> sorted_;
};

/// Windows and signatures, each with the largest statistic of every draw, and of both the smaller p. Some 90 signatures
/// know what they look for; beside thousands of windows in one maximum they had to reach 4.2 deviations where 3.6 are
/// enough. Without signatures the windows are all there is.
struct Families {
    Families(const std::vector<double>& largestWindows, const std::vector<double>& largestSignatures)
        : windows(largestWindows), signatures(largestSignatures), both(rarer(largestWindows, largestSignatures)) {}
    /// Family-wise, of a p within one of the two.
    [[nodiscard]] double overall(double p) const { return both.p(-p); }
    /// p within one of the two at which the family-wise one is this.
    [[nodiscard]] double within(double p) const { return -both.critical(p); }
    Draws windows, signatures;

private:
    [[nodiscard]] Draws rarer(const std::vector<double>& w, const std::vector<double>& s) const {
        std::vector<double> out;
        for (std::size_t b = 0; b < w.size(); ++b)
            out.push_back(-std::min(windows.p(w[b]), s.empty() ? 1.0 : signatures.p(s[b])));
        return Draws(std::move(out));
    }
    Draws both; ///< -p: rare is large
};

/// Whether two windows are of one kind, so that they can be compared.
bool sameKind(const Window& a, const Window& b) {
    return a.run == b.run && a.channel == b.channel && a.axis == b.axis && (a.axis == "time" || a.phase == b.phase);
}

bool overlaps(const Window& a, const Window& b) {
    const bool byTime = a.axis == "time";
    const double a0 = byTime ? a.timeFrom : a.displacementFrom, a1 = byTime ? a.timeTo : a.displacementTo;
    const double b0 = byTime ? b.timeFrom : b.displacementFrom, b1 = byTime ? b.timeTo : b.displacementTo;
    const double shared = std::min(a1, b1) - std::max(a0, b0);
    return shared > 1e-3 * std::min(a1 - a0, b1 - b0);
}

/// Whether the window lies before the head's first move, in readings whose mean there was taken for zero: a misfit
/// elsewhere pulls the run's zero along, and the rest before anything happens stands out of the noise for it.
bool beforeAnything(const Window& w, const Data& data) {
    if (data.zeroWindow <= 0.0 || w.axis != "time" || w.ofMarker())
        return false;
    return std::any_of(data.runs.begin(), data.runs.end(), [&](const RecordedRun& run) {
        return run.name == w.run && !run.strokes.empty() && run.strokes.front().phase == Phase::Hold &&
               w.timeTo <= run.strokes.front().to;
    });
}

/// Leaves those that do not pass out, unless none does.
template <class Passes>
void prefer(std::vector<Window>& all, const Passes& passes) {
    const auto others = std::stable_partition(all.begin(), all.end(), passes);
    if (others != all.begin())
        all.erase(others, all.end());
}

/// Windows that say more than any they overlap, the largest first. Windows over all runs only say what those of single
/// runs are too weak to say.
std::vector<Window> selected(std::vector<Window> all) {
    prefer(all, [](const Window& w) { return w.run != "all"; });
    std::stable_sort(all.begin(), all.end(),
                     [](const Window& a, const Window& b) { return std::abs(a.z) > std::abs(b.z); });
    // A large misfit that changes its sign fills whole runs; in which phases it sits is said by windows inside one.
    std::stable_partition(all.begin(), all.end(),
                          [](const Window& w) { return w.axis != "time" || w.phase != "all" || w.ofMarker(); });
    // Of the reading and of the markers: tracks, which stand out by more, cannot crowd the force out.
    constexpr std::size_t kMost = 60;
    std::vector<Window> kept;
    std::array<std::size_t, 2> count = {};
    for (const Window& w : all) {
        std::size_t& n = count[w.ofMarker() ? 1 : 0];
        if (n < kMost &&
            std::none_of(kept.begin(), kept.end(), [&](const Window& k) { return sameKind(k, w) && overlaps(k, w); })) {
            kept.push_back(w);
            ++n;
        }
    }
    std::stable_sort(kept.begin(), kept.end(),
                     [](const Window& a, const Window& b) { return std::abs(a.z) > std::abs(b.z); });
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
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
    qr.setThreshold(1e-8);
    const Eigen::MatrixXd thin = Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
    return qr.householderQ() * thin;
}

namespace {

/// What is looked for: windows, then signatures; projected as the residual is.
///
/// The whitened shift of a window W e has a number in every row of its run, and there are hundreds of windows a run:
/// kept as a matrix they took 1.6 GB for three runs at 500 Hz. What is wanted is its product with a residual u, freed
/// of what the fit absorbs: e'W'u - (Q'W e)'(Q'u). W'u is taken once for all windows, and e sums its rows.
class Search {
public:
    Search(const Misfit& misfit, const Eigen::MatrixXd& free, const Eigen::MatrixXd& signatures)
        : misfit_(misfit), windows_(windowsOf(misfit)), absorbed_(basisOf(free)) {
        const Eigen::Index n = windows();
        perSize_ = Eigen::VectorXd::Zero(n);
        imitated_.resize(n, absorbed_.cols());
        for (Eigen::Index i = 0; i < n; ++i) {
            Eigen::VectorXd s = shiftOf(misfit, spot(i));
            imitated_.row(i) = (absorbed_.transpose() * s).transpose();
            perSize_[i] = perNorm(s, 0.0);
        }
        signatures_.resize(misfit.rows(), signatures.cols());
        for (Eigen::Index i = 0; i < signatures.cols(); ++i) {
            Eigen::VectorXd s = signatures.col(i);
            // What the nominal parameters imitate to a per cent is round-off, not evidence.
            const double scale = perNorm(s, 0.01);
            signatures_.col(i) = scale * s;
        }
        counted_ = Eigen::VectorXd::Zero(misfit.rows());
        loudest_.resize(misfit.rows());
        for (std::size_t r = 0; r < misfit.runs(); ++r)
            for (Eigen::Index k = 0; k < misfit.rowsOf(r); ++k) {
                counted_[misfit.start(r) + k] = misfit.counts(r, k) ? 1.0 : 0.0;
                loudest_[misfit.start(r) + k] = misfit.isJump(r, k) ? kLoudestJump : kLoudest;
            }
    }
    [[nodiscard]] Eigen::Index windows() const { return static_cast<Eigen::Index>(windows_.size()); }
    [[nodiscard]] Eigen::Index directions() const { return windows() + signatures_.cols(); } ///< and signatures
    [[nodiscard]] const Spot& spot(Eigen::Index window) const { return windows_[static_cast<std::size_t>(window)]; }

    /// Takes out what the fit could have absorbed.
    template <class Matrix>
    void project(Matrix& v) const {
        if (absorbed_.cols() > 0)
            v -= absorbed_ * (absorbed_.transpose() * v);
    }

    /// Statistics, a column each: the shifts of all directions, then the energies of all windows.
    struct Statistics {
        Eigen::MatrixXd quiet; ///< in which no reading counts as more than three noise units: they decide
        Eigen::MatrixXd full;  ///< they say which of the windows that pass are shown
    };
    [[nodiscard]] Statistics of(const Eigen::MatrixXd& projected) const {
        return {statistics(quieted(projected, loudest_)), statistics(projected)};
    }

    /// The same of noise alone.
    [[nodiscard]] Statistics null(std::uint64_t seed, int draws) const {
        const double tails = misfit_.noise().tails;
        const double degrees = tails > 0.0 ? 4.0 + 6.0 / tails : 0.0; // Student's t with this kurtosis
        const auto& possible = misfit_.noise().possible;              // in the order of its grid
        Random random(seed);
        Statistics out{Eigen::MatrixXd(directions() + windows(), draws),
                       Eigen::MatrixXd(directions() + windows(), draws)};
        // Draws at a time: products of matrices instead of many of vectors, some tens of megabytes of them.
        constexpr Eigen::Index kNumbers = 2000000;
        const int kBlock = static_cast<int>(std::clamp<Eigen::Index>(kNumbers / misfit_.rows(), 8, 64));
        for (int first = 0; first < draws; first += kBlock) {
            const int count = std::min(kBlock, draws - first);
            Eigen::MatrixXd v(misfit_.rows(), count);
            for (int b = 0; b < count; ++b) // rows that are missing stay 0 here too
                for (Eigen::Index k = 0; k < v.rows(); ++k)
                    v(k, b) = counted_[k] *
                              (degrees > 0.0 && loudest_[k] == kLoudest ? random.student(degrees) : random.normal());
            for (int b = 0; b < count && !possible.empty(); ++b)
                v.col(b) += beyondProbable(
                    misfit_, possible[static_cast<std::size_t>(41 * (first + b)) % possible.size()], random);
            project(v);
            const Statistics block = of(v);
            out.quiet.middleCols(first, count) = block.quiet;
            out.full.middleCols(first, count) = block.full;
        }
        return out;
    }

    [[nodiscard]] double largestWindow(const Eigen::VectorXd& t) const {
        return std::max(t.head(windows()).cwiseAbs().maxCoeff(), t.tail(windows()).maxCoeff());
    }
    /// Of one signature at least.
    [[nodiscard]] double largestSignature(const Eigen::VectorXd& t) const {
        return t.segment(windows(), directions() - windows()).cwiseAbs().maxCoeff();
    }
    [[nodiscard]] bool signatures() const { return directions() > windows(); }

private:
    /// Projects s; 1 over what is left of its length, 0 where that is round-off.
    double perNorm(Eigen::VectorXd& s, double share) const {
        const double whole = s.norm();
        project(s);
        const double left = s.norm();
        return left > 1e-9 && left > share * whole ? 1.0 / left : 0.0;
    }

    /// Whitening's transposed map of each column, transposed: rows of one window lie apart, draws together.
    [[nodiscard]] Eigen::ArrayXXd unwhitened(const Eigen::MatrixXd& u) const {
        Eigen::ArrayXXd out(u.cols(), u.rows());
        for (std::size_t r = 0; r < misfit_.runs(); ++r) {
            const Eigen::Index from = misfit_.start(r), n = misfit_.rowsOf(r);
            for (Eigen::Index b = 0; b < u.cols(); ++b)
                out.row(b).segment(from, n) = misfit_.whitenTransposed(r, u.col(b).segment(from, n)).transpose();
        }
        return out;
    }

    /// Of residuals, a column each: shifts and signatures first, then energies.
    [[nodiscard]] Eigen::MatrixXd statistics(const Eigen::MatrixXd& u) const {
        const Eigen::Index n = windows(), m = directions();
        Eigen::MatrixXd t(m + n, u.cols());
        t.topRows(n).noalias() = -imitated_ * (absorbed_.transpose() * u);
        t.middleRows(n, m - n).noalias() = signatures_.transpose() * u;
        const Eigen::ArrayXXd squares = u.array().square().transpose(), sums = unwhitened(u);
        for (Eigen::Index i = 0; i < n; ++i) {
            Eigen::ArrayXd e = Eigen::ArrayXd::Zero(u.cols()), s = e;
            const Spot& c = spot(i);
            for (std::size_t k = 0; k < c.rows.size(); ++k) {
                e += squares.col(c.rows[k]);
                s += signOf(c, k) * sums.col(c.rows[k]);
            }
            t.row(i) = perSize_[i] * (t.row(i) + s.matrix().transpose());
            t.row(m + i) = e.unaryExpr([](double x) { return std::cbrt(x); }).matrix().transpose();
        }
        return t;
    }

    const Misfit& misfit_;
    std::vector<Spot> windows_;
    Eigen::MatrixXd absorbed_;   ///< Q, orthonormal
    Eigen::MatrixXd imitated_;   ///< of each window (Q'W e)'
    Eigen::VectorXd perSize_;    ///< of each window 1 / |(1 - QQ') W e|, or 0
    Eigen::MatrixXd signatures_; ///< projected, of unit length, or 0
    Eigen::VectorXd counted_;    ///< of each row, 0 or 1
    Eigen::VectorXd loudest_;
};

/// The largest statistics of every draw.
Families familiesOf(const Search& search, const Standard& standard, const Eigen::MatrixXd& null) {
    std::vector<double> windows, signatures;
    for (Eigen::Index b = 0; b < null.cols(); ++b) {
        const Eigen::VectorXd t = standard(null.col(b));
        windows.push_back(search.largestWindow(t));
        if (search.signatures())
            signatures.push_back(search.largestSignature(t));
    }
    return {windows, signatures};
}

/// Bonferroni's bound on the p of a number of normal deviates.
double bonferroni(Eigen::Index count, double deviate) {
    return static_cast<double>(count) * std::erfc(std::min(deviate, 35.0) / std::sqrt(2.0));
}

} // namespace

Localisation localise(const Misfit& misfit, const Eigen::VectorXd& residual, const Eigen::MatrixXd& free,
                      std::uint64_t seed, int draws, const Eigen::MatrixXd& signatures) {
    const Search search(misfit, free, signatures);
    const Eigen::Index n = search.windows(), m = search.directions();
    Localisation out;
    out.family = static_cast<std::size_t>(m + n);
    if (n == 0) { // too few rows count: nothing stands out, and no effect would
        out.critical = std::numeric_limits<double>::infinity();
        return out;
    }
    const Search::Statistics null = search.null(seed, draws);
    const Standard standard(null.quiet, m), standardFull(null.full, m);
    const Families families = familiesOf(search, standard, null.quiet);
    out.critical =
        (search.signatures() ? families.signatures : families.windows).critical(families.within(kFamilyWise));
    Eigen::VectorXd u = residual;
    search.project(u);
    const Search::Statistics seen = search.of(u);
    const Eigen::VectorXd t = standard(seen.quiet), full = standardFull(seen.full);
    std::vector<Window> found;
    for (Eigen::Index i = 0; i < n; ++i) {
        Window w = search.spot(i).window;
        w.p = families.overall(families.windows.p(std::max(std::abs(t[i]), t[m + i])));
        w.by = std::abs(full[i]) >= full[m + i] ? Seen::Shift : Seen::Energy;
        w.z = w.by == Seen::Shift ? full[i] : full[m + i];
        out.p = std::min(out.p, w.p);
        if (w.p <= kFamilyWise)
            found.push_back(w);
    }
    double tail = bonferroni(2 * n, search.largestWindow(t));
    if (search.signatures()) {
        const double largest = search.largestSignature(t);
        out.p = std::min(out.p, families.overall(families.signatures.p(largest)));
        out.signature = largest;
        tail = 2.0 * std::min(tail, bonferroni(m - n, largest));
    }
    out.tail = out.p * (draws + 1) < 1.5 ? std::min(out.p, tail) : out.p;
    prefer(found, [&](const Window& w) { return !beforeAnything(w, misfit.data()); });
    out.significant = selected(std::move(found));
    return out;
}

} // namespace supercircle::diagnosis
