#include "plugin/identification/diagnosis/evaluator.h"

#include <algorithm>
#include <cstring>
#include <map>

namespace supercircle::diagnosis {

namespace {

void put(std::string& to, const void* raw, std::size_t n) {
    to.append(static_cast<const char*>(raw), n);
}

/// The question as bytes: equal exactly if the simulations are.
std::string keyOf(const Question& q) {
    std::string key;
    const std::uint64_t head[] = {q.run, static_cast<std::uint64_t>(q.fineness), q.point.nominal.size()};
    put(key, head, sizeof head);
    put(key, q.point.nominal.data(), q.point.nominal.size() * sizeof(double));
    for (const Term& t : q.point.terms) {
        const std::uint64_t at[] = {t.candidate, t.values.size()};
        put(key, at, sizeof at);
        put(key, t.values.data(), t.values.size() * sizeof(double));
    }
    return key;
}

bool same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return a.size() == b.size() && (a.array() == b.array() || (a.array().isNaN() && b.array().isNaN())).all();
}

} // namespace

void Evaluator::checkStore(const Point& point, Fineness fineness) {
    std::vector<char> differs(runs_, 0);
    spread(runs_, [&](std::size_t r) {
        if (model_.twin(r) != r)
            return;
        const Question question{r, model_.simulated(point), fineness};
        const auto known = store_.find(keyOf(question));
        if (!known || stopped())
            return;
        const Response again = model_.simulate(r, question.point, fineness, interrupt_);
        differs[r] = again.failure != known->failure || !same(again.force, known->force) ||
                     !same(again.markers, known->markers) || !same(again.jumps, known->jumps);
    });
    if (!stopped() && std::any_of(differs.begin(), differs.end(), [](char d) { return d != 0; }))
        store_.forget();
}

std::vector<Response> Evaluator::ask(const std::vector<Question>& questions) {
    std::vector<std::string> keys;
    std::vector<Question> inner;
    std::map<std::string, std::size_t> first; // twins within a batch are simulated once
    std::vector<std::size_t> open;
    std::vector<Response> results(questions.size());
    for (std::size_t i = 0; i < questions.size(); ++i) {
        inner.push_back({model_.twin(questions[i].run), model_.simulated(questions[i].point), questions[i].fineness});
        keys.push_back(keyOf(inner[i]));
        asked_.insert(keys.back());
        if (auto known = store_.find(keys[i]))
            results[i] = std::move(*known);
        else if (first.emplace(keys[i], i).second)
            open.push_back(i);
    }
    const auto work = [&](std::size_t n) {
        const std::size_t i = open[n];
        if (stopped()) {
            results[i].failure = "interrupted";
            return;
        }
        results[i] = model_.simulate(inner[i].run, inner[i].point, inner[i].fineness, interrupt_);
        if (stopped()) // it may have ended early
            return;
        store_.keep(keys[i], results[i]);
        if (onRun) {
            const std::lock_guard<std::mutex> lock(speaking_);
            onRun();
        }
    };
    spread(open.size(), work);
    for (std::size_t i = 0; i < questions.size(); ++i)
        if (const auto at = first.find(keys[i]); at != first.end() && at->second != i)
            results[i] = results[at->second];
    for (std::size_t i = 0; i < questions.size(); ++i)
        if (results[i].failure.empty())
            model_.read(questions[i].run, questions[i].point, results[i]);
    return results;
}

void Evaluator::spread(std::size_t n, const std::function<void(std::size_t)>& work) const {
    if (loop_)
        loop_(n, work);
    else
        for (std::size_t i = 0; i < n; ++i)
            work(i);
}

std::vector<DesignResponse> Evaluator::foretell(std::size_t design, const std::vector<Point>& points) {
    std::vector<DesignResponse> results(points.size());
    spread(points.size(), [&](std::size_t i) {
        if (!stopped())
            results[i] = model_.simulateDesign(design, points[i], interrupt_);
        if (stopped()) // it may have ended early
            results[i].failure = "interrupted";
    });
    return results;
}

std::vector<std::vector<Response>> Evaluator::everywhere(const std::vector<Point>& points, Fineness fineness) {
    std::vector<Question> questions;
    for (const Point& p : points)
        for (std::size_t r = 0; r < runs_; ++r)
            questions.push_back({r, p, fineness});
    std::vector<Response> flat = ask(questions);
    std::vector<std::vector<Response>> results(points.size());
    for (std::size_t i = 0; i < flat.size(); ++i)
        results[i / runs_].push_back(std::move(flat[i]));
    return results;
}

} // namespace supercircle::diagnosis
