#include "tests/reference_simulator/linear_system.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace supercircle::reference_simulator {

namespace {

/// Gaussian elimination with row pivoting inside a band. A row stores columns i - reach to i + 2 reach.
class Band : public LinearSystem {
public:
    Band(int size, int reach) : n_(size), k_(reach), width_(3 * reach + 1), a_(size_t(size) * size_t(width_)) {}

    void clear() override { std::fill(a_.begin(), a_.end(), 0.0); }
    void add(int row, int column, double value) override { at(row, column) += value; }
    void fix(int row) override {
        std::fill_n(a_.begin() + long(row) * width_, width_, 0.0);
        at(row, row) = 1.0;
    }
    bool factor() override {
        pivot_.assign(size_t(n_), 0);
        lower_.assign(size_t(n_) * size_t(k_), 0.0);
        for (int j = 0; j < n_; ++j) {
            const int last = std::min(n_ - 1, j + k_), right = std::min(n_ - 1, j + 2 * k_);
            int best = j;
            for (int i = j + 1; i <= last; ++i)
                if (std::abs(at(i, j)) > std::abs(at(best, j)))
                    best = i;
            pivot_[size_t(j)] = best;
            if (!(std::abs(at(best, j)) > 0.0))
                return false;
            if (best != j)
                for (int c = j; c <= right; ++c)
                    std::swap(at(best, c), at(j, c));
            for (int i = j + 1; i <= last; ++i) {
                const double f = at(i, j) / at(j, j);
                lower_[size_t(j) * size_t(k_) + size_t(i - j - 1)] = f;
                if (f == 0.0)
                    continue;
                const double* from = &at(j, j);
                double* to = &at(i, j);
                for (int c = 0; c <= right - j; ++c)
                    to[c] -= f * from[c];
            }
        }
        return true;
    }
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const override {
        Eigen::VectorXd x = right;
        for (int j = 0; j < n_; ++j) {
            std::swap(x[j], x[pivot_[size_t(j)]]);
            for (int i = j + 1; i <= std::min(n_ - 1, j + k_); ++i)
                x[i] -= lower_[size_t(j) * size_t(k_) + size_t(i - j - 1)] * x[j];
        }
        for (int j = n_ - 1; j >= 0; --j) {
            for (int c = j + 1; c <= std::min(n_ - 1, j + 2 * k_); ++c)
                x[j] -= at(j, c) * x[c];
            x[j] /= at(j, j);
        }
        return x;
    }

private:
    double& at(int i, int j) { return a_[size_t(i) * size_t(width_) + size_t(j - i + k_)]; }
    [[nodiscard]] double at(int i, int j) const { return a_[size_t(i) * size_t(width_) + size_t(j - i + k_)]; }

    int n_, k_, width_;
    std::vector<double> a_, lower_;
    std::vector<int> pivot_;
};

class Sparse : public LinearSystem {
public:
    explicit Sparse(int size) : n_(size), fixed_(size_t(size), false), pattern_(size, size) {}

    void clear() override {
        entries_.clear();
        std::fill(fixed_.begin(), fixed_.end(), false);
    }
    void add(int row, int column, double value) override { entries_.emplace_back(row, column, value); }
    void fix(int row) override { fixed_[size_t(row)] = true; }
    /// The order of elimination is kept while the entries fit into its pattern.
    bool factor() override {
        if (!fill()) {
            if (pattern_.nonZeros() > 40 * n_) // contacts move: old entries are removed
                pattern_.resize(n_, n_);
            std::vector<Eigen::Triplet<double>> all;
            for (int j = 0; j < pattern_.outerSize(); ++j)
                for (Eigen::SparseMatrix<double>::InnerIterator it(pattern_, j); it; ++it)
                    all.emplace_back(it.row(), it.col(), 0.0);
            for (const auto& e : entries_)
                all.emplace_back(e.row(), e.col(), 0.0);
            for (int i = 0; i < n_; ++i)
                all.emplace_back(i, i, 0.0);
            pattern_.resize(n_, n_);
            pattern_.setFromTriplets(all.begin(), all.end());
            lu_.analyzePattern(pattern_);
            fill();
        }
        lu_.factorize(pattern_);
        return lu_.info() == Eigen::Success;
    }
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const override { return lu_.solve(right); }

private:
    /// @return whether every entry is in the pattern
    bool fill() {
        if (pattern_.nonZeros() == 0)
            return false;
        std::fill_n(pattern_.valuePtr(), pattern_.nonZeros(), 0.0);
        for (const auto& e : entries_) {
            double* at = find(e.row(), e.col());
            if (at == nullptr)
                return false;
            *at += fixed_[size_t(e.row())] ? 0.0 : e.value();
        }
        for (int i = 0; i < n_; ++i)
            if (fixed_[size_t(i)])
                *find(i, i) = 1.0;
        return true;
    }
    double* find(int row, int column) {
        const int* rows = pattern_.innerIndexPtr();
        const int *from = rows + pattern_.outerIndexPtr()[column], *to = rows + pattern_.outerIndexPtr()[column + 1];
        const int* at = std::lower_bound(from, to, row);
        return at == to || *at != row ? nullptr : pattern_.valuePtr() + (at - rows);
    }

    int n_;
    std::vector<bool> fixed_;
    std::vector<Eigen::Triplet<double>> entries_;
    Eigen::SparseMatrix<double> pattern_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu_;
};

} // namespace

std::unique_ptr<LinearSystem> linearSystem(int size, int reach) {
    if (reach > 0)
        return std::make_unique<Band>(size, reach);
    return std::make_unique<Sparse>(size);
}

} // namespace supercircle::reference_simulator
