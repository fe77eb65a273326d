#include "plugin/identification/diagnosis/box_qp.h"
#include "supercircle/support/dense.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace supercircle::diagnosis {

namespace {

/// Solves for the coordinates that are not at a bound; false if that leaves the box.
bool solveFree(const Eigen::MatrixXd& G, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
               const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < x.size(); ++i)
        if (x[i] > lower[i] && x[i] < upper[i])
            free.push_back(i);
    const auto n = static_cast<Eigen::Index>(free.size());
    if (n == 0)
        return true;
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd b(n);
    const Eigen::VectorXd gradient = g - G * x;
    for (Eigen::Index i = 0; i < n; ++i) {
        b[i] = gradient[free[static_cast<std::size_t>(i)]];
        for (Eigen::Index j = 0; j < n; ++j)
            A(i, j) = G(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
    }
    const Eigen::VectorXd step = dense::solveLdlt(A, b);
    Eigen::VectorXd to = x;
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index at = free[static_cast<std::size_t>(i)];
        to[at] += step[i];
        if (!std::isfinite(to[at]) || to[at] < lower[at] || to[at] > upper[at])
            return false;
    }
    x = to;
    return true;
}

} // namespace

Eigen::VectorXd solveBoxQp(const Eigen::MatrixXd& Gin, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                           const Eigen::VectorXd& upper) {
    Eigen::MatrixXd G = Gin;
    const double scale = std::max(1e-300, G.diagonal().maxCoeff());
    G.diagonal().array() += 1e-12 * scale;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(g.size()).cwiseMax(lower).cwiseMin(upper);
    for (int sweep = 0; sweep < 400; ++sweep) {
        double moved = 0.0;
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            const double to = std::clamp(x[i] + (g[i] - G.row(i).dot(x)) / G(i, i), lower[i], upper[i]);
            moved = std::max(moved, std::abs(to - x[i]) * std::sqrt(G(i, i)));
            x[i] = to;
        }
        if (moved < 1e-9)
            break;
        if (sweep % 10 == 4)
            solveFree(G, g, lower, upper, x);
    }
    return x;
}

} // namespace supercircle::diagnosis
