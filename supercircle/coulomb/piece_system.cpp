// Unknowns and equations. In the base a slipping contact has one unknown (r_n, with r_t = slide r_n) and one equation
// (u_n), a sticking one has two of each, an open one none. Later changes never touch the factor; they add a border:
//
//   base open  -> slip        unknown r_n along the cone's edge     equation u_n = rhs
//              -> stick       unknowns r_n, r_t                     equations u_n = rhs, u_t = rhs
//   base slip  -> stick       unknown extra r_t                     equation u_t = rhs
//              -> other slip  unknown extra r_t                     equation r_t + sign mu r_n = 0
//              -> open        unknown u_n (frees that row)          equation r_n = 0
//   base stick -> slip        unknown u_t                           equation r_t + sign mu r_n = 0
//              -> open        unknowns u_n, u_t                     equations r_n = 0, r_t = 0
//
// With base matrix B, border columns U, rows V and corner C:  S = C - V B^-1 U,  lambda = S^-1 (c - V B^-1 b),
// x = B^-1 (b - U lambda). S is small (refactored after some 40 borders) and factored anew after each change. The
// sliding direction a base column was built with stays as it was, whatever the contact does later: changing it in place
// would silently invalidate the factor.

#include "supercircle/coulomb/piece_system.h"

#include <algorithm>
#include <cmath>

namespace supercircle::coulomb {

namespace {
/// Unknowns up to which the dense LU wins (200: 0.4 ms against several for the sparse one).
constexpr Eigen::Index kDenseUpTo = 320;
} // namespace

bool PieceSystem::factor(const Whitened& problem, std::span<const std::int32_t> contacts, std::span<const Piece> piece,
                         double eps) {
    local_.resize(contacts.size());
    borders_.clear();
    active_.clear();
    count_ = 0;
    for (std::size_t k = 0; k < local_.size(); ++k) {
        Local& local = local_[k];
        const Whitened::Contact& contact = problem.contact(contacts[k]);
        local = Local{};
        local.contact = contacts[k];
        local.mu = contact.mu;
        local.prox = eps * contact.d;
        local.base = local.piece = piece[k];
        if (piece[k] == Piece::Open)
            continue;
        active_.push_back(static_cast<std::int32_t>(k));
        local.n = static_cast<std::int32_t>(count_++);
        if (piece[k] == Piece::Stick)
            local.t = static_cast<std::int32_t>(count_++);
        else
            local.slide = -slipSign(piece[k]) * local.mu;
    }
    field_.assign(problem.freeVelocity().size(), 0.0);
    collectNeighbours(problem);
    sparse_ = count_ > kDenseUpTo;
    return count_ == 0 || (sparse_ ? factorSparse(problem) : factorDense(problem));
}

bool PieceSystem::factorDense(const Whitened& problem) {
    base_.setZero(count_, count_);
    assembleBase(problem, [this](std::int32_t i, std::int32_t j, double value) { base_(i, j) += value; });
    lu_.compute(base_);
    const auto diagonal = lu_.matrixLU().diagonal().array().abs();
    return std::isfinite(diagonal.sum()) && diagonal.minCoeff() > 0.0;
}

bool PieceSystem::factorSparse(const Whitened& problem) {
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

void PieceSystem::collectNeighbours(const Whitened& problem) {
    byBody_.resize(problem.bodyCount());
    for (auto& list : byBody_)
        list.clear();
    for (const std::int32_t k : active_) {
        const Whitened::Contact& contact = problem.contact(local_[k].contact);
        for (std::int32_t s = 0; s < contact.sides; ++s)
            byBody_[contact.side[s].body].push_back(k);
    }
}

/// Calls add(row, column, value) for every term of the base matrix.
template <class Add>
void PieceSystem::assembleBase(const Whitened& problem, Add&& add) {
    for (std::size_t b = 0; b < byBody_.size(); ++b) {
        if (byBody_[b].empty())
            continue;
        fillBodyBlock(problem, byBody_[b], static_cast<std::int32_t>(b));
        for (Eigen::Index j = 0; j < block_.cols(); ++j)
            for (Eigen::Index i = 0; i < block_.rows(); ++i)
                add(index_[i], index_[j], block_(i, j));
    }
    for (const std::int32_t k : active_) {
        const Local& local = local_[k];
        add(local.n, local.n, local.prox);
        if (local.t >= 0)
            add(local.t, local.t, local.prox);
    }
}

/// What the contacts of one body do to each other through it: (equation rows)^T (unknown columns).
void PieceSystem::fillBodyBlock(const Whitened& problem, std::span<const std::int32_t> members, std::int32_t body) {
    const auto n = static_cast<Eigen::Index>(problem.bodyPadded(body));
    left_.resize(n, 2 * static_cast<Eigen::Index>(members.size()));
    right_.resize(n, left_.cols());
    index_.clear();
    for (const std::int32_t k : members) {
        const Local& local = local_[k];
        const Whitened::Contact& contact = problem.contact(local.contact);
        const Whitened::Side& side = contact.side[contact.side[0].body == body ? 0 : 1];
        const Eigen::Map<const Eigen::VectorXd> gn(problem.rows() + side.row, n);
        const Eigen::Map<const Eigen::VectorXd> gt(problem.rows() + side.row + side.padded, n);
        const auto j = static_cast<Eigen::Index>(index_.size());
        left_.col(j) = gn;
        right_.col(j) = gn + local.slide * gt;
        index_.push_back(local.n);
        if (local.t >= 0) {
            left_.col(j + 1) = gt;
            right_.col(j + 1) = gt;
            index_.push_back(local.t);
        }
    }
    const auto size = static_cast<Eigen::Index>(index_.size());
    block_.resize(size, size);
    block_.noalias() = left_.leftCols(size).transpose() * right_.leftCols(size);
}

template <class Visit>
void PieceSystem::neighbours(const Whitened& problem, std::size_t k, Visit&& visit) const {
    const Whitened::Contact& contact = problem.contact(local_[k].contact);
    for (std::int32_t s = 0; s < contact.sides; ++s)
        for (const std::int32_t j : byBody_[contact.side[s].body])
            visit(j); // a contact sharing both bodies is visited twice: visits must overwrite, not add
}

namespace {

/// Body velocities caused by an impulse at one contact, undone at the end of the scope.
class Probe {
public:
    Probe(const Whitened& problem, const Whitened::Contact& contact, double rn, double rt, std::vector<double>& field)
        : problem_(problem), contact_(contact), field_(field) {
        problem.apply(contact, rn, rt, field.data());
    }
    ~Probe() {
        for (std::int32_t s = 0; s < contact_.sides; ++s) {
            const Whitened::Side& side = contact_.side[s];
            std::fill_n(field_.begin() + static_cast<std::ptrdiff_t>(side.velocity), side.padded, 0.0);
        }
    }
    Probe(const Probe&) = delete;
    Probe& operator=(const Probe&) = delete;
    Whitened::Velocity at(const Whitened::Contact& contact) const { return problem_.product(contact, field_.data()); }

private:
    const Whitened& problem_;
    const Whitened::Contact& contact_;
    std::vector<double>& field_;
};

} // namespace

void PieceSystem::borderColumn(const Whitened& problem, const Border& border, Eigen::Ref<Eigen::VectorXd> column) {
    column.setZero();
    if (border.slackRow >= 0) {
        column[border.slackRow] = -1.0;
        return;
    }
    const Probe probe(problem, problem.contact(local_[border.k].contact), border.rn, border.rt, field_);
    neighbours(problem, border.k, [&](std::int32_t j) {
        const Local& local = local_[j];
        Whitened::Velocity u = probe.at(problem.contact(local.contact));
        if (j == border.k)
            u = {u.n + local.prox * border.rn, u.t + local.prox * border.rt};
        column[local.n] = u.n;
        if (local.t >= 0)
            column[local.t] = u.t;
    });
}

void PieceSystem::borderRow(const Whitened& problem, const Border& border, Eigen::Ref<Eigen::VectorXd> row) {
    row.setZero();
    const Local& own = local_[border.k];
    if (border.velocity < 0) {
        if (own.n >= 0)
            row[own.n] = border.an + own.slide * border.at;
        if (own.t >= 0)
            row[own.t] = border.at;
        return;
    }
    const double en = border.velocity == 0 ? 1.0 : 0.0;
    const Probe probe(problem, problem.contact(own.contact), en, 1.0 - en, field_);
    neighbours(problem, border.k, [&](std::int32_t j) {
        const Local& local = local_[j];
        Whitened::Velocity u = probe.at(problem.contact(local.contact));
        if (j == border.k)
            u = {u.n + local.prox * en, u.t + local.prox * (1.0 - en)};
        row[local.n] = u.n + local.slide * u.t;
        if (local.t >= 0)
            row[local.t] = u.t;
    });
}

double PieceSystem::entry(const Whitened& problem, const Border& equation, const Border& unknown) {
    if (unknown.slackRow >= 0)
        return 0.0;
    if (equation.velocity < 0)
        return equation.k == unknown.k ? equation.an * unknown.rn + equation.at * unknown.rt : 0.0;
    const Probe probe(problem, problem.contact(local_[unknown.k].contact), unknown.rn, unknown.rt, field_);
    const Whitened::Velocity u = probe.at(problem.contact(local_[equation.k].contact));
    const double value = equation.velocity == 0 ? u.n : u.t;
    if (equation.k != unknown.k)
        return value;
    return value + local_[equation.k].prox * (equation.velocity == 0 ? unknown.rn : unknown.rt);
}

void PieceSystem::solveBase(Eigen::Ref<Eigen::VectorXd> x) const {
    if (count_ == 0)
        return;
    if (sparse_) {
        const Eigen::VectorXd right = x;
        x = sparseLu_.solve(right);
        return;
    }
    x.applyOnTheLeft(lu_.permutationP());
    lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(x);
    lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(x);
}

void PieceSystem::addBorder(const Whitened& problem, const Border& border) {
    const auto j = static_cast<Eigen::Index>(borders_.size());
    if (columns_.rows() < count_ || columns_.cols() <= j) { // grows only: no allocation once warm
        // A multiple of four: every column starts aligned alike, so that sums round alike whatever was solved before.
        const Eigen::Index height = std::max(columns_.rows(), (count_ + 3) / 4 * 4);
        const Eigen::Index width = columns_.cols() > j ? columns_.cols() : std::max<Eigen::Index>(64, 2 * j);
        columns_.conservativeResize(height, width);
        rows_.conservativeResize(height, width);
        schur_.conservativeResize(width, width);
    }
    borders_.push_back(border);
    auto column = columns_.col(j).head(count_);
    auto row = rows_.col(j).head(count_);
    borderColumn(problem, border, column);
    solveBase(column);
    borderRow(problem, border, row);
    for (Eigen::Index i = 0; i <= j; ++i) {
        schur_(i, j) = entry(problem, borders_[i], border) - rows_.col(i).head(count_).dot(column);
        if (i < j)
            schur_(j, i) = entry(problem, border, borders_[i]) - row.dot(columns_.col(i).head(count_));
    }
}

void PieceSystem::dropBorder(std::size_t j) {
    const auto at = static_cast<Eigen::Index>(j);
    const auto last = static_cast<Eigen::Index>(borders_.size()) - 1;
    if (at != last) {
        borders_[j] = borders_.back();
        columns_.col(at).head(count_) = columns_.col(last).head(count_);
        rows_.col(at).head(count_) = rows_.col(last).head(count_);
        schur_.col(at).head(last + 1) = schur_.col(last).head(last + 1);
        schur_.row(at).head(last + 1) = schur_.row(last).head(last + 1);
    }
    borders_.pop_back();
}

void PieceSystem::setPiece(const Whitened& problem, std::size_t k, Piece piece) {
    Local& local = local_[k];
    for (std::size_t j = borders_.size(); j-- > 0;)
        if (borders_[j].k == static_cast<std::int32_t>(k))
            dropBorder(j);
    local.piece = piece;
    if (piece == local.base)
        return;
    const auto index = static_cast<std::int32_t>(k);
    const double edge = slipSign(piece) * local.mu; // r_t + edge r_n = 0 where it slips
    const Border extraT{index, -1, 0.0, 1.0, 1, 0.0, 0.0};
    const bool wasSlip = slipSign(local.base) != 0.0;
    if (local.base == Piece::Open) {
        addBorder(problem, {index, -1, 1.0, piece == Piece::Stick ? 0.0 : -edge, 0, 0.0, 0.0});
        if (piece == Piece::Stick)
            addBorder(problem, extraT);
    } else if (piece == Piece::Open) {
        addBorder(problem, {index, local.n, 0.0, 0.0, -1, 1.0, 0.0});
        if (local.t >= 0)
            addBorder(problem, {index, local.t, 0.0, 0.0, -1, 0.0, 1.0});
    } else if (wasSlip) {
        if (piece == Piece::Stick)
            addBorder(problem, extraT);
        else
            addBorder(problem, {index, -1, 0.0, 1.0, -1, edge, 1.0});
    } else {
        addBorder(problem, {index, local.t, 0.0, 0.0, -1, edge, 1.0});
    }
}

void PieceSystem::setRightHandSide(std::span<const double> rhs) {
    rhs_.assign(rhs.begin(), rhs.end());
    particular_.resize(count_);
    for (const std::int32_t k : active_) {
        particular_[local_[k].n] = rhs[2 * k];
        if (local_[k].t >= 0)
            particular_[local_[k].t] = rhs[2 * k + 1];
    }
    solveBase(particular_);
}

namespace {

/// Dense LU with partial pivoting in place, then the solution of a x = b; false if a pivot vanishes.
bool solveSmall(Eigen::MatrixXd& a, Eigen::Index n, Eigen::VectorXd& b) {
    for (Eigen::Index k = 0; k < n; ++k) {
        Eigen::Index pivot = k;
        a.col(k).segment(k, n - k).cwiseAbs().maxCoeff(&pivot);
        pivot += k;
        if (!(std::abs(a(pivot, k)) > 0.0))
            return false;
        if (pivot != k) {
            a.row(pivot).segment(k, n - k).swap(a.row(k).segment(k, n - k));
            std::swap(b[pivot], b[k]);
        }
        const Eigen::Index rest = n - k - 1;
        a.col(k).segment(k + 1, rest) /= a(k, k);
        for (Eigen::Index j = k + 1; j < n; ++j)
            a.col(j).segment(k + 1, rest) -= a(k, j) * a.col(k).segment(k + 1, rest);
        b.segment(k + 1, rest) -= b[k] * a.col(k).segment(k + 1, rest);
    }
    for (Eigen::Index k = n; k-- > 0;) {
        b[k] /= a(k, k);
        b.head(k) -= b[k] * a.col(k).head(k);
    }
    return true;
}

} // namespace

bool PieceSystem::solve(std::span<double> dr) {
    const auto size = static_cast<Eigen::Index>(borders_.size());
    lambda_.resize(size);
    x_ = particular_;
    if (size > 0) {
        for (Eigen::Index j = 0; j < size; ++j) {
            const Border& border = borders_[j];
            const double c = border.velocity < 0 ? 0.0 : rhs_[2 * border.k + border.velocity];
            lambda_[j] = c - rows_.col(j).head(count_).dot(particular_);
        }
        schurLu_ = schur_.topLeftCorner(size, size);
        if (!solveSmall(schurLu_, size, lambda_))
            return false;
        x_.noalias() -= columns_.topLeftCorner(count_, size) * lambda_;
    }
    std::fill(dr.begin(), dr.end(), 0.0);
    for (const std::int32_t k : active_) {
        const Local& local = local_[k];
        dr[2 * k] = x_[local.n];
        dr[2 * k + 1] = local.t >= 0 ? x_[local.t] : local.slide * x_[local.n];
    }
    for (Eigen::Index j = 0; j < size; ++j) {
        if (borders_[j].slackRow >= 0)
            continue;
        dr[2 * borders_[j].k] += lambda_[j] * borders_[j].rn;
        dr[2 * borders_[j].k + 1] += lambda_[j] * borders_[j].rt;
    }
    double sum = 0.0;
    for (std::size_t k = 0; k < local_.size(); ++k) {
        // exactly on the piece, whatever the round-off
        if (local_[k].piece == Piece::Open)
            dr[2 * k] = dr[2 * k + 1] = 0.0;
        else if (local_[k].piece != Piece::Stick)
            dr[2 * k + 1] = -slipSign(local_[k].piece) * local_[k].mu * dr[2 * k];
        sum += dr[2 * k] + dr[2 * k + 1];
    }
    return std::isfinite(sum);
}

} // namespace supercircle::coulomb
