// The base factorisation of a StatusSystem: order of bodies and contacts, assembly, and choice of the LU. In the order
// of Cuthill & McKee a heap has a narrow band. The envelope LU without pivoting is as accurate as the dense LU with
// pivoting on all recorded and generated problems: the paths have the same pivots. If a pivot vanishes, the dense or
// sparse LU is used.

#include "supercircle/coulomb/pivoting/status_system.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::coulomb {

namespace {
/// Multiply-adds of the envelope LU above which the sparse LU, with its better order, is used.
constexpr double kEnvelopeUpTo = 1e8;
/// Number of unknowns up to which the LU with pivoting, which replaces a failed envelope LU, is dense.
constexpr Eigen::Index kDenseUpTo = 320;
} // namespace

bool StatusSystem::factor(const MassNormalisedProblem& problem, std::span<const std::int32_t> contacts,
                          std::span<const ContactStatus> status, double eps) {
    SC_ASSERT(contacts.size() == status.size(), "one status a contact");
    SC_ASSERT(eps > 0.0, "the proximal term is positive");
    local_.resize(contacts.size());
    borders_.clear();
    rhs_.clear();
    active_.clear();
    count_ = 0;
    cost_ = 0.0;
    for (std::size_t k = 0; k < local_.size(); ++k) {
        LocalContact& local = local_[k];
        SC_ASSERT(invariants::inRange(contacts[k], problem.contactCount()), "a contact of the problem");
        const MassNormalisedProblem::Contact& contact = problem.contact(contacts[k]);
        SC_ASSERT_EXPENSIVE(!contact.frictionless() || status[k] == ContactStatus::Open ||
                                status[k] == ContactStatus::SlipPlus,
                            "a frictionless contact is open or slips");
        local = LocalContact{};
        local.contact = contacts[k];
        local.mu = contact.mu;
        local.prox = eps * contact.d;
        local.base = local.status = status[k];
        if (status[k] != ContactStatus::Open)
            active_.push_back(static_cast<std::int32_t>(k));
        if (slipSign(status[k]) != 0.0)
            local.slide = -slipSign(status[k]) * local.mu;
    }
    field_.resize(problem.freeVelocity().size(), 0.0);
    collectNeighbours(problem);
    orderBodies(problem);
    orderUnknowns(problem);
    SC_ASSERT(first_.size() == static_cast<std::size_t>(count_), "one row for each unknown");
    SC_ASSERT(static_cast<std::size_t>(count_) <= 2 * active_.size(), "two unknowns a closed contact at most");
    if (count_ == 0)
        return true;
    cost_ = EnvelopeLu::cost(first_);
    if (cost_ < kEnvelopeUpTo && factorEnvelope(problem))
        return true;
    return count_ > kDenseUpTo ? factorSparse(problem) : factorDense(problem);
}

bool StatusSystem::factorEnvelope(const MassNormalisedProblem& problem) {
    factor_ = Factor::Envelope;
    envelope_.shape(first_);
    assembleBase(problem, [this](std::int32_t i, std::int32_t j, double value) { envelope_.at(i, j) += value; });
    return envelope_.factor();
}

bool StatusSystem::factorDense(const MassNormalisedProblem& problem) {
    factor_ = Factor::Dense;
    base_.setZero(count_, count_);
    assembleBase(problem, [this](std::int32_t i, std::int32_t j, double value) { base_(i, j) += value; });
    lu_.compute(base_);
    const auto diagonal = lu_.matrixLU().diagonal().array().abs();
    return std::isfinite(diagonal.sum()) && diagonal.minCoeff() > 0.0;
}

bool StatusSystem::factorSparse(const MassNormalisedProblem& problem) {
    factor_ = Factor::Sparse;
    triplets_.clear();
    assembleBase(problem,
                 [this](std::int32_t i, std::int32_t j, double value) { triplets_.emplace_back(i, j, value); });
    sparseBase_.resize(count_, count_);
    sparseBase_.setFromTriplets(triplets_.begin(), triplets_.end());
    sparseLu_.isSymmetric(true);       // the pattern is; values are not where a contact slips
    sparseLu_.setPivotThreshold(1e-3); // prefer the diagonal, which keeps the fill of the ordering
    sparseLu_.compute(sparseBase_);
    return sparseLu_.info() == Eigen::Success;
}

void StatusSystem::collectNeighbours(const MassNormalisedProblem& problem) {
    byBody_.resize(problem.bodyCount());
    rank_.assign(problem.bodyCount(), -1);
    bodies_.clear();
    for (const std::int32_t k : active_) {
        const MassNormalisedProblem::Contact& contact = problem.contact(local_[k].contact);
        for (std::int32_t s = 0; s < contact.sides; ++s) {
            const std::int32_t body = contact.side[s].body;
            if (rank_[body] == -1) {
                rank_[body] = -2;
                bodies_.push_back(body);
                byBody_[body].clear();
            }
            byBody_[body].push_back(k);
        }
    }
}

/// Breadth-first walk over bodies that share a closed contact; queue_ receives the bodies in the order of the visit.
void StatusSystem::visitBodies(const MassNormalisedProblem& problem, std::int32_t from) {
    queue_.assign(1, from);
    rank_[from] = 0;
    for (std::size_t head = 0; head < queue_.size(); ++head)
        for (const std::int32_t k : byBody_[queue_[head]]) {
            const MassNormalisedProblem::Contact& contact = problem.contact(local_[k].contact);
            for (std::int32_t s = 0; s < contact.sides; ++s)
                if (const std::int32_t body = contact.side[s].body; rank_[body] == -2) {
                    rank_[body] = 0;
                    queue_.push_back(body);
                }
        }
}

/// Cuthill & McKee (1969): breadth-first from one end of the heap, so that neighbours get close ranks.
void StatusSystem::orderBodies(const MassNormalisedProblem& problem) {
    first_.clear(); // the bodies ordered so far
    for (const std::int32_t start : bodies_) {
        if (rank_[start] != -2)
            continue;
        std::int32_t end = start;
        for (int walk = 0; walk < 3; ++walk) {
            visitBodies(problem, end);
            end = queue_.back();
            if (walk < 2)
                for (const std::int32_t body : queue_)
                    rank_[body] = -2;
        }
        first_.insert(first_.end(), queue_.begin(), queue_.end());
    }
    bodies_.swap(first_);
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        rank_[bodies_[i]] = static_cast<std::int32_t>(i);
    SC_ASSERT_EXPENSIVE(std::none_of(rank_.begin(), rank_.end(), [](std::int32_t rank) { return rank == -2; }),
                        "every body with a closed contact was visited");
}

/// Contacts in the order of their bodies; numbers the unknowns and finds the envelope.
void StatusSystem::orderUnknowns(const MassNormalisedProblem& problem) {
    key_.clear();
    for (const std::int32_t k : active_) {
        const MassNormalisedProblem::Contact& contact = problem.contact(local_[k].contact);
        std::int32_t low = 0;
        std::int32_t high = 0;
        if (contact.sides > 0) {
            const std::int32_t a = rank_[contact.side[0].body];
            const std::int32_t b = contact.sides > 1 ? rank_[contact.side[1].body] : a;
            low = std::min(a, b);
            high = std::max(a, b);
        }
        key_.push_back({high, low, k});
    }
    std::sort(key_.begin(), key_.end());
    for (std::size_t i = 0; i < key_.size(); ++i)
        active_[i] = key_[i][2];
    for (const std::int32_t body : bodies_)
        byBody_[body].clear();
    first_.clear();
    count_ = 0;
    for (const std::int32_t k : active_) {
        LocalContact& local = local_[k];
        const MassNormalisedProblem::Contact& contact = problem.contact(local.contact);
        auto first = static_cast<std::int32_t>(count_);
        for (std::int32_t s = 0; s < contact.sides; ++s) {
            std::vector<std::int32_t>& members = byBody_[contact.side[s].body];
            members.push_back(k);
            first = std::min(first, members.front() == k ? first : local_[members.front()].n);
        }
        local.n = static_cast<std::int32_t>(count_++);
        first_.push_back(first);
        if (local.status == ContactStatus::Stick) {
            local.t = static_cast<std::int32_t>(count_++);
            first_.push_back(first);
        }
    }
}

namespace {

/// Products of the rows of two contacts on one body: first letter row of i, second of j.
struct Products {
    double nn, nt, tn, tt;
};

Products products(const MassNormalisedProblem& problem, const MassNormalisedProblem::Side& i,
                  const MassNormalisedProblem::Side& j) {
    const double* in = problem.rows() + i.row;
    const double* it = in + i.padded;
    const double* jn = problem.rows() + j.row;
    const double* jt = jn + j.padded;
    DoublePair nn = {0.0, 0.0}, nt = nn, tn = nn, tt = nn;
    const auto add = [&](std::int32_t begin, std::int32_t end) {
        for (std::int32_t x = begin; x < end; x += 2) {
            const DoublePair a = *reinterpret_cast<const UnalignedPair*>(in + x);
            const DoublePair b = *reinterpret_cast<const UnalignedPair*>(it + x);
            const DoublePair c = *reinterpret_cast<const UnalignedPair*>(jn + x);
            const DoublePair d = *reinterpret_cast<const UnalignedPair*>(jt + x);
            nn += a * c;
            nt += a * d;
            tn += b * c;
            tt += b * d;
        }
    };
    add(std::max(i.begin1, j.begin1), std::min(i.end1, j.end1));
    add(std::max(i.begin1, j.begin2), std::min(i.end1, j.end2));
    add(std::max(i.begin2, j.begin1), std::min(i.end2, j.end1));
    add(std::max(i.begin2, j.begin2), std::min(i.end2, j.end2));
    return {nn[0] + nn[1], nt[0] + nt[1], tn[0] + tn[1], tt[0] + tt[1]};
}

const MassNormalisedProblem::Side& sideOn(const MassNormalisedProblem::Contact& contact, std::int32_t body) {
    return contact.side[contact.side[0].body == body ? 0 : 1];
}

} // namespace

/// Coupling of contacts i and j through one body: (equation rows)^T (unknown columns), in both directions.
template <class Add>
void StatusSystem::assemblePair(const MassNormalisedProblem& problem, const LocalContact& i, const LocalContact& j,
                                std::int32_t body, Add&& add) const {
    const Products p =
        products(problem, sideOn(problem.contact(i.contact), body), sideOn(problem.contact(j.contact), body));
    add(i.n, j.n, p.nn + j.slide * p.nt);
    if (j.t >= 0)
        add(i.n, j.t, p.nt);
    if (i.t >= 0)
        add(i.t, j.n, p.tn + j.slide * p.tt);
    if (i.t >= 0 && j.t >= 0)
        add(i.t, j.t, p.tt);
    if (&i == &j)
        return;
    add(j.n, i.n, p.nn + i.slide * p.tn);
    if (i.t >= 0)
        add(j.n, i.t, p.tn);
    if (j.t >= 0)
        add(j.t, i.n, p.nt + i.slide * p.tt);
    if (i.t >= 0 && j.t >= 0)
        add(j.t, i.t, p.tt);
}

/// Calls add(row, column, value) for every term of the base matrix.
template <class Add>
void StatusSystem::assembleBase(const MassNormalisedProblem& problem, Add&& add) const {
    for (const std::int32_t body : bodies_) {
        const std::vector<std::int32_t>& members = byBody_[body];
        for (std::size_t i = 0; i < members.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j)
                assemblePair(problem, local_[members[i]], local_[members[j]], body, add);
    }
    for (const std::int32_t k : active_) {
        const LocalContact& local = local_[k];
        add(local.n, local.n, local.prox);
        if (local.t >= 0)
            add(local.t, local.t, local.prox);
    }
}

} // namespace supercircle::coulomb
