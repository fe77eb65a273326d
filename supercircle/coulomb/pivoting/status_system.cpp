// In the base a slipping contact has one unknown (r_n, with r_t = slide r_n) and one equation (u_n), a sticking one has
// two of each, an open one none. Later changes do not touch the factorisation; they add borders:
//   base open  -> slip        unknown r_n along the cone edge       equation u_n = rhs
//              -> stick       unknowns r_n, r_t                     equations u_n = rhs, u_t = rhs
//   base slip  -> stick       unknown extra r_t                     equation u_t = rhs
//              -> other slip  unknown extra r_t                     equation r_t + sign mu r_n = 0
//              -> open        unknown u_n (releases that row)       equation r_n = 0
//   base stick -> slip        unknown u_t                           equation r_t + sign mu r_n = 0
//              -> open        unknowns u_n, u_t                     equations r_n = 0, r_t = 0
// With base B, border columns U, rows V and corner C:  S = C - V B^-1 U,  lambda = S^-1 (c - V B^-1 b),
// x = B^-1 (b - U lambda). S is small and is factored anew after each change. The slip direction of a base column must
// not change, because that would invalidate the factorisation.

#include "supercircle/coulomb/pivoting/status_system.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::coulomb {

/// Every closed contact of the base that shares a body with contact k, once.
template <class Visit>
void StatusSystem::neighbours(const MassNormalisedProblem& problem, std::size_t k, Visit&& visit) const {
    const MassNormalisedProblem::Contact& contact = problem.contact(local_[k].contact);
    for (std::int32_t s = 0; s < contact.sides; ++s) {
        if (rank_[contact.side[s].body] < 0)
            continue;
        for (const std::int32_t j : byBody_[contact.side[s].body]) {
            const MassNormalisedProblem::Contact& other = problem.contact(local_[j].contact);
            const std::int32_t done = contact.side[0].body;
            if (s == 1 && (other.side[0].body == done || (other.sides > 1 && other.side[1].body == done)))
                continue;
            visit(j);
        }
    }
}

namespace {

/// Body velocities caused by an impulse at one contact; reset at the end of the scope.
class ImpulseResponse {
public:
    ImpulseResponse(const MassNormalisedProblem& problem, const MassNormalisedProblem::Contact& contact, double rn,
                    double rt, std::vector<double>& field)
        : problem_(problem), contact_(contact), field_(field) {
        problem.apply(contact, rn, rt, field.data());
    }
    ~ImpulseResponse() {
        for (std::int32_t s = 0; s < contact_.sides; ++s) {
            const MassNormalisedProblem::Side& side = contact_.side[s];
            std::fill_n(field_.begin() + static_cast<std::ptrdiff_t>(side.velocity), side.padded, 0.0);
        }
    }
    ImpulseResponse(const ImpulseResponse&) = delete;
    ImpulseResponse& operator=(const ImpulseResponse&) = delete;
    MassNormalisedProblem::Velocity at(const MassNormalisedProblem::Contact& contact) const {
        return problem_.product(contact, field_.data());
    }

private:
    const MassNormalisedProblem& problem_;
    const MassNormalisedProblem::Contact& contact_;
    std::vector<double>& field_;
};

bool shareBody(const MassNormalisedProblem::Contact& a, const MassNormalisedProblem::Contact& b) {
    for (std::int32_t i = 0; i < a.sides; ++i)
        for (std::int32_t j = 0; j < b.sides; ++j)
            if (a.side[i].body == b.side[j].body)
                return true;
    return false;
}

} // namespace

double StatusSystem::SparseRow::dot(const double* x) const {
    double even = 0.0;
    double odd = 0.0;
    std::size_t i = 0;
    for (; i + 2 <= index.size(); i += 2) {
        even += value[i] * x[index[i]];
        odd += value[i + 1] * x[index[i + 1]];
    }
    return i < index.size() ? even + odd + value[i] * x[index[i]] : even + odd;
}

/// Fills the column of an unknown and returns where its entries begin.
std::size_t StatusSystem::borderColumn(const MassNormalisedProblem& problem, const Border& border, double* column) {
    std::fill_n(column, count_, 0.0);
    if (border.slackRow >= 0) {
        column[border.slackRow] = -1.0;
        return static_cast<std::size_t>(border.slackRow);
    }
    const ImpulseResponse response(problem, problem.contact(local_[border.k].contact), border.rn, border.rt, field_);
    auto begin = static_cast<std::int32_t>(count_);
    neighbours(problem, border.k, [&](std::int32_t j) {
        const LocalContact& local = local_[j];
        MassNormalisedProblem::Velocity u = response.at(problem.contact(local.contact));
        if (j == border.k)
            u = {u.n + local.prox * border.rn, u.t + local.prox * border.rt};
        begin = std::min(begin, local.n);
        column[local.n] = u.n;
        if (local.t >= 0)
            column[local.t] = u.t;
    });
    return static_cast<std::size_t>(begin);
}

void StatusSystem::borderRow(const MassNormalisedProblem& problem, const Border& border, SparseRow& row) {
    row.index.clear();
    row.value.clear();
    const auto add = [&row](std::int32_t index, double value) {
        row.index.push_back(index);
        row.value.push_back(value);
    };
    const LocalContact& own = local_[border.k];
    if (border.velocity < 0) {
        if (own.n >= 0)
            add(own.n, border.an + own.slide * border.at);
        if (own.t >= 0)
            add(own.t, border.at);
        return;
    }
    const double en = border.velocity == 0 ? 1.0 : 0.0;
    const ImpulseResponse response(problem, problem.contact(own.contact), en, 1.0 - en, field_);
    neighbours(problem, border.k, [&](std::int32_t j) {
        const LocalContact& local = local_[j];
        MassNormalisedProblem::Velocity u = response.at(problem.contact(local.contact));
        if (j == border.k)
            u = {u.n + local.prox * en, u.t + local.prox * (1.0 - en)};
        add(local.n, u.n + local.slide * u.t);
        if (local.t >= 0)
            add(local.t, u.t);
    });
}

double StatusSystem::entry(const MassNormalisedProblem& problem, const Border& equation, const Border& unknown) {
    if (unknown.slackRow >= 0)
        return 0.0;
    if (equation.velocity < 0)
        return equation.k == unknown.k ? equation.an * unknown.rn + equation.at * unknown.rt : 0.0;
    const MassNormalisedProblem::Contact& from = problem.contact(local_[unknown.k].contact);
    const MassNormalisedProblem::Contact& to = problem.contact(local_[equation.k].contact);
    if (!shareBody(from, to))
        return 0.0;
    const ImpulseResponse response(problem, from, unknown.rn, unknown.rt, field_);
    const MassNormalisedProblem::Velocity u = response.at(to);
    const double value = equation.velocity == 0 ? u.n : u.t;
    if (equation.k != unknown.k)
        return value;
    return value + local_[equation.k].prox * (equation.velocity == 0 ? unknown.rn : unknown.rt);
}

/// Solves with the base in place; entries before `begin` are zero. Returns the range of the non-zero solution.
EnvelopeLu::IndexRange StatusSystem::solveBase(double* x, std::size_t begin) const {
    const EnvelopeLu::IndexRange all{0, static_cast<std::size_t>(count_)};
    if (count_ == 0)
        return all;
    if (factor_ == Factor::Envelope && begin > 0)
        return envelope_.solveLocal(x, begin);
    Eigen::Map<Eigen::VectorXd> whole(x, count_);
    if (factor_ == Factor::Envelope) {
        envelope_.solve(x);
    } else if (factor_ == Factor::Sparse) {
        const Eigen::VectorXd right = whole;
        whole = sparseLu_.solve(right);
    } else {
        whole.applyOnTheLeft(lu_.permutationP());
        lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(whole);
        lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(whole);
    }
    return all;
}

/// Reserves storage for `width` borders. It never shrinks, so that allocation ends after some calls.
void StatusSystem::reserveBorders(std::size_t width) {
    if (height_ < static_cast<std::size_t>(count_)) { // only right after `factor`, without borders
        height_ = (static_cast<std::size_t>(count_) + 3) / 4 * 4;
        columns_.clear();
    }
    const std::size_t wanted = std::max<std::size_t>(64, width);
    if (columns_.size() < wanted * height_)
        columns_.resize(std::max(wanted, 2 * rows_.size()) * height_);
    if (rows_.size() < wanted)
        rows_.resize(std::max(wanted, 2 * rows_.size()));
    if (static_cast<std::size_t>(schur_.cols()) < rows_.size())
        schur_.conservativeResize(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(rows_.size()));
}

void StatusSystem::addBorder(const MassNormalisedProblem& problem, const Border& border) {
    const std::size_t j = borders_.size();
    reserveBorders(j + 1);
    SC_ASSERT(rows_.size() > j && columns_.size() >= (j + 1) * height_, "borders fit their storage");
    borders_.push_back(border);
    borders_[j].range = solveBase(column(j), borderColumn(problem, border, column(j)));
    borderRow(problem, border, rows_[j]);
    findConstant(j);
    for (std::size_t i = 0; i <= j; ++i) {
        const auto a = static_cast<Eigen::Index>(i);
        const auto b = static_cast<Eigen::Index>(j);
        schur_(a, b) = entry(problem, borders_[i], border) - rows_[i].dot(column(j));
        if (i < j)
            schur_(b, a) = entry(problem, border, borders_[i]) - rows_[j].dot(column(i));
    }
}

void StatusSystem::dropBorder(std::size_t j) {
    SC_ASSERT(j < borders_.size(), "an existing border");
    const auto at = static_cast<Eigen::Index>(j);
    const auto last = static_cast<Eigen::Index>(borders_.size()) - 1;
    if (at != last) {
        borders_[j] = borders_.back();
        std::copy_n(column(borders_.size() - 1), count_, column(j));
        std::swap(rows_[j], rows_[borders_.size() - 1]);
        schur_.col(at).head(last + 1) = schur_.col(last).head(last + 1);
        schur_.row(at).head(last + 1) = schur_.row(last).head(last + 1);
    }
    borders_.pop_back();
}

void StatusSystem::setStatus(const MassNormalisedProblem& problem, std::size_t k, ContactStatus status) {
    SC_ASSERT(k < local_.size(), "a contact of the system");
    LocalContact& local = local_[k];
    SC_ASSERT(!problem.contact(local.contact).frictionless() || status == ContactStatus::Open ||
                  status == ContactStatus::SlipPlus,
              "a frictionless contact is open or slips");
    for (std::size_t j = borders_.size(); j-- > 0;)
        if (borders_[j].k == static_cast<std::int32_t>(k))
            dropBorder(j);
    local.status = status;
    if (status == local.base)
        return;
    const auto index = static_cast<std::int32_t>(k);
    const double edge = slipSign(status) * local.mu; // r_t + edge r_n = 0 where it slips
    const Border extraT{index, -1, 0.0, 1.0, 1, 0.0, 0.0};
    const bool wasSlip = slipSign(local.base) != 0.0;
    if (local.base == ContactStatus::Open) {
        addBorder(problem, {index, -1, 1.0, status == ContactStatus::Stick ? 0.0 : -edge, 0, 0.0, 0.0});
        if (status == ContactStatus::Stick)
            addBorder(problem, extraT);
    } else if (status == ContactStatus::Open) {
        addBorder(problem, {index, local.n, 0.0, 0.0, -1, 1.0, 0.0});
        if (local.t >= 0)
            addBorder(problem, {index, local.t, 0.0, 0.0, -1, 0.0, 1.0});
    } else if (wasSlip) {
        if (status == ContactStatus::Stick)
            addBorder(problem, extraT);
        else
            addBorder(problem, {index, -1, 0.0, 1.0, -1, edge, 1.0});
    } else {
        addBorder(problem, {index, local.t, 0.0, 0.0, -1, edge, 1.0});
    }
}

void StatusSystem::setRightHandSide(std::span<const double> rhs) {
    SC_ASSERT(rhs.size() == 2 * local_.size(), "two numbers a contact");
    rhs_.assign(rhs.begin(), rhs.end());
    particular_.resize(count_);
    for (const std::int32_t k : active_) {
        particular_[local_[k].n] = rhs[2 * k];
        if (local_[k].t >= 0)
            particular_[local_[k].t] = rhs[2 * k + 1];
    }
    solveBase(particular_.data(), 0);
    for (std::size_t j = 0; j < borders_.size(); ++j)
        findConstant(j);
}

void StatusSystem::findConstant(std::size_t j) {
    if (rhs_.empty())
        return; // set together with the right-hand side
    Border& border = borders_[j];
    const double c = border.velocity < 0 ? 0.0 : rhs_[2 * border.k + border.velocity];
    border.constant = c - rows_[j].dot(particular_.data());
}

namespace {

inline void subtract(double* x, const double* a, double factor, std::size_t n) {
    const DoublePair f = {factor, factor};
    std::size_t i = 0;
    for (; i + 2 <= n; i += 2) {
        UnalignedPair* to = reinterpret_cast<UnalignedPair*>(x + i); // not auto, which would drop the relaxed alignment
        *to = *to - f * *reinterpret_cast<const UnalignedPair*>(a + i);
    }
    if (i < n)
        x[i] -= factor * a[i];
}

/// LU with partial pivoting in place (columns of n), then the solution of a x = b; false if a pivot vanishes.
bool solveSmall(double* a, std::size_t n, double* b) {
    for (std::size_t k = 0; k < n; ++k) {
        double* ak = a + k * n;
        std::size_t pivot = k;
        for (std::size_t i = k + 1; i < n; ++i)
            if (std::abs(ak[i]) > std::abs(ak[pivot]))
                pivot = i;
        if (!(std::abs(ak[pivot]) > 0.0))
            return false;
        if (pivot != k) {
            for (std::size_t j = k; j < n; ++j)
                std::swap(a[j * n + k], a[j * n + pivot]);
            std::swap(b[pivot], b[k]);
        }
        const double inverse = 1.0 / ak[k];
        for (std::size_t i = k + 1; i < n; ++i)
            ak[i] *= inverse;
        const std::size_t rest = n - k - 1;
        for (std::size_t j = k + 1; j < n; ++j)
            if (const double factor = a[j * n + k]; factor != 0.0)
                subtract(a + j * n + k + 1, ak + k + 1, factor, rest);
        subtract(b + k + 1, ak + k + 1, b[k], rest);
    }
    for (std::size_t k = n; k-- > 0;) {
        b[k] /= a[k * n + k];
        subtract(b, a + k * n, b[k], k);
    }
    return true;
}

} // namespace

bool StatusSystem::solve(std::span<double> dr) {
    const std::size_t size = borders_.size();
    SC_ASSERT(dr.size() == 2 * local_.size() && rhs_.size() == dr.size(), "the right-hand side is set");
    SC_ASSERT(size <= 2 * local_.size(), "a contact has two borders at most");
    x_ = particular_;
    if (size > 0) {
        lambda_.resize(size);
        schurLu_.resize(size * size);
        for (std::size_t j = 0; j < size; ++j) {
            lambda_[j] = borders_[j].constant;
            for (std::size_t i = 0; i < size; ++i)
                schurLu_[j * size + i] = schur_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        }
        if (!solveSmall(schurLu_.data(), size, lambda_.data()))
            return false;
        for (std::size_t j = 0; j < size; ++j) {
            const EnvelopeLu::IndexRange range = borders_[j].range;
            subtract(x_.data() + range.begin, column(j) + range.begin, lambda_[j], range.end - range.begin);
        }
    }
    std::fill(dr.begin(), dr.end(), 0.0);
    for (const std::int32_t k : active_) {
        const LocalContact& local = local_[k];
        dr[2 * k] = x_[local.n];
        dr[2 * k + 1] = local.t >= 0 ? x_[local.t] : local.slide * x_[local.n];
    }
    for (std::size_t j = 0; j < size; ++j) {
        if (borders_[j].slackRow >= 0)
            continue;
        dr[2 * borders_[j].k] += lambda_[j] * borders_[j].rn;
        dr[2 * borders_[j].k + 1] += lambda_[j] * borders_[j].rt;
    }
    double sum = 0.0;
    for (std::size_t k = 0; k < local_.size(); ++k) {
        // exactly on the status, free of round-off
        if (local_[k].status == ContactStatus::Open)
            dr[2 * k] = dr[2 * k + 1] = 0.0;
        else if (local_[k].status != ContactStatus::Stick)
            dr[2 * k + 1] = -slipSign(local_[k].status) * local_[k].mu * dr[2 * k];
        sum += dr[2 * k] + dr[2 * k + 1];
    }
    return std::isfinite(sum);
}

} // namespace supercircle::coulomb
