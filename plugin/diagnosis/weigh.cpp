#include "plugin/diagnosis/weigh.h"

#include "plugin/diagnosis/random.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

double dispersionOf(const HeldOut& h) {
    return h.rows.sum() > 0.0 ? h.energy.sum() / h.rows.sum() : 1.0;
}

Eigen::VectorXd unknownScore(const HeldOut& nothing, double dispersion, double floor) {
    const double rows = std::max(1.0, nothing.rows.sum());
    // Pure noise has an energy of `rows` give or take sqrt(2 rows), and the noise's size is known to some 5 %.
    floor *= 1.1 + 2.0 * std::sqrt(2.0 / rows);
    const double toExplain = 0.5 * std::max(0.0, nothing.energy.sum() - floor * rows) / dispersion;
    const double cost = std::max(4.0 * std::log(std::max(2.0, rows)), 0.15 * toExplain);
    // It has the nominal parameters' uncertainty too.
    return -(0.5 * floor / dispersion + cost / rows) * nothing.rows - 0.5 * nothing.volume;
}

void improvementOf(const HeldOut& from, const HeldOut& to, Random& random, Weighed& out) {
    constexpr int kDraws = 1000;
    const auto fall = [](double a, double b) { return a > 0.0 ? 1.0 - std::sqrt(b / a) : 0.0; };
    out.improvement = fall(from.energy.sum(), to.energy.sum());
    std::vector<double> draws;
    for (int d = 0; d < kDraws; ++d) {
        double a = 0.0, b = 0.0;
        for (Eigen::Index k = 0; k < from.energy.size(); ++k) {
            const double w = random.exponential();
            a += w * from.energy[k];
            b += w * to.energy[k];
        }
        draws.push_back(fall(a, b));
    }
    std::sort(draws.begin(), draws.end());
    out.improvementLow = draws[kDraws / 20];
    out.improvementHigh = draws[kDraws - 1 - kDraws / 20];
}

} // namespace

Paired paired(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const Eigen::VectorXd d = a - b;
    const double n = static_cast<double>(std::max<Eigen::Index>(1, d.size()));
    const double variance = n > 1.0 ? (d.array() - d.mean()).square().sum() / (n - 1.0) : 0.0;
    return {d.sum(), std::sqrt(n * variance)};
}

bool alike(const HeldOut& a, const HeldOut& b, double distance, double dispersion) {
    if (distance / std::sqrt(dispersion) < 3.0)
        return true;
    const Paired p = paired(a.score(dispersion), b.score(dispersion));
    return std::abs(p.difference) < 2.0 * p.error && std::abs(p.difference) < 8.0;
}

Weighed weigh(const HeldOut& nothing, const std::vector<HeldOut>& effects, std::size_t catalogue, std::uint64_t seed) {
    Weighed out;
    double least = dispersionOf(nothing);
    for (const HeldOut& h : effects)
        least = std::min(least, dispersionOf(h));
    out.dispersion = std::max(1.0, least);
    const Eigen::Index blocks = nothing.energy.size();
    std::vector<Eigen::VectorXd> scores = {nothing.score(out.dispersion),
                                           unknownScore(nothing, out.dispersion, std::min(1.0, least))};
    std::vector<double> prior = {0.3, 0.1};
    for (const HeldOut& h : effects) {
        scores.push_back(h.score(out.dispersion));
        prior.push_back(0.6 / static_cast<double>(std::max(catalogue, effects.size())));
        const Paired p = paired(scores.back(), scores.front());
        out.gain.push_back(p.difference);
        out.gainError.push_back(p.error);
    }
    if (!out.gain.empty())
        out.best = static_cast<std::size_t>(std::max_element(out.gain.begin(), out.gain.end()) - out.gain.begin());
    // Effects that were not worth a fit do not foretell better than nothing does; their prior stays with it.
    if (catalogue > effects.size())
        prior[0] += 0.6 * static_cast<double>(catalogue - effects.size()) / static_cast<double>(catalogue);
    std::vector<double> sum(scores.size(), 0.0);
    std::vector<std::vector<double>> gains(effects.size());
    Random random(seed);
    constexpr int kDraws = 2000;
    for (int d = 0; d < kDraws; ++d) {
        Eigen::VectorXd w(blocks);
        for (double& x : w)
            x = random.exponential();
        w *= static_cast<double>(blocks) / w.sum();
        std::vector<double> s;
        for (std::size_t m = 0; m < scores.size(); ++m)
            s.push_back(std::log(prior[m]) + w.dot(scores[m]));
        for (std::size_t m = 0; m < effects.size(); ++m)
            gains[m].push_back(w.dot(scores[m + 2] - scores.front()));
        const double top = *std::max_element(s.begin(), s.end());
        double total = 0.0;
        for (double& x : s)
            total += x = std::exp(x - top);
        for (std::size_t m = 0; m < s.size(); ++m)
            sum[m] += s[m] / total / kDraws;
    }
    for (std::vector<double>& g : gains) {
        std::sort(g.begin(), g.end());
        out.gainLow.push_back(g[static_cast<std::size_t>(0.023 * kDraws)]);
    }
    out.nothing = sum[0];
    out.unknown = sum[1];
    out.effects.assign(sum.begin() + 2, sum.end());
    if (!effects.empty())
        improvementOf(nothing, effects[out.best], random, out);
    return out;
}

} // namespace supercircle::diagnosis
