#include "supercircle/coulomb/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::coulomb {

namespace {

/// As allFinite(), four numbers at a time: x 0 is NaN unless x is finite.
template <class Matrix>
bool isFinite(const Matrix& matrix) {
    const double* x = matrix.data();
    const Eigen::Index size = matrix.size();
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    Eigen::Index i = 0;
    for (; i + 4 <= size; i += 4)
        for (int k = 0; k < 4; ++k)
            sum[k] += 0.0 * x[i + k];
    for (; i < size; ++i)
        sum[0] += 0.0 * x[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]) == 0.0;
}

bool shapeFits(const Body& body) {
    return body.A.rows() == body.A.cols() && body.A.rows() == body.vFree.size() && body.A.rows() > 0;
}

bool bodyFits(const Body& body) {
    return shapeFits(body) && isFinite(body.A) && isFinite(body.vFree);
}

/// Message for an invalid body.
std::string bodyError(const Body& body, std::size_t index) {
    const std::string name = "body " + std::to_string(index);
    if (!shapeFits(body))
        return name + ": A is " + std::to_string(body.A.rows()) + " x " + std::to_string(body.A.cols()) +
               ", vFree has " + std::to_string(body.vFree.size()) + " entries";
    return name + ": A or vFree is not finite";
}

bool sideFits(const Problem& problem, std::int32_t body, const Eigen::Matrix<double, 2, Eigen::Dynamic>& H) {
    return body == -1 || (body >= 0 && static_cast<std::size_t>(body) < problem.bodies.size() &&
                          H.cols() == problem.bodies[body].vFree.size() && isFinite(H));
}

std::string sideError(const Problem& problem, std::int32_t body, const Eigen::Matrix<double, 2, Eigen::Dynamic>& H,
                      const std::string& name) {
    if (body == -1)
        return {};
    if (body < 0 || static_cast<std::size_t>(body) >= problem.bodies.size())
        return name + ": no body " + std::to_string(body);
    const Eigen::Index n = problem.bodies[static_cast<std::size_t>(body)].vFree.size();
    if (H.cols() != n)
        return name + ": H has " + std::to_string(H.cols()) + " columns, body " + std::to_string(body) + " has " +
               std::to_string(n) + " freedoms";
    return H.allFinite() ? std::string() : name + ": H is not finite";
}

bool lawFits(const Contact& contact) {
    if (contact.kind == ContactKind::Unilateral)
        return contact.mu >= 0.0 && std::isfinite(contact.mu) && contact.w.allFinite();
    const bool either = contact.mu == 0.0 || contact.mu == std::numeric_limits<double>::infinity();
    return contact.kind == ContactKind::Bilateral && either && contact.w.allFinite();
}

/// Message for an invalid law.
std::string lawError(const Contact& contact, std::size_t index) {
    const std::string name = "contact " + std::to_string(index);
    if (contact.kind == ContactKind::Unilateral)
        return name + ": mu must be finite and not negative, w finite";
    if (contact.kind != ContactKind::Bilateral)
        return name + ": unknown kind " + std::to_string(static_cast<int>(contact.kind));
    return name + ": mu of a bilateral contact must be 0 or infinite, w finite";
}

/// Index of the first invalid item, or the number of items.
template <class Fits>
std::size_t firstInvalid(const parallel::For& loop, std::size_t items, std::vector<std::size_t>& found, Fits&& fits) {
    constexpr std::size_t kGrain = 128;
    if (parallel::chunkCount(loop, items, kGrain) < 2) {
        std::size_t i = 0;
        while (i < items && fits(i))
            ++i;
        return i;
    }
    found.assign(parallel::chunkCount(loop, items, kGrain), items);
    parallel::forChunks(loop, items, kGrain, [&](std::size_t c, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && found[c] == items; ++i)
            if (!fits(i))
                found[c] = i;
    });
    return *std::min_element(found.begin(), found.end());
}

} // namespace

std::string validate(const Problem& problem, const parallel::For& loop) {
    std::vector<std::size_t> found;
    const std::size_t b =
        firstInvalid(loop, problem.bodies.size(), found, [&](std::size_t i) { return bodyFits(problem.bodies[i]); });
    if (b < problem.bodies.size())
        return bodyError(problem.bodies[b], b);
    const std::size_t c = firstInvalid(loop, problem.contacts.size(), found, [&](std::size_t i) {
        const Contact& contact = problem.contacts[i];
        return lawFits(contact) && sideFits(problem, contact.a, contact.Ha) && sideFits(problem, contact.b, contact.Hb);
    });
    if (c < problem.contacts.size()) {
        const Contact& contact = problem.contacts[c];
        if (!lawFits(contact))
            return lawError(contact, c);
        const std::string name = "contact " + std::to_string(c);
        std::string error = sideError(problem, contact.a, contact.Ha, name + " side a");
        return error.empty() ? sideError(problem, contact.b, contact.Hb, name + " side b") : error;
    }
    if (problem.r0.size() != 0 && problem.r0.size() != 2 * static_cast<Eigen::Index>(problem.contacts.size()))
        return "warm start has " + std::to_string(problem.r0.size()) + " entries, expected " +
               std::to_string(2 * problem.contacts.size());
    if (!problem.r0.allFinite())
        return "warm start is not finite";
    return {};
}

} // namespace supercircle::coulomb
