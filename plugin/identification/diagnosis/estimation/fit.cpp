#include "plugin/identification/diagnosis/fit.h"

#include "plugin/identification/diagnosis/box.h"
#include "plugin/identification/diagnosis/estimation/grow.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

namespace supercircle::diagnosis {

Variables::Variables(const Model& model, const Point& like) : scalars_(model.nominal()), like_(like) {
    nominal = static_cast<Eigen::Index>(scalars_.size());
    for (const Term& t : like.terms)
        for (const Scalar& s : model.candidates()[t.candidate].parameters)
            scalars_.push_back(s);
    lower.resize(static_cast<Eigen::Index>(scalars_.size()));
    upper = lower;
    for (Eigen::Index i = 0; i < size(); ++i) {
        lower[i] = (scalar(i).lower - scalar(i).value) / scalar(i).step;
        upper[i] = (scalar(i).upper - scalar(i).value) / scalar(i).step;
    }
    penalty = Eigen::MatrixXd::Zero(size(), size());
    Eigen::Index first = nominal;
    for (const Term& t : like.terms) {
        const auto n = static_cast<Eigen::Index>(t.values.size());
        if (model.candidates()[t.candidate].learned)
            penalty.block(first, first, n, n) = roughness(n, t.smoothing);
        first += n;
    }
}

/// P. H. C. Eilers, B. D. Marx (1996): second differences of neighbouring coefficients, and their size.
Eigen::MatrixXd roughness(Eigen::Index n, double smoothing) {
    constexpr double kBend = 1.0, kSize = 6.0; // steps: deviations of second differences and of coefficients
    Eigen::MatrixXd d = Eigen::MatrixXd::Zero(n - 2, n);
    for (Eigen::Index i = 0; i + 2 < n; ++i)
        d.row(i).segment(i, 3) << 1.0, -2.0, 1.0;
    return smoothing / (kBend * kBend) * d.transpose() * d + Eigen::MatrixXd::Identity(n, n) / (kSize * kSize);
}

Eigen::VectorXd Variables::of(const Point& point) const {
    Eigen::VectorXd x(size());
    Eigen::Index i = 0;
    const auto put = [&](double v) {
        x[i] = (v - scalar(i).value) / scalar(i).step;
        ++i;
    };
    std::for_each(point.nominal.begin(), point.nominal.end(), put);
    for (const Term& t : point.terms)
        std::for_each(t.values.begin(), t.values.end(), put);
    return x.cwiseMax(lower).cwiseMin(upper);
}

Point Variables::at(const Eigen::VectorXd& x) const {
    Point p = like_;
    Eigen::Index i = 0;
    const auto put = [&](double& v) {
        const Scalar& s = scalar(i);
        v = std::clamp(s.value + x[i] * s.step, s.lower, s.upper);
        ++i;
    };
    std::for_each(p.nominal.begin(), p.nominal.end(), put);
    for (Term& t : p.terms)
        std::for_each(t.values.begin(), t.values.end(), put);
    return p;
}

namespace {

std::vector<Eigen::Index> range(Eigen::Index from, Eigen::Index to) {
    std::vector<Eigen::Index> all;
    for (Eigen::Index i = from; i < to; ++i)
        all.push_back(i);
    return all;
}

/// Two neighbours of x in one coordinate, inside the box.
struct Neighbours {
    Neighbours(const Variables& v, const Eigen::VectorXd& x, Eigen::Index c, double difference)
        : column(c), up(x), down(x) {
        up[c] = std::min(x[c] + difference, v.upper[c]);
        down[c] = std::max(x[c] - difference, v.lower[c]);
        toUp = up[c] - x[c];
        toDown = x[c] - down[c];
    }
    [[nodiscard]] double span() const { return up[column] - down[column]; }
    Eigen::Index column;
    Eigen::VectorXd up, down;
    double toUp = 0.0, toDown = 0.0;
};

/// Above and below, of one after the other.
std::vector<Point> pointsOf(const Variables& v, const std::vector<Neighbours>& all) {
    std::vector<Point> points;
    for (const Neighbours& n : all) {
        points.push_back(v.at(n.up));
        points.push_back(v.at(n.down));
    }
    return points;
}

/// How far to go for the derivative by a number, where over `span` it changed all readings by `change`.
/// Where a step of the simulation ends just before a kink of the force at one place and just behind it at the next, a
/// single reading changes by half a noise unit. Beside a number that hardly changes any reading that is most of its
/// column: of an arch's thickness two thirds were such readings, so that a residual projected on what the nominal
/// numbers can do kept what they can do, and gravity stood out of a recording that lacks nothing (p = .007). Over a
/// difference k times as wide they are divided by k, and numbers as faint as that are linear enough for it.
double widened(double difference, double change) {
    constexpr double kPlain = 20.0, kWidest = 1.0; // noise units; of the stated half-width
    return change > 0.0 ? std::clamp(difference * kPlain / change, difference, kWidest) : kWidest;
}

/// Derivatives by the numbers `only`, those that are faint over more of their interval. Only stated numbers: what an
/// effect does may begin at a threshold, and numbers of free scenes have no bounds.
/// @param take fills columns of `into` from their neighbours in x
template <class Take>
void inTwoGoes(const Misfit& misfit, const Variables& v, const Eigen::VectorXd& x, double difference,
               const std::vector<Eigen::Index>& only, const Evaluator& evaluator, Eigen::MatrixXd& into,
               const Take& take) {
    // A fifth of what is open of the spin at which a free body is let go turns its last swing by half a swing; its
    // motion is smooth, and a hundredth is enough.
    constexpr double kFree = 0.05;
    std::vector<Neighbours> near, wide;
    for (const Eigen::Index c : only) {
        into.col(c).setZero();
        near.emplace_back(v, x, c, misfit.data().free ? kFree * difference : difference);
    }
    take(near);
    for (const Neighbours& n : near)
        if (const double wider = widened(difference, into.col(n.column).norm() * n.span());
            wider > difference && n.column < v.nominal && !misfit.data().free)
            wide.emplace_back(v, x, n.column, wider);
    if (!wide.empty() && !evaluator.stopped())
        take(wide);
}

/// The quieter of two one-sided derivatives, if a branch ends between the other neighbour and here: a strip that slips
/// or buckles to the other side reads something else everywhere. Such a column (17 472 noise units per half-width, 97
/// on the branch) held its number, and with it what it stands for, where the search began: a control's nominal fit
/// ended 160 squares above its minimum, and gravity and a defect of the curvature had it beaten (47 of seed 2039).
std::optional<Eigen::VectorXd> onThisBranch(const Misfit& misfit, const std::vector<Response>& here,
                                            const Neighbours& n, const std::vector<Response>& up,
                                            const std::vector<Response>& down) {
    constexpr double kElsewhere = 4.0; // times as much to one side as to the other
    const auto above = misfit.difference(up, here), below = misfit.difference(here, down);
    if (!above || !below || !(n.toUp > 0.0) || !(n.toDown > 0.0))
        return std::nullopt;
    const double a = above->norm() / n.toUp, b = below->norm() / n.toDown;
    if (std::max(a, b) < kElsewhere * std::min(a, b))
        return std::nullopt;
    return Eigen::VectorXd(a < b ? *above / n.toUp : *below / n.toDown);
}

/// Of two neighbours of which one cannot be simulated. Friction that falls with speed makes a specimen stick and slip a
/// little further on; with the column zero its strength stayed where the search began, with an error of what is
/// plausible at all, and no further run was found that could tell it from nothing (27 of seed 2039).
std::optional<Eigen::VectorXd> fromTheOtherSide(const Misfit& misfit, const std::vector<Response>& here,
                                                const Neighbours& n, const std::vector<Response>& up,
                                                const std::vector<Response>& down) {
    if (const auto above = n.toUp > 0.0 ? misfit.difference(up, here) : std::nullopt)
        return Eigen::VectorXd(*above / n.toUp);
    if (const auto below = n.toDown > 0.0 ? misfit.difference(here, down) : std::nullopt)
        return Eigen::VectorXd(*below / n.toDown);
    return std::nullopt;
}

} // namespace

bool differentiate(Evaluator& evaluator, const Misfit& misfit, const Variables& v, const Eigen::VectorXd& x,
                   double difference, const std::vector<Eigen::Index>& only, Eigen::MatrixXd& into, Fineness fineness) {
    constexpr double kLoud = 5.0; // noise units a reading: no stated number does that nearby, if noise can be seen
    const double loud = kLoud * std::sqrt(static_cast<double>(misfit.present()));
    bool edge = false;
    std::vector<Eigen::Index> lost; // to both sides
    std::vector<Response> here;
    const auto middle = [&]() -> const std::vector<Response>& {
        if (here.empty())
            here = evaluator.everywhere({v.at(x)}, fineness).front();
        return here;
    };
    into.conservativeResize(misfit.rows(), v.size());
    inTwoGoes(misfit, v, x, difference, only, evaluator, into, [&](const std::vector<Neighbours>& beside) {
        const auto answers = evaluator.everywhere(pointsOf(v, beside), fineness);
        for (std::size_t i = 0; i < beside.size(); ++i) {
            const Neighbours& n = beside[i];
            const std::vector<Response>&up = answers[2 * i], &down = answers[2 * i + 1];
            const auto change = misfit.difference(up, down);
            if (!(n.span() > 0.0))
                continue;
            if (!change) {
                if (const auto one = fromTheOtherSide(misfit, middle(), n, up, down))
                    into.col(n.column) = *one;
                else if (into.col(n.column).isZero(0.0))
                    lost.push_back(n.column);
                continue;
            }
            into.col(n.column) = *change / n.span();
            // What an effect does may begin at a threshold, and free bodies go where they like.
            if (change->norm() < loud || n.column >= v.nominal || misfit.data().free)
                continue;
            if (const auto quieter = onThisBranch(misfit, middle(), n, up, down)) {
                into.col(n.column) = *quieter;
                edge = true;
            }
        }
    });
    // What sticks and slips may be too much for the coarse simulation alone.
    if (fineness == Fineness::Coarse && !lost.empty() && !evaluator.stopped())
        edge = differentiate(evaluator, misfit, v, x, difference, lost, into, Fineness::Fine) || edge;
    return edge;
}

namespace {

/// Of the slopes to either side the smaller one, reading by reading; of one that does not exist (a bound, a run that
/// failed) the other.
Eigen::VectorXd nearerToZero(const Departure& up, double toUp, const Departure& down, double toDown,
                             Eigen::Index rows) {
    const bool above = toUp > 0.0 && up.rows.size() == rows, below = toDown > 0.0 && down.rows.size() == rows;
    if (!above && !below)
        return Eigen::VectorXd::Zero(rows);
    const Eigen::VectorXd a = above ? Eigen::VectorXd(up.rows / toUp) : Eigen::VectorXd(down.rows / toDown);
    const Eigen::VectorXd b = below ? Eigen::VectorXd(down.rows / toDown) : a;
    return a.binaryExpr(b, [](double p, double q) { return std::abs(p) < std::abs(q) ? p : q; });
}

/// Whitened, of all readings; zero where it is not known.
Eigen::VectorXd slope(const Misfit& misfit, const std::vector<Response>& here, const std::vector<Response>& above,
                      double toUp, const std::vector<Response>& below, double toDown) {
    Eigen::VectorXd out(misfit.rows()); // slopes before they are whitened: whitening spreads a jump
    for (std::size_t r = 0; r < here.size(); ++r)
        out.segment(misfit.start(r), misfit.rowsOf(r)) =
            misfit.whiten(r, nearerToZero(misfit.change(r, above[r], here[r]), toUp,
                                          misfit.change(r, here[r], below[r]), toDown, misfit.rowsOf(r)));
    return out.allFinite() ? out : Eigen::VectorXd::Zero(misfit.rows());
}

} // namespace

Eigen::MatrixXd differentiateCarefully(Evaluator& evaluator, const Misfit& misfit, const Variables& v,
                                       const Eigen::VectorXd& x, double difference) {
    Eigen::MatrixXd out(misfit.rows(), v.size());
    const auto here = evaluator.everywhere({v.at(x)}, Fineness::Coarse).front();
    inTwoGoes(misfit, v, x, difference, range(0, v.size()), evaluator, out, [&](const std::vector<Neighbours>& beside) {
        const auto answers = evaluator.everywhere(pointsOf(v, beside), Fineness::Coarse);
        for (std::size_t i = 0; i < beside.size(); ++i)
            out.col(beside[i].column) =
                slope(misfit, here, answers[2 * i], beside[i].toUp, answers[2 * i + 1], beside[i].toDown);
    });
    return out;
}

Eigen::VectorXd slopeAlong(Evaluator& evaluator, const Misfit& misfit, const Variables& v, const Eigen::VectorXd& x,
                           const Eigen::VectorXd& up, const Eigen::VectorXd& down, Eigen::Index by) {
    const auto answers = evaluator.everywhere({v.at(x), v.at(up), v.at(down)}, Fineness::Coarse);
    return slope(misfit, answers[0], answers[1], up[by] - x[by], answers[2], x[by] - down[by]);
}

bool evaluate(Evaluator& evaluator, const Misfit& misfit, const Variables& v, Fitted& f) {
    f.point = v.at(f.x);
    f.responses = evaluator.everywhere({f.point}, Fineness::Fine).front();
    for (const Response& r : f.responses)
        if (!r.failure.empty())
            f.failure = r.failure;
    const auto residual = misfit.residual(f.responses);
    if (!residual)
        return false;
    f.residual = *residual;
    f.misfit = f.residual.squaredNorm() + misfit.charge(f.responses).sum();
    f.cost = f.misfit + f.x.dot(v.penalty * f.x);
    return true;
}

void learnFrom(Eigen::MatrixXd& jacobian, const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
    jacobian += (change - jacobian * step) * step.transpose() / step.squaredNorm();
}

namespace {

/// One search from a start; a class because its steps share much.
class Search {
public:
    Search(Evaluator& evaluator, const Misfit& misfit, const Point& start, const FitSettings& settings)
        : evaluator_(evaluator), misfit_(misfit), settings_(settings), v_(evaluator.model(), start) {
        now_.x = v_.of(start);
    }

    Fitted run(const Eigen::MatrixXd& known) {
        if (!evaluate(now_)) {
            now_.failure = now_.failure.empty() ? "the start cannot be simulated" : now_.failure;
            return now_;
        }
        const bool fits = known.rows() == misfit_.rows() && known.cols() <= v_.size();
        const Eigen::Index given = fits ? known.cols() : 0;
        now_.jacobian.setZero(misfit_.rows(), v_.size());
        if (given > 0)
            now_.jacobian.leftCols(given) = known;
        if (given < v_.size())
            differentiate(evaluator_, misfit_, v_, now_.x, settings_.difference, range(given, v_.size()),
                          now_.jacobian);
        // Of two effects the first one's columns come from its own search, which has learnt them on the way.
        if (given > v_.nominal && v_.size() > v_.nominal)
            age_ = Age::Learnt;
        constexpr int kMoreTrials = 8; // steps that fail cost simulations, but not the way that is left
        while (!done_ && now_.iterations < settings_.iterations && trials_ < settings_.iterations + kMoreTrials &&
               !evaluator_.stopped())
            iterate();
        return now_;
    }

private:
    bool evaluate(Fitted& f) const { return supercircle::diagnosis::evaluate(evaluator_, misfit_, v_, f); }

    void iterate() {
        ++trials_;
        Eigen::MatrixXd G = now_.jacobian.transpose() * now_.jacobian + v_.penalty;
        const Eigen::VectorXd g = now_.jacobian.transpose() * now_.residual - v_.penalty * now_.x;
        const double typical = std::max(1e-12, G.diagonal().mean());
        G.diagonal() += damping_ * (G.diagonal().array() + 1e-3 * typical).matrix();
        constexpr double kFar = 2.0; // steps in one go
        const Eigen::VectorXd far = Eigen::VectorXd::Constant(v_.size(), kFar);
        const Eigen::VectorXd step =
            boxMinimum(G, g, (v_.lower - now_.x).cwiseMax(-far), (v_.upper - now_.x).cwiseMin(far));
        const Eigen::VectorXd to = now_.x + step;
        // What hides behind a late jump is charged for (Misfit::charge) and stays, as far as derivatives know.
        const double foreseen = now_.residual.squaredNorm() + now_.x.dot(v_.penalty * now_.x) -
                                (now_.residual - now_.jacobian * step).squaredNorm() - to.dot(v_.penalty * to);
        if (foreseen < settings_.enough) {
            finishOrRefresh();
            return;
        }
        Fitted trial;
        trial.x = to;
        if (evaluate(trial) && trial.cost < now_.cost)
            accept(std::move(trial), step, foreseen);
        else
            reject();
    }

    /// Damping of .001, .01 and .1 shortens a step by nothing, 1 and 9 %: what failed would fail again.
    void reject() {
        damping_ = std::max(10.0 * damping_, 0.3);
        const int most = age_ == Age::Fresh ? 4 : 2;
        if (++rejected_ >= most || damping_ > 1e4)
            finishOrRefresh();
    }

    void accept(Fitted&& trial, const Eigen::VectorXd& step, double foreseen) {
        rejected_ = 0;
        age_ = Age::Learnt;
        trial.iterations = now_.iterations + 1;
        const double gain = now_.cost - trial.cost;
        const bool hopeless = trials_ >= 5 && trial.misfit > 3.0 * settings_.rival && gain < 0.1 * trial.misfit;
        trial.jacobian = std::move(now_.jacobian);
        if (const auto change = misfit_.difference(trial.responses, now_.responses))
            learnFrom(trial.jacobian, step, *change);
        damping_ = std::max(1e-6, gain > 0.5 * foreseen ? damping_ / 10.0 : damping_);
        now_ = std::move(trial);
        if (settings_.rival > 0.0 && hopeless)
            done_ = true;
        else if (gain < settings_.enough)
            finishOrRefresh();
        else if (gain < 0.5 * foreseen && !behind()) // the derivatives are not those of this place
            refreshMoved();
    }

    [[nodiscard]] bool behind() const { return settings_.rival > 0.0 && now_.misfit > 3.0 * settings_.rival; }

    /// At a dead end of old derivatives new ones may know the way on: those that have moved most first, and where they
    /// do not help the nominal ones.
    void finishOrRefresh() { done_ = behind() || !(refreshMoved() || refreshRest()); }

    /// Derivatives by the effect's numbers; by the nominal ones where they are alone.
    bool refreshMoved() {
        if (age_ != Age::Learnt || refreshes_ >= settings_.refreshes)
            return false;
        ++refreshes_;
        const bool alone = v_.size() == v_.nominal;
        refresh(range(alone ? 0 : v_.nominal, v_.size()));
        age_ = alone ? Age::Fresh : Age::Moved;
        return true;
    }

    bool refreshRest() {
        if (age_ == Age::Fresh || v_.size() == v_.nominal || rests_ >= settings_.rests)
            return false;
        ++rests_;
        refresh(range(0, age_ == Age::Moved ? v_.nominal : v_.size()));
        age_ = Age::Fresh;
        return true;
    }

    void refresh(const std::vector<Eigen::Index>& columns) {
        differentiate(evaluator_, misfit_, v_, now_.x, settings_.difference, columns, now_.jacobian);
        rejected_ = 0;
        damping_ = std::min(damping_, 1e-2);
    }

    Evaluator& evaluator_;
    const Misfit& misfit_;
    const FitSettings& settings_;
    Variables v_;
    Fitted now_;
    double damping_ = 1e-3;
    int trials_ = 0, rejected_ = 0, refreshes_ = 0, rests_ = 0;
    /// Of the derivatives: all of them taken here, only those that have moved, or learnt from steps.
    enum class Age : std::uint8_t { Fresh, Moved, Learnt } age_ = Age::Fresh;
    bool done_ = false;
};

} // namespace

Fitted fit(Evaluator& evaluator, const Misfit& misfit, const Point& start, const FitSettings& settings,
           const Eigen::MatrixXd& known) {
    const bool grow = settings.grow && misfit.data().free;
    FitSettings given = settings;
    if (misfit.data().free) // runs are cheap, and bends of long swings are hardly learnt from steps
        given.refreshes = given.rests = given.iterations;
    return Search(evaluator, misfit, grow ? grown(evaluator, misfit, start, given) : start, given)
        .run(grow ? Eigen::MatrixXd() : known);
}

Eigen::MatrixXd posteriorOf(const Variables& v, const Eigen::MatrixXd& jacobian, double dispersion) {
    Eigen::MatrixXd precision = jacobian.transpose() * jacobian / std::max(1.0, dispersion);
    for (Eigen::Index k = 0; k < v.size(); ++k) {
        const double width = std::min(v.upper[k] - v.lower[k], 1e3);
        precision(k, k) += 12.0 / (width * width);
    }
    return precision.ldlt().solve(Eigen::MatrixXd::Identity(v.size(), v.size()));
}

double misfitPerRow(const Misfit& misfit, const Fitted& f) {
    return f.misfit / static_cast<double>(std::max<Eigen::Index>(1, misfit.present()));
}

Eigen::MatrixXd freeColumns(const Model& model, const Fitted& f) {
    const Variables v(model, f.point);
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < v.size(); ++i)
        if (f.x[i] > v.lower[i] + 1e-6 && f.x[i] < v.upper[i] - 1e-6)
            free.push_back(i);
    Eigen::MatrixXd columns(f.jacobian.rows(), static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i)
        columns.col(static_cast<Eigen::Index>(i)) = f.jacobian.col(free[i]);
    return columns;
}

std::vector<Eigen::Index> pressedAmplitudes(const Model& model, const Fitted& f, double dispersion) {
    constexpr double kDeviations = 3.0;
    std::vector<Eigen::Index> out;
    const Variables v(model, f.point);
    if (f.residual.size() == 0 || f.jacobian.rows() != f.residual.size() || f.jacobian.cols() != v.size())
        return out;
    const Eigen::MatrixXd free = freeColumns(model, f);
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> follow(free);
    for (Eigen::Index i = v.nominal; i < v.size(); ++i) {
        // The bound at which an effect is absent is no far end.
        const bool up = f.x[i] >= v.upper[i] - 1e-6 && v.upper[i] > 1e-6,
                   down = f.x[i] <= v.lower[i] + 1e-6 && v.lower[i] < -1e-6;
        if (!v.scalar(i).amplitude || (!up && !down))
            continue;
        Eigen::VectorXd own = f.jacobian.col(i);
        if (free.cols() > 0)
            own -= free * follow.solve(own);
        const double size = own.norm();
        if (size > 0.0 && (up ? 1.0 : -1.0) * own.dot(f.residual) / size > kDeviations * std::sqrt(dispersion))
            out.push_back(i);
    }
    return out;
}

} // namespace supercircle::diagnosis
