// With A = L L^T absorbed into the rows, a contact update is two dot products and one vector update on contiguous
// doubles: about 90 multiply-adds for two shells with 18 degrees of freedom. No Delassus matrix is formed. Rods with
// degrees of freedom ordered [left half | right half | middle] have a block-arrow A, and L keeps this pattern. A row
// therefore has a run of exact zeros, which is found from the numbers and skipped.

#include "supercircle/coulomb/strategy/mass_normalised.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace supercircle::coulomb {

namespace {

constexpr std::size_t kFewContacts = 256; ///< below this a pass over all contacts does not profit from threads

constexpr std::size_t even(std::size_t n) {
    return (n + 1) & ~std::size_t{1};
}

/// Splits a row of `padded` entries into two ranges of even length without the zeros at its ends and the longest run
/// of zeros inside.
void findRanges(const double* gn, const double* gt, std::int32_t padded, MassNormalisedProblem::Side& side) {
    std::int32_t first = padded;
    std::int32_t last = 0;
    std::int32_t gapBegin = 0;
    std::int32_t gapEnd = 0;
    for (std::int32_t i = 0; i < padded; i += 2) {
        if (gn[i] == 0.0 && gt[i] == 0.0 && gn[i + 1] == 0.0 && gt[i + 1] == 0.0)
            continue;
        if (first == padded)
            first = i;
        else if (i - last > gapEnd - gapBegin) {
            gapBegin = last;
            gapEnd = i;
        }
        last = i + 2;
    }
    if (first == padded)
        first = last = 0;
    const bool split = gapEnd > gapBegin;
    side.begin1 = first;
    side.end1 = split ? gapBegin : last;
    side.begin2 = split ? gapEnd : 0;
    side.end2 = split ? last : 0;
}

/// Whether L L^T is A to round-off: a check of the Cholesky factor.
[[maybe_unused]] bool reproduces(const double* A, const std::vector<double>& L, std::size_t n) {
    for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = j; i < n; ++i) {
            double sum = 0.0;
            for (std::size_t k = 0; k <= j; ++k)
                sum += L[k * n + i] * L[k * n + j];
            if (std::abs(sum - A[j * n + i]) > 1e-10 * std::sqrt(A[i * n + i] * A[j * n + j]))
                return false;
        }
    return true;
}

} // namespace

bool MassNormalisedProblem::factor(Factor& body, const double* A) {
    const std::size_t n = body.n;
    SC_ASSERT(n > 0, "a body has at least one degree of freedom");
    const std::size_t bytes = n * n * sizeof(double);
    if (body.matrix.size() == n * n && std::memcmp(body.matrix.data(), A, bytes) == 0)
        return true;
    body.matrix.clear(); // no match until this factorisation has succeeded
    body.lower.assign(A, A + n * n);
    body.inverseDiagonal.resize(n);
    double* L = body.lower.data();
    for (std::size_t k = 0; k < n; ++k) {
        double* column = L + k * n;
        for (std::size_t j = 0; j < k; ++j) {
            const double factor = L[j * n + k];
            if (factor == 0.0)
                continue;
            const double* earlier = L + j * n;
            for (std::size_t i = k; i < n; ++i)
                column[i] -= factor * earlier[i];
        }
        // A pivot lost to cancellation is rejected like a negative one.
        if (!(column[k] > 1e-15 * A[k * n + k]) || !std::isfinite(column[k]))
            return false;
        const double pivot = std::sqrt(column[k]);
        const double inverse = 1.0 / pivot;
        body.inverseDiagonal[k] = inverse;
        column[k] = pivot;
        for (std::size_t i = k + 1; i < n; ++i)
            column[i] *= inverse;
    }
    body.matrix.assign(A, A + n * n);
    SC_ASSERT_EXPENSIVE(reproduces(A, body.lower, n), "A = L L^T");
    return true;
}

double MassNormalisedProblem::speedRoundOff() const {
    // Some unit errors from the factorisation that gave v_free and from the products. Half of it leaves bodies at rest
    // unsolved (3 were seen); twice as much lets twice the error pass, still far below any speed.
    constexpr double kUnits = 16.0;
    double largest = 0.0;
    for (const Contact& contact : contacts_) {
        double speed = std::abs(contact.wn) + std::abs(contact.wt);
        for (std::int32_t s = 0; s < contact.sides; ++s) {
            const double* w = free_.data() + contact.side[s].velocity;
            speed += std::sqrt(2.0 * contact.d * std::inner_product(w, w + contact.side[s].padded, w, 0.0));
        }
        largest = std::max(largest, speed);
    }
    return kUnits * std::numeric_limits<double>::epsilon() * largest;
}

void MassNormalisedProblem::layoutBodies(const Problem& problem) {
    bodies_.resize(problem.bodies.size());
    std::size_t offset = 0;
    longest_ = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        bodies_[b].n = static_cast<std::size_t>(problem.bodies[b].vFree.size());
        bodies_[b].padded = even(bodies_[b].n);
        bodies_[b].velocity = offset;
        offset += bodies_[b].padded;
        longest_ = std::max(longest_, bodies_[b].padded);
    }
    SC_ASSERT(longest_ % 2 == 0 && offset % 2 == 0, "velocities are padded to pairs");
    free_.assign(offset, 0.0);
}

/// Sides of a contact and the positions of their rows.
void MassNormalisedProblem::layoutContact(const coulomb::Contact& source, Contact& contact) {
    const auto add = [&](std::int32_t index) {
        SC_ASSERT_EXPENSIVE(invariants::inRange(index, bodies_.size()) && contact.sides < 2,
                            "two bodies of the problem at most");
        const Factor& body = bodies_[index];
        Side& side = contact.side[contact.sides++];
        side.body = index;
        side.padded = static_cast<std::int32_t>(body.padded);
        side.velocity = body.velocity;
        side.row = rowsUsed_;
        rowsUsed_ += 2 * body.padded;
    };
    if (source.a >= 0)
        add(source.a);
    if (source.b >= 0 && source.b != source.a)
        add(source.b);
}

void MassNormalisedProblem::fillSide(Contact& contact, Side& side, const Eigen::Matrix<double, 2, -1>& H,
                                     const Eigen::Matrix<double, 2, -1>* other, std::vector<DoublePair>& scratch) {
    const Factor& body = bodies_[side.body];
    const std::size_t n = body.n;
    DoublePair* x = scratch.data();
    SC_ASSERT(static_cast<std::size_t>(H.cols()) == n, "one column of H for each degree of freedom");
    SC_ASSERT_EXPENSIVE(other == nullptr || other->cols() == H.cols(), "both sides of self contact belong to one body");
    SC_ASSERT_EXPENSIVE(side.row + 2 * body.padded <= rows_.size() && n <= scratch.size(),
                        "the rows lie inside the storage");
    for (std::size_t i = 0; i < n; ++i) {
        x[i] = DoublePair{H.data()[2 * i], H.data()[2 * i + 1]};
        if (other)
            x[i] += DoublePair{other->data()[2 * i], other->data()[2 * i + 1]};
    }
    for (std::size_t j = 0; j < n; ++j) {
        if (x[j][0] == 0.0 && x[j][1] == 0.0)
            continue;
        const double* column = body.lower.data() + j * n;
        const DoublePair value = x[j] * DoublePair{body.inverseDiagonal[j], body.inverseDiagonal[j]};
        x[j] = value;
        for (std::size_t i = j + 1; i < n; ++i)
            x[i] -= DoublePair{column[i], column[i]} * value;
    }
    double* gn = rows_.data() + side.row;
    double* gt = gn + body.padded;
    const double* v = free_.data() + body.velocity;
    DoublePair q = {0.0, 0.0};
    DoublePair square = {0.0, 0.0};
    double cross = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        gn[i] = x[i][0];
        gt[i] = x[i][1];
        q += x[i] * DoublePair{v[i], v[i]};
        square += x[i] * x[i];
        cross += x[i][0] * x[i][1];
    }
    for (std::size_t i = n; i < body.padded; ++i)
        gn[i] = gt[i] = 0.0;
    contact.qn += q[0];
    contact.qt += q[1];
    contact.Wnn += square[0];
    contact.Wnt += cross;
    contact.Wtt += square[1];
    side.reach = std::sqrt(square[0]);
    findRanges(gn, gt, side.padded, side);
    SC_ASSERT_EXPENSIVE(side.begin1 <= side.end1 && side.begin2 <= side.end2 && side.end1 <= side.padded &&
                            side.end2 <= side.padded && (side.end2 == 0 || side.end1 <= side.begin2),
                        "the ranges of a row are disjoint and inside it");
}

void MassNormalisedProblem::fillContact(const coulomb::Contact& source, Contact& contact,
                                        std::vector<DoublePair>& scratch) {
    contact.wn = contact.qn = source.w[0];
    contact.wt = contact.qt = source.w[1];
    contact.mu = source.bilateral() ? 0.0 : source.mu;
    contact.bilateralRows = source.locked()      ? BilateralRows::Both
                            : source.bilateral() ? BilateralRows::Normal
                                                 : BilateralRows::None;
    for (std::int32_t s = 0; s < contact.sides; ++s) {
        const bool first = contact.side[s].body == source.a;
        const bool self = first && source.a == source.b;
        fillSide(contact, contact.side[s], first ? source.Ha : source.Hb, self ? &source.Hb : nullptr, scratch);
    }
    SC_ASSERT(!(contact.Wnn < 0.0) && !(contact.Wtt < 0.0), "the diagonal of a Delassus block is not negative");
    SC_ASSERT_EXPENSIVE(!(contact.Wnt * contact.Wnt > (1.0 + 1e-9) * contact.Wnn * contact.Wtt + 1e-300),
                        "a Delassus block is positive semidefinite");
    SC_ASSERT(!(contact.mu < 0.0) && std::isfinite(contact.mu), "a friction coefficient is finite, not negative");
    contact.d = 0.5 * (contact.Wnn + contact.Wtt);
}

std::string MassNormalisedProblem::build(const Problem& problem, const parallel::For& loop) {
    if (std::string error = validate(problem, loop); !error.empty())
        return error;
    SC_ASSERT(problem.r0.size() == 0 || problem.r0.size() == 2 * static_cast<Eigen::Index>(problem.contacts.size()),
              "the warm start has two numbers a contact");
    layoutBodies(problem);
    positiveDefinite_.assign(bodies_.size(), 0);
    parallel::forEach(loop, bodies_.size(), 16, [&](std::size_t b) {
        Factor& body = bodies_[b];
        if (!factor(body, problem.bodies[b].A.data()))
            return;
        positiveDefinite_[b] = 1;
        for (std::size_t j = 0; j < body.n; ++j) {
            double sum = 0.0;
            for (std::size_t i = j; i < body.n; ++i)
                sum += body.lower[j * body.n + i] * problem.bodies[b].vFree[static_cast<Eigen::Index>(i)];
            free_[body.velocity + j] = sum;
        }
    });
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        if (positiveDefinite_[b] == 0)
            return "body " + std::to_string(b) + ": A is not positive definite";
    contacts_.assign(problem.contacts.size(), Contact{});
    firstOfBody_.clear();
    rowsUsed_ = 0;
    for (std::size_t c = 0; c < contacts_.size(); ++c)
        layoutContact(problem.contacts[c], contacts_[c]);
    if (rows_.size() < rowsUsed_)
        rows_.resize(rowsUsed_);
    constexpr std::size_t kGrain = 64;
    columns_.resize(std::max(columns_.size(), parallel::chunkCount(loop, contacts_.size(), kGrain)));
    parallel::forChunks(loop, contacts_.size(), kGrain, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        columns_[chunk].resize(longest_);
        for (std::size_t c = begin; c < end; ++c)
            fillContact(problem.contacts[c], contacts_[c], columns_[chunk]);
    });
    double largest = 0.0;
    for (const Contact& contact : contacts_)
        largest = std::max(largest, contact.d);
    const double floor = largest > 0.0 ? 1e-12 * largest : 1.0;
    for (Contact& contact : contacts_) {
        contact.d = std::max(contact.d, floor);
        SC_ASSERT(!(contact.d <= 0.0), "the scale of a contact is positive");
    }
    return {};
}

void MassNormalisedProblem::assemble(std::span<const double> r, std::vector<double>& w) const {
    SC_ASSERT(r.size() == 2 * contacts_.size(), "two impulses a contact");
    w = free_;
    for (std::size_t c = 0; c < contacts_.size(); ++c)
        if (r[2 * c] != 0.0 || r[2 * c + 1] != 0.0)
            apply(contacts_[c], r[2 * c], r[2 * c + 1], w.data());
}

void MassNormalisedProblem::listContacts() {
    if (!firstOfBody_.empty())
        return;
    firstOfBody_.assign(bodies_.size() + 1, 0);
    for (const Contact& contact : contacts_)
        for (std::int32_t s = 0; s < contact.sides; ++s)
            ++firstOfBody_[contact.side[s].body + 1];
    std::partial_sum(firstOfBody_.begin(), firstOfBody_.end(), firstOfBody_.begin());
    ofBody_.resize(firstOfBody_.back());
    for (std::size_t c = contacts_.size(); c-- > 0;)
        for (std::int32_t s = 0; s < contacts_[c].sides; ++s)
            ofBody_[--firstOfBody_[contacts_[c].side[s].body + 1]] = static_cast<std::int32_t>(2 * c) + s;
    // Filling from the back has moved every start to that of its own body; shift the starts into place.
    firstOfBody_.erase(firstOfBody_.begin());
    firstOfBody_.push_back(ofBody_.size());
    SC_ASSERT(firstOfBody_.size() == bodies_.size() + 1 && firstOfBody_.front() == 0, "one list of contacts a body");
    SC_ASSERT_EXPENSIVE(
        invariants::forAll(bodies_.size(), [&](std::size_t b) { return invariants::strictlyRising(sidesOf(b)); }),
        "the contacts of a body are in rising order");
}

/// Body by body. Every body sums its contacts in the same order as one loop over all contacts.
void MassNormalisedProblem::assemble(std::span<const double> r, std::vector<double>& w, const parallel::For& loop) {
    if (!loop || contacts_.size() < kFewContacts)
        return assemble(r, w);
    listContacts();
    w = free_;
    parallel::forEach(loop, bodies_.size(), 32, [&](std::size_t b) {
        for (const std::int32_t at : sidesOf(b)) {
            const auto c = static_cast<std::size_t>(at / 2);
            if (r[2 * c] != 0.0 || r[2 * c + 1] != 0.0)
                applySide(contacts_[c].side[at % 2], r[2 * c], r[2 * c + 1], w.data());
        }
    });
}

Residual MassNormalisedProblem::residual(std::span<const double> r, const std::vector<double>& w,
                                         const parallel::For& loop) {
    if (!loop || contacts_.size() < kFewContacts)
        return residual(r, w);
    SC_ASSERT(r.size() == 2 * contacts_.size() && w.size() == free_.size(), "impulses and velocities fit the problem");
    velocity_.resize(contacts_.size());
    parallel::forEach(loop, contacts_.size(), 128,
                      [&](std::size_t c) { velocity_[c] = velocity(contacts_[c], w.data()); });
    ResidualSum sum;
    for (std::size_t c = 0; c < contacts_.size(); ++c)
        addResidual(contacts_[c], velocity_[c], r[2 * c], r[2 * c + 1], sum);
    return sum.result();
}

Residual MassNormalisedProblem::residual(std::span<const double> r, const std::vector<double>& w) const {
    SC_ASSERT(r.size() == 2 * contacts_.size() && w.size() == free_.size(), "impulses and velocities fit the problem");
    ResidualSum sum;
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
        const Contact& contact = contacts_[c];
        const Velocity u = velocity(contact, w.data());
        addResidual(contact, u, r[2 * c], r[2 * c + 1], sum);
    }
    return sum.result();
}

void MassNormalisedProblem::bodyVelocities(const std::vector<double>& w, std::vector<Eigen::VectorXd>& v,
                                           const parallel::For& loop) const {
    SC_ASSERT(w.size() == free_.size(), "one mass-normalised velocity for each degree of freedom");
    v.resize(bodies_.size());
    parallel::forEach(loop, bodies_.size(), 32, [&](std::size_t b) {
        const Factor& body = bodies_[b];
        v[b].resize(static_cast<Eigen::Index>(body.n));
        for (std::size_t j = body.n; j-- > 0;) {
            double sum = w[body.velocity + j];
            for (std::size_t i = j + 1; i < body.n; ++i)
                sum -= body.lower[j * body.n + i] * v[b][static_cast<Eigen::Index>(i)];
            v[b][static_cast<Eigen::Index>(j)] = sum * body.inverseDiagonal[j];
        }
    });
}

} // namespace supercircle::coulomb
