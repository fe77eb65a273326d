#include "plugin/identification/diagnosis/selection/search.h"

#include "plugin/identification/diagnosis/selection/forms.h"
#include "plugin/identification/diagnosis/selection/learn.h"
#include "plugin/identification/diagnosis/selection/pairs.h"
#include "plugin/identification/diagnosis/selection/weigh.h"

#include <algorithm>
#include <set>

namespace supercircle::diagnosis {

namespace {

/// Share of the misfit on unseen runs that a named effect may leave before laws are learned.
constexpr double kLeftOver = 0.05;

class Search {
public:
    Search(const Ground& ground, const std::function<void(double, const std::string&)>& stage)
        : g_(ground), stage_(stage) {}

    Searched run() {
        const std::vector<Probes> ranked = promising();
        for (std::size_t i = 0; i < ranked.size() && !stopped(); ++i) {
            stage_(0.35 + 0.55 * static_cast<double>(i) / static_cast<double>(ranked.size()),
                   "fitting " + labelOf(*ranked[i].front()));
            tryLabel(ranked[i]);
        }
        // Two rivals are always weighed; others only where they come near.
        std::stable_sort(out_.tried.begin(), out_.tried.end(),
                         [](const Tried& a, const Tried& b) { return a.fit.misfit < b.fit.misfit; });
        while (out_.tried.size() > 2 && out_.tried.back().fit.misfit > 3.0 * least_)
            out_.tried.pop_back();
        dropIdle();
        for (Tried& t : out_.tried)
            if (!stopped())
                t.held = scored(t.fit);
        if (!stopped())
            tryMore();
        return std::move(out_);
    }

private:
    [[nodiscard]] bool stopped() const { return g_.evaluator.stopped(); }
    [[nodiscard]] const std::string& labelOf(const Screened& s) const {
        return g_.evaluator.model().candidates()[s.candidate].label;
    }
    [[nodiscard]] HeldOut scored(const Fitted& f) const {
        return usable(heldOutOf(g_.evaluator, g_.misfit, g_.grouping, f, g_.settings), g_.baseHeld);
    }
    [[nodiscard]] std::vector<Probes> promising() const;
    void tryLabel(const Probes& probes);
    void dropIdle();
    void tryMore();
    void tryForms(double dispersion);
    void tryAfresh(double dispersion);
    void settle(double dispersion);
    [[nodiscard]] bool leavesTooMuch() const;
    [[nodiscard]] bool pairsCanCount(double dispersion) const;
    void tryPairs();
    void tryLearned(double left);
    void rank(double dispersion);

    const Ground& g_;
    const std::function<void(double, const std::string&)>& stage_;
    Searched out_;
    std::set<std::size_t> fitted_; ///< candidates that were fitted in full
    double least_ = 0.0;           ///< misfit of any fit so far
};

std::vector<Probes> Search::promising() const {
    // Less is luck: 8 is a p-value of half a per cent for one number.
    std::vector<Probes> ranked = byLabel(g_.evaluator.model(), g_.screened, 8.0);
    // A first look is linear and may be wrong by much, not by a factor of thirty.
    while (ranked.size() > 3 &&
           (ranked.size() > g_.settings.fits || ranked.back().front()->gain < ranked.front().front()->gain / 30.0))
        ranked.pop_back();
    return ranked;
}

void Search::tryLabel(const Probes& probes) {
    auto best = fitLabel(g_.evaluator, g_.misfit, g_.base, probes, least_, fitted_);
    if (best && !stopped() && best->fit.misfit <= g_.base.misfit - 1.0)
        out_.tried.push_back(std::move(*best));
}

/// A law whose threshold was never reached changes no reading: what its fit gained are better nominal numbers, and it
/// is no hypothesis.
void Search::dropIdle() {
    constexpr double kActs = 1.0; // noise units, of all readings together: half a square at most
    for (auto t = out_.tried.begin(); t != out_.tried.end() && !stopped();) {
        Point without = t->fit.point;
        without.terms.clear();
        const auto there = g_.evaluator.everywhere({without}, Fineness::Fine).front();
        const auto changed = stopped() ? std::nullopt : g_.misfit.difference(t->fit.responses, there);
        if (!changed || changed->norm() >= kActs) {
            ++t;
            continue;
        }
        if (!out_.elsewhere || t->fit.misfit < out_.least) {
            out_.elsewhere = std::move(without);
            out_.least = t->fit.misfit;
        }
        t = out_.tried.erase(t);
    }
}

/// Where the best single effect leaves something: two at a time, and laws that are learned.
void Search::tryMore() {
    // Scores at one dispersion rank the singles; the first of them is what the rest must beat.
    double least = dispersionOf(g_.baseHeld);
    for (const Tried& t : out_.tried)
        least = std::min(least, dispersionOf(t.held));
    const double dispersion = std::max(1.0, least);
    rank(dispersion);
    const double bound = noiseBound(g_.baseHeld.rows.sum(), g_.tails, g_.noiseSquares),
                 excess = dispersionOf(g_.baseHeld) - 1.0;
    const auto share = [&](const Tried& t) {
        const double beyond = dispersionOf(t.held) - bound;
        return excess > 0.0 ? std::max(0.0, beyond) / excess : beyond > 0.0 ? 1.0 : 0.0;
    };
    double left = 1.0;
    if (!out_.tried.empty()) {
        out_.left = leftBy(g_.evaluator.model(), g_.misfit, out_.tried.front().fit, g_.settings);
        if (out_.left.p <= 0.01 && share(out_.tried.front()) > kLeftOver)
            tryForms(dispersion);
        if (leavesTooMuch())
            tryAfresh(dispersion);
        left = share(out_.tried.front());
        if (out_.left.p <= 0.01 && pairsCanCount(dispersion)) {
            const std::size_t singles = out_.tried.size();
            tryPairs();
            for (std::size_t i = singles; i < out_.tried.size(); ++i)
                left = std::min(left, share(out_.tried[i]));
        }
    }
    if (g_.p <= 0.01 && left > kLeftOver && !g_.settings.ablation.unknown)
        tryLearned(left);
}

void Search::tryForms(double dispersion) {
    stage_(0.78, "other forms of the best laws");
    for (std::size_t i = 0; i < out_.tried.size() && i < 2; ++i) {
        Tried& known = out_.tried[i];
        auto better = betterForm(g_.evaluator, g_.misfit, g_.base, g_.screened, known, fitted_);
        if (!better || stopped())
            continue;
        better->held = scored(better->fit);
        if (better->held.score(dispersion).sum() > known.held.score(dispersion).sum())
            known = std::move(*better);
    }
    settle(dispersion);
}

/// Which is the best, and what it leaves.
void Search::settle(double dispersion) {
    rank(dispersion);
    out_.left = leftBy(g_.evaluator.model(), g_.misfit, out_.tried.front().fit, g_.settings);
}

/// More than an effect that is all there is.
bool Search::leavesTooMuch() const {
    return diagnosis::leavesTooMuch(g_.baseHeld, out_.tried.front().held, g_.tails, g_.noiseSquares,
                                    standsOut(out_.left));
}

/// The two best singles once more, from the stated numbers.
void Search::tryAfresh(double dispersion) {
    stage_(0.79, "the best laws from the stated numbers");
    bool any = false;
    for (std::size_t i = 0; i < out_.tried.size() && i < 2 && !stopped(); ++i) {
        auto better = fromStated(g_.evaluator, g_.misfit, out_.tried[i]);
        if (!better || stopped())
            continue;
        better->held = scored(better->fit);
        out_.tried[i] = std::move(*better);
        any = true;
    }
    if (any)
        settle(dispersion);
}

/// Whether the best single effect leaves room for a second one, or what it leaves beyond pure noise, all of it, would
/// make a pair material. (The mean alone says little: beside a play and plasticity of a strip the misfit of all rows
/// was .91, because the noise of the markers was stated too large, and the play left seven windows, the largest of 7.7
/// deviations.)
bool Search::pairsCanCount(double dispersion) const {
    const HeldOut& best = out_.tried.front().held;
    if (leavesRoom(g_.baseHeld, best, g_.tails, g_.noiseSquares, standsOut(out_.left)))
        return true;
    const double rows = best.rows.sum(), floor = rows - 2.0 * std::sqrt(2.0 * rows);
    const double gain = best.score(dispersion).sum() - g_.baseHeld.score(dispersion).sum();
    return 0.5 * (best.energy.sum() - floor) / dispersion > kMaterial * gain;
}

void Search::tryPairs() {
    stage_(0.8, "two effects at a time");
    for (Tried& t : fitPairs(g_.evaluator, g_.misfit, out_.tried, g_.settings.probeShare())) {
        if (stopped())
            return;
        t.held = scored(t.fit);
        out_.tried.push_back(std::move(t));
    }
}

void Search::tryLearned(double left) {
    stage_(0.85, "learning a law");
    const std::size_t named = out_.tried.size();
    // The more is left, the more is worth trying.
    for (Tried& t : learn(g_.evaluator, g_.misfit, g_.base, left > 0.3 ? 3 : 2)) {
        if (stopped())
            return;
        t.held = scored(t.fit);
        for (std::size_t i = 0; i < named; ++i)
            t.parts.push_back(i);
        out_.tried.push_back(std::move(t));
    }
}

void Search::rank(double dispersion) {
    std::stable_sort(out_.tried.begin(), out_.tried.end(), [&](const Tried& a, const Tried& b) {
        return a.held.score(dispersion).sum() > b.held.score(dispersion).sum();
    });
}

} // namespace

HeldOut heldOutOf(Evaluator& evaluator, const Misfit& misfit, const Grouping& grouping, const Fitted& fitted,
                  const Settings& settings) {
    return settings.ablation.heldOut ? inSample(misfit, grouping, fitted)
                                     : leaveOut(evaluator, misfit, grouping, fitted);
}

Localisation leftBy(const Model& model, const Misfit& misfit, const Fitted& fitted, const Settings& settings) {
    // Draws of their own: the null of the nominal fit's misfit has been looked at.
    return localise(misfit, fitted.residual, freeColumns(model, fitted), settings.seed + 2, settings.draws);
}

Searched search(const Ground& ground, const std::function<void(double, const std::string&)>& stage) {
    return Search(ground, stage).run();
}

} // namespace supercircle::diagnosis
