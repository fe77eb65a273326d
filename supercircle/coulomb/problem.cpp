#include "supercircle/coulomb/problem.h"

#include <cmath>
#include <limits>

namespace supercircle::coulomb {

namespace {

std::string bodyFault(const Body& body, std::size_t index) {
    const bool finite = body.A.allFinite() && body.vFree.allFinite();
    const bool fits = body.A.rows() == body.A.cols() && body.A.rows() == body.vFree.size() && body.A.rows() > 0;
    if (fits && finite)
        return {};
    const std::string name = "body " + std::to_string(index);
    if (!fits)
        return name + ": A is " + std::to_string(body.A.rows()) + " x " + std::to_string(body.A.cols()) +
               ", vFree has " + std::to_string(body.vFree.size()) + " entries";
    return name + ": A or vFree is not finite";
}

bool sideFits(const Problem& problem, std::int32_t body, const Eigen::Matrix<double, 2, Eigen::Dynamic>& H) {
    return body == -1 || (body >= 0 && static_cast<std::size_t>(body) < problem.bodies.size() &&
                          H.cols() == problem.bodies[body].vFree.size() && H.allFinite());
}

std::string sideFault(const Problem& problem, std::int32_t body, const Eigen::Matrix<double, 2, Eigen::Dynamic>& H,
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

std::string lawFault(const Contact& contact, std::size_t index) {
    if (contact.kind == Kind::Unilateral && contact.mu >= 0.0 && std::isfinite(contact.mu) && contact.w.allFinite())
        return {};
    const std::string name = "contact " + std::to_string(index);
    if (contact.kind == Kind::Unilateral)
        return name + ": mu must be finite and not negative, w finite";
    if (contact.kind != Kind::Bilateral)
        return name + ": unknown kind " + std::to_string(static_cast<int>(contact.kind));
    const bool either = contact.mu == 0.0 || contact.mu == std::numeric_limits<double>::infinity();
    return either && contact.w.allFinite() ? std::string()
                                           : name + ": mu of a bilateral contact must be 0 or infinite, w finite";
}

} // namespace

std::string findFault(const Problem& problem) {
    for (std::size_t b = 0; b < problem.bodies.size(); ++b)
        if (std::string fault = bodyFault(problem.bodies[b], b); !fault.empty())
            return fault;
    for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
        const Contact& contact = problem.contacts[c];
        if (std::string fault = lawFault(contact, c); !fault.empty())
            return fault;
        if (sideFits(problem, contact.a, contact.Ha) && sideFits(problem, contact.b, contact.Hb))
            continue; // the usual way: no string is built
        const std::string name = "contact " + std::to_string(c);
        std::string fault = sideFault(problem, contact.a, contact.Ha, name + " side a");
        if (fault.empty())
            fault = sideFault(problem, contact.b, contact.Hb, name + " side b");
        if (!fault.empty())
            return fault;
    }
    if (problem.r0.size() != 0 && problem.r0.size() != 2 * static_cast<Eigen::Index>(problem.contacts.size()))
        return "warm start has " + std::to_string(problem.r0.size()) + " entries, expected " +
               std::to_string(2 * problem.contacts.size());
    if (!problem.r0.allFinite())
        return "warm start is not finite";
    return {};
}

} // namespace supercircle::coulomb
