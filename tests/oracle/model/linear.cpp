#include "tests/oracle/model/linear.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace supercircle::oracle {

namespace {

/// Gaussian elimination with row pivoting inside a band; a row keeps its columns i - reach .. i + 2 reach.
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
    explicit Sparse(int size) : n_(size), fixed_(size_t(size), false) {}

    void clear() override {
        entries_.clear();
        std::fill(fixed_.begin(), fixed_.end(), false);
    }
    void add(int row, int column, double value) override { entries_.emplace_back(row, column, value); }
    void fix(int row) override { fixed_[size_t(row)] = true; }
    bool factor() override {
        std::vector<Eigen::Triplet<double>> kept;
        for (const auto& e : entries_)
            if (!fixed_[size_t(e.row())])
                kept.push_back(e);
        for (int i = 0; i < n_; ++i)
            if (fixed_[size_t(i)])
                kept.emplace_back(i, i, 1.0);
        Eigen::SparseMatrix<double> a(n_, n_);
        a.setFromTriplets(kept.begin(), kept.end());
        lu_.compute(a);
        return lu_.info() == Eigen::Success;
    }
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const override { return lu_.solve(right); }

private:
    int n_;
    std::vector<bool> fixed_;
    std::vector<Eigen::Triplet<double>> entries_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu_;
};

} // namespace

std::unique_ptr<LinearSystem> linearSystem(int size, int reach) {
    if (reach > 0)
        return std::make_unique<Band>(size, reach);
    return std::make_unique<Sparse>(size);
}

} // namespace supercircle::oracle
